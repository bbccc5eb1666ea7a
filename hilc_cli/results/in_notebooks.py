"""What makes a result show itself in a notebook: figures and a picture, drawn when it is shown."""

from __future__ import annotations

from importlib import import_module

_HOME = "hilc_cli.html_reports.in_notebooks"
"""What turns results into HTML. It knows all of them, so that none of them may know it: it is
loaded by its name, when a notebook asks for the first of them."""


class InNotebooks:
    """A result that notebooks show as HTML."""

    __slots__ = ()

    def _repr_html_(self) -> str:
        """The result as a part of a page, as Jupyter and its like ask for it."""
        text: str = import_module(_HOME).as_html(self)
        return text
