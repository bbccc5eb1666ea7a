"""Tables of runs side by side: golden files, which value is the best, hostile names."""

from __future__ import annotations

import csv
import io
import re
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st

from hilc_cli.comparisons.comparing import ROWS, compare_runs
from hilc_cli.comparisons.formats import WRITERS, csv_text, latex_text, markdown_text
from hilc_cli.comparisons.table import (
    Column,
    ComparisonTable,
    Row,
    Value,
    number_text,
)
from hilc_cli.errors import UsageError
from hilc_cli.reference.sampled import Reference
from hilc_cli.results.metrics import METRICS, MetricsTable
from hilc_cli.results.run import RunData

# A path of 8 m in 4 samples: 1 % of it are 0.08 m, 0.1 % are 0.008 m.
LINE = Reference("line", 0.5, np.array([0.0, 2, 4, 6, 8]), np.zeros(5), np.zeros(5))
ZERO = dict.fromkeys(METRICS, 0.0)


def a_run(
    name: str,
    errors: Sequence[float],
    reference: Reference = LINE,
    limit: float | None = None,
    saturated: Sequence[int] = (),
    diverged_at: int | None = None,
    **last: float,
) -> RunData:
    """A run of given maximum errors, with given other metrics of its last iteration."""
    metrics = MetricsTable()
    for iteration, error in enumerate(errors):
        row = {**ZERO, "max_position_error_m": error}
        row["saturated_samples"] = saturated[iteration] if saturated else 0
        if iteration == len(errors) - 1:
            row |= last
        metrics.append(row)
    return RunData(name, reference, metrics, {}, limit, (0.0, 0.0), diverged_at)


# 3 + 1 of 4 iterations of 4 samples at the limit: 25 %.
ONE = a_run(
    "one_1",
    (2.0, 3.0, 0.05, 0.0078125),
    limit=180.0,
    saturated=(0, 3, 1, 0),
    max_position_error_second_half_m=0.0068359375,
    mean_position_error_m=0.00390625,
    rms_position_error_m=0.005,
    final_position_error_m=1 / 3,
    max_abs_error_heading_rad=1.5e-7,
    max_wheel_speed_rad_s=180.0,
)
ONE = replace(
    ONE, settings={"law": "hybrid", "gains": "l1=0.5 l2=0 l3=0", "start_offset": "x=-1 m"}
)
TWO = a_run(
    "two--2",
    (2.0, 0.5),
    max_position_error_second_half_m=0.125,
    mean_position_error_m=0.0039059,
    rms_position_error_m=0.25,
    final_position_error_m=0.0,
    max_abs_error_heading_rad=12345.678,
    max_wheel_speed_rad_s=1234.5,
)

