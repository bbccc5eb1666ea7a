"""How far parameters that were found may be off, whatever the innovations are like."""

from __future__ import annotations

import math
import sys

import numpy as np

from hilc_cli.compiling import cached
from hilc_cli.reference.sampled import Floats


def consistent_covariance(information: Floats, scores: Floats) -> Floats:
    """Covariance of the parameters' errors, with the larger of two variances.

    The usual ones hold where the innovations are the noise that the model takes them for. The
    others are made from how the innovations really vary, where those of all passes at a sample may
    have a common cause and may be alike from sample to sample.

    Args:
        information: Of all passes about the parameters, shape (m, m).
        scores: Slopes of the likelihood's logarithm by sample, all passes added up, shape (n, m).

    Source:
        Newey and West: A simple, positive semi-definite, heteroskedasticity and autocorrelation
        consistent covariance matrix. Econometrica 55 (1987), 703-708.
    """
    covariance = inverse_of(information)
    reach = math.ceil(4 * (len(scores) / 100) ** (1 / 3)) * 4
    # Products of scores up to that far apart, with weights that fall in a straight line: the
    # squares of all sums of so many in a row.
    spread = squares_of_sums(scores, reach + 1) / (reach + 1)
    robust, usual = (covariance @ spread @ covariance).diagonal(), covariance.diagonal()
    share = np.divide(robust, usual, out=np.ones(len(usual)), where=usual > 0)
    larger = np.sqrt(np.maximum(share, 1.0))
    widened: Floats = covariance * (larger * larger[:, None])
    return widened


def _squares_of_sums(scores: Floats, width: int) -> Floats:
    """Adds up the squares of all sums of so many scores in a row, shape (m, m).

    Args:
        scores: Shape (n, m).
        width: How many, the first and last ones of fewer.
    """
    n, count = scores.shape
    window, squares = np.zeros(count), np.zeros((count, count))
    for k in range(n + width - 1):
        for i in range(count):
            if k < n:
                window[i] += scores[k, i]
            if k >= width:
                window[i] -= scores[k - width, i]
        for i in range(count):
            for j in range(i + 1):
                squares[i, j] += window[i] * window[j]
    for i in range(count):
        for j in range(i):
            squares[j, i] = squares[i, j]
    return squares


squares_of_sums = cached(_squares_of_sums)


def inverse_of(information: Floats) -> Floats:
    """The inverse, with no negative variance where rounding would make one."""
    if not np.isfinite(information).all():
        return np.full_like(information, np.nan)
    scale = 1 / np.sqrt(information.diagonal())
    told, directions = np.linalg.eigh(information * scale * scale[:, None])
    told = np.maximum(told, sys.float_info.epsilon * told[-1])
    inverse: Floats = (directions / told) @ directions.T * scale * scale[:, None]
    return inverse
