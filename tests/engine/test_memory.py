"""A long run holds one iteration at a time."""

from __future__ import annotations

import tracemalloc

from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.loop import simulate
from tests.engine.experiments import LIMIT, experiment_of, law_of
from tests.reference.paths import paper_reference


def test_memory_does_not_grow_with_the_number_of_iterations() -> None:
    # 20 samples: a trial is about 1 kB, so that 400 of them kept would be 400 kB.
    experiment = experiment_of(
        paper_reference("circle", 0.1),
        law_of(0.5, 0.25, 0.25),
        iterations=500,
        speed_limit=LIMIT,
        disturbance=Disturbance(1, state=Bounded((0.01, 0.01, 0.01))),
    )
    iterations = simulate(experiment)
    tracemalloc.start()
    try:
        for _ in range(100):
            next(iterations)
        early, _ = tracemalloc.get_traced_memory()
        tracemalloc.reset_peak()
        for _trial in iterations:
            pass
        late, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert late - early < 20_000
    assert peak - early < 50_000
