"""The paper's claims, each with its criterion, in the paper's order."""

from __future__ import annotations

from hilc_cli.paper.claim import Claim
from hilc_cli.paper.claims import (
    gains,
    initial_error,
    limit,
    structure,
    theorems,
    tracking,
)

CLAIMS: tuple[Claim, ...] = (
    *theorems.CLAIMS,
    *tracking.CLAIMS,
    *initial_error.CLAIMS,
    *gains.CLAIMS,
    *limit.CLAIMS,
    *structure.CLAIMS,
)
