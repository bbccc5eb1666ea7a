"""What the derivative does to learning: the tables and figures of docs/why-tau.md, by simulation.

    python benchmarks/why_tau.py [--write]

Prints what `hilc check` says of waves beside what simulations do: what an iteration multiplies a
small wave of the wheel speeds by, on either side of the bound of l1, and what is left after all
iterations with the tau that it advises. With --write the tables go into the page, the figures
beside it. It takes about a minute.
"""

from __future__ import annotations

import argparse
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray

import hilc_cli as hilc
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.batch import simulate_many
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.plants.kinematic import feedforward
from hilc_cli.theory.laws.hybrid_waves import HybridWaves, iteration_response
from hilc_cli.theory.learning.gains import loop_gains_of
from hilc_cli.theory.linear_law import linear_law

Floats = NDArray[np.float64]

PAGE = Path(__file__).resolve().parents[1] / "docs" / "why-tau.md"
SCENARIOS = (
    *("fig3-circle", "fig3-arc-and-line", "fig3-cardioid", "fig3-spiral"),
    *("fig6a", "fig6e", "fig7c", "fig8a", "fig8b", "rounded-square"),
)
WAVE = 1e-3  # of the heading's error [rad]: far within what is linear
COLORS = ("#000000", "#D55E00", "#0072B2", "#009E73")  # told apart by the colour blind
DASHES = ("-", (0, (6, 2)), (0, (3, 1, 1, 1)), (0, (1, 1)))


def experiment(name: str, changes: dict[str, float] | None = None) -> Experiment:
    """A shipped scenario without its speed limit."""
    return hilc.load_scenario(
        f"example:{name}", {"controller.b_w": None, **(changes or {})}
    ).experiment()


def law_of(each: Experiment) -> HybridLaw:
    """The law of an experiment, which is a hybrid one."""
    return cast("HybridLaw", each.law)


def with_gains(each: Experiment, l1: float, tau: float) -> Experiment:
    """An experiment with another l1 and another tau."""
    return replace(each, law=replace(law_of(each), l1=l1, derivative=tau))


def waves_of(each: Experiment) -> HybridWaves:
    """What the check says of the waves of an experiment."""
    return HybridWaves(each, law_of(each), linear_law(each).feedback)


# --- what an iteration multiplies a wave by ------------------------------------------------------


def turning_wave(each: Experiment, frequency: float, iterations: int) -> Experiment:
    """An experiment that begins with the right wheel speeds and a small wave in turning.

    Args:
        each: The experiment.
        frequency: Of the wave [Hz].
        iterations: How many are run.
    """
    reference, robot = each.reference, each.robot
    left, right = feedforward(reference, robot)
    omega = 2 * math.pi * frequency
    times = reference.sample_time * np.arange(reference.samples)
    rate = WAVE * omega * np.cos(omega * times)  # of the heading [rad/s]
    wheel = rate * robot.signed_half_track / robot.wheel_radius
    start = (float(reference.x[0]), float(reference.y[0]), float(reference.heading[0]))
    return replace(
        each,
        initial_left=left + wheel,
        initial_right=right - wheel,
        initial_pose=start,
        iterations=iterations,
    )


