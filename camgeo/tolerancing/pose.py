"""How a body moves with one coordinate: along a line, or about a point."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from camgeo.numeric.arrays import ComplexArray, FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """The motion of a point of a body; arrays broadcast, machines along the first axis.

    Z(q) = C + (Z_0 - C) exp(i s q) + w q, where either s or w is 0.

    Attributes
    ----------
    start : Z_0 [mm].
    centre : C [mm].
    spin : s, +1 if the body turns counter-clockwise with q, -1 clockwise, 0 if it does not turn.
    way : w, displacement per unit of q.
    """

    start: ComplexArray
    centre: ComplexArray
    spin: float
    way: ComplexArray

    @classmethod
    def of_rates(cls, start: complex, first: complex, second: complex) -> Self:
        """From the place [mm] at q = 0 and two derivatives; Z'' = -(Z - C) if it turns."""
        turns = second != 0.0
        centre = start + second if turns else 0.0
        spin = float(np.sign((first / (start - centre)).imag)) if turns else 0.0
        way = 0.0 if turns else first
        start_at, centre_at, along = (
            np.full((1, 1), each, complex) for each in (start, centre, way)
        )
        return cls(start_at, centre_at, spin, along)

    def at(self, q: FloatArray) -> ComplexArray:
        """The places [mm] at the coordinates q."""
        turned: ComplexArray = self.centre + (self.start - self.centre) * self.turned(q)
        return turned + self.way * q

    def turned(self, q: FloatArray) -> ComplexArray:
        """exp(i s q)."""
        found: ComplexArray = np.exp(1j * self.spin * q)
        return found

    def velocity(self, place: ComplexArray) -> ComplexArray:
        """Of a point of the body that is at `place` [mm], per unit of q."""
        return self.way + 1j * self.spin * (place - self.centre)

    def acceleration(self, place: ComplexArray) -> ComplexArray:
        """The derivative of that."""
        return -(self.spin**2) * (place - self.centre)

    def moved(self, by: ComplexArray, *, whole: bool = False) -> Pose:
        """With the point displaced `by` [mm] at q = 0, with the centre if the `whole` is."""
        centre = self.centre + by if whole else self.centre
        return replace(self, start=self.start + by, centre=centre)

    def rotated(self, turn: ComplexArray) -> Pose:
        """Multiplied by `turn`, of magnitude 1: about the origin."""
        return replace(
            self, start=self.start * turn, centre=self.centre * turn, way=self.way * turn
        )
