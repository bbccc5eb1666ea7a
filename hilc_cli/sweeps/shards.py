"""Parts of a sweep that are computed apart, and put together again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from hilc_cli.errors import MissingFileError, UsageError
from hilc_cli.files import read_file
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.folder import INITIAL_INPUT, SCENARIO
from hilc_cli.results.reading import damaged
from hilc_cli.results.tables import read_stored_input
from hilc_cli.sweeps.chunks import Chunk, Failure
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.store import FolderStore
from hilc_cli.sweeps.work_folder import WORK_FOLDER

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


class Merged:
    """The stores of all shards of a sweep as one.

    Attributes:
        header: What they say of the sweep.
        cases: The cases of the sweep.
    """

    def __init__(self, stores: Sequence[FolderStore]) -> None:
        self._stores = sorted(stores, key=lambda store: store.cases)
        self.header = stores[0].header
        try:
            self.cases = self.header.of_all
        except ValueError as error:
            raise damaged(stores[0].folder / WORK_FOLDER.manifest, f"axes: {error}") from None

    def rows(self) -> Floats:
        """All rows, shape (cases, columns)."""
        return np.concatenate([store.rows() for store in self._stores])

    def errors(self) -> Iterator[Floats]:
        """The maximum errors of all cases, iteration by iteration."""
        for parts in zip(*(store.errors() for store in self._stores), strict=True):
            yield np.concatenate(parts)

    def failures(self) -> list[Failure]:
        """Cases that have failed, in order."""
        return [failure for store in self._stores for failure in store.failures()]


def merge(stores: Sequence[FolderStore]) -> Merged:
    """The shards of a sweep as one.

    Args:
        stores: Of all shards, in any order.

    Raises:
        UsageError: They are not all the shards of one sweep, or one is not finished.
    """
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
    return Merged(stores)


def read_scenario(folder: Path) -> str:
    """The resolved scenario of a shard, with its sweep, as text.

    Raises:
        HilcError: It cannot be read, or is no text.
    """
    try:
        return read_file(folder / SCENARIO, _MOST_SCENARIO_BYTES).decode("utf-8")
    except UnicodeDecodeError:
        raise damaged(folder / SCENARIO, "it is no UTF-8 text") from None


def read_initial_input(folder: Path) -> tuple[float, Floats, Floats] | None:
    """Sample time, left and right wheel speeds of a shard's input file, if it has one."""
    try:
        return read_stored_input(folder / INITIAL_INPUT)
    except MissingFileError:
        return None
