"""The page of each law: its parameters are all there and valid, and its commands run."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

import hilc_cli as hilc_api
from hilc_cli.laws.registry import controllers
from hilc_cli.leaderboards.contests import compete
from hilc_cli.leaderboards.entries import LeaderboardData
from hilc_cli.leaderboards.tables import entries_table
from hilc_cli.yaml_input.nodes import Source, to_data
from hilc_cli.yaml_input.tree import parse_yaml
from tests.conftest import Hilc, Outcome

PAGES = Path(__file__).resolve().parent.parent / "docs" / "laws"


def blocks(law: str, language: str) -> list[str]:
    text = (PAGES / f"{law}.md").read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


def read_yaml(text: str) -> object:
    return to_data(parse_yaml(text.encode(), Source("text", Path())))


def test_each_law_has_a_page() -> None:
    assert {path.stem for path in PAGES.glob("*.md")} >= set(controllers())


@pytest.mark.parametrize("law", controllers())
def test_parameters_of_the_page_are_all_there_and_valid(law: str) -> None:
    (text,) = blocks(law, "yaml")
    controller = read_yaml(text)
    assert isinstance(controller, dict)
    model = controllers()[law]
    assert set(controller) == set(model.model_fields)
    scenario = hilc_api.load_scenario("example:fig3-circle", {"controller": controller})
    assert type(scenario.spec.controller) is model
    for key, value in controller.items():
        if isinstance(value, dict):
            part = getattr(scenario.spec.controller, key)
            assert set(value) == set(type(part).model_fields)


@pytest.mark.parametrize("law", controllers())
def test_commands_of_the_page_run(hilc: Hilc, folder: Path, law: str) -> None:
    (script,) = ["".join(blocks(law, "sh"))]
    for line in script.splitlines():
        program, *arguments = shlex.split(line)
        assert program == "hilc"
        # What a page says will be reached must be reached.
        quick = () if "--require" in arguments else ("--set", "iterations=1")
        assert hilc(*arguments, *quick, "--no-plots", "--force", "-q") == Outcome(0, "", "")


def test_leaderboard_of_the_overview_is_whole_and_runs(folder: Path) -> None:
    text = (PAGES.parent / "laws.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"^```yaml\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    Path("mine.yaml").write_text(block)
    leaderboard = hilc_api.load_leaderboard("mine.yaml")
    assert leaderboard.spec.model_fields_set == set(type(leaderboard.spec).model_fields)
    assert leaderboard.size == 24
    assert leaderboard.cases["late"].spec.robot.imperfections() == {"motor.delay": 0.05}
    # The best law with noise, on the circle.
    contest = [each for each in leaderboard.contests() if each.case == "circle-off"][-1]
    entry = compete(contest, [1, 2], 0.01)
    assert entry.keeps_limit
    assert entry.max_m[1] < 0.1


def test_controllers_of_the_overview_are_those_of_the_leaderboard() -> None:
    text = (PAGES.parent / "laws.md").read_text(encoding="utf-8")
    told = {
        name: read_yaml(f"{{{parameters}}}")
        for name, parameters in re.findall(r"^\| ([\w-]+) \| `(law: .*?)` \|", text, re.MULTILINE)
    }
    shipped = read_yaml((PAGES.parent.parent / "scenarios/leaderboard.yaml").read_text())
    assert isinstance(shipped, dict)
    assert told == shipped["laws"]


def test_columns_of_the_overview_are_those_of_the_table() -> None:
    text = (PAGES.parent / "laws.md").read_text(encoding="utf-8")
    _, table = text.split("| column | meaning |\n|---|---|\n")
    told = [name for row in table.splitlines() for name in re.findall("`(.*?)`", row.split("|")[1])]
    columns = entries_table(LeaderboardData("any", (7,), 0.01, ())).columns
    assert told == [column.name.replace("after_7", "after_N") for column in columns]


@pytest.mark.parametrize("page", sorted(PAGES.glob("*.md")), ids=lambda path: path.name)
def test_links_of_the_page_lead_somewhere(page: Path) -> None:
    text = "\n".join(
        line
        for line in page.read_text(encoding="utf-8").splitlines()
        if not line.startswith("    ")
    )
    for target in re.findall(r"\]\(([^)#]+)\)", text):
        if not target.startswith("https://"):
            assert (page.parent / target).exists(), target
