"""The net below a learning law: what it takes for worse, and what it does then."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hilc_cli as hilc
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.laws.law import Iteration, LastIteration, Learner, Plan, Task
from hilc_cli.laws.safety_net import Judge, SafetyNetLaw, wheel_error
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.sweeps.planning import plan_sweep
from tests.laws.test_arriving import scenario

TOO_LARGE: Mapping[str, dict[str, Any]] = {
    "learning": {"law": "hybrid", "gains": {"l1": 40}},
    "with-feedback": {"law": "hybrid", "gains": {"l1": 60, "l2": 5, "l3": 1}},
    "previous-heading": {"law": "hybrid", "gains": {"l1": 40}, "gain_heading": "previous"},
    "pid": {"law": "pid", "gains": {"kp": 40, "kd": 3}},
}


def alarms(errors: Floats) -> list[int]:
    """Passes after which the judge finds that they have become clearly worse."""
    judge, found = Judge(), []
    for number, error in enumerate(errors.tolist()):
        if judge.is_worse(error):
            found.append(number)
            judge.start_anew()
    return found


@pytest.mark.parametrize("chance", ["readings", "starts", "rounding"])
def test_noise_is_not_taken_for_worse(chance: str) -> None:
    """Less than one false alarm in 500 passes, while learning and long after."""
    random, count = np.random.default_rng(5), 0
    for _ in range(100):
        learned = np.exp(-0.5 * np.arange(60))
        errors = {
            "readings": (learned + 0.02) * np.exp(random.normal(0, 0.2, 60)),
            "starts": np.hypot(learned, np.linalg.norm(random.normal(0, 0.01, (60, 3)), axis=1)),
            "rounding": learned + 1e-13 * random.uniform(size=60),
        }[chance]
        count += len(alarms(errors))
    assert count <= 12


@pytest.mark.parametrize(("growth", "passes"), [(1.1, 9), (1.5, 5), (2.0, 5), (1e3, 1)])
def test_what_grows_is_soon_noticed(growth: float, passes: int) -> None:
    random = np.random.default_rng(6)
    for _ in range(20):
        quiet = np.exp(random.normal(0, 0.01, 20))
        grows = quiet[-1] * growth ** np.arange(1, 15)
        (first, *_) = alarms(np.concatenate([quiet, grows]))
        assert 20 <= first < 20 + passes


def test_a_single_bad_pass_is_bad_luck_but_not_any() -> None:
    errors = np.exp(np.random.default_rng(7).normal(0, 0.02, 40))
    errors[25] *= 6
    assert alarms(errors) == []
    errors[25] *= 2
    assert alarms(errors) == [25]
    errors[25] = np.inf
    assert alarms(errors) == [25]


def test_a_turn_on_the_spot_has_an_error_too() -> None:
    nothing = np.zeros(3)
    iteration = Iteration(nothing, nothing, nothing, nothing, np.array([0.1, -0.1, 0.1]))
    assert wheel_error(iteration, 0.25) == pytest.approx(0.025)


class Doubling:
    """A law that adds 1 to its first wheel speed in each step, whatever comes of it."""

    def learner(self, task: Task) -> Learner:
        def after(last: Iteration) -> Plan:
            return Plan(last.left + 1, last.right - 2, task.reference.poses)

        return LastIteration(task, after)


def test_it_goes_back_to_the_best_pass_and_takes_half_the_step() -> None:
    reference = Reference("point", 0.1, np.zeros(3), np.zeros(3), np.zeros(3))
    start = np.zeros(2)
    learner = SafetyNetLaw(Doubling(), 0.1).learner(Task(reference, start, start, np.inf))

    def run(error: float) -> tuple[float, float, Mapping[str, float]]:
        plan = learner.plan()
        off = np.full(3, error)
        figures = learner.learn(Iteration(plan.left, plan.right, off, 0 * off, 0 * off))
        return float(plan.left[0]), float(plan.right[0]), figures

    sent = [run(error) for error in (1.0, 0.5, 30.0, 0.4, 11.0, 0.3)]
    assert [left for left, _, _ in sent] == [1, 2, 3, 2.5, 3, 2.75]
    assert [right for _, right, _ in sent] == [-2, -4, -6, -5, -6, -5.5]
    assert [dict(figures) for _, _, figures in sent[2:5]] == [
        {"step_share": 0.5, "returns_to_best": 1.0},
        {"step_share": 0.5, "returns_to_best": 1.0},
        {"step_share": 0.25, "returns_to_best": 2.0},
    ]


@pytest.mark.parametrize("law", TOO_LARGE)
def test_gains_that_are_too_large_end_no_worse_than_their_best_pass(law: str) -> None:
    runs = [
        hilc.run(
            scenario(
                {**TOO_LARGE[law], "b_w": None, "safety_net": net},
                iterations=60,
                initial_input=first,
            )
        )
        for net, first in ((False, "zero"), (True, "zero"), (True, "feedforward"))
    ]
    without, caught, fed = (run.metrics["rms_position_error_m"] for run in runs)
    assert without[-1] > 1e9
    assert caught[-1] < 1.1 * caught.min() < 0.1 * without.min()
    assert fed[-1] < 1.1 * fed.min()
    last = runs[1].learning.last()
    assert last["returns_to_best"] >= 1 and last["step_share"] == 0.5 ** last["returns_to_best"]
    (warning,) = [text for text in runs[1].warnings if "safety net" in text]
    assert warning.endswith(
        f"steps are now {last['step_share']:g} of what the gains say: give smaller gains"
    )


def test_gains_that_suit_are_left_alone(folder: Path) -> None:
    law = {"law": "hybrid", "gains": {"l1": 0.5, "l2": 1}}
    without = hilc.run(scenario(law, iterations=20))
    run = hilc.run(scenario({**law, "safety_net": True}, iterations=20))
    for column in ("rms_position_error_m", "max_wheel_speed_rad_s"):
        assert run.metrics[column].tolist() == without.metrics[column].tolist()
    assert run.learning.last() == {"step_share": 1.0, "returns_to_best": 0.0}
    run.write("one", plots=False)
    assert (
        Path("one/learning.csv")
        .read_text()
        .startswith("iteration,step_share,returns_to_best\n0,1.0,0.0\n")
    )
    again = hilc.load_scenario("one/scenario.yaml")
    assert isinstance(again.experiment().law, SafetyNetLaw)
    # Nothing is written of a net that is not there.
    made = hilc.load_scenario(scenario(law))
    assert "safety_net" not in made.resolved()["controller"]
    assert isinstance(made.experiment().law, HybridLaw)


def test_sweeps_with_a_net_are_single_runs() -> None:
    base = hilc.load_scenario(scenario(TOO_LARGE["learning"], iterations=12))
    vary = {"controller.safety_net": [False, True], "controller.gains.l1": [0.5, 40]}
    plan = plan_sweep(base, vary)
    assert not plan.in_lanes
    found = hilc.sweep(plan)
    for case in range(4):
        values = {key: found.values[key][case] for key in vary}
        run = hilc.run(hilc.load_scenario(scenario(TOO_LARGE["learning"], iterations=12), values))
        assert found.columns["rms_position_error_m"][case] == pytest.approx(
            run.metrics["rms_position_error_m"][-1], abs=1e-9
        )
