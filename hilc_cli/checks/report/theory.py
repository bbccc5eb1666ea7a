"""The part of ``hilc check`` that has the paper's conditions, constants and bounds."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from hilc_cli.reporting.terminal import Grid, Section
from hilc_cli.theory.matrices import knows_plant

if TYPE_CHECKING:
    from hilc_cli.checks.checking import Check
    from hilc_cli.theory.proof.bounds import Bounds
    from hilc_cli.theory.proof.constants import Conditions
    from hilc_cli.theory.proof.measured import Comparison, Measured

_CONSTANTS = (
    *("rho", "b_B", "C_B", "b_ud", "b_L1", "b_L2", "b_L3", "b_q0", "b_alpha", "b_beta"),
    *("h1", "h2", "h3", "b_1"),
)
_SHORT = {
    "as printed": "printed",
    "as printed, with the sample time": "with d_k",
    "corrected": "corrected",
    "corrected, within the speed limit": "in limit",
}
_EQUATIONS = {"input": (38, 39), "state": (40, 41), "output": (42, 43)}
"""The equations of each iteration, and of the limit."""
_ZERO = 1e-12  # constants below are rounding
_ROUNDING = 1e-9  # of logarithms
_LAST = 10
"""So many last iterations of a simulation stand for its limit."""


def theory_section(check: Check, *, verbose: bool = False) -> Section:
    """Returns the paper's theory, as printed and as it holds; of another law, nothing.

    Args:
        check: What was found.
        verbose: Say what was corrected.
    """
    title = "What do the paper's theorems say?"
    if check.conditions is None or check.theories is None:
        other = "law" if knows_plant(check.law.experiment) else "robot"
        return Section("theory", title, [("Theory", f"none: this is another {other}")], brief=())
    measured = None if check.simulated is None else check.simulated.comparisons
    rows, grids = _rows(check.conditions), []
    if check.theories:
        iterations = check.scenario.spec.iterations
        grids = [_constants(check.theories), _bounds(check.theories, iterations, measured)]
    else:
        rows.append(("Bounds", "none: their constants leave the range of floating point"))
    gaps: list[str] = []
    if verbose:
        from hilc_cli.theory.proof.constants import EXPLANATIONS

        gaps = [f"Corrected, {name}: {text}." for name, text in EXPLANATIONS.items()]
    return Section(
        "theory",
        title,
        rows,
        grids,
        _document(check.conditions, check.theories, measured),
        gaps,
        brief=(),
    )


def _rows(found: Conditions) -> list[tuple[str, str]]:
    start = "yes" if found.starts_on_reference else "no"
    return [
        ("Theorem 1 as printed, Eq. 19", _told(found.theorem_1_printed)),
        ("Theorem 1 with d_k B", _told(found.theorem_1_simulated)),
        ("Theorem 2 as printed, Eq. 23", _told(found.theorem_2_printed)),
        ("Theorem 2 with d_k B", _told(found.theorem_2_simulated)),
        ("Starts on the reference, y_i(0) = y_d(0)", start),
        ("Speaks of this law", f"Theorem {found.theorem}"),
    ]


def _told(rho: float) -> str:
    if not math.isfinite(rho):
        return "rho leaves the range of floating point"
    verdict = "below 1" if rho < 1 else "not below 1"
    return f"rho = {0.0 if rho < _ZERO else rho:.6g}, {verdict}"


def _constants(theories: Mapping[str, Bounds]) -> Grid:
    """Returns the constants of each theory, a column each."""
    rows = [
        ["rho", *(_contraction(theory.constants.rho) for theory in theories.values())],
        *(
            [name, *(_number(getattr(theory.constants, name)) for theory in theories.values())]
            for name in _CONSTANTS
            if name != "rho"
        ),
    ]
    rows += [
        ["lambda", *(_number(theory.lambda_) for theory in theories.values())],
        ["A", *(_contraction(theory.A) for theory in theories.values())],
        ["B", *(_number(theory.B) for theory in theories.values())],
    ]
    note = (
        "Constants of Eqs. 12 to 37. printed: as it stands; with d_k: d_k B for B; corrected: all "
        "gaps of the proof closed, -v lists them"
    )
    columns = _columns(theories)
    if ("in limit", "") in columns:
        note += "; in limit: likewise, with |u| <= b_w."
    else:
        note += "; without speed limit it has none if gains are taken at the measured heading."
    note += " rho: contraction of the theorem; an iteration takes an input bound x to A x + B."
    return Grid([("Constant", ""), *columns], rows, note)


def _bounds(
    theories: Mapping[str, Bounds], iterations: int, measured: Mapping[str, Comparison] | None
) -> Grid:
    """Returns the bounds, each beside the errors of a simulation if there is one."""
    samples = next(iter(theories.values())).constants.samples
    last = min(_LAST, iterations + 1)
    rows = [
        [
            f"Input, iteration {iterations}, Eq. 38",
            *(_log(float(theory.input(iterations))) for theory in theories.values()),
        ]
    ]
    for quantity, (in_each, at_the_end) in _EQUATIONS.items():
        name = quantity.capitalize()
        limits = [_limit(each, getattr(each, f"{quantity}_limit")) for each in theories.values()]
        rows.append([f"{name}, limit, Eq. {at_the_end}", *map(_log, limits)])
        if quantity == "state":
            at_last = (
                theory.at_sample(limit, samples)
                for theory, limit in zip(theories.values(), limits, strict=True)
            )
            rows.append([f"{name}, limit, at sample {samples}", *map(_log, at_last)])
        if measured:
            parts = [comparison.parts[quantity] for comparison in measured.values()]
            rows += [
                [f"  simulated, last {last}", *(_log(part.over_last(_LAST)) for part in parts)],
                [f"  least room below Eq. {in_each}", *(_room(part) for part in parts)],
                ["  iterations above it", *(f"{len(part.violated)}" for part in parts)],
                [
                    f"  room below Eq. {at_the_end}, last {last}",
                    *(_gap(part.limit_looseness(_LAST)) for part in parts),
                ],
                [
                    "  above it and transient",
                    *("yes" if part.limit_violated(_LAST) else "no" for part in parts),
                ],
            ]
    note = (
        "log10 of bounds in the lambda-norm, of all samples but where one is named; limit: after "
        "infinitely many iterations; none: no finite bound; zero: bounded by 0. printed and with "
        "d_k do not hold for the system that is simulated."
    )
    if measured:
        note += (
            f" simulated: of the errors of the last {last} iterations, in the same norm. room: "
            "log10 of bound / error, below 0 where an error exceeds its bound; any: no bound, or "
            "no error; none: an error beside a bound of 0. transient: what may be left of the "
            "first input's error, which a limit leaves out."
        )
    return Grid([("log10 of", ""), *_columns(theories)], rows, note)


def _limit(theory: Bounds, bound: float) -> float:
    """Returns a limit, without the rounding that is left of it where nothing disturbs."""
    return -math.inf if theory.has_limit and theory.B <= _ZERO else bound


def _room(part: Measured) -> str:
    return _gap(float(part.looseness.min()))


def _gap(room: float) -> str:
    if math.isinf(room):
        return "any" if room > 0 else "none"
    return _log(room)


def _columns(theories: Mapping[str, object]) -> list[tuple[str, str]]:
    return [(_SHORT[name], "") for name in theories]


def _number(value: float) -> str:
    return f"{value:.5g}" if abs(value) > _ZERO else "0"


def _contraction(value: float) -> str:
    """Returns a number that is to be below 1, with enough digits to see whether it is."""
    return f"{value:.8g}" if abs(value) > _ZERO else "0"


def _log(value: float) -> str:
    if math.isinf(value):
        return "none" if value > 0 else "zero"
    if abs(value) < _ROUNDING:
        return "0.00"
    return f"{value:.2f}" if abs(value) >= 0.005 else f"{value:.1g}"  # not -0.00


def _document(
    found: Conditions,
    theories: Mapping[str, Bounds],
    measured: Mapping[str, Comparison] | None,
) -> dict[str, object]:
    document: dict[str, object] = {
        "theorem": found.theorem,
        "rho_theorem_1_printed": found.theorem_1_printed,
        "rho_theorem_1_simulated": found.theorem_1_simulated,
        "rho_theorem_2_printed": found.theorem_2_printed,
        "rho_theorem_2_simulated": found.theorem_2_simulated,
        "starts_on_reference": found.starts_on_reference,
        "bounds": {name: _bounds_document(theory) for name, theory in theories.items()},
    }
    if measured:
        document["simulated"] = {
            name: {
                quantity: {
                    "last_log10": part.over_last(_LAST),
                    "smallest_looseness_log10": float(part.looseness.min()),
                    "limit_looseness_log10": part.limit_looseness(_LAST),
                    "limit_violated": part.limit_violated(_LAST),
                    "violated_iterations": [int(position) for position in part.violated],
                }
                for quantity, part in comparison.parts.items()
            }
            for name, comparison in measured.items()
        }
    return document


def _bounds_document(theory: Bounds) -> dict[str, object]:
    constants = {name: getattr(theory.constants, name) for name in _CONSTANTS}
    return {
        **constants,
        "lambda": theory.lambda_,
        "A": theory.A,
        "B": theory.B,
        "has_limit": theory.has_limit,
        # Not finite, which becomes null: no bound or, with a limit, a bound of zero.
        "input_limit_log10": theory.input_limit,
        "state_limit_log10": theory.state_limit,
        "output_limit_log10": theory.output_limit,
    }
