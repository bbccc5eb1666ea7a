"""Verdicts of ``hilc check``: a part of the benchmark, and each kind of fault with its numbers."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import hilc_cli as hilc
from hilc_cli.theory.findings import disturbed_rows
from hilc_cli.theory.learning import transient
from hilc_cli.theory.learning.outcome import Outcome

BENCHMARK = Path(__file__).parents[1] / "benchmarks" / "check_verdicts.py"
SEEDS = range(31_000, 31_016)
STRAIGHT = {
    "name": "straight",
    "sample_time": "50 ms",
    "start": {"x": 1, "y": 0, "heading": "20 deg"},
    "segments": [{"line": {"length": 3, "speed": 0.25}}],
}
TURN = {
    "name": "turn",
    "sample_time": "50 ms",
    "start": {"x": 0, "y": 0, "heading": 0},
    "segments": [
        {"line": {"length": 1, "speed": 0.2}},
        {"arc": {"radius": 0.6, "turn": "right", "sweep": "150 deg", "speed": 0.2}},
        {"line": {"length": 1, "speed": 0.2}},
    ],
}
ROBOT = {"wheel_radius": 0.04, "wheel_separation": 0.2, "turn_convention": "rep103"}


@pytest.fixture(autouse=True)
def short_horizon(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """What comes long after the scenarios' iterations is of no concern here."""
    monkeypatch.setattr(transient, "ITERATIONS", 60)
    yield


@pytest.fixture(scope="module")
def benchmark() -> ModuleType:
    specification = importlib.util.spec_from_file_location("check_verdicts", BENCHMARK)
    assert specification is not None
    assert specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    sys.modules["check_verdicts"] = module  # its dataclasses look themselves up there
    specification.loader.exec_module(module)
    return module


def test_random_scenarios_do_as_their_verdict_says(benchmark: ModuleType) -> None:
    cases = benchmark.judge(SEEDS, 1)
    assert {case.verdict for case in cases} == {
        benchmark.FINE,
        benchmark.WARNED,
        benchmark.IMPOSSIBLE,
    }
    assert [case for case in cases if case.is_not_fine or case.is_not_impossible] == []


def test_wrong_verdicts_are_counted(benchmark: ModuleType) -> None:
    fine = benchmark.Case(1, "pid", benchmark.FINE, 0.1, 1.0, 1.0, 0.21, "", 0.1)
    impossible = benchmark.Case(2, "pid", benchmark.IMPOSSIBLE, 0.1, 1.0, 0.9, 0.44, "", 0.1)
    assert fine.is_not_fine
    assert impossible.is_not_impossible
    text = benchmark.table([fine, impossible])
    assert "called fine and is not           1 of    1: 100.0 %" in text
    assert "called impossible and is not     1 of    1: 100.0 %" in text


def scenario(trajectory: object, controller: dict[str, Any], **more: Any) -> hilc.Scenario:
    return hilc.load_scenario(
        {
            "name": "given",
            "trajectory": trajectory,
            "robot": ROBOT,
            "initial_input": "feedforward",
            "controller": controller,
            **more,
        }
    )


def amplified(**start: Any) -> hilc.Scenario:
    """Learning by the error and its change on a straight line, from starts that are off."""
    return scenario(
        STRAIGHT,
        {"law": "pid", "gains": {"kp": 0.6, "kd": 0.5}, "b_w": 9},
        model={"wheel_radius": 0.039},
        iterations=25,
        disturbance={"seed": 11, "initial_pose": start},
    )


def test_starts_that_learning_multiplies_are_no_fine_scenario() -> None:
    given = amplified(bound=["3 cm", "1 cm", "3 deg"])
    before, found = hilc.check(given), hilc.check(given, simulate=True)
    assert before.outcome is Outcome.DROWNED
    assert any("learning cannot help much" in text for text in before.warnings)
    assert found.failures[0].startswith("the simulated error goes from ")
    (text,) = (text for text in found.warnings if "swings the whole path" in text)
    # By hand: sqrt((0.03^2 + 0.01^2 + (3 deg * 3 m)^2) / 3) = 0.0925 m.
    assert "0.093 m (RMS) off where it is worst, 3.3 % of the path's size, anew" in text
    assert found.simulated is not None
    assert found.simulated.errors_m[-1] > 2 * found.simulated.errors_m[0]
    assert found.outcome is Outcome.MADE_WORSE


