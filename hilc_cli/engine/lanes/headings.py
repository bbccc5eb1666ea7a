"""Cosine and sine of the lanes' headings: what they cost decides what a sample costs.

From one sample to the next they are rotated by the turn, see `trigonometry.rotated`. A lane that
has turned too far for that, and each of them every `RENEWAL` samples, has them computed anew: no
lane sees what its neighbours do.
"""

from __future__ import annotations

from hilc_cli.engine.lanes.machine_code import formula
from hilc_cli.engine.lanes.trigonometry import cos_sin_near_zero, reduced, turned

FORMULAS = (reduced, cos_sin_near_zero, turned)
_reduced, _cos_sin_near_zero, _turned = [formula(function) for function in FORMULAS]

RENEWAL = 256
"""Samples after which cosine and sine are computed anew; a power of two."""


def _cos_sin(heading: float) -> tuple[float, float]:
    rest, shifted = _reduced(heading)
    cosine, sine = _cos_sin_near_zero(rest)
    cos, sin = _turned(cosine, sine, shifted)
    return cos, sin


cos_sin = formula(_cos_sin)


def _renew(heading: float, cos: float, sin: float, always: bool) -> tuple[float, float]:
    """Cosine and sine, computed anew where the cosine is not-a-number, or always."""
    new_cos, new_sin = cos_sin(heading)
    far = always or cos != cos
    return (new_cos if far else cos), (new_sin if far else sin)


renewed = formula(_renew)
