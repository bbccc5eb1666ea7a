"""Plug-ins are found where packages are installed, and nowhere else."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from hilc_cli import plug_ins
from hilc_cli.plug_ins import PlugInError, find, import_path, installed, trusting


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder of installed packages with one of them, ``toys`` 1.2, and nothing found before."""
    folder = tmp_path / "site"
    info = folder / "toys-1.2.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: toys\nVersion: 1.2\n")
    (info / "top_level.txt").write_text("toy_robots\n")
    (info / "entry_points.txt").write_text(
        "[hilc.laws]\ntoy = toy_robots:Toy\nbroken = toy_broken:Toy\nnumber = toy_robots:NUMBER\n"
        "[hilc.plants]\ntoy = toy_robots:Plant\n"
    )
    (folder / "toy_robots.py").write_text(
        "NUMBER = 1\nclass Toy: pass\nclass Plant: pass\nprint('imported')\n"
    )
    (folder / "toy_broken.py").write_text("raise OSError('first line\\nsecond line')\n")
    (folder / "toy_leaves.py").write_text("import sys\nsys.exit(7)\n")
    monkeypatch.syspath_prepend(folder)
    before = set(sys.modules)
    monkeypatch.setattr(plug_ins, "_FOUND", {})
    yield folder
    for name in set(sys.modules) - before:
        del sys.modules[name]


def problem_of(name: str, *, trust: bool = False) -> str:
    with pytest.raises(PlugInError) as error:
        find("law", name, trust=trust, own=("pid", "hybrid"))
    assert "\n" not in str(error.value)
    assert error.value.exit_code == 2
    return str(error.value)


def test_entry_point_needs_no_trust_and_tells_its_package(
    site: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    found = find("law", "toy", trust=False)
    assert (found.cls.__name__, found.distribution, found.version) == ("Toy", "toys", "1.2")
    assert find("plant", "toy", trust=False).cls.__name__ == "Plant"
    assert capsys.readouterr().out == "", "standard output is hilc's own"


def test_nothing_is_imported_that_is_not_named(site: Path) -> None:
    assert installed("law") == ["broken", "number", "toy"]
    assert "toy_robots" not in sys.modules


def test_reference_needs_trust(site: Path) -> None:
    assert "--trust" in problem_of("toy_robots:Toy")
    assert "toy_robots" not in sys.modules
    found = find("law", "toy_robots:Toy", trust=True)
    assert (found.cls.__name__, found.distribution, found.version) == ("Toy", "toys", "1.2")
    assert find("law", "toy_robots:Toy", trust=False) == found, "it has been imported by now"


def test_trust_is_given_for_what_is_inside(site: Path) -> None:
    with trusting(True), trusting(False):
        assert "--trust" in problem_of("toy_robots:Toy", trust=False)
        with pytest.raises(PlugInError, match="--trust"):
            find("law", "toy_robots:Toy")
    with trusting(True):
        assert find("law", "toy_robots:Toy").cls.__name__ == "Toy"


def test_unknown_name_is_told_with_the_near_one_or_those_that_are_known(site: Path) -> None:
    assert problem_of("toyy").endswith("is not one of the choices; did you mean 'toy'?")
    assert problem_of("nothing").endswith(
        "is not one of the choices; give pid, hybrid, broken, number or toy"
    )


@pytest.mark.parametrize(
    ("name", "what"),
    [
        ("broken", "cannot be imported: OSError: first line; "),
        ("toy_leaves:Law", "cannot be imported: SystemExit: 7; "),
        ("nowhere.at_all:Law", "cannot be imported: ModuleNotFoundError: No module named"),
        ("toy_robots:Other", "cannot be imported: AttributeError: "),
        ("number", "is no class"),
        ("toy robots:Toy", "is no name of a law"),
        ("toy_robots:Toy\x1b", "is no name of a law"),
        ("toy_robots:Toy.__init__.__globals__", "is no name of a law"),
        (f"{'a' * 300}:B", "is no name of a law"),
    ],
)
def test_what_fails_is_one_line(site: Path, name: str, what: str) -> None:
    assert what in problem_of(name, trust=True)


def test_working_folder_is_not_searched(
    site: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = tmp_path / "here"
    here.mkdir()
    (here / "of_this_folder.py").write_text("class Law: pass\n")
    info = here / "foreign-1.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: foreign\nVersion: 1\n")
    (info / "entry_points.txt").write_text("[hilc.laws]\nforeign = of_this_folder:Law\n")
    monkeypatch.chdir(here)
    monkeypatch.setattr(sys, "path", ["", str(here), *sys.path])
    assert "foreign" not in installed("law")
    assert "No module named 'of_this_folder'" in problem_of("of_this_folder:Law", trust=True)
    assert sys.path[:2] == ["", str(here)], "as it was"
    assert "of_this_folder" not in sys.modules


def test_working_folder_that_is_installed_is_searched(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [str(tmp_path), *sys.path, str(tmp_path)])
    assert import_path().count(str(tmp_path)) == 1
