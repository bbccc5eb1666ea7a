"""The linearised plant against differences of the exact one, and against the circle."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.theory.matrices import GainParts, Linearisation, linearise
from tests.engine.experiments import PLATFORM, experiment_of, law_of, matrix_of
from tests.reference.paths import paper_reference
from tests.theory.cases import CASES, winding
from tests.transcription import equation_9, equation_45, equation_57


def linearised(reference: Reference) -> Linearisation:
    return linearise(experiment_of(reference, law_of(1.0)))


def step(pose: Floats, speeds: Floats, sample_time: float) -> Floats:
    """Eqs. 8 and 9 as matrices."""
    control = equation_9(0.200, 0.518)(math.cos(pose[2]), math.sin(pose[2]))
    moved: Floats = pose + sample_time * (control @ speeds)
    return moved


@pytest.mark.parametrize("k", [0, 17, 29, 31, 59])
def test_matrices_are_the_derivatives_of_a_step(k: int) -> None:
    # Central differences of width 1e-4 leave errors of 1e-8 of the third derivative.
    reference = winding(60)
    plant = linearised(reference)
    pose = np.array([reference.x[k], reference.y[k], reference.heading[k]])
    d, width = reference.sample_time, 1e-4
    for axis in range(3):
        moved = width * np.eye(3)[axis]
        ahead = step(pose + moved, plant.feedforward[k], d)
        behind = step(pose - moved, plant.feedforward[k], d)
        slope = (ahead - behind) / (2 * width)
        np.testing.assert_allclose(plant.states[k][:, axis], slope, rtol=0, atol=1e-9)
    for wheel in range(2):
        faster = step(pose, plant.feedforward[k] + np.eye(2)[wheel], d) - step(
            pose, plant.feedforward[k], d
        )
        np.testing.assert_allclose(plant.inputs[k][:, wheel], faster, rtol=0, atol=1e-15)


def test_residual_is_what_the_feedforward_leaves_of_each_step() -> None:
    reference = winding(60)
    plant = linearised(reference)
    poses = np.column_stack([reference.x, reference.y, reference.heading])
    for k in range(60):
        reached = step(poses[k], plant.feedforward[k], reference.sample_time)
        np.testing.assert_allclose(plant.residual[k], poses[k + 1] - reached, rtol=0, atol=1e-15)


def test_circle_leaves_the_sine_of_half_a_turn_sideways() -> None:
    reference = paper_reference("circle", 0.01)
    cos, sin = np.cos(reference.heading[:-1]), np.sin(reference.heading[:-1])
    # The chord c of a turn by a is at a/2 from the tangent: c sin(a/2) aside, c (cos(a/2) - 1) on.
    plant = linearised(reference)
    turn = 2 * math.pi / 200
    chord = 20 * math.sin(turn / 2)
    aside = -sin * plant.residual[:, 0] + cos * plant.residual[:, 1]
    along = cos * plant.residual[:, 0] + sin * plant.residual[:, 1]
    np.testing.assert_allclose(aside, chord * math.sin(turn / 2), rtol=1e-10)
    np.testing.assert_allclose(along, chord * (math.cos(turn / 2) - 1), rtol=1e-7)
    np.testing.assert_allclose(plant.residual[:, 2], 0, atol=1e-15)


def test_line_leaves_nothing() -> None:
    reference = winding(60)
    plant = linearised(reference)
    np.testing.assert_allclose(plant.residual[20:40], 0, atol=1e-15)


@pytest.mark.parametrize("name", ["model", "contradicting"])
def test_gains_are_the_printed_matrix_at_each_heading(name: str) -> None:
    headings = np.array([0.0, 0.3, 2.0, -4.0])
    case = next(case for case in CASES.values() if case.matrix == name)
    gains = GainParts.of(matrix_of(case.matrix, PLATFORM)).at(headings)
    printed = (equation_45 if name == "model" else equation_57)(0.200, 0.518)
    for gain, heading in zip(gains, headings, strict=True):
        np.testing.assert_allclose(gain, printed(math.cos(heading), math.sin(heading)), rtol=1e-15)
