"""What another run has identified of its robot, in the place of ``model: {from: RUN}``."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from hilc_cli.errors import HilcError, InvalidInputError, Problem, UsageError
from hilc_cli.yaml_input.nodes import (
    MapNode,
    Place,
    Scalar,
    Source,
    describe,
    from_data,
    to_data,
    with_entry,
)

FROM = "from"
_COLUMNS = "model_wheel_radius_m", "model_half_track_m"
_RATIO = "model_left_per_right_radius", "model_left_per_right_radius_standard_error"
_MOTOR = {
    "delay": ("model_delay_s", "model_delay_and_lag_standard_error_s"),
    "lag": ("model_lag_s", "model_delay_and_lag_standard_error_s"),
    "dead_zone": ("model_friction_rad_s", "model_friction_standard_error_rad_s"),
}
"""Keys of a motor, and the columns of ``learning.csv`` that tell them and how sure they are.

Delay and lag are hardly told apart, but surely together, and are taken together."""
_CLEARLY = 2.0
"""So many standard errors from a motor's or a wheel's being ideal are worth telling."""
_NOTHING = Scalar(Place(Source("", Path())), None, "")
_REMEDY = "name the folder of a run whose law identifies, such as norm-optimal"


def with_identified(tree: MapNode, read: Callable[[Path, int], bytes]) -> MapNode:
    """Returns the scenario with numbers in the place of ``model.from``.

    They are those that the run believed after its last iteration. The numbers alone are kept, so
    that the scenario no longer needs the run.

    Args:
        tree: The scenario.
        read: Reads a file of a limited size, and remembers its checksum.

    Raises:
        InvalidInputError: There is no such run, it has identified nothing, or the model says the
            same itself.
    """
    model = tree.entries.get("model")
    if not isinstance(model, MapNode) or FROM not in model.entries:
        return tree
    node = model.entries[FROM]
    if isinstance(node, Scalar) and node.value is None:
        return tree
    try:
        if not isinstance(node, Scalar) or not isinstance(node.value, str) or not node.value:
            raise UsageError(f"must be the folder of a run, got {describe(node)}; {_REMEDY}")
        known = _identified(node.place.source.folder / node.value, read)
        for key in (*known, "wheel_separation"):
            if to_data(model.entries.get(key, _NOTHING)) is not None:
                raise UsageError(
                    f"tells {key}, which the model has, too; give one of them, such as "
                    f"'model: {{from: {node.value}}}' alone"
                )
    except HilcError as error:
        raise InvalidInputError([Problem(str(node.place), f"model.{FROM}", str(error))]) from None
    entries = {key: value for key, value in model.entries.items() if key != FROM}
    found = MapNode(model.place, entries, model.key_places)
    for key, value in known.items():
        found = with_entry(found, key, from_data(value, node.place), node.place)
    return with_entry(tree, "model", found, tree.key_places.get("model", model.place))


def _identified(folder: Path, read: Callable[[Path, int], bytes]) -> dict[str, object]:
    """Returns what the model of a run was at its end, by key of a scenario's model.

    Of unequal wheels and of motors what was clearly measured.

    Raises:
        HilcError: There is no such table, it is damaged, or nothing of it was identified.
    """
    # Few models are those of another run.
    from hilc_cli.results.learning import LEARNING, read_learning
    from hilc_cli.results.reading import MAX_CSV_BYTES

    path = folder / LEARNING
    if folder.is_dir() and not path.exists():
        raise UsageError(f"{folder}: holds no {LEARNING}; {_REMEDY}")
    read(path, MAX_CSV_BYTES)
    table = read_learning(path)
    if not set(_COLUMNS) <= set(table.names):
        raise UsageError(f"{path}: tells no wheel radius and half track; {_REMEDY}")
    figures = table.last()
    radius, half_track = (figures[column] for column in _COLUMNS)
    found: dict[str, object] = {"wheel_radius": radius, "half_track": half_track}
    ratio = figures.get(_RATIO[0], 1.0)
    if _is_clear(ratio - 1, figures.get(_RATIO[1])):
        right = 2 * radius / (1 + ratio)
        found["wheel_radius"] = {"left": ratio * right, "right": right}
    motor = {
        key: figures[column]
        for key, (column, error) in _MOTOR.items()
        if column in figures and _is_clear(figures[column], figures.get(error))
    }
    return found | ({"motor": motor} if motor else {})


def _is_clear(off: float, error: float | None) -> bool:
    """Returns whether a quantity was measured, and is not what an ideal robot has."""
    return error is not None and abs(off) > _CLEARLY * error  # not of not-a-number
