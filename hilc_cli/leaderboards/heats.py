"""Which runs of a leaderboard are computed side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.kinds import Kind, joined, kinds_of, offers_of
from hilc_cli.engine.lanes.lanes import LANES
from hilc_cli.leaderboards.plan import Contest
from hilc_cli.numba_loading import DISABLED

_PAYS = 4_000_000
"""Samples of a heat from which on its lanes are worth the seconds in which they are compiled."""

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
    compile is compiled by one worker each, not by all of them at the same time.

    Laws and cases share machine code as far as they can, since that takes seconds to compile. So
    what runs a contest depends on the others: by the last digits of its errors.
    """
    experiments = [experiment_of(contest) for contest in contests]
    offers = [] if DISABLED else offers_of(experiments)
    members = {number: member for number, member in enumerate(offers) if member is not None}
    kinds = joined(list(kinds_of(list(members.values()), own_references=True)))
    alike: dict[tuple[float, Kind], list[int]] = {}
    for number, kind in zip(members, kinds, strict=True):
        sample_time = experiments[number].reference.sample_time
        alike.setdefault((sample_time, kind), []).append(number)
    in_lanes: list[Heat] = []
    alone = dict(enumerate(contests))
    for (_, kind), numbers in alike.items():
        runs = [experiments[number] for number in numbers]
        if sum(run.reference.samples * (run.iterations + 1) for run in runs) >= _PAYS:
            together = [alone.pop(number) for number in numbers]
            for first in range(0, len(together), _MOST):
                in_lanes.append(Heat(tuple(together[first : first + _MOST]), kind))
    begun = {type(experiments[number].law): number for number in reversed(alone)}
    firsts = [Heat((alone.pop(number),)) for number in reversed(begun.values())]
    return [*firsts, *in_lanes, *(Heat((contest,)) for contest in alone.values())]
