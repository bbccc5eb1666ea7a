"""The keys that a scenario may have, as ``--set`` and ``--vary`` take them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import get_args, get_origin

from hilc_cli.scenario.scenario import ScenarioSpec
from hilc_cli.yaml_input.model import Model, models_in

_WHOLE = frozenset({"trajectory", "sweep"})
"""Sections that may be a single value: the path of a file, or nothing."""


def scenario_keys() -> list[str]:
    """Dotted keys of all values that a scenario may hold, those of all laws among them, in order.

    What is in lists, such as the segments of a trajectory, is left out: those keys have numbers.
    """
    return list(dict.fromkeys(_keys(ScenarioSpec, "")))


def _keys(model: type[Model], above: str) -> Iterator[str]:
    for name, field in model.model_fields.items():
        parts = [] if _holds_many(field.annotation) else models_in(field.annotation)
        if not parts or name in _WHOLE:
            yield f"{above}{name}"
        for part in parts:
            yield from _keys(part, f"{above}{name}.")


def _holds_many(annotation: object) -> bool:
    """Whether values of a kind may be lists or have names of the user's choice."""
    parts = get_args(annotation)
    return get_origin(annotation) in (list, tuple, dict) or any(map(_holds_many, parts))
