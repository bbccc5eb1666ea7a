"""Runs the notebooks of docs/notebooks without Jupyter, and stores what they show.

python -m tests.notebooks              runs all of them and stores their outputs
python -m tests.notebooks first-steps  one of them

A cell's output is what Jupyter makes of it: what it prints, the value of its last line as text and
HTML, and the figures that it leaves open.
"""

from __future__ import annotations

import ast
import base64
import io
import json
import os
import re
import sys
import tempfile
from collections.abc import Iterator
from contextlib import chdir, redirect_stdout
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
_DPI = 80  # of stored figures
_PICTURE, _STYLE, _TAG = (
    re.compile(text, re.DOTALL) for text in ("<img [^>]*>", "<style.*?</style>", "<[^>]*>")
)


def read(file: Path) -> dict[str, Any]:
    """A notebook as JSON has it."""
    notebook: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    return notebook


def write(file: Path, notebook: dict[str, Any]) -> None:
    """Writes a notebook as Jupyter does, so that it changes nothing of what stays."""
    text = json.dumps(notebook, indent=1, ensure_ascii=False, sort_keys=True)
    file.write_text(text + "\n", encoding="utf-8", newline="\n")


def executed(notebook: dict[str, Any]) -> dict[str, Any]:
    """A notebook with the outputs of all its cells, run in order in one namespace.

    It is run in the working folder, of which nothing is stored.
    """
    names: dict[str, Any] = {"__name__": "__main__"}
    cells: list[dict[str, Any]] = []
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            count = 1 + sum(each["cell_type"] == "code" for each in cells)
            outputs = list(_outputs("".join(cell["source"]), names, count))
            cell = {**cell, "execution_count": count, "outputs": outputs}
        cells.append(cell)
    return {**notebook, "cells": cells}


def _outputs(source: str, names: dict[str, Any], count: int) -> Iterator[dict[str, Any]]:
    import matplotlib.pyplot as plt

    *body, last = ast.parse(source).body
    shown = isinstance(last, ast.Expr) and not source.rstrip().endswith(";")
    printed, value = io.StringIO(), None
    with redirect_stdout(printed):
        exec(compile(ast.Module(body, []), f"<cell {count}>", "exec"), names)
        if shown:
            assert isinstance(last, ast.Expr)
            value = eval(compile(ast.Expression(last.value), f"<cell {count}>", "eval"), names)
        else:
            exec(compile(ast.Module([last], []), f"<cell {count}>", "exec"), names)
    if printed.getvalue():
        yield {"name": "stdout", "output_type": "stream", "text": _lines(printed.getvalue())}
    if value is not None:
        data = {"text/plain": _lines(repr(value))}
        if hasattr(value, "_repr_html_"):
            data["text/html"] = _lines(value._repr_html_())
        yield {
            "data": data,
            "execution_count": count,
            "metadata": {},
            "output_type": "execute_result",
        }
    for number in plt.get_fignums():
        content = io.BytesIO()
        figure = plt.figure(number)
        figure.savefig(content, dpi=_DPI, bbox_inches="tight", metadata={"Software": None})
        image = base64.b64encode(content.getvalue()).decode("ascii") + "\n"
        yield {
            "data": {"image/png": image, "text/plain": [repr(figure)]},
            "metadata": {},
            "output_type": "display_data",
        }
        plt.close(figure)


def _lines(text: str) -> list[str]:
    return text.splitlines(keepends=True)


def told(cell: dict[str, Any]) -> list[str]:
    """What the outputs of a cell say: pictures are Matplotlib's, and their looks may change."""
    outputs = cell.get("outputs", [])
    printed = "".join(part for output in outputs for part in output.get("text", []))
    found = [f"printed: {printed}"]  # Jupyter stores it in several pieces
    for output in outputs:
        for kind, part in sorted(output.get("data", {}).items()):
            text = "a picture" if kind == "image/png" else "".join(part)
            if kind == "text/html":
                text = _TAG.sub(" ", _STYLE.sub(" ", _PICTURE.sub(" a picture ", text)))
            found.append(f"{kind}: {text}")
    return found


def main(wanted: list[str]) -> None:
    """Runs notebooks and stores their outputs."""
    os.environ["MPLBACKEND"] = "agg"
    for file in NOTEBOOKS:
        if wanted and file.stem not in wanted:
            continue
        with tempfile.TemporaryDirectory() as folder, chdir(folder):
            write(file, executed(read(file)))
        print(f"{file.name}: {file.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main(sys.argv[1:])
