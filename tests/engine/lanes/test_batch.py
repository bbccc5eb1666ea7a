"""The batch engine against the loop engine, which has an engine and tests of its own."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes import batch, iterations, kernel, noise
from hilc_cli.engine.lanes.batch import NEVER, simulate_batch
from hilc_cli.engine.lanes.lanes import LANES
from hilc_cli.errors import UsageError
from hilc_cli.laws.gain_matrix import GainHeading, GainMatrix, model_gain
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.kinematic_plant import KinematicPlant
from hilc_cli.results.metrics import METRICS
from hilc_cli.runs.running import load_scenario, run
from hilc_cli.shipped_files import examples
from hilc_cli.yaml_input.expressions import Affine
from tests.engine.lanes.random_experiments import (
    ALL,
    CIRCLE,
    SOME,
    assert_agree,
    check_random_experiment,
)


@given(data=st.data())
@settings(max_examples=150, derandomize=True)
def test_every_metric_of_every_iteration_agrees_with_the_loop_engine(data: st.DataObject) -> None:
    check_random_experiment(data, SOME)


@pytest.mark.slow
@given(data=st.data())
@settings(max_examples=500)
def test_they_agree_in_all_mixtures(data: st.DataObject) -> None:
    check_random_experiment(data, ALL)


def shipped() -> list[str]:
    """Scenarios of the law that this engine knows."""
    names = [path.stem for path in examples()]
    return [name for name in names if load_scenario(f"example:{name}").spec.controller.in_lanes]


@pytest.mark.parametrize("name", shipped())
def test_shipped_scenario_gives_the_same_numbers_in_both_engines(name: str) -> None:
    scenario = load_scenario(f"example:{name}", {"iterations": 10})
    expected = run(scenario).metrics
    result = simulate_batch([scenario.experiment()])
    row = expected.row(-1)
    assert_agree(result.final[0], np.array([row[name] for name in METRICS]))
    assert_agree(result.errors[0], expected["max_position_error_m"])


def test_result_does_not_depend_on_the_neighbours() -> None:
    def case(number: int) -> Experiment:
        law = HybridLaw(0.1 + 0.02 * number, 0.3, 0.1, model_gain(robot), "measured", False, 5)
        noise = Disturbance(number, Bounded((1e-3, 1e-3, 1e-3)))
        zero = np.zeros(CIRCLE.samples)
        return Experiment(
            CIRCLE, plant, law, (10.0, 0.0, 1.5), zero, zero, False, 3 + number % 4, 180.0, noise
        )

    robot = Robot(0.2, 0.518)
    plant = KinematicPlant(robot)
    cases = [case(number) for number in range(LANES + 9)]
    together = simulate_batch(cases)
    backwards = simulate_batch(cases[::-1])
    for number, alone in enumerate(map(simulate_batch, [[c] for c in cases[::7]])):
        place = 7 * number
        assert together.final[place].tobytes() == alone.final[0].tobytes()
        assert backwards.final[len(cases) - 1 - place].tobytes() == alone.final[0].tobytes()
        last = cases[place].iterations + 1
        assert together.errors[place, :last].tobytes() == alone.errors[0].tobytes()
        assert np.isnan(together.errors[place, last:]).all()


def test_lane_at_the_limit_does_not_see_a_neighbour_beyond_it() -> None:
    # Wheels that have been limited once lie at the limit or a rounding above it.
    robot = Robot(0.2, 0.518)
    drawn = np.random.default_rng(0)
    left, right = drawn.uniform(-400, 400, (2, CIRCLE.samples))

    def case(gain: float, limit: float) -> Experiment:
        law = HybridLaw(gain, 0.0, 0.0, model_gain(robot), "measured", False, 5)
        pose, none = (10.0, 0.0, 1.5), Disturbance()
        return Experiment(
            CIRCLE, KinematicPlant(robot), law, pose, left, right, True, 4, limit, none
        )

    still = [case(0.0, 20.0 + number) for number in range(8)]
    together = simulate_batch([*still, case(0.5, 5.0), case(5.0, 60.0)])
    assert together.final[-2:, list(METRICS).index("saturated_samples")].min() > 0
    for number, experiment in enumerate(still):
        alone = simulate_batch([experiment])
        assert together.final[number].tobytes() == alone.final[0].tobytes()
        assert together.errors[number].tobytes() == alone.errors[0].tobytes()


def test_both_engines_take_the_same_size_for_diverged() -> None:
    # At 1e140 m: until there a wheel may be faster than that, in either engine.
    values = {"controller.b_w": None, "iterations": 30, "controller.gains.l1": 1e12}
    found = run(load_scenario("example:fig6c", values))
    assert found.diverged_at is not None
    result = simulate_batch([load_scenario("example:fig6c", values).experiment()])
    assert result.diverged_at[0] != NEVER
    kept = result.errors[0, : result.diverged_at[0]]
    assert kept.max() <= 1e140 and found.metrics["max_position_error_m"].max() <= 1e140
    assert (
        found.metrics["max_wheel_speed_rad_s"].max() > found.metrics["max_position_error_m"].max()
    )


def test_divergence_ends_about_when_it_does_in_the_loop_engine() -> None:
    free = {"controller.b_w": None, "iterations": 30}
    gains = [1e9, 0.5, 1e12]
    scenarios = [load_scenario("example:fig6c", {**free, "controller.gains.l1": g}) for g in gains]
    runs = [run(scenario) for scenario in scenarios]
    assert [expected.diverged_at is None for expected in runs] == [False, True, False]
    result = simulate_batch([scenario.experiment() for scenario in scenarios])
    for case, expected in enumerate(runs):
        found = int(result.diverged_at[case])
        assert (found == NEVER) == (expected.diverged_at is None)
        if expected.diverged_at is not None:
            # Rounding errors have long become as large as the motion itself.
            assert abs(found - expected.diverged_at) <= 2
        completed = found if found != NEVER else len(expected.metrics)
        assert np.isfinite(result.errors[case, :completed]).all()
        assert np.isnan(result.errors[case, completed:]).all()
        assert np.isfinite(result.final[case]).all()


def test_headings_beyond_reason_do_not_end_a_run() -> None:
    # The loop engine, with the library's cosine, reaches 1e99 m here and stays finite.
    values = {"controller.b_w": None, "iterations": 30, "controller.gains.l1": 1e3}
    experiment = load_scenario("example:fig6c", values).experiment()
    result = simulate_batch([experiment])
    assert result.diverged_at[0] == NEVER
    assert result.errors.max() > 1e20


@pytest.mark.slow
def test_kernel_says_the_same_interpreted(monkeypatch: pytest.MonkeyPatch) -> None:
    """The lane code is plain Python: the compiler may change its speed, not its numbers."""
    scenario = load_scenario(
        "example:rounded-square",
        {
            "iterations": 1,
            "trajectory.sample_time": 0.5,
            "controller.compensation": "on",
            "controller.h": 3,
            "disturbance.state.bound": [1e-3] * 3,
            "disturbance.output.bound": [1e-3] * 3,
            "disturbance.output.distribution": "truncated-normal",
            "disturbance.output.standard_deviation": [1e-3] * 3,
            "disturbance.initial_pose.bound": [1e-3] * 3,
        },
    )
    cases = []
    # Each is compiled for itself: all that the code tells apart, but not all mixtures of it.
    kinds: list[tuple[GainHeading, bool]] = [
        ("measured", False),
        ("previous", True),
        ("reference", False),
    ]
    for heading, full in kinds:
        experiment = scenario.experiment()
        matrix = GainMatrix(*[(Affine(0.1), Affine(cos=1.0), Affine(sin=2.0))] * 2)
        law = experiment.law
        assert isinstance(law, HybridLaw)
        law = replace(law, gain_heading=heading)
        law = replace(law, matrix=matrix) if full else replace(law, compensation=False)
        cases.append(replace(experiment, law=law))
    compiled = simulate_batch(cases)
    monkeypatch.setattr(batch, "run_iterations", iterations.run_iterations.py_func)
    for module in (iterations, kernel, noise):
        for name, function in vars(module).items():
            if hasattr(function, "py_func"):
                monkeypatch.setattr(module, name, function.py_func)
        monkeypatch.setattr(module, "use_widest_vectors", lambda: None, raising=False)
    interpreted = simulate_batch(cases)
    assert_agree(compiled.final, interpreted.final)
    assert_agree(compiled.errors, interpreted.errors)


def test_other_laws_are_refused() -> None:
    class Other:
        pass

    scenario = load_scenario("example:fig6a")
    other = replace(scenario.experiment(), law=Other())  # type: ignore[arg-type]
    with pytest.raises(UsageError, match="hybrid"):
        simulate_batch([other])
