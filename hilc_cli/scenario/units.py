"""The units of a scenario's keys, as their models have them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

from hilc_cli.scenario.scenario import ScenarioSpec
from hilc_cli.yaml_input.model import Model, models_in
from hilc_cli.yaml_input.quantities import Quantity, quantities_in


def unit_of(key: str) -> str:
    """The unit of a dotted key; empty if it has none or none is known."""
    *above, last = key.split(".")
    units = _units()
    if last.isdigit() and above:
        places = units.get(above[-1], ())
        return places[int(last)] if int(last) < len(places) else ""
    places = units.get(last, ())
    return places[0] if len(set(places)) == 1 else ""


@cache
def _units() -> Mapping[str, tuple[str, ...]]:
    """Units of the numbers that fields hold, by the fields' names: a name has the same anywhere."""
    units: dict[str, tuple[str, ...]] = {}
    models: list[type[Model]] = [ScenarioSpec]
    for model in models:
        for name, field in model.model_fields.items():
            found = [part for part in field.metadata if isinstance(part, Quantity)]
            found = found or quantities_in(field.annotation)
            if found:
                units[name] = tuple(each.told_in or each.unit.text for each in found)
            models += (part for part in models_in(field.annotation) if part not in models)
    return units
