"""Pages that are made from the program: none of its commands, names and pictures is missing."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

import hilc_cli as hilc_api
from hilc_cli.cli.app import PANELS
from hilc_cli.leaderboards.folder import LEADERBOARD_FOLDER
from hilc_cli.results.picture_kinds import MOVING_PICTURES, RUN_PICTURES, SWEEP_PICTURES
from hilc_cli.runs.run_folder import RUN_FOLDER
from hilc_cli.sweeps.sweep_folder import SWEEP_FOLDER
from tests.conftest import Hilc
from website import commands, gallery, interface
from website.rst import literal, prose


def written(folder: Path, name: str) -> str:
    return (folder / name).read_text(encoding="utf-8")


def test_each_command_has_a_page_with_its_options(hilc: Hilc, tmp_path: Path) -> None:
    index = written(tmp_path, commands.write_pages(tmp_path))
    named = [name for panel in commands.by_panel().values() for name in panel]
    assert len(named) == sum(map(len, PANELS.values()))
    assert re.findall(r":doc:`hilc (\w+) <commands/\1>`", index) == named
    for name in named:
        page = written(tmp_path, f"{commands.FOLDER}/{name}.rst")
        parts = re.findall(rf"^hilc {name} (\w+)$", page, re.MULTILINE)
        for words in [[name], *([name, part] for part in parts)]:
            told = hilc(*words, "--help").out
            spelled = set(re.findall(r"^  (?:-\w, )?(--[\w-]+)", told, re.MULTILINE))
            after = page.partition(f".. program:: hilc {' '.join(words)}\n")[2]
            section = after.partition(".. program::")[0]
            given = set(re.findall(r"(?<!\S)--[\w-]+", "".join(options_of(section))))
            assert spelled <= given, words
    assert "hilc learn start" in written(tmp_path, f"{commands.FOLDER}/learn.rst")


def options_of(section: str) -> list[str]:
    return [
        f" {line}\n".replace(",", " ") for line in re.findall(r"^.. option:: (.*)$", section, re.M)
    ]


def test_no_text_of_a_help_is_markup() -> None:
    assert literal("a*b `c` |d| <e> f_ :g:") == r"a\*b \`c\` \|d\| \<e\> f\_ \:g\:"
    assert (
        prose("with -q or (--set), not a-b -- c_") == "with ``-q`` or (``--set``), not a-b -- c\\_"
    )


def test_each_public_name_has_its_place(tmp_path: Path) -> None:
    index = written(tmp_path, interface.write_pages(tmp_path))
    pages = re.findall(r"^   (python/\w+)$", index, re.MULTILINE)
    text = "".join(written(tmp_path, f"docs/reference/{page}.rst") for page in pages)
    shown = re.findall(
        r"^\.\. auto(?:function|class|exception|data):: hilc_cli\.(\w+)$", text, re.M
    )
    assert sorted(shown) == dir(hilc_api)
    assert ".. automodule:: hilc_cli.testing" in text
    assert pages[0] == "python/runs"


def test_the_gallery_forgets_no_kind_of_picture() -> None:
    drawn = {kind for step in gallery.STEPS for kind in step.kinds}
    for folder in (RUN_FOLDER, SWEEP_FOLDER, LEADERBOARD_FOLDER):
        assert drawn >= {*folder.pictures, *folder.moving}
    for kinds in (RUN_PICTURES, MOVING_PICTURES, SWEEP_PICTURES):
        for name, kind in kinds.items():
            assert gallery.WORDS[name] == kind.shows
    assert gallery.forgotten() == set()


def test_a_new_kind_of_picture_stops_the_site(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(gallery.WORDS, "new", "something new")
    with pytest.raises(ValueError, match=r"no command draws \['new'\]"):
        gallery.write_page(tmp_path, draw=False)


def test_commands_of_the_gallery_are_understood(hilc: Hilc, tmp_path: Path) -> None:
    text = written(tmp_path, gallery.write_page(tmp_path, draw=False))
    for step in gallery.STEPS:
        program, command, *_ = shlex.split(step.command)
        assert program == "hilc"
        assert hilc(command, "--help").code == 0
        if step.kinds:
            assert f"   {step.command}\n" in text
        if step.kept:
            assert f".. image:: /docs/images/{step.kept}\n" in text


def test_command_of_the_gallery_that_fails_stops_the_site(tmp_path: Path) -> None:
    step = gallery.Step("hilc show example:nothing", "runs", ("path",))
    with pytest.raises(RuntimeError, match=r"hilc show example:nothing: exit code 2: hilc: "):
        gallery._make(step, tmp_path, tmp_path, draw=True)
