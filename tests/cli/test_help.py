"""Help, version, completion and verbosity."""

from __future__ import annotations

import platform
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy
import pytest

from hilc_cli import __version__
from hilc_cli.cli.app import PANELS, make_app
from hilc_cli.shipped_files import examples
from tests.cli.processes import environment, run_hilc
from tests.conftest import Hilc, Outcome, Write

APP = make_app()
GROUPS = [str(group.name) for group in APP.registered_groups]
COMMANDS = [
    *(str(command.callback.__name__) for command in APP.registered_commands),  # type: ignore[union-attr]
    *GROUPS,
]
PARTS = [
    [str(group.name), str(command.callback.__name__)]  # type: ignore[union-attr]
    for group in APP.registered_groups
    for command in group.typer_instance.registered_commands  # type: ignore[union-attr]
]
PROJECT = Path(__file__).resolve().parents[2] / "pyproject.toml"
HEAVY = {"numpy", "matplotlib", "pydantic", "yaml", "jinja2"}


@pytest.mark.parametrize("command", [[], *([command] for command in COMMANDS), *PARTS])
@pytest.mark.parametrize("option", ["--help", "-h"])
def test_every_help_carries_an_example(
    hilc: Hilc, monkeypatch: pytest.MonkeyPatch, command: list[str], option: str
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    outcome = hilc(*command, option)
    assert (outcome.code, outcome.err) == (0, "")
    assert "Example:\n" in outcome.out or "Examples:\n" in outcome.out
    assert f"\n    hilc {' '.join(command)}" in outcome.out
    assert "\x1b" not in outcome.out
    lines = outcome.out.splitlines()
    assert max(map(len, lines)) <= 80
    # The usage has dots behind what may be repeated; anywhere else they are a text cut short.
    assert not [line for line in lines[1:] if line.endswith(("...", "\N{HORIZONTAL ELLIPSIS}"))]


def test_no_command_imports_another() -> None:
    contracts = tomllib.loads(PROJECT.read_text())["tool"]["importlinter"]["contracts"]
    modules = next(each["modules"] for each in contracts if "command" in each["name"])
    assert sorted(modules) == sorted(f"hilc_cli.cli.{command}" for command in COMMANDS)


def test_no_command_shows_the_help(hilc: Hilc) -> None:
    assert hilc() == hilc("--help")


def test_help_names_every_command(hilc: Hilc) -> None:
    out = hilc("--help").out
    for command in COMMANDS:
        assert f"\n  {command} " in out


@pytest.mark.parametrize("command", [[], *([command] for command in COMMANDS), *PARTS])
def test_version_is_told_everywhere(hilc: Hilc, command: list[str]) -> None:
    assert hilc(*command, "--version") == Outcome(0, f"hilc {__version__}\n", "")


@pytest.mark.parametrize(
    ("arguments", "allowed"),
    # Typer itself needs Pydantic for the options of a command.
    [(["--help"], set()), (["--version"], set()), (["run", "--help"], {"pydantic"})],
)
def test_help_imports_nothing_heavy(
    tmp_path: Path, arguments: list[str], allowed: set[str]
) -> None:
    program = (
        "import sys\nfrom hilc_cli.cli.main import main\n"
        f"try: main({arguments!r})\n"
        "except SystemExit: pass\n"
        f"print(sorted({HEAVY - allowed!r} & set(sys.modules)), file=sys.stderr)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, capture_output=True, env=environment()
    )
    assert done.stderr.decode() == "[]\n"


def test_run_without_pictures_does_not_import_matplotlib(tmp_path: Path) -> None:
    program = (
        "import sys\nfrom hilc_cli.cli.main import main\n"
        "try: main(['run', 'example:fig6a', '--set=iterations=0', '--no-plots', '-q'])\n"
        "except SystemExit: pass\n"
        "print('matplotlib' in sys.modules, file=sys.stderr)"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, capture_output=True, env=environment()
    )
    assert done.stderr.decode() == "False\n"


def complete(words: str, position: int, cwd: Path) -> list[str]:
    changes = {
        "_HILC_COMPLETE": "complete_bash",
        "COMP_WORDS": words,
        "COMP_CWORD": str(position),
    }
    outcome = run_hilc(cwd=cwd, changes=changes)
    assert (outcome.code, outcome.err) == (0, "")
    return outcome.out.split()


def test_shell_completes_commands(tmp_path: Path) -> None:
    assert set(complete("hilc ", 1, tmp_path)) >= set(COMMANDS)


def test_shell_completes_example_names(tmp_path: Path) -> None:
    names = [f"example:{path.stem}" for path in examples()]
    assert complete("hilc run example:", 2, tmp_path) == names
    found = complete("hilc run example:fig3-c", 2, tmp_path)
    assert found == ["example:fig3-cardioid", "example:fig3-circle"]


def test_shell_completes_yaml_files_and_folders(tmp_path: Path) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "a.yaml").touch()
    (tmp_path / "mine" / "notes.txt").touch()
    assert complete("hilc run mi", 2, tmp_path) == ["mine/"]
    assert complete("hilc run mine/", 2, tmp_path) == ["mine/a.yaml"]


