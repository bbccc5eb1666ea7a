"""Prints the lower bounds of `pyproject.toml` as constraints, to test what is promised.

python .ci/minimum_versions.py > minimum.txt
pip install -c minimum.txt -e ".[dev]"
python -m pytest -n auto -W ignore::DeprecationWarning
"""

import re
import tomllib
from pathlib import Path

TOOLS = "dev", "docs"  # what works on hilc, and not with it


def lower_bounds(pyproject: Path) -> list[str]:
    """Returns ``NAME==VERSION`` for each requirement of the package and of its extras.

    Raises:
        ValueError: A requirement has no lower bound, or more than that.
    """
    project = tomllib.loads(pyproject.read_text(encoding="utf-8"))["project"]
    wanted = list(project["dependencies"])
    for extra, requirements in project["optional-dependencies"].items():
        wanted += requirements if extra not in TOOLS else []
    bounds = []
    for requirement in wanted:
        found = re.fullmatch(r"([A-Za-z0-9_.-]+)>=([0-9.]+)", requirement)
        if found is None:
            raise ValueError(f"{pyproject}: {requirement}: must read NAME>=VERSION")
        bounds.append(f"{found[1]}=={found[2]}")
    return bounds


if __name__ == "__main__":
    print("\n".join(lower_bounds(Path(__file__).parent.parent / "pyproject.toml")))
