"""Disturbances drawn in vector lanes: the numbers that `disturbance.streams` draws.

Each function draws three numbers for each of some samples, for all lanes.
"""

from __future__ import annotations

from typing import Any

from numpy import uint64

from hilc_cli.disturbance.normal import (
    NEAR,
    centre_and_tail,
    chosen,
    cubic,
    depth,
    far_quantile,
    near_quantile,
    polynomial,
    quantile,
)
from hilc_cli.disturbance.streams import (
    ROUNDS,
    Stream,
    Words as WordArray,
    mixed,
    open_unit_interval,
)
from hilc_cli.engine.lanes.lanes import LANES, Field, Noise, NoiseField, Words
from hilc_cli.engine.lanes.machine_code import LIBERTIES, compiled, formula, use_widest_vectors
from hilc_cli.numba_loading import overload, register_jitable
from hilc_cli.reference.sampled import Floats


@overload(chosen)
def _chosen(condition, yes, no):  # type: ignore[no-untyped-def]  # Numba compares signatures
    return lambda condition, yes, no: yes if condition else no


for part in (cubic, polynomial, near_quantile, far_quantile):
    register_jitable(fastmath=set(LIBERTIES), error_model="numpy", forceinline=True)(part)
FORMULAS = (mixed, open_unit_interval, centre_and_tail, depth, near_quantile, quantile)
_mixed, _open_unit_interval, _centre_and_tail, _depth, _near_quantile, _quantile = [
    formula(f) for f in FORMULAS
]

W = LANES
KEYS = int(Words.KEYS) * W
NONE, UNIFORM, NORMAL = 0, 1, 2


def _drawing(stream: Stream, source: Field, target: Noise) -> Any:
    """The function that draws one disturbance; its places in the arrays are constants in it."""
    stream_word, passes = uint64(int(stream)), (int(Words.PASS) + int(stream)) * W
    bounds = (int(source) + int(NoiseField.BOUND)) * W
    insides = (int(source) + int(NoiseField.INSIDE)) * W
    belows = (int(source) + int(NoiseField.BELOW)) * W
    deviations = (int(source) + int(NoiseField.DEVIATION)) * W
    target_row, depths = int(target) * W, int(Noise.DEPTH) * W

    def draw(
        noise: Floats, lanes: Floats, words: WordArray, kind: int, first: int, count: int
    ) -> None:
        """Draws x, y and heading of some samples for all lanes.

        Args:
            noise: Where they go, see `Noise`.
            lanes: The lane array.
            words: The whole numbers of the lanes, see `Words`.
            kind: NONE, UNIFORM or NORMAL.
            first: The first of the samples.
            count: How many, at most BLOCK.
        """
        use_widest_vectors()
        if kind == NONE:
            return
        # Two samples at once: the rounds of one fill the time that those of the other wait.
        for pair in range((count + 1) // 2):
            sample = uint64(first + 2 * pair)
            next_sample = uint64(first + 2 * pair + 1)
            to = target_row + 6 * W * pair
            for j in range(W):
                a0, a1, a2, a3 = sample, words[passes + j], stream_word, uint64(0)
                b0, b1, b2, b3 = next_sample, words[passes + j], stream_word, uint64(0)
                for r in range(ROUNDS):
                    k0, k1 = words[KEYS + 2 * r * W + j], words[KEYS + (2 * r + 1) * W + j]
                    a0, a1, a2, a3 = _mixed(a0, a1, a2, a3, k0, k1)
                    b0, b1, b2, b3 = _mixed(b0, b1, b2, b3, k0, k1)
                noise[to + j] = 2.0 * _open_unit_interval(a0) - 1.0
                noise[to + W + j] = 2.0 * _open_unit_interval(a1) - 1.0
                noise[to + 2 * W + j] = 2.0 * _open_unit_interval(a2) - 1.0
                noise[to + 3 * W + j] = 2.0 * _open_unit_interval(b0) - 1.0
                noise[to + 4 * W + j] = 2.0 * _open_unit_interval(b1) - 1.0
                noise[to + 5 * W + j] = 2.0 * _open_unit_interval(b2) - 1.0
        for i in range(count):
            to = target_row + 3 * W * i
            if kind == UNIFORM:
                for j in range(3 * W):
                    noise[to + j] = lanes[bounds + j] * noise[to + j]
            else:
                # In two loops, for the processor to find more to do at once.
                far = False
                for j in range(3 * W):
                    noise[to + j], tail = _centre_and_tail(
                        noise[to + j], lanes[insides + j], lanes[belows + j]
                    )
                    noise[depths + j] = _depth(tail)
                    far |= noise[depths + j] > NEAR
                # Never so where the bound is three deviations or less, and else in few samples.
                if far:
                    for j in range(3 * W):
                        number = _quantile(noise[to + j], noise[depths + j])
                        bound = lanes[bounds + j]
                        noise[to + j] = min(max(lanes[deviations + j] * number, -bound), bound)
                else:
                    for j in range(3 * W):
                        number = _near_quantile(noise[to + j], noise[depths + j])
                        bound = lanes[bounds + j]
                        noise[to + j] = min(max(lanes[deviations + j] * number, -bound), bound)

    return compiled(draw)


draw_state = _drawing(Stream.STATE, Field.STATE, Noise.STATE)
draw_output = _drawing(Stream.OUTPUT, Field.OUTPUT, Noise.OUTPUT)
draw_pose = _drawing(Stream.INITIAL_POSE, Field.POSE, Noise.POSE)
