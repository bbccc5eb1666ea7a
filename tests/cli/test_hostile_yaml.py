"""Files that are made to hang or to exhaust a reader: each ends at once, in one line."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from pathlib import Path
from types import FrameType

import pytest

from tests.cli.inputs import SCENARIO, TRAJECTORY, scenario
from tests.conftest import Hilc, Outcome

SECONDS = (
    60  # far above the fraction of a second that it takes; a machine that counts lines is slow
)
SYNTAX = "check quotes, colons, brackets and indentation"

LAUGHS = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]\n" for i in range(1, 13)
)
DOUBLING = "a0: &a0 {x: 1}\n" + "".join(
    f"a{i}: &a{i} {{p: *a{i - 1}, q: *a{i - 1}}}\n" for i in range(1, 40)
)

CASES: list[tuple[str, str | bytes, str]] = [
    ("list of lists of aliases", LAUGHS, "5:35: holds more than 50000 values; shorten it"),
    ("mapping of aliases", DOUBLING, "15:15: holds more than 50000 values; shorten it"),
    ("opening brackets", "[" * 200_000, "1:22: is nested more than 20 deep; flatten it"),
    ("opening braces", "{" * 200_000, "1:2: has a key that is no plain word; use words as keys"),
    ("nested mappings", "{a: " * 200_000, "1:85: is nested more than 20 deep; flatten it"),
    ("nested dashes", "- " * 300_000, "1:43: is nested more than 20 deep; flatten it"),
    (
        "deep indentation",
        "".join(f"{' ' * depth}a:\n" for depth in range(1_300)),
        "22:22: is nested more than 20 deep; flatten it",
    ),
    ("many entries", "-\n" * 400_000, "50000:2: holds more than 50000 values; shorten it"),
    (
        "many complex keys",
        "? " * 300_000,
        "1:3: has a key that is no plain word; use words as keys",
    ),
    ("long comment", "#" * 900_000, "1:1: is empty; write a mapping of keys and values"),
    ("blank lines", "\n" * 900_000, "1:1: is empty; write a mapping of keys and values"),
    (
        "open quote",
        '"' + "a" * 900_000,
        f"1:900002: is not valid YAML: found unexpected end of stream; {SYNTAX}",
    ),
    (
        "long number",
        scenario("0.2", "9" * 900_000),
        "3:23: robot.wheel_radius: has 900000 digits, got "
        f"'{'9' * 40}...'; give a number above 0, such as 0.2 or 20 cm",
    ),
    (
        "brackets of an expression",
        scenario("0.2", f"'{'(' * 400_000}'"),
        "3:23: robot.wheel_radius: is longer than 120 characters, got "
        f"'{'(' * 40}...'; give a number above 0, such as 0.2 or 20 cm",
    ),
    (
        "long text",
        f"{SCENARIO}description: {'x' * 900_000}\n",
        f"8:14: description: is too long, got '{'x' * 40}...'; shorten it",
    ),
    (
        "UTF-16",
        SCENARIO.encode("utf-16-le"),
        "1:2: is not valid YAML: ",
    ),
    (
        "no UTF-8",
        SCENARIO.encode().replace(b"l1", b"l\xff"),
        "6:12: is not UTF-8 text, got byte 0xff; save the file as UTF-8",
    ),
]


@pytest.fixture(autouse=True)
def in_time() -> Iterator[None]:
    """What hangs is woken up."""

    def stop(number: int, frame: FrameType | None) -> None:
        raise AssertionError("hangs")

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(SECONDS)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize(
    ("content", "message"), [pytest.param(content, text, id=name) for name, content, text in CASES]
)
def test_hostile_file_ends_at_once(
    hilc: Hilc, folder: Path, content: str | bytes, message: str
) -> None:
    data = content.encode() if isinstance(content, str) else content
    (folder / "scenario.yaml").write_bytes(data)
    (folder / "path.yaml").write_text(TRAJECTORY)
    outcome = hilc("run", "scenario.yaml")
    if message.endswith(": "):  # the library's words follow
        assert outcome.err.startswith(f"scenario.yaml:{message}")
        assert outcome.err.count("\n") == 1
    else:
        assert outcome == Outcome(2, "", f"scenario.yaml:{message}\n")
    assert sorted(path.name for path in folder.iterdir()) == ["path.yaml", "scenario.yaml"]


@pytest.mark.parametrize(
    "line", ["key{}: 1\n", "key: {}\n", "key{}: !tag 1\n", "key{}: {{a: 1, a: 2}}\n"]
)
def test_thousands_of_mistakes_do_not_flood_the_terminal(
    hilc: Hilc, folder: Path, line: str
) -> None:
    (folder / "scenario.yaml").write_text("".join(line.format(i) for i in range(12_000)))
    outcome = hilc("run", "scenario.yaml")
    assert outcome.code == 2
    assert outcome.err.count("\n") <= 200


def test_path_of_very_many_segments_loads_at_once(hilc: Hilc, folder: Path) -> None:
    # Quadratic work would show: this is near the most segments that a file may have.
    segment = "  - line: {length: 1, duration: 0.1}\n"
    (folder / "path.yaml").write_text(TRAJECTORY + segment * 3_999)
    (folder / "scenario.yaml").write_text(scenario("iterations: 2", "iterations: 0"))
    outcome = hilc("run", "scenario.yaml", "--no-plots", "-q")
    assert outcome == Outcome(0, "", "")
