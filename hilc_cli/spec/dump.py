"""Plain data as YAML that this program reads back to the same values."""

from __future__ import annotations

from typing import Any

import yaml

from hilc_cli.spec.scalars import resolve_plain


class _Dumper(yaml.SafeDumper):
    """Quotes what YAML 1.2, in which hilc reads, would take for a number or a truth value."""


def _text(dumper: yaml.SafeDumper, text: str) -> yaml.ScalarNode:
    plain = isinstance(resolve_plain(text), str) and text.isprintable()
    style = None if plain else '"'
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style)


_Dumper.add_representer(str, _text)


def to_yaml(data: Any) -> str:
    """YAML text of dictionaries, lists and values, keys in their order."""
    return yaml.dump(
        data,
        Dumper=_Dumper,
        sort_keys=False,
        allow_unicode=True,
        width=10_000,
        default_flow_style=None,
    )
