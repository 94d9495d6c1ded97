"""Results at a speed of the cam that is known to an error: the errors of all their figures.

A speed that `speed-fluctuation` or `camshaft-windup` finds is off by less than it differs from the
one on cells twice as long (`camgeo.effects.results.Turning`). So is what follows from it: an effect
is computed for both, and of all its figures in one unit the largest difference is taken for each of
them. That one figure hardly differs, by chance or because it depends on the speed where that is
accurate, thus does not make it look exact. The second computation waits until an error is asked
for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

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

OFFSET: Final = 0.381966
"""Offset of the first of these angles from 0, as a fraction of their spacing: no jump is there."""


@dataclass(frozen=True, eq=False)
class ErrorsOfSpeed(Mapping[str, Bound]):
    """The errors of all figures of `result`, see `camgeo.effects.effect.Result.errors`.

    Attributes
    ----------
    result : with errors that do not include that of the speed.
    rough : gives the same result at the rough speed; raises EffectError or GeometryError if there
        is none.
    """

    result: Result
    rough: Callable[[], Result]

    @cached_property
    def _bounds(self) -> dict[str, Bound]:
        own = _figures(self.result)
        try:
            other = _figures(self.rough())
        except (EffectError, GeometryError):
            other = {}
        placed = {each.name for each in self.result.findings if each.cam_angle is not None}
        moved: dict[str, float] = {}
        sizes: dict[str, float] = {}
        for name, (unit, values) in own.items():
            size = float(np.max(np.abs(values)))
            sizes[unit] = max(sizes.get(unit, 0.0), size)
            off = size  # nothing is known of a figure that the rough speed does not have
            if name in other and other[name][1].shape == values.shape:
                off = float(np.max(np.abs(values - other[name][1])))
            moved[unit] = max(moved.get(unit, 0.0), off)
        found = dict(self.result.errors)
        for name, (unit, _) in own.items():
            size = sizes[unit]
            known = found.get(name, Bound((PLACE if name in placed else SHARE) * size, size))
            found[name] = Bound(known.error + moved[unit], known.scale)
        return found

    def __getitem__(self, name: str) -> Bound:
        return self._bounds[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._bounds)

    def __len__(self) -> int:
        return len(self._bounds)


def _figures(result: Result) -> dict[str, tuple[str, FloatArray]]:
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
