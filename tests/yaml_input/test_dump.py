"""What is written as YAML is read back as it was."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, strategies as st

from hilc_cli.yaml_input.nodes import Source, to_data
from hilc_cli.yaml_input.tree import parse_yaml, to_yaml

TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=40) | st.sampled_from(
    ["", "1e3", "017", "0o17", "0x1F", "no", "true", "null", "~", ".5", "1_0", ".inf", "<<", "="]
)
NUMBERS = st.floats(allow_nan=False, allow_infinity=False) | st.integers(-(2**64), 2**64)
LEAVES = TEXTS | NUMBERS | st.booleans() | st.none()
KEYS = st.from_regex(r"[a-z_]{1,8}", fullmatch=True)
DATA = st.recursive(
    LEAVES,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(KEYS, inner, max_size=4),
    max_leaves=15,
)


def read_back(text: str) -> object:
    return to_data(parse_yaml(text.encode(), Source("f", Path())))


@given(st.dictionaries(KEYS, DATA, min_size=1, max_size=4))
def test_written_data_reads_back_equal(data: dict[str, object]) -> None:
    found = read_back(to_yaml(data))
    assert found == data
    assert repr(found) == repr(data)  # types, the sign of zero and the order of keys


@pytest.mark.parametrize("text", ["a\u0085b", "a\u2028b", "\x07", "tab\there", "\ufeff", "  x  "])
def test_odd_characters_survive(text: str) -> None:
    assert read_back(to_yaml({"description": text})) == {"description": text}
