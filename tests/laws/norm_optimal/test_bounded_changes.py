"""Steps of the interior-point method, against what they are by its equations."""

from __future__ import annotations

import numpy as np
import pytest

from hilc_cli.laws.norm_optimal.bounded_changes import Inside, moved_inside, towards_centre
from hilc_cli.reference.sampled import Floats

N = 7


def somewhere(seed: int, far: float) -> tuple[Inside, Floats]:
    """Where a search is, and a solution that leads so far away."""
    random = np.random.default_rng(seed)
    inside = Inside(random.normal(size=(N, 2)), *random.uniform(0.2, 2, (4, N, 2)))
    return inside, inside.changes + far * random.normal(size=(N, 2))


def multipliers(inside: Inside, changes: Floats, products: tuple[Floats, Floats]) -> Floats:
    """Those with which products are as wanted at other changes, to first order, by both bounds."""
    move = changes - inside.changes
    return np.array(
        [
            (products[0] - inside.push_up * move) / inside.below,
            (products[1] + inside.push_down * move) / inside.above,
        ]
    )


@pytest.mark.parametrize("far", [0.01, 0.5, 3.0])
@pytest.mark.parametrize("seed", range(3))
def test_step_is_that_of_predictor_and_corrector(seed: int, far: float) -> None:
    inside, straight = somewhere(seed, far)
    # The predictor: all products are to be none.
    rooms = np.array([inside.below, inside.above])
    pushes = np.array([inside.push_up, inside.push_down])
    move = straight - inside.changes
    moves = np.array([move, -move])
    pushed = multipliers(inside, straight, (np.zeros((N, 2)), np.zeros((N, 2)))) - pushes
    length = min(1.0, *(-rooms / moves)[moves < 0], *(-pushes / pushed)[pushed < 0])
    gap = float((rooms * pushes).sum())
    left = ((rooms + length * moves) * (pushes + length * pushed)).sum() / gap
    centre = left**3 * gap / (4 * N)
    slopes = np.zeros((N, 2))
    assert towards_centre(inside, straight, gap, slopes) == pytest.approx(centre, rel=1e-9)
    # The corrector: what the predictor makes of the products beside that is taken off.
    wanted = centre - moves * pushed
    up, down = wanted / rooms
    assert slopes == pytest.approx(down - up, rel=1e-9, abs=1e-12)

    target = inside.changes + far * np.random.default_rng(9).normal(size=(N, 2))
    away = target - inside.changes
    aways = np.array([away, -away])
    changed = multipliers(inside, target, (wanted[0], wanted[1])) - pushes
    most = max(1.0, (-aways / rooms).max(), (-changed / pushes).max())
    length = 1.0 if most == 1.0 else 0.99 / most
    moved_inside(inside, straight, target, centre, 0.99)
    assert np.array([inside.below, inside.above]) == pytest.approx(rooms + length * aways)
    assert np.array([inside.push_up, inside.push_down]) == pytest.approx(pushes + length * changed)
