"""Damages logs in ways that follow from a seed."""
# ruff: noqa: E501

from __future__ import annotations

import random
from pathlib import Path

WORDS = ("", "nan", "inf", "-inf", "1e309", "1e200", "-1", "0", "9" * 400, "1e11", "1,5", "x", '"',
         "\x00", "\x1b[31m", "\ufeff", "1_0", "0x10", "t_s", ";", "#", "%", "n" * 20_000)  # fmt: skip
NAMES = ("../x", "/etc/passwd", "..", "", "a" * 300, "*a", "&a [*a]", "!!python/object:os.system",
         "2" * 400, "-1", "null", "{}", "[]", "zstd", "file", "message", "mcap", "sqlite3")  # fmt: skip


def damaged_table(text: str, dice: random.Random) -> bytes:
    """Returns a table with a few cells, lines or bytes that are something else."""
    lines = text.split("\n")
    for _ in range(dice.choice((1, 1, 2, 5))):
        line = dice.randrange(len(lines))
        way = dice.randrange(6)
        if way <= 2:
            cells = lines[line].split(",")
            cells[dice.randrange(len(cells))] = dice.choice(WORDS)
            lines[line] = ",".join(cells)
        elif way == 3:
            lines[line] = dice.choice(WORDS)
        elif way == 4:
            other = dice.randrange(len(lines))
            lines[line], lines[other] = lines[other], lines[line]
        else:
            lines = lines[: max(line, 1)]
    return damaged_bytes("\n".join(lines).encode(), dice) if dice.random() < 0.2 else (
        "\n".join(lines).encode()
    )  # fmt: skip


def damaged_bytes(content: bytes, dice: random.Random) -> bytes:
    """Returns content with a few bytes that are others, or parts that are gone or there twice."""
    changed = bytearray(content)
    for _ in range(dice.choice((1, 2, 5, 20))):
        at = dice.randrange(max(len(changed), 1))
        length = dice.choice((1, 2, 4, 8, 64))
        way = dice.randrange(5)
        if way == 0:
            changed[at : at + length] = dice.randbytes(length)
        elif way == 1:
            changed[at : at + length] = dice.choice((b"\xff", b"\x00", b"\x7f")) * length
        elif way == 2:
            del changed[at : at + length]
        elif way == 3:
            changed[at:at] = changed[at : at + length]
        elif dice.random() < 0.2:
            del changed[at:]
    return bytes(changed)


def damage_bag(bag: Path, dice: random.Random) -> None:
    """Damages the metadata or a storage file of a bag."""
    metadata = bag / "metadata.yaml"
    if dice.random() < 0.35:
        lines = metadata.read_text().split("\n")
        line = dice.randrange(len(lines))
        key, colon, _ = lines[line].partition(":")
        lines[line] = f"{key}{colon} {dice.choice(NAMES)}" if dice.random() < 0.8 else ""
        metadata.write_bytes("\n".join(lines).encode())
        return
    if dice.random() < 0.1:
        metadata.unlink()
    files = [file for file in bag.iterdir() if file.name != metadata.name]
    if files:
        file = dice.choice(sorted(files))
        content = file.read_bytes()
        # The parts that tell what else there is stand at the ends.
        if dice.random() < 0.5 and len(content) > 4000:
            cut = dice.choice((2000, len(content) - 2000))
            parts = content[:cut], content[cut:]
            head, tail = (
                (damaged_bytes(parts[0], dice), parts[1])
                if cut == 2000
                else (parts[0], damaged_bytes(parts[1], dice))
            )
            file.write_bytes(head + tail)
        else:
            file.write_bytes(damaged_bytes(content, dice))
