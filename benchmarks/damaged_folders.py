"""Folders of results, damaged in thousands of ways: what hilc makes of each.

    python benchmarks/damaged_folders.py [--cases N] [--seed S] [--processes N]

Makes a folder of each kind once: runs, a sweep, one under way, its shards, a leaderboard and the
manifest of a reproduction. Each case is a damage that follows from its seed: a cell of a table or a
value of a document becomes something else, a file is cut, or something else than a file stands in
its place. Then a command that reads the folder runs in a process of its own, forked from one that
has imported everything.

A case has failed if there is a traceback, an exit code other than 0 to 3, more than one line of
error, a character that would steer a terminal, anything written outside, more than 2 seconds of
processor time, or more memory than 500 MB above what the program takes anyway. Prints a table of
the cases and those that failed; exit code 1 if any has.
"""

from __future__ import annotations

import argparse
import gc
import io
import json
import os
import random
import resource
import shutil
import signal
import socket
import sys
import tempfile
import time
import traceback
import zlib
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import redirect_stderr, redirect_stdout, suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

SECONDS, BYTES = 2.0, 500_000_000
PATIENCE = 120
"""Seconds after which a process counts as one that hangs, on a machine that is busy."""

SCENARIO = """\
name: test
trajectory: path.yaml
robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: paper}
iterations: 2
initial_input: input.csv
controller:
  gains: {l1: 0.5}
  b_w: 180
"""
TRAJECTORY = """\
name: path
sample_time: 100 ms
start: {x: 0, y: 0, heading: 0}
segments:
  - line: {length: 1, duration: 0.3 s}
"""
INPUT = "sample,t_s,left_wheel_rad_s,right_wheel_rad_s\n0,0.0,1,2\n1,0.1,1,2\n2,0.2,1,2\n"
LEARNING = "iteration,gain,gain_standard_error\n0,1.0,0.1\n1,2.0,0.1\n2,3.0,0.1\n"
BOARD = """\
name: board
cases: {short: scenario.yaml}
laws: {slow: {gains: {l1: 0.1}}, fast: {gains: {l1: 0.5}}}
beliefs: {exact: {}, wide: {half_track: 1.1}}
after: [1, 2]
"""

SWEEP = ("sweep", "scenario.yaml", "--vary", "controller.gain_matrix=model,unit",
         "--vary", "iterations=1,2", "--bands", "--no-plots", "--workers", "1",
         "--over", "iterations")  # fmt: skip
PLOT = ("--dpi", "20", "--out", "drawn", "--kind")
REPRODUCTION = "reproduction"
"""Not a command: only whether one may be written there, as that alone reads the folder."""
COMMANDS: dict[str, list[tuple[str, ...]]] = {
    "a": [
        ("compare", "a", "b", "--no-plots", "--out", "both"),
        ("compare", "b", "a", "--no-plots", "--out", "both", "--table", "latex"),
        ("run", "scenario.yaml", "--no-plots", "--out", "a"),
        ("run", "a/scenario.yaml", "--no-plots", "--out", "again"),
        ("check", "a/scenario.yaml"),
        ("plot", "a", *PLOT, "error"),
        ("plot", "a", *PLOT, "learning"),
        ("plot", "a", *PLOT, "wheel-speeds"),
    ],
    "sweep": [
        (*SWEEP, "--out", "sweep", "--resume"),
        (*SWEEP, "--out", "sweep"),
        ("run", "sweep/scenario.yaml", "--no-plots", "--out", "again"),
        ("run", "sweep", "--case", "1", "--no-plots", "--out", "again"),
        ("run", "sweep", "--best", "--no-plots", "--out", "again"),
        ("check", "sweep/scenario.yaml"),
        ("compare", "sweep", "b", "--no-plots", "--out", "both"),
        ("plot", "sweep", *PLOT, "spread"),
        ("plot", "sweep", *PLOT, "effects"),
        ("plot", "sweep", *PLOT, "bands"),
    ],
    "new.part": [
        (*SWEEP, "--out", "new", "--resume"),
        (*SWEEP, "--out", "new", "--force"),
        ("sweep", "--merge", "new.part", "--no-plots", "--out", "merged"),
    ],
    "part.1-of-2": [
        ("sweep", "--merge", "part.1-of-2", "part.2-of-2", "--no-plots", "--out", "merged"),
        ("sweep", "--merge", "part.2-of-2", "part.1-of-2", "--no-plots", "--out", "merged"),
        (*SWEEP, "--shard", "1/2", "--out", "part", "--resume"),
        ("run", "part.1-of-2/scenario.yaml", "--no-plots", "--out", "again"),
    ],
    "board": [
        ("plot", "board", "--dpi", "20", "--out", "drawn"),
        ("compare", "board", "a", "b", "--no-plots", "--out", "both"),
    ],
    "figures": [(REPRODUCTION, "figures")],
}
"""The commands that read a folder, by its name."""

