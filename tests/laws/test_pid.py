"""PID-type learning: its transcription, the hybrid law in it, what it ends at, and its Q-filter."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy import signal as scipy_signal

from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.gain_matrix import GainHeading, GainMatrix, model_gain
from hilc_cli.laws.pid import LowPass, PidLaw, rectifying_pulse
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.runs.running import load_scenario, run
from tests.engine.experiments import (
    LIMIT,
    PLATFORM,
    UP,
    MatrixName,
    experiment_of,
    law_of,
    matrix_of,
)
from tests.laws.transcription_pid import transcribe_pid
from tests.reference.paths import paper_reference
from tests.transcription import equation_45

TOLERANCE = 1e-9
NOISE = Bounded((0.01, 0.02, 0.01))


def pid(
    kp: float = 0.0,
    ki: float = 0.0,
    kd: float = 0.0,
    *,
    forgetting: float = 0.0,
    matrix: GainMatrix | None = None,
    gain_heading: GainHeading = "measured",
    cutoff: float | None = None,
    rectifying: int | None = None,
) -> PidLaw:
    gain = model_gain(PLATFORM) if matrix is None else matrix
    return PidLaw(kp, ki, kd, forgetting, gain, gain_heading, cutoff, rectifying)


def with_law(experiment: Experiment, law: PidLaw) -> Experiment:
    return replace(experiment, law=law)


# Times d_t = 0.02 s and up to 100 samples: gains that do not blow rounding up.
@settings(max_examples=25, deadline=None)
@given(
    gains=st.tuples(st.floats(0, 2), st.floats(0, 1), st.floats(0, 0.5)),
    forgetting=st.floats(0, 1),
    cutoff=st.none() | st.floats(0.5, 24.9),
    rectifying=st.none() | st.integers(1, 100),
    gain_heading=st.sampled_from(["measured", "previous", "reference"]),
    start=st.tuples(st.floats(9, 11), st.floats(-1, 1), st.floats(UP - 0.5, UP + 0.5)),
    speed_limit=st.sampled_from([100.0, 180.0, math.inf]),
    convention=st.sampled_from(["paper", "rep103"]),
    seed=st.integers(0, 2**64 - 1),
)
def test_law_agrees_with_its_transcription(
    gains: tuple[float, float, float],
    forgetting: float,
    cutoff: float | None,
    rectifying: int | None,
    gain_heading: GainHeading,
    start: tuple[float, float, float],
    speed_limit: float,
    convention: str,
    seed: int,
) -> None:
    reference = paper_reference("circle", 0.02)
    robot = Robot(0.2, 0.518, convention)  # type: ignore[arg-type]
    sign = 1 if convention == "paper" else -1
    believed = replace(robot, wheel_radius=0.23, half_track=0.45)
    law = pid(
        *gains,
        forgetting=forgetting,
        matrix=model_gain(believed),
        gain_heading=gain_heading,
        cutoff=cutoff,
        rectifying=rectifying,
    )
    ramp = np.linspace(-20, 90, reference.samples)
    experiment = experiment_of(
        reference,
        law_of(0.0),
        initial_pose=start,
        robot=robot,
        initial_input=(ramp, ramp[::-1].copy()),
        iterations=3,
        speed_limit=speed_limit,
        disturbance=Disturbance(seed, output=NOISE),
    )
    desired = np.column_stack([reference.x, reference.y, reference.heading])
    passes = transcribe_pid(
        desired=desired,
        sample_time=0.02,
        wheel_radius=0.2,
        half_track=sign * 0.518,
        gain_matrix=equation_45(0.23, sign * 0.45),
        kp=law.kp,
        ki=law.ki,
        kd=law.kd,
        forgetting=forgetting,
        cutoff=cutoff,
        rectifying=rectifying,
        gain_heading=gain_heading,
        speed_limit=speed_limit,
        initial_pose=start,
        initial_input=np.column_stack([ramp, ramp[::-1]]),
        iterations=3,
        output_noise=[experiment.disturbance.of_output(i, reference.samples + 1) for i in range(4)],
    )
    for trial, expected in zip(simulate(with_law(experiment, law)), passes, strict=True):
        # Beyond a meter of error, rounding is blown up with the error.
        size = max(1.0, float(np.abs(desired - expected.poses).max()))
        fastest = max(1.0, float(np.abs(expected.inputs).max()))
        poses = np.column_stack([trial.x, trial.y, trial.heading])
        inputs = np.column_stack([trial.left, trial.right])
        np.testing.assert_allclose(poses, expected.poses, rtol=0, atol=TOLERANCE * size)
        np.testing.assert_allclose(inputs, expected.inputs, rtol=0, atol=TOLERANCE * fastest)


@pytest.mark.parametrize("gain_heading", ["measured", "previous", "reference"])
@pytest.mark.parametrize("matrix", ["model", "unit", "contradicting"])
def test_kp_alone_is_the_hybrid_law_without_feedback_to_the_bit(
    matrix: MatrixName, gain_heading: GainHeading
) -> None:
    gain = matrix_of(matrix, PLATFORM)
    hybrid = law_of(0.7, matrix=gain, gain_heading=gain_heading)
    experiment = experiment_of(
        paper_reference("cardioid", 0.01),
        hybrid,
        initial_pose=(2.0, 0.0, 14 * math.pi / 15),
        iterations=6,
        speed_limit=LIMIT,
        disturbance=Disturbance(3, NOISE, NOISE, NOISE),
    )
    same = pid(0.7, matrix=gain, gain_heading=gain_heading)
    for one, other in zip(simulate(experiment), simulate(with_law(experiment, same)), strict=True):
        for name in ("x", "y", "heading", "left", "right"):
            assert getattr(one, name).tobytes() == getattr(other, name).tobytes()


STEPS, DT, SPEED = 60, 0.05, 1.5


def on_a_line(law: PidLaw, *, offset: float = 0.0, iterations: int = 4) -> list[Floats]:
    """Errors along a line that is driven at constant speed; the offset is e(0)."""
    zero = np.zeros(STEPS + 1)
    line = Reference("line", DT, SPEED * DT * np.arange(STEPS + 1.0), zero, zero)
    experiment = experiment_of(
        line, law_of(0.0), initial_pose=(-offset, 0.0, 0.0), iterations=iterations
    )
    return [line.x - trial.x for trial in simulate(with_law(experiment, law))]


@pytest.mark.parametrize("kd", [0.3, 1.0])
def test_d_type_learning_ends_at_the_initial_error(kd: float) -> None:
    # Each step of the error shrinks by 1 - kd: e_i(k) = e(0) + (1 - kd)^i d v_d k.
    k = np.arange(STEPS + 1)
    for i, error in enumerate(on_a_line(pid(kd=kd), offset=0.4)):
        expected = 0.4 + (1 - kd) ** i * DT * SPEED * k
        np.testing.assert_allclose(error, expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("h", [1, 20, 60])
def test_rectifying_takes_the_initial_error_away_over_its_window(h: int) -> None:
    # With kd = 1 one iteration is enough: e(k) = e(0) (1 - k / h)^2 up to h, and 0 from there on.
    expected = 0.4 * np.maximum(1 - np.arange(STEPS + 1) / h, 0) ** 2
    last = on_a_line(pid(kd=1.0, rectifying=h), offset=0.4)[-1]
    np.testing.assert_allclose(last, expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("h", [1, 7, 60])
def test_rectifying_pulse_has_area_one_and_ends(h: int) -> None:
    pulse = rectifying_pulse(h, STEPS, DT)
    assert DT * pulse.sum() == pytest.approx(1, rel=1e-14)
    assert (pulse[h:] == 0).all()
    np.testing.assert_allclose(np.diff(pulse[:h]), -2 / (DT * h**2), rtol=1e-9)


def test_forgetting_ends_between_the_first_input_and_the_learned_one() -> None:
    # From rest v_i = v_d kd / (gamma + kd) (1 - (1 - gamma - kd)^i).
    kd, gamma = 0.3, 0.2
    for i, error in enumerate(on_a_line(pid(kd=kd, forgetting=gamma), iterations=8)):
        speed = SPEED * kd / (gamma + kd) * (1 - (1 - gamma - kd) ** i)
        expected = DT * (SPEED - speed) * np.arange(STEPS + 1)
        np.testing.assert_allclose(error, expected, rtol=0, atol=1e-12)


def test_sum_of_errors_counts_the_first_of_them() -> None:
    # e_0(k) = c + d v_d k; after one update v_1(k) = ki d sum_{j <= k+1} e_0(j).
    ki, c = 0.1, 0.4
    first, second = on_a_line(pid(ki=ki), offset=c, iterations=1)
    speed = ki * DT * np.cumsum(first)[1:]
    expected = c + DT * np.concatenate([[0], np.cumsum(SPEED - speed)])
    np.testing.assert_allclose(second, expected, rtol=0, atol=1e-12)


def test_full_forgetting_of_a_law_without_gains_is_the_first_input() -> None:
    reference = paper_reference("circle", 0.05)
    ramp = np.linspace(-50, 150, reference.samples)
    experiment = experiment_of(reference, law_of(0.0), initial_input=(ramp, -ramp), iterations=2)
    for law in (pid(), pid(forgetting=1.0)):
        for trial in simulate(with_law(experiment, law)):
            np.testing.assert_array_equal(trial.left, ramp)


def test_filter_keeps_noise_out_of_the_input() -> None:
    noisy = load_scenario("example:pid-figure-eight", {"controller.cutoff": None})
    smooth = load_scenario("example:pid-figure-eight")
    rough, learned = (np.abs(np.diff(run(each).learned_input[0])) for each in (noisy, smooth))
    assert learned.mean() < 0.01 * rough.mean()


def test_derivative_learns_in_few_iterations_what_the_paper_does_not_in_a_hundred() -> None:
    errors = run(load_scenario("example:pd-arc-and-line")).metrics["max_position_error_m"]
    paper = run(load_scenario("example:fig3-arc-and-line")).metrics["max_position_error_m"]
    assert paper[100] > 1
    assert errors[50:].max() < 0.05


SAMPLES, SAMPLE_TIME = 400, 0.005  # a Nyquist frequency of 100 Hz


def cosine(half_waves: int) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """So many half waves over all samples, level at both ends."""
    return np.cos(np.pi * half_waves * (np.arange(SAMPLES) + 0.5) / SAMPLES)


@pytest.mark.parametrize("cutoff", [1.0, 5.0, 40.0, 95.0])
@pytest.mark.parametrize("half_waves", [0, 1, 20, 160, 399])
def test_cosine_comes_back_smaller_by_the_square_of_the_gain(
    cutoff: float, half_waves: int
) -> None:
    # Second order: |H|^2 = 1 / (1 + (tan(pi f d_t) / tan(pi f_c d_t))^4), f = half_waves / (2 T).
    frequency = half_waves / (2 * SAMPLES * SAMPLE_TIME)
    ratio = math.tan(math.pi * frequency * SAMPLE_TIME) / math.tan(math.pi * cutoff * SAMPLE_TIME)
    signal = cosine(half_waves)
    found = LowPass(cutoff, SAMPLE_TIME)(signal)
    np.testing.assert_allclose(found, signal / (1 + ratio**4), rtol=0, atol=1e-10)


def test_half_of_the_cutoff_frequency_itself_is_left() -> None:
    signal = cosine(40)  # 10 Hz
    np.testing.assert_allclose(LowPass(10.0, SAMPLE_TIME)(signal), signal / 2, atol=1e-10)


@pytest.mark.parametrize("cutoff", [0.5, 3.0, 30.0])
def test_sum_over_all_samples_stays(cutoff: float) -> None:
    pulse = np.zeros(SAMPLES)
    pulse[:3] = 180.0
    filtered = LowPass(cutoff, SAMPLE_TIME)(pulse)
    assert filtered.sum() == pytest.approx(540, rel=1e-9)


@pytest.mark.parametrize("cutoff", [2.0, 20.0, 90.0])
def test_filter_is_that_of_scipy_on_the_mirrored_signal(cutoff: float) -> None:
    signal = np.random.default_rng(1).normal(size=SAMPLES)
    sections = scipy_signal.butter(2, cutoff, fs=1 / SAMPLE_TIME, output="sos")
    mirrored = np.pad(signal, 5 * SAMPLES, mode="symmetric")
    expected = scipy_signal.sosfiltfilt(sections, mirrored)[5 * SAMPLES : 6 * SAMPLES]
    np.testing.assert_allclose(LowPass(cutoff, SAMPLE_TIME)(signal), expected, rtol=0, atol=1e-10)


@pytest.mark.parametrize("cutoff", [0.05, 1e-9, 1e-200])
@pytest.mark.parametrize("samples", [1, 2, 50])
def test_low_cutoff_leaves_the_mean(samples: int, cutoff: float) -> None:
    signal = np.random.default_rng(1).normal(size=samples)
    # Half a wave in 0.5 s is 20 times as fast as the fastest cut-off: 1 / 20^4 of it is left.
    filtered = LowPass(cutoff, 0.01)(signal)
    np.testing.assert_allclose(filtered, signal.mean(), rtol=0, atol=2 / 20**4)


def test_each_signal_is_filtered_by_itself() -> None:
    signals = np.random.default_rng(2).normal(size=(5, SAMPLES))
    low_pass = LowPass(7.0, SAMPLE_TIME)
    together = low_pass(signals)
    for signal, filtered in zip(signals, together, strict=True):
        np.testing.assert_allclose(low_pass(signal), filtered, rtol=0, atol=1e-13)
