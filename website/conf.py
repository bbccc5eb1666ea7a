"""How Sphinx makes the site. `website/build.py` calls it, with pages staged in a folder."""

from __future__ import annotations

from typing import Any

from pygments.lexers.special import TextLexer

import hilc_cli as hilc

project = "hilc"
author = "The hilc developers"
version = release = hilc.__version__
copyright = author  # as Sphinx calls it

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
root_doc = "index"
exclude_patterns = ["scenarios", "trajectories", "programs"]
nitpicky = True
smartquotes_action = "D"  # dashes only: quotes stay as they are typed
default_role = "code"  # docstrings have names in single backticks

# Pages are plain Markdown: what only MyST knows is text there, and so is HTML.
myst_disable_syntax = [
    *("html_block", "html_inline", "myst_role", "myst_target", "myst_line_comment"),
    *("myst_block_break", "substitution_block", "substitution_inline"),
]
myst_heading_anchors = 6
suppress_warnings = ["myst.header"]

autodoc_preserve_defaults = True
autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_typehints_format = "short"
autodoc_typehints_description_target = "documented_params"
autodoc_class_signature = "mixed"
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 88
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True
napoleon_custom_sections = ["Source"]
nitpick_ignore_regex = [("py:.*", r"(?!hilc_cli\.).*")]  # of other packages, which are elsewhere

html_theme = "furo"
html_title = f"hilc {release}"
html_show_search_summary = False  # it would have to fetch pages, which browsers refuse for files
html_copy_source = False
html_show_sphinx = False
html_theme_options = {"navigation_with_keys": True}
linkcheck_ignore = [".*"]


def _public(app: Any, env: Any, node: Any, content: Any) -> Any:
    """Leads a name of the package from where it is written to where it is documented."""
    target = node.get("reftarget", "")
    if node.get("refdomain") != "py" or not target.startswith("hilc_cli."):
        return None
    home, _, name = target.rpartition(".")
    if hilc._HOMES.get(name) == home:
        python = env.get_domain("py")
        return python.resolve_xref(
            env, node["refdoc"], app.builder, "obj", f"hilc_cli.{name}", node, content
        )
    return content  # of the inside: told, but not documented here


def setup(app: Any) -> None:
    """Is called by Sphinx."""
    app.add_lexer("csv", TextLexer)
    app.connect("missing-reference", _public)