def test_starts_that_are_off_the_same_way_are_learned() -> None:
    found = hilc.check(amplified(bound=["2 mm", "2 mm", "0.1 deg"], repeat=True), simulate=True)
    assert found.failures == ()
    assert found.expected is not None
    assert found.simulated is not None
    assert found.simulated.errors_m[-1] < 2 * found.expected.foretold_m


def test_learning_that_works_for_a_while_is_not_called_impossible() -> None:
    gains = {"l1": 0.6, "l2": 16, "lateral": 0.2}
    given = scenario(
        TURN,
        {"gains": gains, "compensation": "off", "b_w": 8.5},
        model={"wheel_separation": 0.17},
        iterations=20,
    )
    found, beside = hilc.check(given), hilc.check(given, simulate=True)
    for each in (found, beside):
        assert each.failures == ()
        assert any("ripples" in text for text in each.warnings)
    assert found.outcome is Outcome.GROWS_LATER
    assert found.expected is not None
    assert beside.simulated is not None
    errors = beside.simulated.errors_m
    assert errors[-1] < errors[0] / 10
    assert found.expected.foretold_m == pytest.approx(errors[-1], rel=0.3)


def test_simulation_has_the_last_word() -> None:
    # From wheels at rest the theory is out of its range; the run tells.
    given = scenario(
        TURN,
        {"gains": {"l1": 0.02}, "compensation": "off", "b_w": None},
        iterations=6,
        initial_input="zero",
    )
    found, beside = hilc.check(given), hilc.check(given, simulate=True)
    assert found.outcome is Outcome.OUT_OF_RANGE
    assert any("cannot be foretold" in text for text in found.warnings)
    assert not any("cannot be foretold" in text for text in beside.warnings)
    assert beside.outcome is not None
    assert beside.outcome is not Outcome.OUT_OF_RANGE


NORM_OPTIMAL = {"law": "norm-optimal", "h": 40, "b_w": 9}


def verdict_of(found: hilc.Check) -> str:
    return found.verdict.partition(",")[0]


@pytest.mark.parametrize("aside", ["5 cm", "-12 cm"])
def test_wrong_start_is_judged_by_the_second_half_as_runs_are(aside: str) -> None:
    given = scenario(
        TURN, NORM_OPTIMAL, model={"wheel_radius": 0.041}, iterations=5, initial_pose={"y": aside}
    )
    found = hilc.check(given, simulate=True)
    assert found.simulated is not None
    errors = found.simulated.errors_m
    assert errors[-1] > errors[0] / 2  # the initial error is there whatever is learned
    assert found.simulated.telling_errors_m[-1] < 1e-4
    assert found.simulated.summary.on_path is not None
    assert found.verdict == hilc.check(given).verdict == "nothing wrong"


@pytest.mark.slow
def test_error_that_is_noise_alone_has_nothing_to_halve() -> None:
    # A turn on the spot leaves no position error but that of disturbances.
    spin = {"radius": 1e-9, "turn": "left", "sweep": "500 deg", "duration": "15 s"}
    found = hilc.check(
        scenario(
            {**TURN, "segments": [{"arc": spin}]},
            {**NORM_OPTIMAL, "feedback": "none"},
            model={"wheel_separation": 0.18},
            iterations=5,
            disturbance={"seed": 3, "state": {"bound": ["0.4 mm", "0.4 mm", "0.05 deg"]}},
        ),
        simulate=True,
    )
    assert found.simulated is not None
    assert found.simulated.errors_m[-1] > 0.01 * 0.2
    assert verdict_of(found) == "works"


@pytest.mark.parametrize("law", [NORM_OPTIMAL, {"law": "feedback", "b_w": 9}])
def test_start_from_which_a_law_is_not_on_the_path_in_time_cannot_work(law: dict[str, Any]) -> None:
    given = scenario(TURN, law, iterations=2, initial_pose={"y": 3})
    run = hilc.run(given)
    assert run.summary().on_path is None
    for simulate in (False, True):
        found = hilc.check(given, simulate=simulate)
        assert any("from initial_pose" in text for text in found.failures)
        assert verdict_of(found) == "cannot work"