def measured_factors(each: Experiment, frequency: float, iterations: int = 4) -> Floats:
    """What each iteration of a simulation multiplies a wave of the wheel speeds by.

    The last third of the path is looked at, where little is left of the wave's beginning: there a
    wave and a polynomial of third degree are fitted to the turning of the wheels.
    """
    made = turning_wave(each, frequency, iterations)
    right_left, right_right = feedforward(made.reference, made.robot)
    times = made.reference.sample_time * np.arange(made.reference.samples)
    window = slice(2 * len(times) // 3, None)
    t = times[window]
    basis = np.stack(
        [np.exp(1j * 2 * math.pi * frequency * t), *((t - t.mean()) ** power for power in range(4))]
    )
    system = np.concatenate([basis[:1].real, basis[:1].imag, basis[1:].real]).T
    sizes = []
    for trial in simulate(made):
        turning = (trial.left - right_left) - (trial.right - right_right)
        cos, sin, *_ = np.linalg.lstsq(system, turning[window], rcond=None)[0]
        sizes.append(math.hypot(cos, sin))
    factors: Floats = np.array(sizes[1:]) / np.array(sizes[:-1])
    return factors


def predicted_factor(each: Experiment, frequency: float) -> float:
    """What the theory has for it, of waves in turning with the model that the law has."""
    law, d = law_of(each), each.reference.sample_time
    loop = loop_gains_of(each, law.matrix)[:1]
    turning = each.robot.wheel_radius / each.robot.signed_half_track * law.matrix.coefficients[6]
    nearest = loop[:, [int(np.abs(loop[0] - turning).argmin())]]
    phase = np.array([2 * math.pi * frequency * d])
    learned, fed_back = iteration_response(law, linear_law(each).feedback, d, nearest, phase)
    return float(np.abs(learned / fed_back)[0, 0])


@dataclass(frozen=True)
class WaveRow:
    """A wave in a scenario with certain gains, predicted and measured."""

    name: str
    l1: float
    tau: float
    frequency: float
    predicted: float
    measured: float


def wave_rows() -> Iterator[WaveRow]:
    """Waves on either side of where they learn, and of the bound of l1."""
    for name in SCENARIOS:
        plain = experiment(name)
        nyquist = 0.5 / plain.reference.sample_time
        tau, _ = waves_of(plain).suggested or (0.1, None)
        cases = [(law_of(plain).l1, 0.0), (law_of(plain).l1, tau)]
        bound = waves_of(plain).bound(tau)
        cases += [(0.95 * bound, tau), (1.05 * bound, tau)]
        for l1, each_tau in cases:
            each = with_gains(plain, l1, each_tau)
            frequencies = (nyquist / 25, nyquist / 2.5) if l1 < bound / 2 else (nyquist / 2.5,)
            for frequency in frequencies:
                measured = measured_factors(each, frequency)
                yield WaveRow(
                    name,
                    l1,
                    each_tau,
                    frequency,
                    predicted_factor(each, frequency),
                    float(np.exp(np.log(measured).mean())),
                )


# --- what is left in the end ---------------------------------------------------------------------


@dataclass(frozen=True)
class EndRow:
    """What is left after all iterations: as shares of the path's size."""

    name: str
    l1: float
    iterations: int
    told: tuple[float, float] | None
    left: tuple[float, float, float]


def end_rows() -> list[EndRow]:
    """The error of each scenario with tau 0 and as advised, and with l1 beyond the bound."""
    rows, experiments = [], []
    for name in SCENARIOS:
        plain = experiment(name)
        waves = waves_of(plain)
        tau = None if waves.suggested is None else waves.suggested[0]
        told = None if tau is None else (tau, waves.bound(tau))
        rows.append((name, plain, told))
        derived = tau or 0.0
        experiments += [
            plain,
            with_gains(plain, law_of(plain).l1, derived),
            with_gains(plain, 1.1 * waves.bound(derived), derived),
        ]
    found = simulate_many(experiments)
    return [
        EndRow(
            name,
            law_of(plain).l1,
            plain.iterations,
            told,
            cast(
                "tuple[float, float, float]",
                tuple(
                    float(found.errors[3 * number + part, plain.iterations]) / plain.reference.size
                    for part in range(3)
                ),
            ),
        )
        for number, (name, plain, told) in enumerate(rows)
    ]


# --- tables --------------------------------------------------------------------------------------


def wave_table(rows: list[WaveRow]) -> str:
    """The fastest wave of each scenario and gain as Markdown, and the worst difference of all."""
    lines = [
        "| scenario | wave [Hz] | tau [s] | as it is, tau 0 | with tau | l1 5 % below its bound | "
        "5 % above |",
        "|---|---:|---:|---:|---:|---:|---:|",
    ]
    for name in SCENARIOS:
        own = [row for row in rows if row.name == name]
        fastest = max(row.frequency for row in own)
        cells = [
            f"{row.predicted:.5f} / {row.measured:.5f}" for row in own if row.frequency == fastest
        ]
        lines.append(f"| {name} | {fastest:g} | {own[-1].tau:g} | " + " | ".join(cells) + " |")
    worst = max(abs(row.predicted - row.measured) for row in rows)
    told = f"Of {len(rows)} waves, slower ones included, the two differ by at most {worst:.1g}."
    return "\n".join([*lines, "", told])


def end_table(rows: list[EndRow]) -> str:
    """The rows as Markdown."""
    lines = [
        "| scenario | l1 | iterations | left, tau 0 | advised tau [s] | left with it | l1 below | "
        "left, l1 10 % above |",
        "|---|---:|---:|---:|---:|---:|---:|---:|",
    ]
    for row in rows:
        tau, bound = row.told or (math.nan, math.nan)
        plain, derived, beyond = (share_text(share) for share in row.left)
        lines.append(
            f"| {row.name} | {row.l1:g} | {row.iterations} | {plain} | {tau:g} | {derived} | "
            f"{bound:.3g} | {beyond} |"
        )
    return "\n".join(lines)


def share_text(share: float) -> str:
    """A share in percent; above one in times, and far above as a power of ten."""
    if share <= 1:
        return f"{100 * share:.2g} %"
    if share <= 100:
        return f"{share:.2g} times"
    return f"10^{math.log10(share):.0f} times" if math.isfinite(share) else "infinite"


def marked(name: str, text: str) -> str:
    """A table between its marks in the page."""
    return f"<!-- {name}: by benchmarks/why_tau.py -->\n\n{text}\n\n<!-- end of {name} -->"


def with_table(page: str, name: str, text: str) -> str:
    """The page with another table.

    Raises:
        ValueError: It has no such table.
    """
    pattern = re.compile(rf"<!-- {name}: .*?<!-- end of {name} -->", re.DOTALL)
    if not pattern.search(page):
        raise ValueError(f"{PAGE} has no table {name}")
    return pattern.sub(lambda _: marked(name, text), page)


# --- figures -------------------------------------------------------------------------------------

TAUS = (0.0, 0.02, 0.1, 0.5)
LARGE = (0.01, 0.05, 1.0)  # shares of the path's size between the colors of a map


def new_figure(width: float, height: float) -> Figure:
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def draw_waves() -> Figure:
    """What an iteration leaves of waves, and what iterations leave of the error."""
    figure = new_figure(9.6, 4.6)
    left, right = figure.subplots(1, 2)
    plain = experiment("fig3-circle")
    runs = [replace(with_gains(plain, 1.0, tau), iterations=1000) for tau in TAUS]
    found = simulate_many(runs)
    for tau, each, errors, color, dashes in zip(
        TAUS, runs, found.errors, COLORS, DASHES, strict=True
    ):
        waves, label = waves_of(each).now, f"tau = {tau:g} s"
        left.semilogx(waves.frequency_hz, waves.factor, color=color, ls=dashes, lw=2, label=label)
        points = [4.0, 20.0, 100.0]
        measured = [float(np.exp(np.log(measured_factors(each, f)).mean())) for f in points]
        left.plot(points, measured, "o", color=color, ms=5, mfc="white")
        right.loglog(
            np.arange(1, 1001), errors[1:] / plain.reference.size, color=color, ls=dashes, lw=2
        )
    left.axhline(1, color="0.5", lw=1)
    left.set(xlabel="frequency of the wave [Hz]", ylabel="left by an iteration, times")
    left.set(title="A wave of the error (circles: simulated)", ylim=(0.4, 1.15), xlim=(0.5, 500))
    right.axhline(0.01, color="0.5", lw=1)
    right.text(1.1, 0.009, "1 % of the size", color="0.35", va="top")
    right.set(xlabel="iteration", ylabel="largest error / path's size", xlim=(1, 1000))
    right.set(title="The whole error, simulated", ylim=(1e-3, 3))
    for axes in (left, right):
        axes.grid(color="0.9")
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def draw_maps() -> Figure:
    """What is left for many l1 and tau, of the paper's platform and of another robot."""
    figure = new_figure(9.6, 5.0)
    axes = figure.subplots(1, 2)
    _draw_map(axes[0], "fig3-circle", "Circle of 2 s, no feedback")
    _draw_map(axes[1], "rounded-square", "Small robot, 22 s, with l2 = 3")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    colors = figure.colorbar(axes[0].images[0], ax=list(axes), ticks=[0.5, 1.5, 2.5, 3.5])
    colors.ax.set_yticklabels(["< 1 %", "< 5 %", "< 100 %", "more"])
    colors.set_label("left of the path's size")
    return figure


def _draw_map(axes: Axes, name: str, title: str) -> None:
    plain = experiment(name)
    gains, taus = np.geomspace(0.1, 100, 31), np.geomspace(0.002, 20, 33)
    cases = [with_gains(plain, l1, tau) for tau in taus.tolist() for l1 in gains.tolist()]
    errors = simulate_many(cases).errors[:, plain.iterations]
    shares = np.where(np.isfinite(errors), errors, np.inf) / plain.reference.size
    kinds = np.searchsorted(LARGE, shares).reshape(len(taus), len(gains)) + 0.5
    half = math.sqrt(gains[1] / gains[0]), math.sqrt(taus[1] / taus[0])
    extent = np.log10(
        [gains[0] / half[0], gains[-1] * half[0], taus[0] / half[1], taus[-1] * half[1]]
    )
    axes.imshow(
        kinds,
        origin="lower",
        aspect="auto",
        extent=(extent[0], extent[1], extent[2], extent[3]),
        cmap="cividis_r",
        norm=BoundaryNorm([0, 1, 2, 3, 4], 256),
    )
    worst = np.array([waves_of(each).now.factor.max() for each in cases]).reshape(kinds.shape)
    x, y = np.log10(gains), np.log10(taus)
    bounds = [waves_of(plain).bound(tau) for tau in taus.tolist()]
    axes.plot(np.log10(bounds), y, color="#D55E00", lw=2.5, label="bound of l1")
    axes.contour(x, y, worst, levels=[1.0], colors="black", linestyles="--", linewidths=2)
    axes.plot([], [], color="black", ls="--", lw=2, label="inside: all waves learn")
    advised = [
        (l1, found[0])
        for l1 in gains.tolist()
        if (found := waves_of(with_gains(plain, l1, 0.0)).suggested) is not None
    ]
    axes.plot(
        *np.log10(advised).T, "o", ms=5, color="white", mec="black", label="tau that is advised"
    )
    axes.set(title=title, xlabel="l1", ylabel="tau [s]")
    axes.set(xlim=(extent[0], extent[1]), ylim=(extent[2], extent[3]))
    axes.set_xticks([-1, 0, 1, 2], ["0.1", "1", "10", "100"])
    axes.set_yticks([-2, -1, 0, 1], ["0.01", "0.1", "1", "10"])


FIGURES = {"why-tau-waves.png": draw_waves, "why-tau-map.png": draw_maps}


def main() -> None:
    """Prints the tables; writes them and draws the figures if that is asked for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--write", action="store_true", help="put them into docs/")
    options = parser.parse_args()
    tables = {"waves": wave_table(list(wave_rows())), "ends": end_table(end_rows())}
    print("\n\n".join(tables.values()))
    if not options.write:
        return
    page = PAGE.read_text(encoding="utf-8")
    for name, text in tables.items():
        page = with_table(page, name, text)
    PAGE.write_text(page, encoding="utf-8")
    for name, draw in FIGURES.items():
        draw().savefig(PAGE.parent / "images" / name, dpi=110)


if __name__ == "__main__":
    main()
