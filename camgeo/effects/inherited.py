"""Results from others that are known to an error: the errors that all their figures inherit.

A speed that `speed-fluctuation` or `camshaft-windup` finds is off by less than it differs from the
one on cells twice as long (`camgeo.effects.results.Turning`), and the force of an elastic train by
no more than its error e, in either direction at each cam angle. So is what follows from them: an
effect is computed again with the other speed, and with trains that are off by e
(`camgeo.effects.elastic.ElasticTrain.off`), and of all its figures in one unit the largest
difference is taken for each of them; those of several causes add up. That one figure hardly
differs, by chance or because it depends on the speed where that is accurate, thus does not make it
look exact. These computations wait until an error is asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.effect import Bound, Result
from camgeo.errors import EffectError, GeometryError
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.rounding import SHARE
from camgeo.units import TURN

PLACE: Final = 2.0**-26
"""Error of a value at the place of an extreme that is not its own, as a share: such a place is
known to the root of a rounding."""

ANGLES: Final = 1024
"""Cam angles over a turn at which columns are compared."""

OF_FORCE: Final = ("contact-lost", "other-side")
"""Findings on premises that state a contact force."""

OFFSET: Final = 0.381966
"""Offset of the first of these angles from 0, as a fraction of their spacing: no jump is there."""


Figures = dict[str, tuple[str, FloatArray]]
"""The unit and the values of figures, by name."""


@dataclass(frozen=True, eq=False)
class InheritedErrors(Mapping[str, Bound]):
    """The errors of all figures of `result`, see `camgeo.effects.effect.Result.errors`.

    Attributes
    ----------
    result : with errors that do not include the inherited ones.
    others : each gives the same result from others that are off; raises EffectError or
        GeometryError if there is none.
    """

    result: Result
    others: Sequence[Callable[[], Result]]

    @cached_property
    def _bounds(self) -> dict[str, Bound]:
        own = _figures(self.result)
        placed = {each.name for each in self.result.findings if each.cam_angle is not None}
        moved: dict[str, float] = {}
        sizes: dict[str, float] = {}
        for unit, values in own.values():
            sizes[unit] = max(sizes.get(unit, 0.0), float(np.max(np.abs(values))))
        for other in self.others:
            for unit, off in _moved(own, other).items():
                moved[unit] = moved.get(unit, 0.0) + off
        found = dict(self.result.errors)
        for name, (unit, _) in own.items():
            size = sizes[unit]
            known = found.get(name, Bound((PLACE if name in placed else SHARE) * size, size))
            found[name] = Bound(known.error + moved[unit], known.scale)
        return found

    def __getitem__(self, name: str) -> Bound:
        return self._bounds[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    @property
    def _names(self) -> dict[str, None]:
        """All figures."""
        result = self.result
        valued = [each.name for each in result.findings if each.value is not None]
        columns = [each.name for each in result.columns]
        return dict.fromkeys([*result.errors, *valued, *columns])


@dataclass(frozen=True, eq=False)
class ErrorsWithPremises(Mapping[str, Bound]):
    """The errors of figures, and of those that premises add to them.

    Attributes
    ----------
    own : of the effect.
    added : the findings with the premises; `OF_FORCE` are as accurate as the contact force.
    force : makes the errors of its figures.
    """

    own: InheritedErrors
    added: Sequence[Finding]
    force: Callable[[], Mapping[str, Bound]]

    def __getitem__(self, name: str) -> Bound:
        if name in OF_FORCE:
            return max(self.force().values(), key=lambda bound: bound.error)
        return self.own[name]

    def __iter__(self) -> Iterator[str]:
        yield from self.own
        yield from (each.name for each in self.added if each.name in OF_FORCE)

    def __len__(self) -> int:
        return sum(1 for _ in self)


def _moved(own: Figures, other: Callable[[], Result]) -> dict[str, float]:
    """By unit, the largest difference of any figure in it."""
    try:
        others = _figures(other())
    except (EffectError, GeometryError):
        others = {}
    found: dict[str, float] = {}
    for name, (unit, values) in own.items():
        off = float(np.max(np.abs(values)))  # nothing is known of a figure that the other has not
        if name in others and others[name][1].shape == values.shape:
            off = float(np.max(np.abs(values - others[name][1])))
        found[unit] = max(found.get(unit, 0.0), off)
    return found


def _figures(result: Result) -> Figures:
    """The unit and the values of all figures: of findings, in order, and of columns."""
    phi: FloatArray = (np.arange(ANGLES, dtype=np.float64) + OFFSET) * (TURN / ANGLES)
    units: dict[str, str] = {}
    found: dict[str, list[float]] = {}
    for each in result.findings:
        if each.value is not None:
            units.setdefault(each.name, each.unit)
            found.setdefault(each.name, []).append(each.value)
    figures = {name: (units[name], np.array(values)) for name, values in found.items()}
    columns = {each.name: (each.unit, each.values(phi, "right")) for each in result.columns}
    return figures | columns
