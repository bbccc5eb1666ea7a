"""The part of ``hilc check`` that has the paper's conditions, constants and bounds."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from hilc_cli.cli.section import Grid, Section

if TYPE_CHECKING:
    from hilc_cli.analysis.bounds import Bounds
    from hilc_cli.analysis.conditions import Conditions, Contraction
    from hilc_cli.analysis.measured import Comparison
    from hilc_cli.api import Check

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
_LAST = 10
"""So many last iterations of a simulation stand for its limit."""


def theory_section(check: Check, *, verbose: bool = False) -> Section:
    """The paper's theory, as printed and as it holds; of another law, nothing.

    Args:
        check: What was found.
        verbose: Say what was corrected.
    """
    title = "What do the paper's theorems say?"
    if check.conditions is None or check.theories is None:
        return Section("theory", title, [("Theory", "none: this is another law")], document={})
    grids = [_constants(check.theories), _limits(check.theories)]
    measured = None if check.simulated is None else check.simulated.comparisons
    if measured:
        grids.append(_measured(measured))
    rows = _rows(check.conditions)
    if verbose:
        from hilc_cli.analysis.corrections import EXPLANATIONS

        rows += [(f"Corrected: {name}", text) for name, text in EXPLANATIONS.items()]
    return Section(
        "theory",
        title,
        rows,
        grids,
        check.findings["theory"].warnings,
        _document(check.conditions, check.theories, measured),
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


def _told(contraction: Contraction) -> str:
    verdict = "below 1" if contraction.holds else "not below 1"
    # A contraction of 1e-16 is rounding.
    rho = 0.0 if contraction.rho < 1e-12 else contraction.rho
    return f"rho = {rho:.6g}, {verdict}"


def _constants(theories: Mapping[str, Bounds]) -> Grid:
    """The constants of each theory, a column each."""
    rows = [
        [name, *(_number(getattr(theory.constants, name)) for theory in theories.values())]
        for name in _CONSTANTS
    ]
    rows += [
        ["lambda", *(_number(theory.lambda_) for theory in theories.values())],
        ["A", *(_number(theory.A) for theory in theories.values())],
        ["B", *(_number(theory.B) for theory in theories.values())],
    ]
    note = (
        "Constants of Eqs. 12 to 37. printed: as it stands; with d_k: d_k B for B; corrected: all "
        "gaps of the proof closed; in limit: likewise, with |u| <= b_w."
    )
    return Grid([("Constant", ""), *_columns(theories)], rows, note)


def _limits(theories: Mapping[str, Bounds]) -> Grid:
    """The bounds after infinitely many iterations and, for the state, at the last sample."""
    samples = next(iter(theories.values())).constants.samples
    rows = [
        ["Input, Eq. 39", *(_log(theory.input_limit) for theory in theories.values())],
        ["State, Eq. 41", *(_log(theory.state_limit) for theory in theories.values())],
        ["Output, Eq. 43", *(_log(theory.output_limit) for theory in theories.values())],
        [
            f"State at sample {samples}",
            *(_log(theory.at_sample(theory.state_limit, samples)) for theory in theories.values()),
        ],
    ]
    note = (
        "log10 of the bounds in the lambda-norm, after infinitely many iterations. As printed they "
        "do not hold for the system that is simulated."
    )
    return Grid([("Limit", ""), *_columns(theories)], rows, note)


def _measured(comparisons: Mapping[str, Comparison]) -> Grid:
    """A simulation beside the bounds of each iteration, and beside the limits."""
    rows = []
    for quantity, equations in (("input", 38), ("state", 40), ("output", 42)):
        parts = [comparison.parts[quantity] for comparison in comparisons.values()]
        name = quantity.capitalize()
        rows += [
            [f"{name}, last {_LAST}", *(_log(part.over_last(_LAST)) for part in parts)],
            [
                f"{name}, room below Eq. {equations}",
                *(_log(float(part.looseness.min())) for part in parts),
            ],
            [f"{name}, iterations above it", *(str(len(part.violated)) for part in parts)],
        ]
    note = (
        "log10 of the simulated errors in the same norms, and of bound / error where it is "
        "smallest over the iterations: below 0 the bound is violated."
    )
    return Grid([("Simulated", ""), *_columns(comparisons)], rows, note)


def _columns(theories: Mapping[str, object]) -> list[tuple[str, str]]:
    return [(_SHORT[name], "") for name in theories]


def _number(value: float) -> str:
    return f"{value:.5g}" if abs(value) > 1e-12 else "0"


def _log(value: float) -> str:
    if math.isinf(value):
        return "none" if value > 0 else "-inf"
    return f"{value:.2f}"


def _document(
    found: Conditions,
    theories: Mapping[str, Bounds],
    measured: Mapping[str, Comparison] | None,
) -> dict[str, object]:
    document: dict[str, object] = {
        "theorem": found.theorem,
        "rho_theorem_1_printed": found.theorem_1_printed.rho,
        "rho_theorem_1_simulated": found.theorem_1_simulated.rho,
        "rho_theorem_2_printed": found.theorem_2_printed.rho,
        "rho_theorem_2_simulated": found.theorem_2_simulated.rho,
        "starts_on_reference": found.starts_on_reference,
        "bounds": {name: _bounds_document(theory) for name, theory in theories.items()},
    }
    if measured:
        document["simulated"] = {
            name: {
                quantity: {
                    "last_log10": _finite(part.over_last(_LAST)),
                    "smallest_looseness_log10": _finite(float(part.looseness.min())),
                    "violated_iterations": [int(position) for position in part.violated],
                }
                for quantity, part in comparison.parts.items()
            }
            for name, comparison in measured.items()
        }
    return document


def _bounds_document(theory: Bounds) -> dict[str, object]:
    constants = {name: _finite(getattr(theory.constants, name)) for name in _CONSTANTS}
    return {
        **constants,
        "lambda": theory.lambda_,
        "A": _finite(theory.A),
        "B": _finite(theory.B),
        "input_limit_log10": _finite(theory.input_limit),
        "state_limit_log10": _finite(theory.state_limit),
        "output_limit_log10": _finite(theory.output_limit),
    }


def _finite(number: float) -> float | None:
    """A number as JSON has it: null for no bound, and for a bound of zero."""
    return number if math.isfinite(number) else None