NUMBERS = ("nan", "NaN", "inf", "-inf", "1e309", "-1e309", "1e308", "1e300", "-1e300", "1e200",
           "1e150", "1e-320", "-1", "0", "0.5", "1.5", "1e12", "1" + "0" * 400, "9" * 5000,
           "9223372036854775808", "18446744073709551616", "100000000", "-0.0")  # fmt: skip
TEXTS = ("", " ", "x", "null", "None", "True", "0x10", "1_0", '"', "'", "=1+1", "-x", "../../x",
         "/etc/passwd", "\x1b[31mred", "\x1b]0;title\x07", "\u202eleft", "\ud800", "\x00", "\r",
         "[red]x[/red]", "$\\frac{$", "n" * 101, "n" * 200_000, "\u0661", "\ufeff")  # fmt: skip


def make_folders(place: Path) -> None:
    """Makes one folder of each kind in the working folder, which is the place."""
    import hilc_cli as hilc
    from hilc_cli.paper.contents import REPRODUCTION_FOLDER
    from hilc_cli.paper.plan import plan_reproduction
    from hilc_cli.sweeps.compute import Execution
    from hilc_cli.sweeps.planning import plan_sweep
    from hilc_cli.sweeps.shards import sweep_shard
    from hilc_cli.sweeps.sweeping import sweep

    for name, text in (("scenario.yaml", SCENARIO), ("path.yaml", TRAJECTORY),
                       ("input.csv", INPUT), ("board.yaml", BOARD)):  # fmt: skip
        Path(name).write_text(text)
    scenario = hilc.load_scenario("scenario.yaml")
    for name in "ab":
        hilc.run(scenario).write(name, plots=False)
        Path(name, "learning.csv").write_text(LEARNING)
    plan = plan_sweep(scenario, [SWEEP[3], SWEEP[5]], bands=True, over="iterations")
    alone = Execution(workers=1)
    sweep(plan, alone, work_folder="new.part").write("sweep", plots=False)
    for number, name in enumerate(("part.1-of-2", "part.2-of-2"), 1):
        sweep_shard(plan, (number, 2), name, alone)
    hilc.compare_laws("board.yaml", workers=1).write("board", plots=False)
    figures = plan_reproduction(["fig3"])

    def fill(folder: Path) -> None:
        (folder / "data").mkdir()
        (folder / "index.md").write_text("# Figures\n")

    REPRODUCTION_FOLDER.write(
        place / "figures",
        fill,
        lambda: {
            "figures": [figure.name for figure in figures.figures],
            "checksum": figures.checksum(),
            "scenarios_sha256": figures.checksums(),
        },
        lambda folder: None,
    )


# --- Damage


