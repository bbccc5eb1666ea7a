"""What is published says the same everywhere; that the package builds is for `.ci/package`."""

from __future__ import annotations

import re
import runpy
import tomllib
from pathlib import Path
from typing import Any

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.version import Version

from hilc_cli import __version__

ROOT = Path(__file__).resolve().parent.parent
PYPROJECT: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT = PYPROJECT["project"]
BUILD = PYPROJECT["tool"]["hatch"]["build"]["targets"]
EXTRAS: dict[str, list[str]] = PROJECT["optional-dependencies"]
ALL = [*PROJECT["dependencies"], *(each for extra in EXTRAS.values() for each in extra)]


def text(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def test_changelog_and_citation_have_the_version_and_its_date() -> None:
    released = re.findall(
        r"^## \[(\d+\.\d+\.\d+)\] - (\d{4}-\d\d-\d\d)$", text("CHANGELOG.md"), re.M
    )
    citation = yaml.safe_load(text("CITATION.cff"))
    assert released[0] == (__version__, citation["date-released"])
    assert citation["version"] == __version__
    assert citation["license"] == PROJECT["license"]


def test_each_requirement_has_a_lower_bound_that_the_pinned_version_keeps() -> None:
    lines = (line.split("==") for line in text("constraints.txt").split())
    pinned = {name.lower().replace("_", "-"): Version(version) for name, version in lines}
    for requirement in map(Requirement, ALL):
        if requirement.name == "hilc-cli":
            assert requirement.extras <= set(EXTRAS)
            continue
        assert [bound.operator for bound in requirement.specifier] == [">="], requirement
        assert pinned[requirement.name.lower()] in requirement.specifier, requirement


def test_minimum_versions_are_those_that_are_promised(tmp_path: Path) -> None:
    script = runpy.run_path(str(ROOT / ".ci/minimum_versions.py"))
    bounds = script["lower_bounds"](ROOT / "pyproject.toml")
    assert len(bounds) == len(PROJECT["dependencies"]) + sum(
        len(requirements) for extra, requirements in EXTRAS.items() if extra not in ("dev", "docs")
    )
    for bound, requirement in zip(bounds, map(Requirement, ALL), strict=False):
        assert Requirement(bound).name == requirement.name
        assert str(requirement.specifier).removeprefix(">=") in bound
    unbounded = tmp_path / "pyproject.toml"
    unbounded.write_text('[project]\ndependencies = ["numpy"]\noptional-dependencies = {}\n')
    with pytest.raises(ValueError, match="numpy: must read NAME>=VERSION"):
        script["lower_bounds"](unbounded)


def test_examples_and_what_the_tests_need_are_packed() -> None:
    inside = BUILD["wheel"]["force-include"]
    assert set(inside) == {"trajectories", "scenarios", "programs"}
    assert all(place == f"hilc_cli/shipped/{name}" for name, place in inside.items())
    packed = BUILD["sdist"]["include"]
    for name in ("hilc_cli", "tests", "docs", "website", "benchmarks", ".ci", ".github", *inside):
        assert f"/{name}" in packed and (ROOT / name).is_dir()
    for name in ("CITATION.cff", "constraints.txt", "LICENSE", "README.md"):
        assert (ROOT / name).is_file()


def test_workflow_tries_the_pythons_that_are_named_and_no_step_that_is_not_here() -> None:
    workflow = yaml.safe_load(text(".github/workflows/checks.yml"))
    jobs = workflow["jobs"]
    named = {
        version
        for each in PROJECT["classifiers"]
        for version in re.findall(r"Python :: (3\.\d+)$", each)
    }
    tried = {
        step["with"]["python-version"]
        for job in jobs.values()
        for step in job["steps"]
        if "python-version" in step.get("with", {})
    }
    matrix = jobs["pythons"]["strategy"]["matrix"]["python"]
    assert {version for version in tried if "$" not in version} | set(matrix) == named
    assert f">={min(named, key=Version)}" == PROJECT["requires-python"]
    commands = [step["run"] for job in jobs.values() for step in job["steps"] if "run" in step]
    scripts = [
        word for line in commands for word in line.split() if re.match(r"(\.ci|website)/", word)
    ]
    assert sorted(set(scripts)) == [
        *(".ci/minimum_versions.py", ".ci/package", ".ci/run", "website/build.py")
    ]
    assert all((ROOT / script).is_file() for script in scripts)
