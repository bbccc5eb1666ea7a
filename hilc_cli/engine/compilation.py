"""Whether the batch engine has the machine code that experiments need, or must compile it first."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hilc_cli.compiling import is_at_hand
from hilc_cli.engine.batch import arguments, groups
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.iterations import run_iterations
from hilc_cli.engine.lanes import LANES
from hilc_cli.engine.packs import Pack
from hilc_cli.numba_loading import typeof


def is_compiled(experiments: Sequence[Experiment]) -> bool:
    """Whether `simulate_batch` could run these experiments without compiling anything.

    Compiling takes seconds and is done once for each law and kind of disturbance; the code is kept
    in the ``__pycache__`` beside the engine, or in the user's cache folder where that cannot be
    written; the environment variable ``NUMBA_CACHE_DIR`` names another one.

    Args:
        experiments: As for `simulate_batch`.

    Raises:
        UsageError: An experiment has a law that the batch engine does not know.
    """
    signatures = set()
    for kind, members in groups(experiments):
        pack = Pack(experiments[members[0]].reference, kind)
        values = arguments(pack, np.empty((1, LANES)))
        signatures.add(tuple(map(typeof, values)))
    return all(is_at_hand(run_iterations, signature) for signature in signatures)
