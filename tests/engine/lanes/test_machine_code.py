"""What the compiler makes of the lane loops."""

import re
from typing import Any

import llvmlite.binding as llvm
import numpy as np
import pytest
from numpy.typing import NDArray

from hilc_cli.engine.lanes import kernel, noise
from hilc_cli.engine.lanes.lanes import FIELDS, HISTORY_FIELDS, LANES, NOISE_ROWS, WORD_ROWS
from hilc_cli.engine.lanes.machine_code import compiled
from hilc_cli.engine.lanes.packs import aligned

ARITHMETIC = r"\b(?:vfm\w+pd|vfnm\w+pd|vmulpd|mulpd|fmla|fmul)\b"
DIVISIONS = r"\b(?:vdivpd|divpd|fdiv\s+v)\w*"
PRODUCTS_OF_WORDS = r"\b(?:vpmuludq|pmuludq|umull)\b"


def lane_arrays() -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    return (
        aligned(FIELDS * LANES, np.float64),
        aligned(WORD_ROWS * LANES, np.uint64),
        aligned(NOISE_ROWS * LANES, np.float64),
    )


@pytest.fixture(scope="module", params=[None, True], ids=["quiet", "disturbed"])
def pass_assembly(request: pytest.FixtureRequest) -> str:
    # Compiled anew: code from the cache cannot be looked into.
    fresh = compiled(kernel.follow.py_func)
    lanes, words, drawn = lane_arrays()
    x = np.linspace(0, 1, 9)
    history = aligned(10 * HISTORY_FIELDS * LANES, np.float64)
    disturbed = request.param
    flags = (*(None,) * 5, disturbed, *(None,) * 7, -1, 0, disturbed, False)
    fresh(lanes, words, drawn, history, x, x, x, *flags, noise.NORMAL, noise.NORMAL)
    (assembly,) = fresh.inspect_asm().values()
    return str(assembly)


def test_pass_over_the_trajectory_is_vector_code(pass_assembly: str) -> None:
    assert len(re.findall(ARITHMETIC, pass_assembly)) > 30
    assert re.search(DIVISIONS, pass_assembly)  # of the speed limit


def test_disturbances_are_drawn_by_vector_code() -> None:
    lanes, words, drawn = lane_arrays()
    noise.draw_state(drawn, lanes, words, noise.NORMAL, 0, 1)
    (assembly,) = noise.draw_state.inspect_asm().values()
    assert len(re.findall(PRODUCTS_OF_WORDS, assembly)) >= 18  # two a round; the first is constant
    assert len(re.findall(ARITHMETIC, assembly)) > 30
    assert re.search(DIVISIONS, assembly)


@pytest.mark.skipif(
    not llvm.get_host_cpu_features().get("avx512dq"), reason="no 512-bit vectors here"
)
def test_vectors_have_512_bits_where_the_processor_has_them(pass_assembly: str) -> None:
    wide = [line for line in pass_assembly.splitlines() if re.search(ARITHMETIC, line)]
    assert sum("zmm" in line for line in wide) > len(wide) / 2
