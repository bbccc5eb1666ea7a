"""Pages on the Python interface, made from the list of public names and their docstrings."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import hilc_cli as hilc
from website.rst import contents, heading, literal, page

FOLDER = "docs/reference/python"
TESTING = "hilc_cli.testing"
CONFORMANCE = "Conformance tests for laws and plants of other packages"
FIRST = ("runs", "scenario", "checks", "paths", "sweeps", "comparisons", "leaderboards", "labs")
"""Packages with which the list begins; the others follow by name."""


def groups() -> dict[str, list[str]]:
    """Returns the public names by the package or module that they come from, such as ``runs``."""
    found: dict[str, list[str]] = {}
    for name, home in hilc._HOMES.items():
        found.setdefault(home.split(".")[1], []).append(name)

    def place(group: str) -> tuple[int, str]:
        return (FIRST.index(group) if group in FIRST else len(FIRST), group)

    return {group: sorted(found[group], key=_place_of_name) for group in sorted(found, key=place)}


def _place_of_name(name: str) -> tuple[bool, str]:
    return (inspect.isclass(getattr(hilc, name)), name.lower())


def write_pages(folder: Path) -> str:
    """Writes a page for each group of names, and one that lists them, whose name is returned."""
    for group, members in groups().items():
        page(folder, f"{FOLDER}/{group}.rst", _page(group, members))
    page(folder, f"{FOLDER}/testing.rst", _testing())
    return page(folder, f"{FOLDER}.rst", _overview())


def _overview() -> Iterator[str]:
    yield from heading("Python, name by name", "=")
    yield (
        "All public names of ``import hilc_cli as hilc``, made from their docstrings; "
        ":doc:`/docs/python` shows how they are used.\n"
    )
    for group, members in groups().items():
        told = ", ".join(f":py:obj:`~hilc_cli.{name}`" for name in members)
        yield f"- :doc:`{literal(_title(group))} <python/{group}>`: {told}"
    yield f"- :doc:`{CONFORMANCE} <python/testing>`\n"
    yield from contents(f"python/{group}" for group in (*groups(), "testing"))


def _title(group: str) -> str:
    """Returns the first sentence of the docstring of a package, without its full stop."""
    told = inspect.getdoc(import_module(f"hilc_cli.{group}")) or group
    return told.splitlines()[0].rstrip(".")


def _page(group: str, members: list[str]) -> Iterator[str]:
    yield from heading(_title(group), "=")
    for name in members:
        value = getattr(hilc, name)
        if inspect.isclass(value):
            kind = "autoexception" if issubclass(value, BaseException) else "autoclass"
            yield f".. {kind}:: hilc_cli.{name}\n   :members:\n"
        else:
            yield f".. {'autofunction' if callable(value) else 'autodata'}:: hilc_cli.{name}\n"


def _testing() -> Iterator[str]:
    yield from heading(CONFORMANCE, "=")
    yield f".. automodule:: {TESTING}\n   :members:\n"
