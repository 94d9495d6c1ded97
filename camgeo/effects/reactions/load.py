"""A reaction over the cam angle, with its finding."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from camgeo.effects.wording import extreme_finding
from camgeo.numeric.extremes import Extreme, piecewise_highest
from camgeo.numeric.rounding import resolved

if TYPE_CHECKING:
    from camgeo.check.finding import Finding
    from camgeo.effects.effect import Quantity
    from camgeo.numeric.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Load:
    """A reaction as it is reported.

    Attributes
    ----------
    name : of its column; its finding is "largest-" and the name.
    words : of its finding.
    values : in `unit`.
    """

    name: str
    words: str
    values: Quantity
    unit: str = "N"

    def largest(self, edges: FloatArray, force: float) -> Finding:
        """The finding of its largest magnitude between `edges` (k,) [rad]; a force that is rounding
        of `force` [N] is 0.
        """
        end = piecewise_highest(lambda phi, side: np.abs(self.values(phi, side)), edges)
        if self.unit == "N":
            end = Extreme(resolved(end.value, force), end.place)
        name = f"largest-{self.name.replace(' ', '-')}"
        return extreme_finding(name, f"largest {self.words}", end, self.unit)