GOLDEN_CSV = """\
run,law,gains,compensation,start_offset,trajectory,path_size_m,iterations,max_position_error_m,\
max_position_error_second_half_m,mean_position_error_m,\
rms_position_error_m,final_position_error_m,max_abs_error_heading_rad,max_wheel_speed_rad_s,\
speed_limit_rad_s,iterations_to_1_percent,iterations_to_0_1_percent,peak_max_position_error_m,\
peak_iteration,saturated_share,diverged_at
one_1,hybrid,l1=0.5 l2=0 l3=0,,x=-1 m,line,8.0,3,\
0.0078125,0.0068359375,0.00390625,0.005,0.3333333333333333,1.5e-07,180.0,180.0,2,3,3.0,1,0.25,
two--2,,,,,line,8.0,1,0.5,0.125,0.0039059,0.25,0.0,12345.678,1234.5,,,,2.0,0,0.0,
"""
NOTE = (
    "Errors and the fastest wheel are those of the last iteration. From the iteration given for "
    "1 % and 0.1 % on, the maximum error stays within that share of the path's size. Samples at "
    "the speed limit are counted over all iterations."
)
LATEX_NOTE = NOTE.replace("%", "\\%")
GOLDEN_MARKDOWN = f"""\
|  | one\\_1 | two--2 |
| --- | ---: | ---: |
| Learning law | hybrid |  |
| Gains | l1=0.5 l2=0 l3=0 |  |
| Start offset | x=-1 m |  |
| Trajectory | line | line |
| Path size [m] | 8.000 | 8.000 |
| Iterations | 3 | 1 |
| Maximum position error [m] | **0.007812** | 0.5000 |
| Maximum position error, second half [m] | **0.006836** | 0.1250 |
| Mean position error [m] | 0.003906 | 0.003906 |
| RMS position error [m] | **0.005000** | 0.2500 |
| Position error at the end [m] | 0.3333 | **0** |
| Maximum heading error [rad] | **1.500e-7** | 12346 |
| Fastest wheel [rad/s] | 180.0 | 1234 |
| Speed limit [rad/s] | 180.0 | none |
| Within 1 % of path size from iteration | **2** | never |
| Within 0.1 % of path size from iteration | **3** | never |
| Largest maximum error on the way [m] | 3.000 | 2.000 |
| Largest in iteration | 1 | 0 |
| Samples at the speed limit [%] | 25.0 | 0 |
| Diverged in iteration | no | no |

{NOTE} Bold: the best of the runs on the same trajectory.
"""
GOLDEN_LATEX = rf"""% Needs \usepackage{{booktabs}} in the preamble.
\begin{{table}}
  \centering
  \caption{{Comparison of 2 runs. {LATEX_NOTE} Bold: the best of the runs on the same trajectory.}}
  \label{{tab:comparison}}
  \footnotesize
  \setlength{{\tabcolsep}}{{4pt}}
  \begin{{tabular}}{{lrr}}
    \toprule
    & one\_1 & two-{{}}-2 \\
    \midrule
    Learning law & hybrid & \\
    Gains & $l_1 = 0.5$, $l_2 = 0$, $l_3 = 0$ & \\
    Start offset & $x = -1$\,m & \\
    Trajectory & line & line \\
    Path size [m] & 8.000 & 8.000 \\
    Iterations & 3 & 1 \\
    Maximum position error [m] & \textbf{{0.007812}} & 0.5000 \\
    Maximum position error, second half [m] & \textbf{{0.006836}} & 0.1250 \\
    Mean position error [m] & 0.003906 & 0.003906 \\
    RMS position error [m] & \textbf{{0.005000}} & 0.2500 \\
    Position error at the end [m] & 0.3333 & \textbf{{0}} \\
    Maximum heading error [rad] & $\mathbf{{1.500 \times 10^{{-7}}}}$ & 12346 \\
    Fastest wheel [rad\,s$^{{-1}}$] & 180.0 & 1234 \\
    Speed limit [rad\,s$^{{-1}}$] & 180.0 & none \\
    Within 1 \% of path size from iteration & \textbf{{2}} & never \\
    Within 0.1 \% of path size from iteration & \textbf{{3}} & never \\
    Largest maximum error on the way [m] & 3.000 & 2.000 \\
    Largest in iteration & 1 & 0 \\
    Samples at the speed limit [\%] & 25.0 & 0 \\
    Diverged in iteration & no & no \\
    \bottomrule
  \end{{tabular}}
\end{{table}}
"""


@pytest.mark.parametrize(
    ("kind", "golden"),
    [("csv", GOLDEN_CSV), ("markdown", GOLDEN_MARKDOWN), ("latex", GOLDEN_LATEX)],
)
def test_golden_tables(kind: str, golden: str) -> None:
    assert WRITERS[kind](compare_runs([ONE, TWO])) == golden


@pytest.mark.parametrize(
    ("setting", "expected"),
    [
        ("kp=0.1 ki=0 kd=-1.5", "$k_p = 0.1$, $k_i = 0$, $k_d = -1.5$"),
        ("k_x=8 k_theta=1e-09", r"$k_x = 8$, $k_{\theta} = 1 \times 10^{-9}$"),
        ("on h=200", "on, $h = 200$"),
        ("lateral=0.3 l12=1", "lateral = $0.3$, $l_{12} = 1$"),
        ("weights.x_y=2 gain_matrix=unit", r"weights.x\_y = $2$, gain\_matrix = unit"),
        ("x=-1 m heading=0.5 rad", r"$x = -1$\,m, heading = $0.5$\,rad"),
        ("y=2 rad/s z=1", r"$y = 2$\,rad\,s$^{-1}$, $z = 1$"),
        ("l1=} l2=$", r"l1 = \}, l2 = \$"),
        (r"\input{x}=1 =", r"\textbackslash{}input\{x\} = $1$, ="),
        ("", ""),
    ],
)  # fmt: skip
def test_gains_are_set_as_formulas_and_nothing_else_is(setting: str, expected: str) -> None:
    run = replace(ONE, settings={"gains": setting})
    text = latex_text(compare_runs([run, TWO], ["gains"]))
    check_latex(text)
    assert f"    Gains & {expected} & " in text


