"""A comparison as CSV for programs, and as Markdown and LaTeX for documents."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence

from hilc_cli.results.comparison import ComparisonTable, Value
from hilc_cli.results.comparison_layout import Cell, Grid, for_page, note_of
from hilc_cli.results.tables import text_cell

_MARKDOWN = str.maketrans({character: f"\\{character}" for character in "\\`*_<>|#~&$"})
_LATEX = str.maketrans(
    {
        **{character: f"\\{character}" for character in "{}$&#_%"},
        "\\": r"\textbackslash{}",
        "^": r"\textasciicircum{}",
        "~": r"\textasciitilde{}",
        "<": r"\textless{}",
        ">": r"\textgreater{}",
        "|": r"\textbar{}",
        "`": r"\textasciigrave{}",
    }
)


def csv_text(table: ComparisonTable) -> str:
    """The stored values under machine names; numbers read back exactly, no value is no text."""
    rows = [[text_cell(column.name) for column in table.columns]]
    rows += [[_stored(value) for value in row.values] for row in table.rows]
    return "".join(f"{','.join(cells)}\n" for cells in rows)


def markdown_text(table: ComparisonTable) -> str:
    """Tables of GitHub's Markdown, the best values in bold."""
    parts = [_markdown_grid(grid) for grid in for_page(table)]
    return "\n\n".join([*parts, note_of(table, "Bold")]) + "\n"


def latex_text(table: ComparisonTable) -> str:
    r"""A float with tables in the style of booktabs, the best values in bold.

    The document needs ``\usepackage{booktabs}``, and a font that has the letters of the names.
    """
    caption = _latex(f"{table.title}. {note_of(table, 'Bold')}")
    lines = [
        r"% Needs \usepackage{booktabs} in the preamble.",
        r"\begin{table}",
        r"  \centering",
        f"  \\caption{{{caption}}}",
        r"  \label{tab:comparison}",
        r"  \footnotesize",
        r"  \setlength{\tabcolsep}{4pt}",
    ]
    for number, grid in enumerate(for_page(table)):
        if number:
            lines += ["", r"  \medskip"]
        lines += [f"  {line}" for line in _latex_grid(grid)]
    return "\n".join([*lines, r"\end{table}"]) + "\n"


WRITERS: Mapping[str, Callable[[ComparisonTable], str]] = {
    "csv": csv_text,
    "markdown": markdown_text,
    "latex": latex_text,
}
"""What writes a kind of table."""

FILES: Mapping[str, str] = {
    "csv": "comparison.csv",
    "markdown": "comparison.md",
    "latex": "comparison.tex",
}
"""The file that holds it."""


def _stored(value: Value) -> str:
    if value is None:
        return ""
    return text_cell(value) if isinstance(value, str) else repr(value)


def _markdown_grid(grid: Grid) -> str:
    heads = [" ".join(filter(None, lines)) for lines in zip(*grid.heads, strict=True)]
    rules = ["---:" if right else "---" for right in grid.at_right]
    rows = [[_markdown_cell(cell) for cell in row] for row in grid.rows]
    lines = [[_markdown(head) for head in heads], rules, *rows]
    table = "\n".join(f"| {' | '.join(cells)} |" for cells in lines)
    return f"**{_markdown(grid.title)}**\n\n{table}" if grid.title else table


def _markdown_cell(cell: Cell) -> str:
    text = _markdown(cell.text)
    return f"**{text}**" if cell.is_best else text


def _markdown(text: str) -> str:
    return text.translate(_MARKDOWN).replace("](", r"]\(")


def _latex_grid(grid: Grid) -> list[str]:
    kinds = "".join("r" if right else "l" for right in grid.at_right)
    lines = [f"\\begin{{tabular}}{{{kinds}}}", r"  \toprule"]
    if grid.title:
        lines += [_latex_row([f"\\multicolumn{{{len(kinds)}}}{{l}}{{{_latex(grid.title)}}}"])]
        lines += [r"  \midrule"]
    lines += [_latex_row([_latex(head) for head in heads]) for heads in grid.heads]
    lines += [r"  \midrule"]
    lines += [_latex_row([_latex_cell(cell) for cell in row]) for row in grid.rows]
    return [*lines, r"  \bottomrule", r"\end{tabular}"]


def _latex_row(cells: Sequence[str]) -> str:
    row = " & ".join(cells).strip()
    # Behind the end of the row before, these would be arguments of it.
    guard = "{}" if row.startswith(("[", "*")) else ""
    return f"  {guard}{row} \\\\"


def _latex_cell(cell: Cell) -> str:
    mantissa, exponent, power = cell.text.partition("e")
    if cell.is_real and exponent:
        formula = f"{mantissa} \\times 10^{{{power}}}"
        return f"$\\mathbf{{{formula}}}$" if cell.is_best else f"${formula}$"
    text = _latex(cell.text)
    return f"\\textbf{{{text}}}" if cell.is_best else text


def _latex(text: str) -> str:
    # Two hyphens would become a dash.
    return re.sub("-(?=-)", "-{}", text.translate(_LATEX))
