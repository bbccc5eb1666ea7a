"""A page of all kinds of pictures, each drawn by the command below it while the site is built."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from hilc_cli.leaderboards.folder import LEADERBOARD_PICTURE
from hilc_cli.paper.contents import FIGURE_NAMES
from hilc_cli.paths.showing import PICTURE as PATH_PICTURE
from hilc_cli.results.picture_kinds import MOVING_PICTURES, RUN_PICTURES, SWEEP_PICTURES
from website.rst import code, heading, literal, page

PAGE = "docs/reference/gallery.rst"
PICTURES = "docs/reference/pictures"


@dataclass(frozen=True)
class Step:
    """A command of the gallery, and what it draws.

    Attributes:
        command: As a user types it.
        folder: Where its pictures are.
        kinds: The pictures, by their files' names without the ending.
        kept: A picture of `docs/images` that shows it, for what takes too long for each build.
    """

    command: str
    folder: str
    kinds: tuple[str, ...]
    kept: str = ""


RUN = "norm-optimal-arc-and-line"
SWEEP = "hilc sweep example:fig8a --vary controller.gains.l1"
STEPS = (
    Step("hilc show example:slalom", "runs/slalom-path", (PATH_PICTURE,)),
    Step("hilc check example:fig7a --simulate --plot", "runs/fig7a-check", ("transient",)),
    Step(f"hilc run example:{RUN}", f"runs/{RUN}", tuple(RUN_PICTURES)),
    Step(
        f"hilc plot runs/{RUN} --kind animation --width 12cm --out runs/moving",
        "runs/moving", tuple(MOVING_PICTURES),
    ),
    Step(f"{SWEEP}=0.05:5:60:log --out runs/gains", "runs/gains", ("curve",)),
    Step(
        f"{SWEEP}=0.05:5:25:log --vary controller.gains.l2=0.05:5:25:log --tolerance 20cm "
        "--out runs/two-gains",
        "runs/two-gains", ("map",),
    ),
    Step(
        f"{SWEEP}=0.05:5 --vary controller.gains.l2=0:5 --vary controller.gains.l3=0:1 "
        "--sample sobol --cases 256 --out runs/three-gains",
        "runs/three-gains", ("effects", "best"),
    ),
    Step(
        "hilc sweep example:fig8a --vary robot.wheel_radius=0.15:0.25:41 --bands --out runs/radii",
        "runs/radii", ("bands",),
    ),
    Step(
        f"{SWEEP}=0.05:5:25:log --vary robot.wheel_radius=0.15:0.25:11 "
        "--over robot.wheel_radius --robust worst --out runs/choices",
        "runs/choices", ("spread",),
    ),
    Step(
        f"{SWEEP}=0.01:10:log --vary controller.gains.l2=0:20 --minimise max_position_error_m "
        "--cases 60 --out runs/tuned",
        "runs/tuned", ("search",),
    ),
    Step("hilc run example:pd-arc-and-line --no-plots", "", ()),
    Step(
        f"hilc compare runs/{RUN} runs/pd-arc-and-line --out runs/both",
        "runs/both", ("comparison",),
    ),
    Step(
        "hilc compare --laws example:leaderboard",
        "runs/leaderboard", (LEADERBOARD_PICTURE,), kept="laws.png",
    ),
    Step(f"hilc report runs/{RUN}", "", ("report",), kept="report.png"),
    *(
        Step(f"hilc reproduce {name}", "runs/paper", (name,), kept=f"paper/{name}-literal.png")
        for name in FIGURE_NAMES
    ),
)  # fmt: skip
"""All commands of the gallery in the order in which they are run."""

WORDS = {
    PATH_PICTURE: "a path before it is driven: speed, curvature, what the wheels need",
    "transient": "the error that theory predicts for each iteration, beside the simulated one",
    "comparison": "several runs side by side",
    LEADERBOARD_PICTURE: "several laws on the same cases",
    "report": "a page for a browser on which passes can be played",
    **{
        kind.name: kind.shows
        for kinds in (RUN_PICTURES, MOVING_PICTURES, SWEEP_PICTURES)
        for kind in kinds.values()
    },
    **{name: f"figure {name.removeprefix('fig')} of the paper" for name in FIGURE_NAMES},
}
"""What each picture shows; of runs and sweeps as the program says it."""


def forgotten() -> set[str]:
    """Returns the kinds of pictures for which there is no command here."""
    drawn = {kind for step in STEPS for kind in step.kinds}
    return set(WORDS) - drawn


def write_page(folder: Path, *, draw: bool) -> str:
    """Writes the page, and returns its name.

    Args:
        folder: Where all pages are.
        draw: Whether to run the commands; without, only pictures that are kept are shown.

    Raises:
        ValueError: A kind of picture has no command.
        RuntimeError: A command fails, or does not draw what it is here for.
    """
    if forgotten():
        raise ValueError(f"website/gallery.py: no command draws {sorted(forgotten())}")
    pictures = folder / PICTURES
    pictures.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory() as work:
        for step in STEPS:
            _make(step, Path(work), pictures, draw=draw)
    return page(folder, PAGE, _lines(pictures))


def _make(step: Step, work: Path, pictures: Path, *, draw: bool) -> None:
    """Puts the pictures of a step in their place."""
    if step.kept or not draw:
        return
    done = subprocess.run(
        [sys.executable, "-m", "hilc_cli", *shlex.split(step.command)[1:]],
        cwd=work,
        env={**os.environ, "NO_COLOR": "1"},
        capture_output=True,
        text=True,
    )
    if done.returncode:
        raise RuntimeError(f"{step.command}: exit code {done.returncode}: {done.stderr}")
    for kind in step.kinds:
        made = _picture(work / step.folder, kind)
        if made is None:
            raise RuntimeError(f"{step.command}: draws no {kind}")
        shutil.copyfile(made, pictures / made.name)


def _picture(folder: Path, kind: str) -> Path | None:
    """Returns the file of a picture; None if there is none."""
    files = (folder / f"{kind}.{ending}" for ending in ("png", "gif"))
    return next((file for file in files if file.is_file()), None)


def _lines(pictures: Path) -> Iterator[str]:
    yield from heading("Gallery", "=")
    yield (
        "Every kind of picture, with the command that draws it. Unless it says otherwise, "
        "each was drawn when this site was built; ``--format svg`` and ``pdf`` draw it for print.\n"
    )
    for step in STEPS:
        for kind in step.kinds:
            yield from heading(kind, "-")
            yield f"{literal(WORDS[kind])[:1].upper()}{literal(WORDS[kind])[1:]}.\n"
            yield from code(step.command, "sh")
            if step.kept:
                yield "Drawn before, since the command takes longer than a build may.\n"
            file = _picture(pictures, kind)
            place = f"/docs/images/{step.kept}" if step.kept else file and f"pictures/{file.name}"
            if place:
                yield f".. image:: {place}\n   :alt: {literal(WORDS[kind])}\n   :loading: lazy\n"