def test_failure_shows_no_traceback(hilc: Hilc) -> None:
    assert "Traceback" not in hilc("run", "nosuch.yaml").err


@pytest.mark.parametrize("option", ["-v", "--verbose"])
def test_verbose_shows_the_traceback_of_a_failure(hilc: Hilc, option: str) -> None:
    outcome = hilc("run", "nosuch.yaml", option)
    assert (outcome.code, outcome.out) == (2, "")
    assert outcome.err.startswith("Traceback (most recent call last):\n")
    assert outcome.err.endswith("hilc: nosuch.yaml: there is no such file; check the path\n")


def test_verbose_tells_how_long_it_took(hilc: Hilc, write: Write) -> None:
    write()
    outcome = hilc("run", "scenario.yaml", "--no-plots", "-v")
    assert outcome.code == 0
    assert outcome.err.startswith("hilc: simulation: ") and outcome.err.endswith(" s\n")


def test_verbose_of_one_command_line_does_not_last(hilc: Hilc) -> None:
    assert "Traceback" in hilc("run", "nosuch.yaml", "-v").err
    assert "Traceback" not in hilc("run", "nosuch.yaml").err


def test_a_run_needs_no_compiler(tmp_path: Path) -> None:
    program = (
        "import sys\nfrom hilc_cli.cli.main import main\n"
        "try: main(['run', 'example:fig3-circle', '--set', 'iterations=0', '--no-plots', '-q'])\n"
        "except SystemExit as end: code = end.code\n"
        "print(code, sorted({'numba', 'scipy', 'matplotlib'} & set(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=tmp_path,
        env=environment(),
        capture_output=True,
        text=True,
    )
    assert (done.stdout, done.stderr) == ("0 []\n", "")


@pytest.mark.parametrize("words", ["--version -v", "-v --version", "run --version -qv"])
def test_version_of_all_that_takes_part(hilc: Hilc, words: str) -> None:
    outcome = hilc(*words.split())
    assert (outcome.code, outcome.err) == (0, "")
    lines = outcome.out.splitlines()
    assert lines[0] == f"hilc {__version__}"
    told = dict(re.split("  +", line, maxsplit=1) for line in lines[1:])
    assert told["Python"].startswith(platform.python_version())
    assert f"numpy {numpy.__version__}" in told["Packages"]
    assert re.search(r"\d cores?$", told["Processor"])
    assert "Machine code" in told
    project = tomllib.loads(PROJECT.read_text())["project"]
    known = {name for name in told if name.startswith("Extra ")}
    assert known <= {f"Extra {extra}" for extra in project["optional-dependencies"]}
    assert not {"Extra dev", "Extra docs"} & known
    assert "Extra tune" in known


def test_where_machine_code_is_kept(
    hilc: Hilc, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(folder / "codes"))
    assert "none yet" in hilc("--version", "-v").out
    (folder / "codes/loop_1").mkdir(parents=True)
    (folder / "codes/loop_1/loop.run-1.py311.nbi").write_bytes(b"x" * 200_000)
    assert f"1 file, 0.2 MB, in {folder}/codes" in hilc("--version", "-v").out


def test_commands_are_listed_by_what_they_are_for(hilc: Hilc) -> None:
    out = hilc("--help").out
    parts = re.split(r"\n\n([A-Z][a-z ]+):\n", out.partition("Options:")[2])
    panels = dict(zip(parts[1::2], parts[2::2], strict=True))
    assert list(panels) == list(PANELS)
    for name, commands in PANELS.items():
        named = re.findall(r"^  ([a-z]+) ", panels[name], re.MULTILINE)
        assert sorted(named) == sorted(commands)
    assert sorted(re.findall(r"^  ([a-z]+) ", "\n".join(panels.values()), re.M)) == sorted(COMMANDS)
