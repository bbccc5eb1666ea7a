"""What is set for libraries, and what lies around, changes nothing of results and messages."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import matplotlib
import pytest

from hilc_cli.drawing import loading
from hilc_cli.surroundings import hidden, settle
from tests.cli.inputs import SCENARIO, TRAJECTORY
from tests.cli.processes import environment, run_hilc
from tests.conftest import Hilc, Outcome

WITH_MACHINE_CODE = """\
name: test
trajectory: path.yaml
robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: paper}
iterations: 1
controller: {law: norm-optimal, h: 1, b_w: 180}
"""
RUN = ("run", "scenario.yaml", "--format", "svg", "--format", "png", "-q")


def put(folder: Path, scenario: str) -> None:
    (folder / "scenario.yaml").write_text(scenario)
    (folder / "path.yaml").write_text(TRAJECTORY)


def results(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.suffix != ".json"}


def test_nothing_set_for_libraries_matters(hilc: Hilc, folder: Path) -> None:
    put(folder, WITH_MACHINE_CODE)
    assert hilc(*RUN, "--out", "plain") == Outcome(0, "", "")
    (folder / "settings").write_bytes(b"axes.facecolor: \xff\nno colon\n")
    for name in ("matplotlibrc", ".numba_config.yaml"):  # who reads them waits for ever
        os.mkfifo(folder / name)
    outcome = run_hilc(
        *RUN,
        *("--out", "odd"),
        cwd=folder,
        timeout=300,
        changes={
            "MPLBACKEND": "module://matplotlib_inline.backend_inline",
            "MATPLOTLIBRC": str(folder / "settings"),
            "MPLCONFIGDIR": str(folder / "scenario.yaml"),  # no folder
            "NUMBA_NUM_THREADS": "0",
            "NUMBA_CPU_NAME": "nosuch",
            "NUMBA_DEBUG_CACHE": "1",
            "NUMBA_OPT": "many",
            "NUMBA_CACHE_LOCATOR_CLASSES": "nosuch.module",
        },
    )
    assert outcome == Outcome(0, "", "")
    assert results(folder / "odd") == results(folder / "plain")
    assert len(results(folder / "odd")) > 8


def no_folder(place: Path) -> str:
    raise RuntimeError("Symlink loop")  # as Python 3.11 says


def folder_with_a_pipe(place: Path) -> str:
    os.mkfifo(place / "fontlist-v1.json")
    return str(place)


@pytest.mark.parametrize("own", [no_folder, folder_with_a_pipe])
def test_folder_of_matplotlib_that_is_of_no_use(
    folder: Path, monkeypatch: pytest.MonkeyPatch, own: Callable[[Path], str]
) -> None:
    monkeypatch.setenv("MPLCONFIGDIR", "own")
    monkeypatch.setattr("matplotlib.get_cachedir", lambda: own(folder))
    loading._settle_folder()
    place = Path(matplotlib.get_cachedir())
    assert place.is_dir() and not any(place.iterdir())
    assert os.environ["MPLCONFIGDIR"] == str(place)


def test_folder_of_matplotlib_that_is_of_use_stays(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "fontlist-v1.json").touch()
    monkeypatch.setattr("matplotlib.get_cachedir", lambda: str(folder))
    loading._settle_folder()
    assert matplotlib.get_cachedir() == str(folder)


NOTEBOOK = """\
import os
import hilc_cli as hilc
hilc.run(hilc.load_scenario("scenario.yaml")).write("notebook", formats=["png", "svg"])
import matplotlib
print(matplotlib.rcParams["lines.linewidth"], matplotlib.rcParams._get("backend"))
print(matplotlib.rcParams["axes.edgecolor"], matplotlib.rcParamsOrig["lines.linewidth"])
print(os.environ["MPLBACKEND"], os.environ["MATPLOTLIBRC"])
"""


def test_settings_of_a_notebook_stay(hilc: Hilc, folder: Path) -> None:
    put(folder, SCENARIO)
    assert hilc(*RUN, "--out", "plain") == Outcome(0, "", "")
    (folder / "settings").write_text("lines.linewidth: 7\nnosuch: 1\naxes.edgecolor: red\n")
    done = subprocess.run(
        [sys.executable, "-c", NOTEBOOK],
        env=environment({"MPLBACKEND": "module://a.notebook", "MATPLOTLIBRC": "settings"}),
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == "7.0 module://a.notebook\nred 7.0\nmodule://a.notebook settings\n"
    assert results(folder / "notebook") == results(folder / "plain")


def test_hidden_files_are_out_of_sight_for_a_while(folder: Path) -> None:
    (folder / "a").touch()
    (folder / "b").touch()
    with hidden("a", {"HILC_TEST": "1", "HOME": None}):
        assert not os.path.exists("a") and os.path.exists("b")  # noqa: PTH110  # as libraries ask
        assert os.environ["HILC_TEST"] == "1" and "HOME" not in os.environ
    assert os.path.exists("a")  # noqa: PTH110
    assert "HILC_TEST" not in os.environ and "HOME" in os.environ


def test_settings_of_numba_that_stay(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in os.environ if name.startswith("NUMBA_")]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "3")
    for value, stays in (("1", True), ("0", False), ("yes", False)):
        monkeypatch.setenv("NUMBA_CACHE_DIR", "somewhere")
        monkeypatch.setenv("NUMBA_DISABLE_JIT", value)
        monkeypatch.setenv("NUMBA_ANYTHING", "1")
        settle()
        found = {name: v for name, v in os.environ.items() if name.startswith("NUMBA_")}
        assert found == {
            "NUMBA_CACHE_DIR": "somewhere",
            **({"NUMBA_DISABLE_JIT": "1"} if stays else {}),
        }
    assert os.environ["OPENBLAS_NUM_THREADS"] == "3"


def test_objects_are_not_looked_through_as_the_program_ends() -> None:
    # What is registered first is called last.
    code = (
        "import atexit, gc\n"
        "atexit.register(lambda: print(len(gc.get_objects()) < 0.1 * gc.get_freeze_count()))\n"
        "from hilc_cli.surroundings import settle\n"
        "settle()"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "True\n"


def test_working_folder_that_is_gone_is_named(
    hilc: Hilc, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object, **__: object) -> None:
        os.getcwd()  # noqa: PTH109  # as a library does that is loaded

    monkeypatch.setattr("hilc_cli.sweeps.shards.merge_shards", fail)
    folder.rmdir()
    message = "hilc: the working folder: the system refused: No such file or directory\n"
    assert hilc("sweep", "--merge", "../x") == Outcome(1, "", message)