@pytest.mark.parametrize(
    ("iterations", "bound"),
    [
        (1, ["1 cm", "1 cm", "20 deg"]),
        (3, ["3 cm", "3 cm", "10 deg"]),
        (8, ["8 cm", "8 cm", "40 deg"]),
    ],
)
def test_what_readings_spoil_of_the_identification_is_foretold(
    iterations: int, bound: list[str]
) -> None:
    def given(seed: int) -> hilc.Scenario:
        return scenario(
            TURN,
            {**NORM_OPTIMAL, "feedback": "none"},
            model={"wheel_radius": 0.041},
            iterations=iterations,
            disturbance={"seed": seed, "output": {"bound": bound}},
        )

    runs = (hilc.run(given(seed)) for seed in range(8))
    last = [float(run.metrics["max_position_error_m"][-1]) for run in runs]
    expected = hilc.check(given(0)).expected
    assert expected is not None
    assert not expected.is_floor
    assert max(last) / 1.5 < expected.foretold_m < 3 * max(last)


def test_floor_is_not_printed_as_a_figure() -> None:
    found = hilc.check(
        scenario(
            TURN,
            NORM_OPTIMAL,
            iterations=3,
            disturbance={"output": {"bound": [1e-6, 1e-6, 1e-6]}},
        )
    )
    assert found.expected is not None
    assert found.expected.is_floor
    ((_, text),) = disturbed_rows(found.expected)
    assert text.startswith("less than theory tells apart, 0.00")


def warned(controller: dict[str, Any], trajectory: object = TURN, **more: Any) -> str:
    """All that is said, in one text."""
    more = {"iterations": 0, **more}
    found = hilc.check(scenario(trajectory, controller, **more))
    return "\n".join([*found.failures, *found.warnings])


def test_remedies_are_those_that_the_law_has_and_has_not_taken() -> None:
    noise = {
        name: {"bound": ["5 cm", "5 cm", "5 deg"]} for name in ("initial_pose", "output", "state")
    }
    noise["state"] = {"bound": ["3 mm", "3 mm", "0.5 deg"]}
    stiff = {**NORM_OPTIMAL, "feedback": "regulator"}
    for law in (stiff, {**NORM_OPTIMAL, "feedback": "none"}, {"law": "feedback", "b_w": 9}):
        said = warned(law, iterations=2, disturbance=noise)
        assert "swings the whole path" in said
        assert "lower the gains" not in said
        assert "take feedback" not in said
        assert ("set controller.feedback: regulator" in said) == (law.get("feedback") == "none")
        assert ("raise controller.gains" in said) == (law["law"] == "feedback")


def test_feedback_that_explodes_is_told_to_be_lowered_and_no_more() -> None:
    gains = {"k_x": 60, "k_y": 500}
    said = warned({"law": "feedback", "gains": gains}, model={"wheel_separation": 0.18})
    assert "the feedback is unstable" in said
    assert "raise controller.gains" not in said
    assert "wrong model" not in said


def test_limit_is_to_blame_for_what_a_right_model_leaves_as_well() -> None:
    turned = {"line": {"to": [2, 1.5], "speed": 0.2}}
    corner = {
        **TURN,
        "corners": "allow",
        "segments": [{"line": {"to": [2, 0], "speed": 0.2}}, turned],
    }
    law = {"law": "feedback", "b_w": 5.5}
    wrong, right = (warned(law, corner, model=model) for model in ({"wheel_radius": 0.0405}, {}))
    for said in (wrong, right):
        assert "controller.b_w acts in" in said
        assert "wrong model" not in said
    assert "the wrong model leaves" in warned({**law, "b_w": 9}, model={"wheel_radius": 0.05})


def test_turn_in_place_has_no_size_and_no_side() -> None:
    spin = {"radius": 1e-9, "turn": "left", "sweep": "500 deg", "duration": "5 s"}
    path = {**TURN, "segments": [{"arc": spin}]}
    noise = {"state": {"bound": ["1 mm", "1 mm", 0]}, "output": {"bound": ["5 mm", "5 mm", 0]}}
    wrong = {"wheel_separation": 0.18}
    said = warned({"law": "feedback", "b_w": 9}, path, disturbance=noise, model=wrong)
    assert "steers neither heading nor side" in said
    said += warned({**NORM_OPTIMAL, "feedback": "none"}, path, disturbance=noise, iterations=3)
    assert "too soft" not in said
    assert "the whole path," not in said
    assert "the reference moves by" not in said


def test_half_a_turn_beside_the_start_may_be_degrees() -> None:
    assert "all the way back; 5 deg?" in warned(NORM_OPTIMAL, initial_pose={"heading": 5})
    assert "deg?" not in warned(NORM_OPTIMAL, initial_pose={"heading": "1.5*pi"})
