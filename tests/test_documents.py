"""Every example in the documents is run as it stands there, and every link leads somewhere."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest

import hilc_cli as hilc_api
from hilc_cli.scenario.trajectory import TrajectorySpec
from tests.cli.processes import environment
from tests.conftest import Hilc
from tests.pages import PAGES, ROOT, Block, Command, blocks, commands

# By test_law_pages, cli/test_plug_ins and test_clusters.
RUN_BY_THEIR_OWN_TESTS = ("docs/laws/", "docs/plug-ins.md", "docs/clusters.md")


def is_run_here(page: str) -> bool:
    return not page.startswith(RUN_BY_THEIR_OWN_TESTS) and any(
        block.language in ("sh", "python") for block in blocks(page)
    )


def run(command: Command, hilc: Hilc) -> tuple[int, str]:
    """Runs a command line in the working folder; exit code and what it said."""
    if command.arguments is not None:
        outcome = hilc(*command.arguments)
        if command.output:
            Path(command.output).write_text(outcome.out, encoding="utf-8")
        return outcome.code, outcome.err
    done = subprocess.run(
        ["bash", "-c", f"set -euo pipefail\n{command.line}"],
        env={**environment(), "PATH": f"{Path(sys.executable).parent}:/usr/bin:/bin"},
        capture_output=True,
        text=True,
        timeout=120,
    )
    return done.returncode, done.stderr


@pytest.mark.parametrize("page", [page for page in PAGES if is_run_here(page)])
def test_examples_of_the_page_run_one_after_the_other(
    hilc: Hilc, folder: Path, page: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Sweeps then start no processes of their own, each of which would import everything anew.
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {0}, raising=False)
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    names: dict[str, object] = {"__name__": "__main__"}  # of all Python blocks of the page
    for block in filter(lambda block: block.is_run, blocks(page)):
        keep(block)
        if block.language == "python" and not block.mark:  # one with a name is a program
            exec(compile(block.text, page, "exec"), names)
        for command in commands(block) if block.language == "sh" else ():
            code, said = run(command, hilc)
            assert code == command.code, f"{command.line}\n{said}"


def keep(block: Block) -> None:
    """Writes a block whose mark says ``file: NAME`` to that file."""
    kind, _, name = block.mark.partition(": ")
    if kind == "file":
        Path(name).parent.mkdir(parents=True, exist_ok=True)
        Path(name).write_text(block.text, encoding="utf-8")


@pytest.mark.parametrize("page", PAGES)
def test_no_command_hides_in_a_block_that_is_not_run(page: str) -> None:
    for block in blocks(page):
        if block.language not in ("sh", "python") and not block.mark:
            assert not re.search(r"^(hilc|pip|python3?|make) ", block.text, re.MULTILINE), block
        if block.mark and not block.is_run and block.mark.startswith("not run: "):
            assert len(block.mark.split()) > 4, "say why"


def test_no_block_is_forgotten() -> None:
    known = ("not run: ", "ci: ", "file: ", "same as: ")
    for page in PAGES:
        for block in blocks(page):
            if block.mark:
                assert block.mark.startswith(known), (page, block)
            elif page.startswith("docs/laws/"):
                assert block.language in ("sh", "yaml"), (page, block)  # test_law_pages takes these
            else:  # what runs them is named above; test_each_yaml_example_is_known_to_a_test
                assert block.language in ("sh", "python", "yaml"), (page, block)
        # Blocks within lists or with other fences would not be seen by tests/pages.py.
        text = (ROOT / page).read_text(encoding="utf-8")
        fences = re.findall(r"^[ >]*(?:```|~~~).*$", text, re.MULTILINE)
        assert len(fences) == 2 * len(blocks(page)), page


def test_the_readme_is_short_and_tells_of_the_claims_before_they_surprise() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 120
    claims = (ROOT / "docs/paper.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| [TF]\d\S* \| (.*) \| (.*) \| .* \|$", claims, re.MULTILINE)
    literal, derivative = (
        [verdicts.count(verdict) for verdict in ("holds", "holds in part", "does not hold")]
        for verdicts in zip(*rows, strict=True)
    )
    told = " ".join(text.split())
    hold, in_part, fail = literal
    counted = f"{hold} hold, {in_part} hold in part, and {fail} do not"
    assert f"paper's {len(rows)} claims **{counted}**" in told
    hold, in_part, fail = derivative
    assert f"derivative in the law {hold} hold, {in_part} in part, and {fail} does not" in told
    assert text.index("claims **6") < text.index("**not reached**") < text.index("hilc run ")


def test_the_picture_of_the_readme_shows_what_its_caption_says() -> None:
    spec = importlib.util.spec_from_file_location("two_laws", ROOT / "docs/images/two_laws.py")
    assert spec is not None and spec.loader is not None
    picture = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(picture)
    done = {"paper": picture.run("paper"), "norm-optimal": picture.run("norm-optimal", 4)}
    assert done["paper"].metrics[picture.ERROR][100] == pytest.approx(3, abs=0.1)
    assert max(done["norm-optimal"].metrics[picture.ERROR][2:]) < 0.03e-3
    for law in done.values():
        assert max(law.metrics["max_wheel_speed_rad_s"]) <= 180
    paths, errors = picture.draw(done).axes
    assert paths.get_aspect() == 1
    assert errors.get_yscale() == "log"
    assert len(paths.lines) == 4


def yaml_block(page: str, mark: str) -> str:
    (block,) = (block for block in blocks(page) if block.mark == mark)
    return block.text


def test_each_yaml_example_is_known_to_a_test() -> None:
    # Of laws and the leaderboard tests/test_law_pages.py reads them, of a search the test below.
    elsewhere = ("docs/laws/", "docs/laws.md", "docs/plug-ins.md")
    unmarked = [
        (page, block.text)
        for page in PAGES
        for block in blocks(page)
        if block.language == "yaml" and not block.mark and not page.startswith(elsewhere)
    ]
    assert [page for page, _ in unmarked] == ["docs/sweeps.md"]
    assert "minimise" in unmarked[0][1]


@pytest.mark.parametrize("page", PAGES)
def test_shipped_files_on_the_page_are_those_that_are_shipped(page: str) -> None:
    for block in blocks(page):
        kind, _, name = block.mark.partition(": ")
        if kind == "same as":
            shipped = (ROOT / name).read_text(encoding="utf-8")
            assert block.text == shipped[shipped.index("name:") :]


def test_the_scenario_of_the_reference_is_valid(folder: Path) -> None:
    Path("scenario.yaml").write_text(yaml_block("docs/scenario.md", "file: scenario.yaml"))
    Path("trajectory.yaml").write_text(yaml_block("docs/trajectory.md", "file: trajectory.yaml"))
    loaded = hilc_api.load_scenario("scenario.yaml")
    assert loaded.name == "my-experiment"
    assert loaded.compensates  # it starts at x = 9
    path = {"trajectory": "trajectory.yaml", "initial_pose": None}
    other = hilc_api.load_scenario("scenario.yaml", overrides=path)
    assert isinstance(other.spec.trajectory, TrajectorySpec)
    assert other.spec.trajectory.reference().samples == 3000


def test_the_sweep_of_the_reference_is_valid(folder: Path) -> None:
    Path("sweep.yaml").write_text(yaml_block("docs/sweeps.md", "file: sweep.yaml"))
    assert len(hilc_api.plan_sweep(hilc_api.load_scenario("sweep.yaml")).cases) == 33


def test_the_search_in_the_scenario_is_that_of_the_command(folder: Path) -> None:
    (section,) = (
        block.text for block in blocks("docs/sweeps.md") if block.text.startswith("sweep:")
    )
    (words,) = (
        command.arguments
        for block in blocks("docs/sweeps.md")
        if block.language == "sh"
        for command in commands(block)
        if "--minimise" in command.line
    )
    assert words is not None
    options = dict(pairwise(words))
    scenario = hilc_api.load_scenario(words[1])
    plan = hilc_api.plan_sweep(
        scenario,
        [value for option, value in pairwise(words) if option == "--vary"],
        minimise=options["--minimise"],
        cases=int(options["--cases"]),
        seed=int(options["--seed"]),
    )
    Path("scenario.yaml").write_text(scenario.resolved_yaml() + section, encoding="utf-8")
    same = hilc_api.plan_sweep(hilc_api.load_scenario("scenario.yaml"))
    assert (plan.axes, plan.spec) == (same.axes, same.spec)


def test_the_error_messages_shown_are_the_ones_given(hilc: Hilc, folder: Path) -> None:
    (shown,) = (block.text for block in blocks("README.md") if block.text.startswith("my.yaml:"))
    lines = [
        "name: mine",
        "trajectory: example:circle",
        "",
        "",
        "robot:",
        "  wheel_radius: -1",
        "  half_track: 0.5",
        "  turn_convention: paper",
        "controller: {gain: 3, gains: {l1: 1}}",
    ]
    Path("my.yaml").write_text("\n".join(lines), encoding="utf-8")
    outcome = hilc("run", "my.yaml")
    assert (outcome.code, outcome.err) == (2, shown)


@pytest.mark.parametrize("document", [*PAGES, "ARCHITECTURE.md", "CHANGELOG.md"])
def test_links_between_documents_lead_somewhere(document: str) -> None:
    for link in links(document):
        target, _, anchor = link.partition("#")
        page = (ROOT / document).parent / target if target else ROOT / document
        assert page.exists(), link
        assert not anchor or anchor in anchors(page), link


def links(document: str) -> list[str]:
    """The targets of the links of a page that lead to files here; formulas have none."""
    text = (ROOT / document).read_text(encoding="utf-8")
    text = "\n".join(line for line in text.splitlines() if not line.startswith("    "))
    return [link for link in re.findall(r"\]\(([^)\s]+)\)", text) if "://" not in link]


def anchors(page: Path) -> set[str]:
    """What the headings of a page are called in links."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}
