"""The end of a search: from its best points down to the bottom of the hollows that they lie in.

What goes before it finds where the best lies, but comes no nearer than its points are apart.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from hilc_cli.reference.sampled import Floats
from hilc_cli.variation import Axis, Range, Value

Values = tuple[Value, ...]

# docs/sweeps.md has what these were chosen by.
_SHARE = 4
"""A quarter of the cases of a search are left for this."""
_LEAST = 16
"""A search of fewer cases has none left."""
_NEAR = 1e-6
"""Where a hollow has been searched to its bottom, of the width of the ranges."""
_SIMPLEX = 0.05
"""Size of the first simplex, of the width of the ranges."""
_APART = 0.02
"""How far the next starting point lies from those before it, of the width of the ranges."""
_MOST_STEPS = 400
"""Points of one hollow."""
_MOST_STARTS = 50
"""After so many in a row without a new point there are hardly any."""


def refinable(axes: Mapping[str, Axis]) -> list[str]:
    """The keys that can be refined: those with ranges. Lists are left at the best values found."""
    return [key for key, axis in axes.items() if isinstance(axis, Range) and axis.low < axis.high]


def refined_cases(axes: Mapping[str, Axis], cases: int) -> int:
    """How many of the cases of a search are left for its refinement."""
    return cases // _SHARE if refinable(axes) and cases >= _LEAST else 0


class Refinement:
    """Suggests one case after another, near the best ones that are known.

    All suggestions follow from the ranges and from what has been tried. SciPy's methods call for
    the value of a point, where this is asked for points and told their values: so they are run
    again from their start each time, through all that is known, to the first point that is not.

    Attributes:
        method: What it goes by, in words.

    Source:
        Brent 1973, minimisation within bounds, for one key; Nelder and Mead 1965 for several.
    """

    def __init__(
        self,
        axes: Mapping[str, Axis],
        tried: Sequence[Values],
        costs: Sequence[float],
        another: Callable[[], Values],
    ) -> None:
        """Begins where a search has come to.

        Args:
            axes: What each key takes.
            tried: What each key was in the cases so far.
            costs: How good they were, the smaller the better; infinite is the worst.
            another: Gives a case where there is nothing left to be refined.
        """
        self._places = [place for place, key in enumerate(axes) if key in refinable(axes)]
        found = [axes[key] for key in refinable(axes)]
        self._ranges = [axis for axis in found if isinstance(axis, Range)]
        self.method = "Nelder-Mead" if len(self._places) > 1 else "Brent's within bounds"
        self._known = dict(zip(tried, costs, strict=True))
        self._another = another
        self._starts: list[tuple[Values, list[float]]] = []
        # A value that is known is taken as it is, not as it comes back from its place.
        self._exact = {(*self._flat(values), *self._others(values)): values for values in tried}
        self._asked: Values = ()

    def ask(self) -> Values:
        """The next case."""
        for _ in range(_MOST_STARTS):
            if not self._starts and not self._begin():
                break
            try:
                self._go_down(*self._starts[-1])
                self._look_beside()
            except _Unknown as found:
                self._asked = found.values
                return found.values
            if not self._begin():
                break
        for _ in range(_MOST_STARTS):
            self._asked = self._another()
            if self._asked not in self._known:
                break
        return self._asked

    def tell(self, costs: Floats | Sequence[float]) -> None:
        """How good the case was that it was asked for last."""
        self._known[self._asked] = float(costs[0])
        place = (*self._flat(self._asked), *self._others(self._asked))
        self._exact.setdefault(place, self._asked)

    def _begin(self) -> bool:
        """Chooses the best known point that is far from all where it has begun before."""
        best = sorted(self._known, key=lambda values: self._known[values])
        for values in best:
            if not math.isfinite(self._known[values]):
                return False
            others = self._others(values)
            before = [start for start, _ in self._starts if self._others(start) == others]
            away = [np.abs(self._flat(values) - self._flat(start)).max() for start in before]
            if all(distance > _APART for distance in away):
                self._starts.append((values, self._bracket(values)))
                return True
        return False

    def _bracket(self, values: Values) -> list[float]:
        """Of one key: where the best point lies between those beside it, or the ends.

        Returns:
            Two places if it lies at an end itself, otherwise three; empty for several keys.
        """
        if len(self._places) > 1:
            return []
        at = float(self._flat(values)[0])
        others = self._others(values)
        alike = [other for other in self._known if self._others(other) == others]
        beside = [float(self._flat(other)[0]) for other in alike]
        low = max((other for other in beside if other < at), default=min(0.0, at))
        high = min((other for other in beside if other > at), default=max(1.0, at))
        return sorted({low, at, high})

    def _others(self, values: Values) -> tuple[object, ...]:
        """What is not refined, each with its type: 1 and true are equal, but not the same."""
        kept = [value for place, value in enumerate(values) if place not in self._places]
        return tuple((type(value), value) for value in kept)

    def _go_down(self, start: Values, bracket: list[float]) -> None:
        """Runs one of SciPy's methods to its end, unless it comes to a point that is not known."""
        from scipy.optimize import minimize, minimize_scalar  # starts slowly

        def cost(point: Floats | float) -> float:
            values = self._values(start, np.atleast_1d(point))
            if values not in self._known:
                raise _Unknown(values)
            return self._known[values]

        with np.errstate(all="ignore"):  # what diverges is infinitely bad
            if len(self._places) > 1:
                simplex = self._simplex(start)
                options = {"initial_simplex": simplex, "xatol": _NEAR, "fatol": math.inf}
                bounds = [(0.0, 1.0)] * len(self._places)
                minimize(
                    *(cost, simplex[0]),
                    method="Nelder-Mead",
                    bounds=bounds,
                    options={**options, "maxfev": _MOST_STEPS},
                )
            elif len(bracket) == 3 and cost(bracket[1]) < min(cost(bracket[0]), cost(bracket[2])):
                options = {"xtol": _NEAR, "maxiter": _MOST_STEPS}
                minimize_scalar(cost, bracket=bracket, method="brent", options=options)
            else:
                options = {"xatol": _NEAR, "maxiter": _MOST_STEPS}
                ends = (bracket[0], bracket[-1])
                minimize_scalar(cost, bounds=ends, method="bounded", options=options)

    def _look_beside(self) -> None:
        """Tries the whole numbers next to those of the best point, between which steps end."""
        best = min(self._known, key=lambda values: self._known[values])
        for place, axis in zip(self._places, self._ranges, strict=True):
            number = best[place]
            if not isinstance(number, int) or not (axis.whole or axis.spacing == "integer"):
                continue
            for other in (number - 1, number + 1):
                values = (*best[:place], other, *best[place + 1 :])
                if axis.low <= other <= axis.high and values not in self._known:
                    raise _Unknown(values)

    def _simplex(self, start: Values) -> Floats:
        """A start and a point beside it along each key, shape (keys + 1, keys)."""
        first = self._flat(start)
        simplex = np.tile(first, (len(first) + 1, 1))
        for number, at in enumerate(first):
            simplex[number + 1, number] += _SIMPLEX if at < 0.5 else -_SIMPLEX
        return simplex

    def _flat(self, values: Values) -> Floats:
        """Where values lie in the ranges that are refined, 0 at the low ends and 1 at the high."""
        return np.array(
            [
                axis.place(values[place])
                for place, axis in zip(self._places, self._ranges, strict=True)
            ]
        )

    def _values(self, start: Values, point: Floats) -> Values:
        """The values at a place in the ranges, all else as at a start."""
        known = self._exact.get((*point, *self._others(start)))
        if known is not None:
            return known
        values = list(start)
        for place, axis, share in zip(self._places, self._ranges, point.tolist(), strict=True):
            values[place] = axis.drawn(share)
        return tuple(values)


class _Unknown(Exception):
    """Nothing is known of these values yet."""

    def __init__(self, values: Values) -> None:
        super().__init__()
        self.values = values