def damage(file: Path, dice: random.Random, outside: Path) -> str:
    """Damages a file in one of the ways that fit it; says how."""
    place_of_file = dice.random() < 0.12
    if not place_of_file and file.is_file() and file.stat().st_size:
        content, rest = file.read_bytes(), dice.random()
        if rest < 0.12:
            return _write(file, *_cut(content, dice))
        if file.suffix == ".json":
            return _write(file, *_changed_json(content, dice))
        if file.suffix == ".csv":
            return _write(file, *_changed_table(content, dice))
        if file.name == "journal":
            return _write(file, *_changed_journal(content, dice))
        if file.suffix == ".bin":
            return _changed_numbers(file, dice)
        return _write(file, *_changed_text(content, dice))
    way = dice.choice((_link_to_the_same, _dangling, _pipe, _socket, _endless, _folder, _missing))
    way(file, outside)
    return way.__name__.strip("_")


def _write(file: Path, content: bytes, how: str) -> str:
    file.write_bytes(content)
    return how


def _cut(content: bytes, dice: random.Random) -> tuple[bytes, str]:
    place = dice.randrange(len(content))
    return dice.choice(
        (
            (content[:place], "cut"),
            (b"", "empty"),
            (bytes(len(content)), "zero bytes"),
            (content[:place] + dice.randbytes(20) + content[place:], "random bytes within"),
            (dice.randbytes(300), "random bytes"),
            (content * 2, "twice"),
            (content[:place] + b"[" * 100_000, "deep nesting"),
        )
    )


def _changed_table(content: bytes, dice: random.Random) -> tuple[bytes, str]:
    rows = [line.split(",") for line in content.decode().splitlines()]
    row = dice.randrange(len(rows)) if dice.random() < 0.1 else dice.randrange(1, len(rows))
    way = dice.random()
    if way < 0.75:
        column = dice.randrange(len(rows[row]))
        cell = dice.choice(NUMBERS if dice.random() < 0.6 else TEXTS)
        rows[row][column] = cell if dice.random() < 0.7 or '"' in cell else f'"{cell}"'
        if dice.random() < 0.1:  # the whole column
            for each in rows[1:]:
                each[column : column + 1] = [cell]
        how = f"cell {cell[:20]!r}"
    elif way < 0.8:
        del rows[row][dice.randrange(len(rows[row]))]
        how = "cell left out"
    elif way < 0.85:
        rows[row].insert(0, dice.choice(NUMBERS))
        how = "cell too many"
    elif way < 0.9:
        del rows[row]
        how = "row left out"
    elif way < 0.95:
        rows.insert(row, list(rows[row]))
        how = "row twice"
    else:
        dice.shuffle(rows)
        how = "rows in disorder"
    return "\n".join(map(",".join, rows)).encode("utf-8", "surrogatepass") + b"\n", how


def _changed_json(content: bytes, dice: random.Random) -> tuple[bytes, str]:
    document = json.loads(content)
    parent, key = dice.choice(list(_places(document)))
    way = dice.random()
    mark = "MARK-OF-THE-PLACE"
    if way < 0.08 and isinstance(parent, dict):
        del parent[key]
        return json.dumps(document).encode(), f"{key} left out"
    if way < 0.12 and isinstance(parent, dict):
        text = dice.choice(TEXTS)
        parent[text] = parent.pop(key)
        return json.dumps(document).encode(), f"{key} called otherwise"
    if way < 0.15:
        value = json.dumps(parent[key])
        parent[key] = mark
        return json.dumps(document).replace(f'"{mark}"', f'{value}, "{key}": 1').encode(), "twice"
    parent[key] = mark
    if dice.random() < 0.5:
        value = dice.choice((*NUMBERS, "NaN", "Infinity", "-Infinity"))
    else:
        others = ("null", "true", "[]", "{}", "[[]]", '{"a": null}', "[1, 2, 3]",
                  "[" * 50_000 + "]" * 50_000, "[1e309]", "[null, null]")  # fmt: skip
        value = dice.choice((*others, *map(json.dumps, TEXTS)))
    return json.dumps(document).replace(f'"{mark}"', value).encode(), f"{key}: {value[:20]}"


def _places(document: Any) -> Iterator[tuple[Any, Any]]:
    """Each place of a document, as what it is in and its key there."""
    entries = document.items() if isinstance(document, dict) else enumerate(document)
    for key, value in list(entries):
        yield document, key
        if isinstance(value, dict | list):
            yield from _places(value)


