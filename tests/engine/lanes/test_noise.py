"""Disturbances drawn in vector lanes against those that the loop engine draws."""

import numpy as np
import pytest

from hilc_cli.disturbance.streams import Bounded, Distribution, Disturbance
from hilc_cli.engine.lanes.kinds import Kind, member
from hilc_cli.engine.lanes.lanes import BLOCK, LANES, WORD_ROWS, Field, Noise, Words
from hilc_cli.engine.lanes.noise import NONE, draw_output, draw_pose, draw_state
from hilc_cli.engine.lanes.packs import Pack
from hilc_cli.reference.sampled import Floats
from tests.engine.experiments import experiment_of, law_of
from tests.reference.paths import paper_reference

ITERATION = 5
FUNCTIONS = {"state": draw_state, "output": draw_output, "initial_pose": draw_pose}
TARGETS = {"state": Noise.STATE, "output": Noise.OUTPUT, "initial_pose": Noise.POSE}


def source(distribution: Distribution, lane: int) -> Bounded:
    size = 10.0 ** (-lane % 7)
    bound = (size, 0.0 if lane % 5 == 0 else 2 * size, 3 * size)
    return Bounded(bound, distribution, (size / 3, size, 30 * size), lane % 2 == 1)


def disturbances(distribution: Distribution) -> list[Disturbance]:
    kinds = [source(distribution, lane) for lane in range(LANES)]
    return [Disturbance(2**64 - 1 - 2**33 * i, k, k, k) for i, k in enumerate(kinds)]


def drawn_in_lanes(name: str, cases: list[Disturbance], first: int, count: int) -> Floats:
    """Offsets of all lanes, shape (count, 3, LANES)."""
    reference = paper_reference("circle", 0.1)
    law = law_of(0.5, 0.25, 0.25)
    members = [member(experiment_of(reference, law, disturbance=case)) for case in cases]
    kind = Kind.of(members[0])
    pack = Pack(reference, kind)
    pack.fill(members)
    words = pack.words.reshape(WORD_ROWS, LANES)
    words[Words.PASS :] = ITERATION * words[Words.FREQUENCY : Words.PASS]
    FUNCTIONS[name](pack.noise, pack.lanes, pack.words, kind.state, first, count)
    rows = pack.noise.reshape(-1, LANES)
    return rows[TARGETS[name] :][: 3 * count].reshape(count, 3, LANES)


@pytest.mark.parametrize("count", [1, BLOCK - 1, BLOCK])
@pytest.mark.parametrize("name", ["state", "output"])
@pytest.mark.parametrize("distribution", ["uniform", "truncated-normal"])
def test_lanes_draw_the_numbers_of_the_loop_engine(
    distribution: Distribution, name: str, count: int
) -> None:
    cases, first = disturbances(distribution), 37
    found = drawn_in_lanes(name, cases, first, count)
    for lane, case in enumerate(cases):
        expected = getattr(case, f"of_{name}")(ITERATION, first + count)
        np.testing.assert_allclose(found[:, :, lane], expected[first:], rtol=1e-13)


@pytest.mark.parametrize("distribution", ["uniform", "truncated-normal"])
def test_lanes_scatter_the_initial_pose_like_the_loop_engine(distribution: Distribution) -> None:
    cases = disturbances(distribution)
    found = drawn_in_lanes("initial_pose", cases, 0, 1)
    for lane, case in enumerate(cases):
        expected = case.of_initial_pose(ITERATION)
        np.testing.assert_allclose(found[0, :, lane], expected, rtol=1e-13)


def test_nothing_is_drawn_without_a_disturbance() -> None:
    pack = Pack(paper_reference("circle", 0.1), Kind())
    draw_state(pack.noise, pack.lanes, pack.words, NONE, 0, BLOCK)
    assert not pack.noise.any()


def test_rows_of_the_lanes_do_not_overlap() -> None:
    starts = [int(field) for field in Field]
    assert starts == sorted(set(starts))
