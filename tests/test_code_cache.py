"""Machine code that is kept is used only if it is what was kept; else it is made anew."""

from __future__ import annotations

import errno
import importlib.util
import logging
import os
import pickle
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import pytest

from hilc_cli import compiling
from hilc_cli.compiling import CodeCache

SIGNATURE = (numba.int64,)
Damage = Callable[[bytes], bytes]


SOURCE = "def triple(value):\n    return 3 * value\n"


def function_of(path: Path) -> Any:
    path.write_text(SOURCE)
    specification = importlib.util.spec_from_file_location("small", path)
    assert specification is not None and specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module.triple


@pytest.fixture(scope="module")
def code(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A compiled function; that takes its time."""
    dispatcher = numba.njit(function_of(tmp_path_factory.mktemp("code") / "small.py"))
    assert dispatcher(14) == 42
    return dispatcher


@pytest.fixture
def new_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[], CodeCache]:
    """Gives the cache as a new process has it."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # else it lies in the same folder

    def new() -> CodeCache:
        compiling._told.clear()
        return CodeCache(function_of(tmp_path / "small.py"))

    return new


def load(cache: CodeCache, code: Any) -> Any:
    """What comes out of the cache, called with 14; None if nothing does."""
    found = cache.load_overload(SIGNATURE, code.targetctx)
    if found is None:
        return None
    fresh = numba.njit(code.py_func)
    fresh.add_overload(found)
    fresh.disable_compile()
    return fresh(14)


def kept(cache: CodeCache) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in Path(cache.cache_path).glob("*.nb?")}


def put(cache: CodeCache, files: dict[str, bytes]) -> None:
    for name, content in files.items():
        (Path(cache.cache_path) / name).write_bytes(content)


DAMAGES: dict[str, Damage] = {
    "empty": lambda content: b"",
    "cut off": lambda content: content[: len(content) // 3],
    "last byte gone": lambda content: content[:-1],
    "zeros": lambda content: bytes(len(content)),
    "zeros from the middle": lambda content: (
        content[: len(content) // 2] + bytes(len(content) - len(content) // 2)
    ),
    "one bit": lambda content: (
        content[: len(content) // 2]
        + bytes([content[len(content) // 2] ^ 4])
        + content[len(content) // 2 + 1 :]
    ),
    "rubbish": lambda content: os.urandom(len(content)),
    "another pickle": lambda content: pickle.dumps({"a": 1}),
    "an old one": lambda content: content + content,
}


def test_damaged_code_is_thrown_away_with_one_line(
    new_cache: Callable[[], CodeCache], code: Any, caplog: pytest.LogCaptureFixture
) -> None:
    cache = new_cache()
    assert load(cache, code) is None
    cache.save_overload(SIGNATURE, code.overloads[SIGNATURE])
    good = kept(cache)
    assert sorted(Path(name).suffix for name in good) == [".nbc", ".nbi"]
    cache = new_cache()
    assert cache.has(SIGNATURE, code.targetctx.codegen())
    assert load(cache, code) == 42
    assert not caplog.records
    for what, damage in DAMAGES.items():
        for suffixes in ((".nbc",), (".nbi",), (".nbc", ".nbi")):
            bad = {n: damage(c) if Path(n).suffix in suffixes else c for n, c in good.items()}
            cache = new_cache()
            put(cache, bad)
            assert not cache.has(SIGNATURE, code.targetctx.codegen()), (what, suffixes)
            assert load(cache, code) is None
            assert kept(cache) == {}
            (record,) = caplog.records
            assert record.levelno == logging.ERROR
            assert record.getMessage() == (
                f"hilc: machine code kept in {cache.cache_path} is damaged; "
                "it is thrown away and made anew"
            )
            caplog.clear()
    cache.save_overload(SIGNATURE, code.overloads[SIGNATURE])
    assert load(new_cache(), code) == 42


def test_first_to_find_damage_throws_all_of_it_away(
    new_cache: Callable[[], CodeCache], code: Any, caplog: pytest.LogCaptureFixture
) -> None:
    cache = new_cache()
    cache.save_overload(SIGNATURE, code.overloads[SIGNATURE])
    put(cache, dict.fromkeys((*kept(cache), "other-1.py311.nbi"), b"rubbish"))
    put(cache, {"notes.txt": b"mine"})
    other = new_cache()
    assert load(cache, code) is None
    assert [path.name for path in Path(cache.cache_path).iterdir()] == ["notes.txt"]
    assert load(other, code) is None
    assert len(caplog.records) == 1


def folder_with_a_file(place: Path) -> None:
    place.mkdir()
    (place / "file").touch()


@pytest.mark.parametrize("put_there", [os.mkfifo, folder_with_a_file])
@pytest.mark.parametrize("suffix", [".nbi", ".nbc"])
def test_what_is_no_file_is_thrown_away(
    new_cache: Callable[[], CodeCache],
    code: Any,
    caplog: pytest.LogCaptureFixture,
    put_there: Callable[[Path], None],
    suffix: str,
) -> None:
    cache = new_cache()
    cache.save_overload(SIGNATURE, code.overloads[SIGNATURE])
    (place,) = Path(cache.cache_path).glob(f"*{suffix}")
    place.unlink()
    put_there(place)
    cache = new_cache()
    assert not cache.has(SIGNATURE, code.targetctx.codegen())
    assert load(cache, code) is None
    assert not any(Path(cache.cache_path).iterdir())
    (record,) = caplog.records
    assert "is damaged: something else stands in the place of a file; it is" in record.getMessage()
    cache.save_overload(SIGNATURE, code.overloads[SIGNATURE])
    assert load(new_cache(), code) == 42


def test_code_under_the_name_of_other_code_is_not_used(
    new_cache: Callable[[], CodeCache], code: Any
) -> None:
    # As after a repair of the file system that mixes up names.
    cache = new_cache()
    cache.save_overload(SIGNATURE, code.overloads[SIGNATURE])
    (name,) = [name for name in kept(cache) if name.endswith(".1.nbc")]
    another = name.replace(".1.nbc", ".2.nbc")
    put(cache, {another: kept(cache)[name]})
    cache._cache_file._load_data(name)
    with pytest.raises(compiling._UnusableError, match="damaged"):
        cache._cache_file._load_data(another)


def test_code_of_another_user_is_not_used(
    new_cache: Callable[[], CodeCache], code: Any, caplog: pytest.LogCaptureFixture
) -> None:
    cache = new_cache()
    cache.save_overload(SIGNATURE, code.overloads[SIGNATURE])
    cache._cache_file._trusted = {os.getuid() + 1}
    assert not cache.has(SIGNATURE, code.targetctx.codegen())
    assert load(cache, code) is None
    (record,) = caplog.records
    assert " is of another user; it is thrown away and made anew" in record.getMessage()


@pytest.mark.parametrize(
    ("call", "word", "number"),
    [("load", "read", errno.EMFILE), ("save", "written", errno.ENOSPC)],
)
def test_trouble_with_the_folder_costs_time_only(
    new_cache: Callable[[], CodeCache],
    code: Any,
    caplog: pytest.LogCaptureFixture,
    call: str,
    word: str,
    number: int,
) -> None:
    def fail(*_: object) -> None:
        raise OSError(number, os.strerror(number))

    cache = new_cache()
    setattr(cache._cache_file, call, fail)
    assert load(cache, code) is None
    cache.save_overload(SIGNATURE, code.overloads[SIGNATURE])
    (record,) = caplog.records
    assert record.levelno == logging.WARNING
    assert f"cannot be {word} ([Errno {number}] {os.strerror(number)}); " in record.getMessage()
