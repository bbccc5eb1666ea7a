"""Damage to the folder of a sweep under way: what is damaged is computed again."""

from __future__ import annotations

import json
import random
import zlib
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest

from hilc_cli.errors import ExistingResultsError, UsageError
from hilc_cli.sweeps.chunks import Chunk, Journal
from hilc_cli.sweeps.compute import run_chunk
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.store import FolderStore, open_store
from tests.cli.inputs import listing
from tests.sweeps.plans import small_plan

ALL = Chunk(0, 64)
Damage = Callable[[Path], None]


def compute(store: FolderStore, plan: Plan, size: int = 8) -> list[Chunk]:
    """Computes what is missing; tells what it was."""
    missing = store.missing()
    for gap in missing:
        for first in range(gap.first, gap.last, size):
            store.keep(run_chunk(plan, Chunk(first, min(first + size, gap.last))))
    return missing


def contents(store: FolderStore) -> tuple[bytes, list[bytes]]:
    return store.rows().tobytes(), [errors.tobytes() for errors in store.errors()]


def change(path: Path, change: Callable[[bytes], bytes]) -> None:
    path.write_bytes(change(path.read_bytes()))


def torn_line(folder: Path) -> None:
    change(folder / "journal", lambda content: content[:-5])


def torn_in_its_midst(folder: Path) -> None:
    change(folder / "journal", lambda content: content[: len(content) // 2])


def no_journal(folder: Path) -> None:
    (folder / "journal").unlink()


def garbage_in_the_journal(folder: Path) -> None:
    def garbage(content: bytes) -> bytes:
        lines = content.split(b"\n")
        lines[5] = lines[5].replace(b"first", b"worst")
        lines[7:7] = [b"\xff\x00garbage", b"", b"00000000 {}", b"[]", b"\0" * 5000]
        return b"\n".join(lines)

    change(folder / "journal", garbage)


def journal_of_binary(folder: Path) -> None:
    change(folder / "journal", lambda content: random.Random(0).randbytes(10_000) + content[60:])


def truncated_rows(folder: Path) -> None:
    change(folder / "results.bin", lambda content: content[: len(content) // 2 + 3])


def truncated_errors(folder: Path) -> None:
    change(folder / "errors.bin", lambda content: content[: len(content) // 2 + 3])


def no_rows(folder: Path) -> None:
    (folder / "results.bin").unlink()


def no_errors(folder: Path) -> None:
    (folder / "errors.bin").write_bytes(b"")


def flipped(content: bytes) -> bytes:
    changed = bytearray(content)
    for position in (0, len(content) // 3, len(content) - 1):
        changed[position] ^= 0x10
    return bytes(changed)


def flipped_rows(folder: Path) -> None:
    change(folder / "results.bin", flipped)


def flipped_errors(folder: Path) -> None:
    change(folder / "errors.bin", flipped)


def old_content_behind_the_end(folder: Path) -> None:
    change(folder / "results.bin", lambda content: content[:1000] + bytes(len(content)))


DAMAGES = [
    torn_line, torn_in_its_midst, no_journal, garbage_in_the_journal, journal_of_binary,
    truncated_rows, truncated_errors, no_rows, no_errors, flipped_rows, flipped_errors,
    old_content_behind_the_end,
]  # fmt: skip


@pytest.mark.parametrize("damage", DAMAGES, ids=lambda damage: damage.__name__)
def test_damaged_chunks_are_computed_again(tmp_path: Path, damage: Damage) -> None:
    plan, folder = small_plan(tmp_path), tmp_path / "part"
    store = open_store(folder, plan, ALL, None, resume=False, force=False)
    assert compute(store, plan) == [ALL]
    whole = contents(store)
    store.close()
    damage(folder)
    # Each time in chunks of another size, and opened once more in between.
    for size in (5, 16):
        store = open_store(folder, plan, ALL, None, resume=True, force=False)
        missing = compute(store, plan, size)
        assert bool(missing) == (size == 5)
        assert contents(store) == whole
        store.close()


def test_nothing_is_computed_again_without_need(tmp_path: Path) -> None:
    plan, folder = small_plan(tmp_path), tmp_path / "part"
    store = open_store(folder, plan, ALL, None, resume=False, force=False)
    compute(store, plan)
    store.close()
    change(folder / "results.bin", lambda content: content[:-1] + bytes([content[-1] ^ 1]))
    store = open_store(folder, plan, ALL, None, resume=True, force=False)
    assert store.missing() == [Chunk(56, 64)]
    store.close()


def test_line_after_a_torn_one_counts(tmp_path: Path) -> None:
    plan, folder = small_plan(tmp_path), tmp_path / "part"
    store = open_store(folder, plan, ALL, None, resume=False, force=False)
    store.keep(run_chunk(plan, Chunk(0, 8)))
    store.close()
    torn_line(folder)
    store = open_store(folder, plan, ALL, None, resume=True, force=False)
    store.keep(run_chunk(plan, Chunk(8, 16)))
    store.close()
    store = open_store(folder, plan, ALL, None, resume=True, force=False)
    assert store.missing() == [Chunk(0, 8), Chunk(16, 64)]
    store.close()


def test_huge_journal_is_refused_unread(tmp_path: Path) -> None:
    with (tmp_path / "journal").open("wb") as file:
        file.truncate(10**12)
    with (
        closing(Journal(tmp_path / "journal", read_only=True)) as journal,
        pytest.raises(UsageError, match=r"journal: is larger than 2000000000 bytes"),
    ):
        journal.is_empty()


@pytest.mark.parametrize("first", [-8, 56, 10**15])
def test_entry_of_cases_that_are_not_here(tmp_path: Path, first: int) -> None:
    """A journal that somebody has copied here from elsewhere."""
    plan, folder = small_plan(tmp_path), tmp_path / "part"
    open_store(folder, plan, ALL, None, resume=False, force=False).close()
    text = json.dumps({"first": first, "last": first + 16, "checksum": 0, "failures": []})
    line = f"\n{zlib.crc32(text.encode()):08x} {text}\n"
    (folder / "journal").write_text(line)
    store = open_store(folder, plan, ALL, None, resume=True, force=False)
    assert compute(store, plan) == [ALL]
    store.close()


def test_of_two_that_start_at_once_the_second_changes_nothing(tmp_path: Path) -> None:
    folder = tmp_path / "part"
    first = open_store(folder, small_plan(tmp_path), ALL, None, resume=False, force=False)
    before = listing(folder)
    # It has looked before the first one made the folder.
    other = small_plan(tmp_path, cases=32)
    with pytest.raises(ExistingResultsError):
        FolderStore.create(folder, other, Chunk(0, 32), None)
    assert listing(folder) == before
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".")] == []
    first.close()


@pytest.mark.parametrize("content", ["", "{", "[]", "{}", '{"kind": "hilc sweep"}', "\0" * 100])
def test_no_header(tmp_path: Path, content: str) -> None:
    (tmp_path / "plan.json").write_text(content)
    with pytest.raises(UsageError, match="is no folder of a sweep in progress"):
        FolderStore(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["plan.json"]