@given(st.text(st.characters(codec="utf-8"), max_size=20))
def test_any_setting_leaves_the_table_whole(setting: str) -> None:
    run = replace(ONE, settings={"gains": setting})
    check_latex(latex_text(compare_runs([run, TWO])))


def test_a_name_that_looks_like_a_unit_is_none() -> None:
    text = latex_text(compare_runs([a_run("w [rad/s]", (1.0,)), TWO]))
    assert r"& w [rad/s] & two-{}-2 \\" in text


def test_rows_are_those_that_are_asked_for_in_their_order() -> None:
    rows = ["rms_position_error_m", "gains", "max_abs_error_x_m", "rms_position_error_m"]
    table = compare_runs([ONE, TWO], rows)
    assert csv_text(table).splitlines() == [
        "run,rms_position_error_m,gains,max_abs_error_x_m",
        "one_1,0.005,l1=0.5 l2=0 l3=0,0.0",
        "two--2,0.25,,0.0",
    ]
    titles = [line.split(" | ")[0] for line in markdown_text(table).splitlines()[2:5]]
    assert titles == ["| RMS position error [m]", "| Gains", "| Maximum error in x [m]"]
    assert [line.split(" & ")[0].strip() for line in latex_text(table).splitlines()[11:14]] == [
        title.removeprefix("| ") for title in titles
    ]
    none = compare_runs([TWO, TWO], ["compensation"])
    assert "| Compensation |  |  |" in markdown_text(none), "told though there is nothing to tell"
    assert set(METRICS) < set(ROWS)
    with pytest.raises(
        UsageError, match=r"no row 'rms_position_eror_m' .* did you mean 'rms_position_error_m'"
    ):
        compare_runs([ONE, TWO], ["gains", "rms_position_eror_m"])
    with pytest.raises(UsageError, match="no row 'run' in a table of runs; known: law, gains, "):
        compare_runs([ONE, TWO], ["run"])


def leaderboard(marks: str = "law") -> ComparisonTable:
    """Not of runs: five rows, and columns of two sections."""
    columns = (
        Column(marks, "Learning law", "Law"),
        Column("error_m", "Error", "Max. error", "m", digits=3, section="Errors", is_ranked=True),
        Column("passes", "Passes", "Passes", section="Effort", absent="-"),
        Column("share", "Share", "Share", "%", digits=2, scale=100.0, section="Effort"),
    )
    rows = (
        Row(("[P]", 0.5, 12, 0.125), group=0),
        Row(("*PD", 0.25, None, 1.0), group=0),
        Row(("P_2", 2e-9, 3, 0.0), group=1),
        Row(("PD|2", 1e9, 4, 0.5), group=1),
        Row(("wild", 1e-9, 5, 0.5), group=1, may_be_best=False),
    )
    return ComparisonTable("Laws", columns, rows, "Note.", "best of its case")


def test_many_rows_stand_below_each_other_in_markdown() -> None:
    expected = """\
**Errors**

| Law | Max. error [m] |
| --- | ---: |
| [P] | 0.500 |
| \\*PD | **0.250** |
| P\\_2 | **2.00e-9** |
| PD\\|2 | 1.00e9 |
| wild | 1.00e-9 |

**Effort**

| Law | Passes | Share [%] |
| --- | ---: | ---: |
| [P] | 12 | 12 |
| \\*PD | - | 100 |
| P\\_2 | 3 | 0 |
| PD\\|2 | 4 | 50 |
| wild | 5 | 50 |

Note. Bold: best of its case.
"""
    assert markdown_text(leaderboard()) == expected


def test_many_rows_stand_below_each_other_in_latex() -> None:
    text = latex_text(leaderboard())
    first = r"""
  \begin{tabular}{lr}
    \toprule
    \multicolumn{2}{l}{Errors} \\
    \midrule
    & Max. \\
    Law & error \\
    & [m] \\
    \midrule
    {}[P] & 0.500 \\
    {}*PD & \textbf{0.250} \\
    P\_2 & $\mathbf{2.00 \times 10^{-9}}$ \\
    PD\textbar{}2 & $1.00 \times 10^{9}$ \\
    wild & $1.00 \times 10^{-9}$ \\
    \bottomrule
  \end{tabular}

  \medskip
  \begin{tabular}{lrr}
"""
    assert first in text
    check_latex(text)