def _line(text: bytes) -> bytes:
    return b"%08x %s" % (zlib.crc32(text), text)


def _changed_journal(content: bytes, dice: random.Random) -> tuple[bytes, str]:
    """Lines with the right checksum, whatever is in them."""
    lines = [line for line in content.split(b"\n") if line]
    place = dice.randrange(len(lines))
    text, how = _changed_json(lines[place].partition(b" ")[2], dice)
    lines[place] = _line(text.replace(b"\n", b" "))
    return b"\n".join(lines) + b"\n", f"journal {how}"


def _changed_numbers(file: Path, dice: random.Random) -> str:
    """Another number in the results, mostly with the checksum of them in the journal."""
    import numpy as np

    from hilc_cli.results.metrics import CASE_COLUMNS

    numbers = np.fromfile(file)
    value = dice.choice((np.nan, np.inf, -np.inf, 1e300, -1.0, 0.5, 1e19, -0.0, 1e200))
    numbers[dice.randrange(len(numbers))] = value
    numbers.tofile(file)
    journal, folder = file.with_name("journal"), file.parent
    header = json.loads((folder / "plan.json").read_bytes())
    rows = np.fromfile(folder / "results.bin").reshape(-1, len(CASE_COLUMNS))
    errors = np.fromfile(folder / "errors.bin").reshape(header["iterations"] + 1, -1)
    lines = []
    for line in journal.read_bytes().split(b"\n"):
        if line:
            entry = json.loads(line.partition(b" ")[2])
            part = slice(entry["first"] - header["first"], entry["last"] - header["first"])
            checksum = zlib.crc32(rows[part].tobytes())
            for each in errors:
                checksum = zlib.crc32(each[part].tobytes(), checksum)
            lines.append(_line(json.dumps({**entry, "checksum": checksum}).encode()))
    if dice.random() < 0.9:
        journal.write_bytes(b"\n".join(lines) + b"\n")
    return f"number {value}"


def _changed_text(content: bytes, dice: random.Random) -> tuple[bytes, str]:
    words = content.decode().split(" ")
    words[dice.randrange(len(words))] = dice.choice(NUMBERS + TEXTS)
    return " ".join(words).encode("utf-8", "surrogatepass"), "word"


def _link_to_the_same(file: Path, outside: Path) -> None:
    file.rename(outside / "target")
    file.symlink_to(outside / "target")


def _dangling(file: Path, outside: Path) -> None:
    _missing(file, outside)
    file.symlink_to(outside / "nowhere")


def _pipe(file: Path, outside: Path) -> None:
    _missing(file, outside)
    os.mkfifo(file)


def _socket(file: Path, outside: Path) -> None:
    _missing(file, outside)
    before = Path.cwd()
    os.chdir(file.parent)  # names of sockets are short
    with socket.socket(socket.AF_UNIX) as one:
        one.bind(file.name)
    os.chdir(before)


def _endless(file: Path, outside: Path) -> None:
    _missing(file, outside)
    file.symlink_to("/dev/zero")


def _folder(file: Path, outside: Path) -> None:
    _missing(file, outside)
    file.mkdir()


def _missing(file: Path, outside: Path) -> None:
    shutil.rmtree(file) if file.is_dir() else file.unlink()


# --- Running


@dataclass(frozen=True)
class Outcome:
    """What came of a case.

    Attributes:
        case: Its number.
        kind: Name of the folder.
        what: The file, its damage, and the command.
        code: Exit code; negative for a signal.
        seconds: Processor time.
        megabytes: Memory above that of the program before.
        faults: What should not be.
    """

    case: int
    kind: str
    what: str
    code: int
    seconds: float
    megabytes: float
    faults: tuple[str, ...]


