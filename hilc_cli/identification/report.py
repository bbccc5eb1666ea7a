"""What was identified, for the terminal, for JSON, and to paste into a scenario."""

from __future__ import annotations

import math
from collections.abc import Iterable

from hilc_cli.identification.identifying import Estimate, Identification
from hilc_cli.reporting.terminal import Grid, print_grid, print_text
from hilc_cli.yaml_input.tree import to_yaml

HEADER = ("", "value", "standard error", "believed", "")
_CONVENTIONS = {"left": "paper", "right": "rep103"}


def print_report(found: Identification) -> None:
    """Tells what was identified, on stdout."""
    print_text(
        f"Identified from {found.length:.3g} m driven in {found.duration:.3g} s "
        f"({found.duration / 60:.1f} min)"
    )
    print_text("")
    header = [(name, "") for name in HEADER]
    rows = [estimate_row(each) for each in found.estimates.values()]
    print_grid(Grid(header, rows))
    print_text("")
    for line in sentences(found):
        print_text(line)
    print_text("")
    print_text("Could not be known:")
    for line in found.unknown:
        print_text(f"  {line}")
    print_text("")
    print_text("To paste into a scenario:")
    print_text("")
    print_text(to_yaml({"model": model_block(found)}).rstrip("\n"))
    multipliers = ros2_control(found)
    if multipliers:
        print_text("")
        print_text("To paste into the parameters of diff_drive_controller (ros2_control):")
        print_text("")
        for name, value in multipliers.items():
            print_text(f"{name}: {value:.5f}")


def estimate_row(each: Estimate) -> list[str]:
    """An estimate as a table tells it, under `HEADER`."""
    unit = f" {each.unit}" if each.unit else ""
    error = "" if each.error is None else f"{each.error:.1g}{unit}"
    believed = "" if each.believed is None else f"{each.believed:.6g}{unit}"
    return [each.name, f"{_rounded(each)}{unit}", error, believed, "" if each.known else "unknown"]


def _rounded(each: Estimate) -> str:
    """The value with the digits that its standard error leaves."""
    if not each.error:
        return f"{each.value:.4g}"
    digits = max(0, 1 - math.floor(math.log10(each.error)))
    return f"{each.value:.{min(digits, 9)}f}"


def sentences(found: Identification) -> Iterable[str]:
    """What is to be said beside the numbers."""
    other = {"left": "right", "right": "left"}[found.turns_left]
    name = _CONVENTIONS[found.turns_left]
    yield f"A faster {found.turns_left} wheel turns the robot left (turn_convention: {name})."
    if found.swapped:
        yield (
            f"It is believed that a faster {other} wheel does: left and right wheel are swapped, "
            "or the convention of turning is mirrored."
        )
    if found.backward:
        yield (
            "Speeds above 0 drive the robot backward, as its headings have it: both wheels turn "
            "the other way, or the marker looks back."
        )
    blind = f"Driven blindly, the found robot is {_length(found.rms_blind)} from the poses (RMS)"
    if found.rms_blind_believed is None:
        yield f"{blind}."
    else:
        yield f"{blind}, the believed one {_length(found.rms_blind_believed)}."
    noise = found.noise
    yield f"Positions are read to {_length(math.sqrt(noise.position))} (standard deviation)."


def _length(metres: float) -> str:
    return f"{metres * 1e3:.3g} mm" if metres < 1 else f"{metres:.3g} m"


def model_block(found: Identification) -> dict[str, object]:
    """The section ``model`` of a scenario: what the logs tell, or what was believed where not."""
    numbers = found.estimates

    def told(key: str) -> float | None:
        each = numbers.get(key)
        if each is None or not each.known:
            return None if each is None else each.believed
        digits = 9 if not each.error else max(0, 2 - math.floor(math.log10(each.error)))
        return round(each.value, min(digits, 9))

    block: dict[str, object] = {}
    left, right = told("left_wheel_radius_m"), told("right_wheel_radius_m")
    if left is not None and right is not None:
        block["wheel_radius"] = {"left": left, "right": right}
    separation = told("wheel_separation_m")
    if separation is not None:
        block["wheel_separation"] = separation
    block["turn_convention"] = _CONVENTIONS[found.turns_left]
    motor = {key: told(f"{key}_s") for key in ("delay", "lag")}
    known = {key: value for key, value in motor.items() if value is not None}
    if known:
        block["motor"] = known
    return block


def ros2_control(found: Identification) -> dict[str, float]:
    """Multipliers of ros2_control's diff_drive_controller, for what it believes and is known."""
    pairs = {
        "wheel_separation_multiplier": "wheel_separation_m",
        "left_wheel_radius_multiplier": "left_wheel_radius_m",
        "right_wheel_radius_multiplier": "right_wheel_radius_m",
    }
    multipliers = {}
    for name, key in pairs.items():
        each = found.estimates[key]
        if each.believed is not None and each.known:
            multipliers[name] = round(each.value / each.believed, 5)
    return multipliers


def document(found: Identification) -> dict[str, object]:
    """What was identified, as a JSON document."""
    estimates = {
        key: {
            "value": each.value,
            "standard_error": each.error,
            "believed": each.believed,
            "known": each.known,
        }
        for key, each in found.estimates.items()
    }
    noise = found.noise
    return {
        "estimates": estimates,
        "turn_convention": _CONVENTIONS[found.turns_left],
        "swapped": found.swapped,
        "backward": found.backward,
        "length_m": found.length,
        "duration_s": found.duration,
        "rms_blind_m": found.rms_blind,
        "rms_blind_believed_m": found.rms_blind_believed,
        "noise": {
            "position_m": math.sqrt(noise.position),
            "heading_rad": math.sqrt(noise.heading),
            "ahead_m_per_sqrt_m": math.sqrt(noise.ahead),
            "left_m_per_sqrt_m": math.sqrt(noise.left),
            "turn_rad_per_sqrt_m": math.sqrt(noise.turn),
        },
        "unknown": list(found.unknown),
        "model": model_block(found),
        "ros2_control": ros2_control(found),
        "notes": list(found.notes),
        "warnings": list(found.warnings),
    }
