"""A comparison on a terminal, as CSV for programs, and as Markdown and LaTeX for documents."""

from __future__ import annotations

import shutil
import sys
import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from hilc_cli.comparisons.latex import latex_escaped, latex_settings, latex_title
from hilc_cli.comparisons.table import Column, ComparisonTable
from hilc_cli.reporting.terminal import is_decorated, print_table, print_text
from hilc_cli.results.tables import text_cell
from hilc_cli.wording import printable

if TYPE_CHECKING:
    from rich.console import Group

MOST_SIDE_BY_SIDE = 4
"""The most rows of a table that stand side by side on a page; more stand below each other."""
_WIDTH = 100  # [characters], where there is no terminal to ask
_LONGEST_NAME = 12  # [characters], that a narrow terminal does not break
_BEST = "*"  # bold is not seen in a log


@dataclass(frozen=True, slots=True)
class Cell:
    """What stands in one place.

    Attributes:
        text: On one line.
        is_best: Whether it is to be marked.
        is_real: Whether it is a number that need not be whole.
        is_setting: Whether it is a list of symbols with their values, such as ``l1=0.5 l2=0``.
        is_title: Whether it is the title of a column, with its unit in brackets.
    """

    text: str
    is_best: bool = False
    is_real: bool = False
    is_setting: bool = False
    is_title: bool = False


@dataclass(frozen=True, slots=True)
class Grid:
    """A table as it is printed.

    Attributes:
        title: What it shows; empty for everything.
        heads: What stands above the columns, line by line.
        at_right: Whether each column holds numbers, which stand at the right.
        rows: The cells, row by row.
        names: So many columns at the left say what a row is of.
    """

    title: str
    heads: tuple[tuple[str, ...], ...]
    at_right: tuple[bool, ...]
    rows: tuple[tuple[Cell, ...], ...]
    names: int = 1

    def part(self, first: int, last: int) -> Grid:
        """The columns from one to before another, with those that name the rows."""
        places = [*range(self.names), *range(max(first, self.names), last)]
        return replace(
            self,
            heads=tuple(tuple(line[place] for place in places) for line in self.heads),
            at_right=tuple(self.at_right[place] for place in places),
            rows=tuple(tuple(row[place] for place in places) for row in self.rows),
        )


def for_page(table: ComparisonTable) -> list[Grid]:
    """The grids for a document: one if there are few rows, or one for each section."""
    if len(table.rows) <= MOST_SIDE_BY_SIDE:
        return [side_by_side(table)]
    return below_each_other(table)


def side_by_side(table: ComparisonTable) -> Grid:
    """One grid with a column for each row of the table, headed by what names it first."""
    head, *others = table.printed()
    cells = _cells(table)
    columns = [table.columns[place] for place in others]
    return Grid(
        title="",
        heads=(("", *(row[head].text for row in cells)),),
        at_right=(False, *(True for _ in cells)),
        rows=tuple(
            (
                Cell(
                    f"{column.title} [{column.unit}]" if column.unit else column.title,
                    is_title=True,
                ),
                *(row[place] for row in cells),
            )
            for place, column in zip(others, columns, strict=True)
        ),
    )


def below_each_other(table: ComparisonTable) -> list[Grid]:
    """A grid for each section; what names a row stands in each of them."""
    cells = _cells(table)
    sections = dict.fromkeys(table.columns[place].section for place in table.printed())
    return [_section(table, cells, section) for section in sections if section]