class Fuzzer:
    """Damages copies of folders and runs commands on them."""

    def __init__(self, place: Path, seed: int) -> None:
        """Makes the folders, and runs each command once in this process, which loads everything.

        Args:
            place: An empty folder.
            seed: Of all damages.
        """
        self._place, self._seed = place, seed
        self._whole = place / "whole"
        self._whole.mkdir()
        os.chdir(self._whole)
        make_folders(self._whole)
        numbered = enumerate(command for commands in COMMANDS.values() for command in commands)
        for number, command in numbered:
            folder = place / f"warm-{number}"
            shutil.copytree(self._whole, folder)
            os.chdir(folder)
            said = io.StringIO()
            with redirect_stdout(said), redirect_stderr(said):
                code = _run(command)
            if code and command[:2] != ("compare", "sweep"):  # which it refuses
                raise RuntimeError(f"{command} on sound folders: {code}, {said.getvalue()}")

        gc.freeze()  # what is loaded stays where it is in the processes that are forked

    def case(self, number: int) -> Outcome:
        """Runs one case."""
        dice = random.Random(f"{self._seed} {number}")
        work = self._place / f"case-{number}"
        outside, inside = work / "outside", work / "inside"
        outside.mkdir(parents=True)
        shutil.copytree(self._whole, inside)
        kinds = list(COMMANDS)
        kind = kinds[number % len(kinds)]
        command = COMMANDS[kind][number // len(kinds) % len(COMMANDS[kind])]
        file = dice.choice(sorted((inside / kind).iterdir()))
        how = damage(file, dice, outside)
        before = _listing(outside)
        code, seconds, megabytes, out, error = self._forked(command, inside, work)
        faults = list(_faults(code, out, error))
        if _listing(outside) != before or {"outside", "inside", "out", "err"} != {
            entry.name for entry in work.iterdir()
        }:
            faults.append("written outside")
        if seconds > SECONDS:
            faults.append("slow")
        if megabytes > BYTES / 1e6:
            faults.append("memory")
        shutil.rmtree(work)
        what = f"{kind}/{file.name}: {how}: {' '.join(command)}"
        if faults:
            what += f"\n    {error[-500:]!a}"
        return Outcome(number, kind, what, code, seconds, megabytes, tuple(faults))

    def _forked(
        self, command: tuple[str, ...], folder: Path, work: Path
    ) -> tuple[int, float, float, str, str]:
        used = _memory(1)  # which a process that is forked has at once
        child = os.fork()
        if child == 0:
            code = 70
            try:
                os.chdir(folder)
                for name, number in (("out", 1), ("err", 2)):
                    os.dup2(os.open(work / name, os.O_WRONLY | os.O_CREAT), number)
                most = _memory(0) + 2 * BYTES
                resource.setrlimit(resource.RLIMIT_AS, (most, most))
                resource.setrlimit(resource.RLIMIT_CPU, (20, 20))
                signal.alarm(PATIENCE)
                code = _run(command)
            except BaseException:
                traceback.print_exc()
            finally:
                with suppress(BaseException):
                    sys.stdout.flush()
                os._exit(code)
        _, status, usage = os.wait4(child, 0)
        out, error = [
            (work / name).read_bytes().decode("utf-8", "replace") for name in ("out", "err")
        ]
        return (
            os.waitstatus_to_exitcode(status),
            usage.ru_utime + usage.ru_stime,
            max(0.0, usage.ru_maxrss * 1024 - used) / 1e6,
            out,
            error,
        )


def _memory(kind: int) -> int:
    """Memory of this process [bytes]: 0 asked for, 1 in use."""
    return int(Path("/proc/self/statm").read_text().split()[kind]) * resource.getpagesize()


def _run(command: tuple[str, ...]) -> int:
    from hilc_cli.cli.main import main

    if command[0] == REPRODUCTION:
        return _check_reproduction(Path(command[1]))
    try:
        main([*command, "-q"] if command[0] != "check" else list(command))
    except SystemExit as stop:
        return stop.code if isinstance(stop.code, int) else 1


def _check_reproduction(folder: Path) -> int:
    from hilc_cli.errors import HilcError
    from hilc_cli.paper.plan import plan_reproduction
    from hilc_cli.paper.reproducing import check_reproduction
    from hilc_cli.wording import printable

    try:
        check_reproduction(plan_reproduction(["fig3"]), folder)
    except HilcError as error:
        print(f"hilc: {printable(str(error))}", file=sys.stderr)
        return error.exit_code
    return 0


def _listing(folder: Path) -> dict[str, tuple[int, int]]:
    entries = {entry.name: entry.lstat() for entry in folder.rglob("*")}
    return {name: (status.st_mtime_ns, status.st_size) for name, status in entries.items()}


def _faults(code: int, out: str, error: str) -> Iterator[str]:
    if "Traceback" in error or "this is a bug" in error:
        yield "traceback"
    if code not in (0, 1, 2, 3):
        yield f"exit code {code}"
    lines = [line for line in error.splitlines() if not line.startswith("hilc: go on with: ")]
    # Problems of a scenario and what check says have a line each.
    if code in (1, 2) and not lines:
        yield "nothing said"
    if "out of memory" in error:
        yield "memory"
    if any(not line.isprintable() for line in (*out.splitlines(), *lines)):
        yield "steers the terminal"
    if len(error) > 20_000:
        yield "long"


def outcomes(fuzzer: Fuzzer, cases: range, processes: int, place: Path) -> list[Outcome]:
    """Runs cases, in several processes."""
    children = []
    for number in range(processes):
        child = os.fork()
        if child == 0:
            with (place / f"outcomes-{number}").open("w") as file:
                for case in cases[number::processes]:
                    print(json.dumps(asdict(fuzzer.case(case))), file=file, flush=True)
            os._exit(0)
        children.append(child)
    for child in children:
        os.waitpid(child, 0)
    found = [
        Outcome(**{**entry, "faults": tuple(entry["faults"])})
        for number in range(processes)
        for entry in map(json.loads, (place / f"outcomes-{number}").read_text().splitlines())
    ]
    return sorted(found, key=lambda outcome: outcome.case)


def _report(found: list[Outcome], print_line: Callable[[str], None]) -> None:
    print_line(f"{'folder':14}{'cases':>7}{'exit 0':>8}{'1':>6}{'2':>6}{'3':>6}{'other':>7}"
               f"{'failed':>8}{'slowest':>9}{'most MB':>9}")  # fmt: skip
    for kind in (*COMMANDS, ""):
        part = [outcome for outcome in found if kind in ("", outcome.kind)]
        if part:
            codes = Counter(min(outcome.code, 4) if outcome.code >= 0 else 4 for outcome in part)
            print_line(
                f"{kind or 'all':14}{len(part):7}{codes[0]:8}{codes[1]:6}{codes[2]:6}{codes[3]:6}"
                f"{codes[4]:7}{sum(bool(outcome.faults) for outcome in part):8}"
                f"{max(outcome.seconds for outcome in part):8.2f}s"
                f"{max(outcome.megabytes for outcome in part):9.0f}"
            )
    for outcome in found:
        if outcome.faults:
            print_line(f"case {outcome.case}: {', '.join(outcome.faults)}: {outcome.what}")


def main() -> int:
    """Runs all cases and prints what came of them."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--cases", type=int, default=3000)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    chosen = parser.parse_args()
    started, before = time.perf_counter(), Path.cwd()
    memory = Path("/dev/shm")  # where nothing waits for a disk
    with tempfile.TemporaryDirectory(dir=memory if memory.is_dir() else None) as name:
        place = Path(name)
        cases = range(chosen.first, chosen.first + chosen.cases)
        found = outcomes(Fuzzer(place, chosen.seed), cases, chosen.processes, place)
        os.chdir(before)
    _report(found, print)
    print(f"{len(found)} of {len(cases)} cases in {time.perf_counter() - started:.0f} s")
    return int(len(found) < len(cases) or any(outcome.faults for outcome in found))


if __name__ == "__main__":
    sys.exit(main())