ESCAPES = (
    *("\\textbackslash", "\\textasciicircum", "\\textasciitilde", "\\textasciigrave"),
    *("\\textless", "\\textgreater", "\\textbar", "\\times", "\\mathbf", "\\textbf"),
    "\\theta",
)
FRAME = (
    *("\\begin", "\\end", "\\centering", "\\caption", "\\label", "\\footnotesize", "\\setlength"),
    *("\\tabcolsep", "\\medskip", "\\toprule", "\\midrule", "\\bottomrule", "\\multicolumn"),
)


def check_latex(text: str) -> None:
    """As much of LaTeX as these tables have: known commands, closed groups, even rows."""
    assert text.startswith("% Needs ") and text.endswith("\\end{table}\n")
    body = text.partition("\n")[2]
    tokens = re.findall(r"\\[A-Za-z]+|\\.|[{}$&%#_^~\n]|[^\\{}$&%#_^~\n]+", body)
    assert "".join(tokens) == body, "no backslash stands alone"
    depth = 0
    for token in tokens:
        depth += {"{": 1, "}": -1}.get(token, 0)
        assert depth >= 0
        if re.fullmatch(r"\\[A-Za-z]+", token):
            assert token in ESCAPES + FRAME
        elif token.startswith("\\"):
            assert token[1] in "{}$&#_%\\,", token
        assert token not in ("%", "#", "~"), "is escaped"
    assert depth == 0
    assert body.count("\\begin{table}") == body.count("\\end{table}") == 1
    tabulars = re.findall(
        r"^  \\begin\{tabular\}\{([lr]+)\}\n(.*?)^  \\end\{tabular\}\n", body, re.M | re.S
    )
    assert len(tabulars) == body.count("\\begin{tabular}") == body.count("\\end{tabular}") > 0
    for kinds, inside in tabulars:
        lines = inside.splitlines()
        assert (lines[0], lines[-1]) == ("    \\toprule", "    \\bottomrule")
        for line in lines[1:-1]:
            if line == "    \\midrule":
                continue
            assert line.endswith(" \\\\"), "a row ends with a line break"
            row = line.strip().removesuffix(" \\\\")
            assert not row.startswith(("[", "*")), "would be an argument of the break before"
            # Math mode is left where it was entered: a ^ belongs nowhere else.
            outside = "".join(re.split(r"(?<!\\)\$", row)[::2])
            assert "^" not in outside and not re.search(r"(?<!\\)_", outside)
            assert len(re.findall(r"(?<!\\)\$", row)) % 2 == 0
            cells = len(re.findall(r"(?<!\\)&", row)) + 1
            assert cells == (1 if row.startswith("\\multicolumn") else len(kinds))


names = st.text(st.characters(codec="utf-8"), max_size=12)


@given(st.lists(names, min_size=2, max_size=6))
def test_any_name_leaves_the_tables_whole(chosen: list[str]) -> None:
    table = compare_runs([a_run(name, (1.0, 0.5)) for name in chosen])
    check_latex(latex_text(table))
    widths = [1 + len(chosen)] if len(chosen) <= 4 else [9, 10]
    for line in markdown_text(table).split("\n"):
        if line.startswith("|"):
            assert len(re.findall(r"(?<!\\)(?:\\\\)*\|", line)) - 1 in widths
    rows = list(csv.reader(io.StringIO(csv_text(table), newline="")))
    for cell, name in zip([row[0] for row in rows[1:]], map(str, table.values("run")), strict=True):
        shown = "".join(letter if letter.isprintable() else "\ufffd" for letter in name)
        assert cell == (
            f"'{shown}" if shown[:1] in tuple("=+-@\uff1d\uff0b\uff0d\uff20") else shown
        )
    assert len(set(table.values("run"))) == len(chosen)


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="needs LaTeX")
def test_latex_sets_the_tables(tmp_path: Path) -> None:
    settings = {"gains": "k_theta=1e-09 lateral=0.5 l1=2", "start_offset": "x=-1 m heading=0.1 rad"}
    odd = a_run("a\\b{c}$d&e#f_g%h~i^j<k>l|m`n\"o'p--q[r]", (1.0,))
    odd = replace(odd, settings=settings)
    tables = [compare_runs([ONE, odd]), compare_runs([odd, TWO] * 3)]
    body = "\n".join(latex_text(table) for table in tables)
    document = f"\\documentclass{{article}}\\usepackage{{booktabs}}\n\\begin{{document}}\n{body}"
    (tmp_path / "a.tex").write_text(document + "\\end{document}\n")
    done = subprocess.run(
        ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "a.tex"],
        cwd=tmp_path,
        capture_output=True,
    )
    assert done.returncode == 0, done.stdout.decode()


