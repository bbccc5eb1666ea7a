"""What a YAML file says of itself."""

from __future__ import annotations

from pathlib import Path

from hilc_cli.spec.nodes import MapNode, Scalar
from hilc_cli.spec.reading import Inputs


def description_of(path: Path) -> str:
    """The description in a trajectory or scenario file; empty if it has none.

    Raises:
        HilcError: It cannot be read, or is no YAML.
    """
    tree = Inputs().tree(str(path))
    node = tree.entries.get("description") if isinstance(tree, MapNode) else None
    return node.text if isinstance(node, Scalar) else ""
