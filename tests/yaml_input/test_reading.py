"""Values of ``--set`` that lead into lists which the file leaves out."""

from __future__ import annotations

import pytest

import hilc_cli as hilc

BOUND = "disturbance.output.bound"


def test_entry_of_a_list_that_is_left_out() -> None:
    changes = [f"{BOUND}.0=1 mm", f"{BOUND}.2=0.5"]
    loaded = hilc.load_scenario("example:fig8a", changes)
    assert loaded.spec.disturbance.output.bound == (0.001, 0.0, 0.5)
    assert loaded.spec.disturbance.state.bound == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (f"{BOUND}.3=1", f"{BOUND}.3: is no entry of the list; give a number from 0 to 2"),
        ("disturbance.outputs.bound.0=1", "disturbance.outputs: is an unknown key; did you mean"),
    ],
)
def test_no_such_entry(change: str, message: str) -> None:
    with pytest.raises(hilc.HilcError) as failure:
        hilc.load_scenario("example:fig8a", [change])
    assert str(failure.value).startswith(f"--set {change}: {message}")