@given(st.lists(st.floats(0, 1e300), min_size=2, max_size=5))
def test_numbers_read_back_from_csv_exactly(errors: list[float]) -> None:
    table = compare_runs([a_run(f"r{number}", (error,)) for number, error in enumerate(errors)])
    rows = list(csv.DictReader(io.StringIO(csv_text(table))))
    assert [float(row["max_position_error_m"]) for row in rows] == errors


@given(st.floats(1e-300, 1e300) | st.floats(0.1, 1e7), st.integers(1, 6))
def test_printed_numbers_are_right_to_their_digits(value: float, digits: int) -> None:
    text = number_text(value, digits)
    mantissa, _, exponent = text.partition("e")
    if 10.0**digits - 0.5 <= value < 999_999:
        assert text == str(round(value))
        return
    # Half a unit in the last place, which is at least 1 in 10 ** (digits - 1) of the value.
    assert float(text) == pytest.approx(value, rel=0.5000001 * 10.0 ** (1 - digits))
    assert len(mantissa.replace(".", "").lstrip("0")) == digits
    assert not mantissa.endswith(".") and not exponent.startswith(("+", "0", "-0"))


def best(table: ComparisonTable, name: str) -> list[Value]:
    place = [column.name for column in table.columns].index(name)
    return [table.rows[number].values[0] for number in sorted(table.best(place))]


def test_best_of_those_on_the_same_trajectory() -> None:
    other = Reference("line", 0.5, 2 * LINE.x, LINE.y, LINE.heading)
    again = Reference("other name", 0.5, LINE.x.copy(), LINE.y.copy(), LINE.heading.copy())
    slow = Reference("line", 1.0, LINE.x, LINE.y, LINE.heading)
    table = compare_runs(
        [
            a_run("a", (0.3,)),
            a_run("far", (0.2,), other),
            a_run("b", (0.1,), again),
            a_run("farther", (0.5,), other),
            a_run("alone", (0.01,), slow),
        ]
    )
    assert best(table, "max_position_error_m") == ["far", "b"]
    assert best(table, "max_wheel_speed_rad_s") == [], "speed is no aim"


def test_equally_good_values_share_the_mark_unless_all_do() -> None:
    first, second, third = a_run("a", (0.3,)), a_run("b", (0.3 + 1e-9,)), a_run("c", (0.4,))
    assert best(compare_runs([first, second, third]), "max_position_error_m") == ["a", "b"]
    assert best(compare_runs([first, second]), "max_position_error_m") == []


def test_run_that_has_diverged_is_not_the_best() -> None:
    table = compare_runs([a_run("a", (0.3,)), a_run("wild", (0.1,), diverged_at=1)])
    assert best(table, "max_position_error_m") == ["a"]
    assert table.values("diverged_at") == [None, 1]


def test_reached_is_better_than_never() -> None:
    table = compare_runs([a_run("a", (0.3, 0.3)), a_run("b", (0.3, 0.08))])
    assert table.values("iterations_to_1_percent") == [None, 1]
    assert best(table, "iterations_to_1_percent") == ["b"]
    assert best(table, "iterations_to_0_1_percent") == []


def test_numbers_beyond_all_bounds_are_no_best() -> None:
    table = compare_runs([a_run("a", (float("inf"),)), a_run("b", (float("nan"),))])
    assert best(table, "max_position_error_m") == []
    assert [row.split(",")[8] for row in csv_text(table).splitlines()[1:]] == ["inf", "nan"]
    check_latex(latex_text(table))


def test_equal_names_are_told_apart() -> None:
    runs = [a_run("a", (0.3,)), a_run("a", (0.2,)), a_run("a (2)", (0.1,))]
    assert compare_runs(runs).values("run") == ["a", "a (2)", "a (2) (2)"]


def test_what_cannot_be_compared_is_told() -> None:
    with pytest.raises(UsageError, match="needs at least two runs, got 1"):
        compare_runs([ONE])
    with pytest.raises(UsageError, match="none: has no completed iteration"):
        compare_runs([ONE, a_run("none", ())])
    with pytest.raises(KeyError):
        compare_runs([ONE, TWO]).values("nonsense")