def in_parts(grid: Grid, fits: Callable[[Grid], bool]) -> list[Grid]:
    """The fewest parts of about as many columns that fit; a column each where nothing else does."""
    others = len(grid.at_right) - grid.names
    for count in range(1, others + 1):
        size = -(-others // count)
        starts = range(grid.names, grid.names + others, size)
        parts = [grid.part(start, min(start + size, grid.names + others)) for start in starts]
        if count == others or all(map(fits, parts)):
            return parts
    return [grid]


def note_of(table: ComparisonTable, mark: str) -> str:
    """What a reader must know.

    Args:
        table: The table.
        mark: What the best values are marked with, such as ``Bold``.
    """
    marked = any(table.best(place) for place in range(len(table.columns)))
    parts = [table.note, f"{mark}: {table.mark_note}." if marked else ""]
    return " ".join(part for part in parts if part)


def _section(table: ComparisonTable, cells: list[list[Cell]], section: str) -> Grid:
    places = [place for place in table.printed() if table.columns[place].section in ("", section)]
    columns = [table.columns[place] for place in places]
    units = [column.unit for column in columns if column.section]
    shared = units[0] if len(units) > 1 and len(set(units)) == 1 else ""
    heads = [_head(column, with_unit=not shared) for column in columns]
    return Grid(
        title=f"{section} [{shared}]" if shared else section,
        heads=tuple(filter(any, zip(*heads, strict=True))),
        at_right=tuple(
            not any(isinstance(row.values[place], str) for row in table.rows) for place in places
        ),
        rows=tuple(tuple(row[place] for place in places) for row in cells),
        names=sum(not column.section for column in columns),
    )


def _cells(table: ComparisonTable) -> list[list[Cell]]:
    best = [table.best(place) for place in range(len(table.columns))]
    return [
        [
            Cell(
                printable(column.text(value)),
                number in best[place],
                isinstance(value, float),
                column.is_setting,
            )
            for place, (column, value) in enumerate(zip(table.columns, row.values, strict=True))
        ]
        for number, row in enumerate(table.rows)
    ]


def _head(column: Column, *, with_unit: bool) -> tuple[str, ...]:
    """Three short lines, as numbers are narrower than words; the last is for the unit, if asked."""
    words = column.heading.split(" ", 1 if with_unit else 2)
    if with_unit:
        words.append(f"[{column.unit}]" if column.unit else "")
    return ("",) * (3 - len(words)) + tuple(words)


_MARKDOWN = str.maketrans({character: f"\\{character}" for character in "\\`*_<>|#~&$"})


def csv_text(table: ComparisonTable) -> str:
    """The stored values under machine names; numbers read back exactly, no value is no text."""
    rows = [[text_cell(column.name) for column in table.columns]]
    rows += [
        [text_cell(v) if isinstance(v, str) else "" if v is None else repr(v) for v in row.values]
        for row in table.rows
    ]
    return "".join(f"{','.join(cells)}\n" for cells in rows)


def markdown_text(table: ComparisonTable) -> str:
    """Tables of GitHub's Markdown, the best values in bold."""
    parts = [_markdown_grid(grid) for grid in for_page(table)]
    return "\n\n".join([*parts, note_of(table, "Bold")]) + "\n"


def latex_text(table: ComparisonTable, label: str = "comparison") -> str:
    r"""A float with tables in the style of booktabs, the best values in bold.

    The document needs ``\usepackage{booktabs}``, and a font that has the letters of the names.

    Args:
        table: The table.
        label: By which the document refers to it, behind ``tab:``; of letters, digits, . _ and -.
    """
    caption = latex_escaped(f"{table.title}. {note_of(table, 'Bold')}")
    lines = [
        r"% Needs \usepackage{booktabs} in the preamble.",
        r"\begin{table}",
        r"  \centering",
        f"  \\caption{{{caption}}}",
        f"  \\label{{tab:{label}}}",
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


def _markdown_grid(grid: Grid) -> str:
    heads = [" ".join(filter(None, lines)) for lines in zip(*grid.heads, strict=True)]
    rules = ["---:" if right else "---" for right in grid.at_right]
    texts = [[(_markdown(cell.text), cell.is_best) for cell in row] for row in grid.rows]
    rows = [[f"**{text}**" if best else text for text, best in row] for row in texts]
    lines = [[_markdown(head) for head in heads], rules, *rows]
    table = "\n".join(f"| {' | '.join(cells)} |" for cells in lines)
    return f"**{_markdown(grid.title)}**\n\n{table}" if grid.title else table


def _markdown(text: str) -> str:
    return text.translate(_MARKDOWN).replace("](", r"]\(")


def _latex_grid(grid: Grid) -> list[str]:
    kinds = "".join("r" if right else "l" for right in grid.at_right)
    lines = [f"\\begin{{tabular}}{{{kinds}}}", r"  \toprule"]
    if grid.title:
        lines += [_latex_row([f"\\multicolumn{{{len(kinds)}}}{{l}}{{{latex_title(grid.title)}}}"])]
        lines += [r"  \midrule"]
    # On one line there are names, which may look like anything; units have a line of their own.
    set_head = latex_escaped if len(grid.heads) == 1 else latex_title
    lines += [_latex_row([set_head(head) for head in heads]) for heads in grid.heads]
    lines += [r"  \midrule"]
    lines += [_latex_row([_latex_cell(cell) for cell in row]) for row in grid.rows]
    return [*lines, r"  \bottomrule", r"\end{tabular}"]


def _latex_row(cells: Sequence[str]) -> str:
    row = " & ".join(cells).strip()
    # Behind the end of the row before, these would be arguments of it.
    guard = "{}" if row.startswith(("[", "*")) else ""
    return f"  {guard}{row} \\\\"


def _latex_cell(cell: Cell) -> str:
    if cell.is_title:
        return latex_title(cell.text)
    if cell.is_setting:
        return latex_settings(cell.text)
    mantissa, exponent, power = cell.text.partition("e")
    if cell.is_real and exponent:
        formula = f"{mantissa} \\times 10^{{{power}}}"
        return f"$\\mathbf{{{formula}}}$" if cell.is_best else f"${formula}$"
    text = latex_escaped(cell.text)
    return f"\\textbf{{{text}}}" if cell.is_best else text


def print_comparison(table: ComparisonTable) -> None:
    """Prints a table with a column for each row, or below each other what would be too wide."""
    decorated = is_decorated(sys.stdout)
    width = shutil.get_terminal_size().columns if decorated else _WIDTH

    def fits(grid: Grid) -> bool:
        # In a log lines may be long, so that each row is whole.
        return not decorated or _width(grid, _LONGEST_NAME) <= width

    beside = side_by_side(table)
    grids = [beside] if _width(beside) <= width else below_each_other(table)
    for grid in grids:
        section = f": {grid.title[0].lower()}{grid.title[1:]}" if grid.title else ""
        for number, part in enumerate(in_parts(grid, fits)):
            more = ", continued" if number else ""
            print_table(_rich_table(part, f"{table.title}{section}{more}"))
            print_text("")
    note = textwrap.fill(note_of(table, _BEST), width - 2)
    print_text(textwrap.indent(note, " ") + "\n")


def _width(grid: Grid, longest_name: int | None = None) -> int:
    """Width of a printed grid [characters]: two beside each column, and two at the edges.

    Args:
        grid: The grid.
        longest_name: Words that are longer are broken; None: no word is.
    """
    cells = [*grid.heads, *([cell.text for cell in row] for row in grid.rows)]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    if longest_name is not None:
        widths = [
            width if right else min(width, longest_name)
            for width, right in zip(widths, grid.at_right, strict=True)
        ]
    return sum(widths) + 2 * len(widths) + 2


def _rich_table(grid: Grid, title: str) -> Group:
    from rich import box
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, padding=0)
    for lines, right in zip(zip(*grid.heads, strict=True), grid.at_right, strict=True):
        # With room for a mark behind each text, numbers stay in line. Where there is no room, names
        # are broken and numbers are not.
        head = Text("\n".join(f"{line} " for line in lines))
        table.add_column(head, justify="right" if right else "left", no_wrap=right, overflow="fold")
    for row in grid.rows:
        marks = [(_BEST, "bold") if cell.is_best else (" ", "") for cell in row]
        cells = zip(row, marks, strict=True)
        table.add_row(*(Text(f"{cell.text}{mark}", style=style) for cell, (mark, style) in cells))
    return Group(Text(title, style="bold"), table)  # the title may be the wider one
