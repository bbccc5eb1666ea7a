"""The templates of pages and of their parts, all of which escape what is put into them."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jinja2 import Environment, Template


@cache
def own_file(name: str) -> str:
    """The text of a file of hilc's own."""
    return (files("hilc_cli.html_reports") / "page" / name).read_text(encoding="utf-8")


def template(name: str) -> Template:
    """A template of hilc's own."""
    return _environment().get_template(name)


@cache
def _environment() -> Environment:
    from jinja2 import Environment, FunctionLoader, StrictUndefined

    environment = Environment(
        loader=FunctionLoader(own_file),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.policies["json.dumps_kwargs"] = {"allow_nan": False, "separators": (",", ":")}
    return environment
