"""Parts of a sweep that are computed apart, and put together again."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack, closing
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from hilc_cli.errors import UsageError
from hilc_cli.files import folder_to_read, is_there, read_file
from hilc_cli.results.folder import COMPILED_WITH, INITIAL_INPUT, SCENARIO, origin
from hilc_cli.results.reading import damaged
from hilc_cli.results.tables import read_stored_input
from hilc_cli.scenario.loading import ScenarioSource
from hilc_cli.sweeps.chunks import Chunk, Failure
from hilc_cli.sweeps.compute import Execution, compute
from hilc_cli.sweeps.data import collect
from hilc_cli.sweeps.one_case import best_yaml, read_resolved
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.planning import plan_sweep
from hilc_cli.sweeps.store import WORK_FOLDER, FolderStore
from hilc_cli.sweeps.sweeping import DEFAULT, Sweep, as_fields, opened_store

_MOST_SCENARIO_BYTES = 1_000_000_000  # a million values of a key are in it


def shard_cases(cases: int, number: int, shards: int) -> Chunk:
    """The cases of one shard: all shards have nearly the same number, in order.

    Args:
        cases: Number of all cases.
        number: Of the shard, from 1.
        shards: How many there are.

    Raises:
        UsageError: There is no such shard, or it would be empty.
    """
    if not 1 <= number <= shards:
        raise UsageError(f"--shard {number}/{shards}: K must be from 1 to N, such as 1/3")
    if shards > cases:
        raise UsageError(
            f"--shard {number}/{shards}: there are only {cases} cases; make fewer shards"
        )
    return Chunk(cases * (number - 1) // shards, cases * number // shards)


def check_shardable(plan: Plan) -> None:
    """Whether parts of a sweep can be computed apart.

    Raises:
        UsageError: They cannot: it is a search.
    """
    if plan.searches:
        raise UsageError(
            "a search has no shards: each case follows from those before it; "
            "leave out --shard, or draw the cases with --sample instead of --minimise"
        )


def sweep_shard(
    plan: Plan | ScenarioSource,
    shard: tuple[int, int],
    folder: str | Path,
    how: Execution = DEFAULT,
    *,
    resume: bool = False,
    force: bool = False,
) -> list[Failure]:
    """Runs one of several parts of a sweep, for `merge_shards`.

    Args:
        plan: As for `sweep`, the same for all parts.
        shard: ``(K, N)``: the K-th of N parts, counted from 1.
        folder: Where its results stay.
        how: As for `sweep`.
        resume: As for `sweep`.
        force: As for `sweep`.

    Returns:
        The cases that have failed.

    Raises:
        UsageError: There is no such part.
        HilcError: As for `sweep`.
    """
    plan = plan if isinstance(plan, Plan) else plan_sweep(plan)
    check_shardable(plan)
    cases = shard_cases(len(plan.cases), *shard)
    name = f"{shard[0]}/{shard[1]}"
    with opened_store(plan, folder, cases, name, resume=resume, force=force) as store:
        compute(plan, store, how)
        return store.failures()


def merge_shards(
    folders: Sequence[str | Path], *, go_on: Callable[[], None] = lambda: None
) -> Sweep:
    """The results of a sweep from those of its shards.

    Args:
        folders: Of all shards, in any order.
        go_on: Called now and then; may raise to stop.

    Raises:
        UsageError: They are not all the shards of one sweep, or not finished.
        HilcError: One cannot be read.
    """
    started = datetime.now(UTC)
    places = [folder_to_read(Path(folder)) for folder in folders]
    twice = next(
        (folder for folder, n in zip(folders, places, strict=True) if places.count(n) > 1), None
    )
    if twice is not None:
        raise UsageError(f"{twice}: is given more than once; give each shard once")
    with ExitStack() as stack:
        stores = [
            stack.enter_context(closing(FolderStore(Path(folder), read_only=True)))
            for folder in folders
        ]
        _check_whole(stores)
        header = stores[0].header
        try:
            cases = header.of_all
        except ValueError as error:
            raise damaged(stores[0].folder / WORK_FOLDER.manifest, f"axes: {error}") from None
        stores.sort(key=lambda store: store.cases)
        errors = zip(*(store.errors() for store in stores), strict=True)
        data = collect(
            header.name,
            cases,
            np.concatenate([store.rows() for store in stores]),
            map(np.concatenate, errors) if header.bands else None,
            header.tolerance_m,
            header.metric,
            header.path_size_m,
            header.over,
            header.robust,
            go_on,
        )
        scenario = _read_scenario(Path(folders[0]))
        given = Path(folders[0]) / INITIAL_INPUT
        return Sweep(
            **as_fields(data),
            failures=tuple(failure for store in stores for failure in store.failures()),
            checksum=header.checksum,
            scenario_yaml=scenario,
            best_yaml=best_yaml(data, read_resolved(scenario, Path(folders[0]) / SCENARIO)),
            initial_input=read_stored_input(given) if is_there(given) else None,
            how={**origin(started, COMPILED_WITH), "shards": len(stores)},
        )


def _check_whole(stores: Sequence[FolderStore]) -> None:
    """Makes sure that some stores are all the shards of a sweep, and finished."""
    first = stores[0]
    position = 0
    searched = next((store.folder for store in stores if store.header.minimise), None)
    if searched is not None:
        raise UsageError(f"{searched}: is a search under way, no shard; finish it with --resume")
    for store in sorted(stores, key=lambda store: store.cases):
        if store.header.checksum != first.header.checksum:
            raise UsageError(
                f"{store.folder}: is a shard of another sweep than {first.folder}; "
                "give the shards of one scenario, sweep and version of hilc"
            )
        if store.cases.first < position:
            raise UsageError(f"{store.folder}: holds cases that another shard holds too")
        if store.cases.first > position:
            missing = Chunk(position, store.cases.first)
            raise UsageError(f"no shard holds {missing}; give all shards of the sweep")
        position = store.cases.last
        if store.missing():
            raise UsageError(f"{store.folder}: lacks {store.missing()[0]}; finish it with --resume")
    if position < first.header.cases:
        missing = Chunk(position, first.header.cases)
        raise UsageError(f"no shard holds {missing}; give all shards of the sweep")


def _read_scenario(folder: Path) -> str:
    """The resolved scenario of a shard, with its sweep, as text."""
    try:
        return read_file(folder / SCENARIO, _MOST_SCENARIO_BYTES).decode("utf-8")
    except UnicodeDecodeError:
        raise damaged(folder / SCENARIO, "it is no UTF-8 text") from None
