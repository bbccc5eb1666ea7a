"""Which runs of a leaderboard are computed side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import zip_longest
from typing import NamedTuple

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.kinds import Kind, Member, joined, kinds_of, offered
from hilc_cli.engine.lanes.lanes import LANES
from hilc_cli.leaderboards.plan import Contest
from hilc_cli.numba_loading import DISABLED

_PAYS = 5_000_000
"""Samples of runs from which on lanes are worth the seconds in which they are compiled, once: the
loop engine takes about one for them, each time."""

_FEWEST = 8
"""Runs from which on lanes, most of which would be empty otherwise, are faster by far."""

_LONGEST = 20_000
"""Samples of a trajectory up to which the numbers of all lanes stay near the processor."""

_MOST = 8 * LANES
"""The most runs of a heat, so that many are shared out among workers."""


class Heat(NamedTuple):
    """Runs that are computed together.

    Attributes:
        contests: The runs.
        kind: What they have in common to be run in lanes; None for one that the loop engine runs.
    """

    contests: tuple[Contest, ...]
    kind: Kind | None = None


def experiment_of(contest: Contest) -> Experiment:
    """What is run.

    Where all iterations are the same, since nothing is learned and nothing disturbed, one is run
    and stands for all.
    """
    spec, experiment = contest.scenario.spec, contest.scenario.experiment()
    same = not spec.controller.learns and not spec.disturbance.active
    return replace(experiment, iterations=0) if same else experiment


def heats(contests: Sequence[Contest]) -> list[Heat]:
    """All runs in the order in which they are best begun.

    First comes one of each law that is run alone, then those that take lanes: so what there is to
    compile is mostly compiled by one worker, not by all of them at the same time.

    Laws and cases share machine code as far as they can, since that takes seconds to compile. So
    which engine computes a run, and what else it could, depends on the other runs: by the last
    digits of errors, and by what grows out of those where a law leads to chaos.
    """
    members = {
        number: member
        for number, member in enumerate(map(_member, contests))
        if member is not None and member.experiment.reference.samples <= _LONGEST
    }
    kinds = joined(list(kinds_of(list(members.values()), own_references=True)))
    alike: dict[tuple[float, Kind], list[int]] = {}
    for (number, member), kind in zip(members.items(), kinds, strict=True):
        alike.setdefault((member.experiment.reference.sample_time, kind), []).append(number)
    alone = dict(enumerate(contests))
    rounds: list[list[Heat]] = []
    for (_, kind), numbers in alike.items():
        if len(numbers) >= _FEWEST and sum(_samples(members[each]) for each in numbers) >= _PAYS:
            runs = [alone.pop(number) for number in numbers]
            parts = range(0, len(runs), _MOST)
            rounds.append([Heat(tuple(runs[first : first + _MOST]), kind) for first in parts])
    in_lanes = [heat for each in zip_longest(*rounds) for heat in each if heat is not None]
    begun: dict[type[object], int] = {}
    for number, contest in alone.items():
        begun.setdefault(type(contest.scenario.spec.controller), number)
    firsts = [Heat((alone.pop(number),)) for number in begun.values()]
    return [*firsts, *in_lanes, *(Heat((contest,)) for contest in alone.values())]


def _member(contest: Contest) -> Member | None:
    """What a run offers to lanes; None where it offers nothing, or cannot even be made."""
    if DISABLED:
        return None
    try:
        return offered(experiment_of(contest))
    except Exception:  # of any law or plant; it is told when the run is to be computed
        return None


def _samples(member: Member) -> int:
    return member.experiment.reference.samples * (member.experiment.iterations + 1)
