"""What the printed theory leaves out or gets wrong, point by point."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum


class Correction(StrEnum):
    """One change that turns the printed bounds into bounds of the system that is simulated."""

    SAMPLE_TIME = "sample-time"
    LEARNING_GAIN = "learning-gain"
    HEADINGS = "headings"
    STATE_DISTURBANCE = "state-disturbance"
    REACHABILITY = "reachability"
    COMPENSATION = "compensation"
    SPEED_LIMIT = "speed-limit"
    OUTPUT_SIGN = "output-sign"


EXPLANATIONS: Mapping[Correction, str] = {
    Correction.SAMPLE_TIME: (
        "Eqs. 12, 19 and 23 have B, and Eq. 26 loses the sample time from its second line on; the "
        "plant of Eq. 8 moves by d_k B, so that b_B and rho need d_k B"
    ),
    Correction.LEARNING_GAIN: (
        "Eq. 34 puts rho of Eq. 19, ||I - (L1 + L2 + L3) B||, for ||I - L1 B||, which Eq. 32 has "
        "and Eq. 23 bounds; L2 and L3 do not learn"
    ),
    Correction.HEADINGS: (
        "L is taken at the heading that the law uses, B at the one of the iteration before: "
        "||I - L1 B|| must hold for both headings, not on the reference alone"
    ),
    Correction.STATE_DISTURBANCE: (
        "Eq. 30 leaves beta out of e_i(k+1), so that b_L1 b_beta is missing in b_1 of Eq. 32"
    ),
    Correction.REACHABILITY: (
        "Eq. 26 takes q_d(k+1) = q_d(k) + d_k B u_d(k); the Euler plant does not reach the samples "
        "of an arc exactly, and what is missing counts as a disturbance of the state"
    ),
    Correction.COMPENSATION: (
        "Eq. 21 adds exp(-k d_k) theta(k) L1 e_i(0), at most 2 b_L1 (b_q0 + b_alpha) / (d_k h), "
        "which no bound contains; b_1 needs it"
    ),
    Correction.SPEED_LIMIT: (
        "Eq. 25 is not in the proof: scaling both wheels may take the input further from u_d in "
        "the Euclidean norm, by a factor of up to sqrt 2, though not in the sum of the wheels' "
        "absolute values; and u_d itself may exceed the limit"
    ),
    Correction.OUTPUT_SIGN: ("Eqs. 42 and 43 subtract b_alpha; the triangle inequality adds it"),
}

PRINTED: frozenset[Correction] = frozenset()
ALL: frozenset[Correction] = frozenset(Correction)
