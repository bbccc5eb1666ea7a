"""The command line in the process of the tests, in an empty working folder."""

from __future__ import annotations

import functools
import io
import signal
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import hypothesis
import pytest
import typer.main

from hilc_cli.cli.main import main
from hilc_cli.cli.session import STOPPED
from tests.cli.inputs import INPUT_CSV, SCENARIO, TRAJECTORY

pytest_plugins = ["tests.made_up_runs", "tests.made_up_sweeps", "tests.yaml_files"]

_HANDLERS = {number: signal.getsignal(number) for number in STOPPED}

# How long an example takes says nothing on a loaded machine.
hypothesis.settings.register_profile("hilc", deadline=None)
hypothesis.settings.load_profile("hilc")


@dataclass(frozen=True)
class Outcome:
    """What a command line left behind."""

    code: int
    out: str
    err: str


class Hilc(Protocol):
    """Runs a command line."""

    def __call__(self, *arguments: str, stdin: bytes = b"") -> Outcome: ...


class Write(Protocol):
    """Writes files into the working folder: the small valid inputs, and others over them."""

    def __call__(self, files: Mapping[str, str | bytes] | None = None) -> None: ...


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Pages of examples take longest and begin first: no process waits for them in the end."""
    items.sort(key=lambda item: "test_examples_of_the_page" not in item.name)


@pytest.fixture(scope="session", autouse=True)
def _compiler_without_tracing() -> Iterator[None]:
    """Coverage does not look at calls within the compiler, which adds half to what it takes.

    The compiler reads the formulas and does not run them: the few lines that it does run, in
    ``machine_code.py``, are not counted.
    """
    from numba.core import dispatcher

    Compiler: Any = vars(dispatcher)["_FunctionCompiler"]
    compile_traced = Compiler.compile

    def compile_untraced(self: Any, *arguments: Any) -> Any:
        tracer = sys.gettrace()
        sys.settrace(None)
        try:
            return compile_traced(self, *arguments)
        finally:
            sys.settrace(tracer)

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(Compiler, "compile", compile_untraced)
        yield


@pytest.fixture(scope="session", autouse=True)
def _commands_are_built_once() -> Iterator[None]:
    """A process builds the commands of ``hilc`` once, which takes as long as many a test."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(typer.main, "get_command", functools.cache(typer.main.get_command))
        yield


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty working folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def write(folder: Path) -> Write:
    def write(files: Mapping[str, str | bytes] | None = None) -> None:
        inputs = {"scenario.yaml": SCENARIO, "path.yaml": TRAJECTORY, "input.csv": INPUT_CSV}
        for name, content in {**inputs, **(files or {})}.items():
            data = content.encode() if isinstance(content, str) else content
            (folder / name).write_bytes(data)

    return write


def put_back(handlers: Mapping[signal.Signals, Any]) -> None:
    """The program leaves with signals ignored, which processes that a test starts would inherit."""
    for number, handler in handlers.items():
        signal.signal(number, handler)


@pytest.fixture(autouse=True)
def _signals_are_heard() -> Iterator[None]:
    yield
    put_back(_HANDLERS)


@pytest.fixture
def hilc(folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Hilc:
    """The command line, run in this process: much faster than a new one for each case."""
    monkeypatch.delenv("_HILC_COMPLETE", raising=False)

    def hilc(*arguments: str, stdin: bytes = b"") -> Outcome:
        capsys.readouterr()
        before = {number: signal.getsignal(number) for number in STOPPED}
        with monkeypatch.context() as patched:
            patched.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(stdin)))
            patched.setattr(sys, "argv", ["hilc", *arguments])
            with pytest.raises(SystemExit) as stop:
                main(arguments)
        put_back(before)
        printed = capsys.readouterr()
        assert isinstance(stop.value.code, int)
        return Outcome(stop.value.code, printed.out, printed.err)

    return hilc
