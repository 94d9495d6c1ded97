"""The edges between chamfers that meet at a corner of a line and an arc."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Point:
    """A place and its height [mm]."""

    place: complex
    z: float


@dataclass(frozen=True, slots=True)
class Parabola:
    """A parabola between two heights, of three control points, whole."""

    start: Point
    middle: Point
    end: Point

    def at(self, share: float) -> Point:
        """The point at a parameter from 0 to 1."""
        weights = ((1.0 - share) ** 2, 2.0 * share * (1.0 - share), share**2)
        points = (self.start, self.middle, self.end)
        return Point(
            sum(weight * each.place for weight, each in zip(weights, points, strict=True)),
            sum(weight * each.z for weight, each in zip(weights, points, strict=True)),
        )

    @property
    def _heights(self) -> tuple[float, float]:
        """The second and the first coefficient of the height in powers of the parameter."""
        low, middle, high = self.start.z, self.middle.z, self.end.z
        return low - 2.0 * middle + high, 2.0 * (middle - low)

    @property
    def turning(self) -> float:
        """The height [mm] at which the curve is level; infinite if it is nowhere."""
        square, along = self._heights
        return self.start.z - along**2 / (4.0 * square) if square else math.inf

    @property
    def is_monotonic(self) -> bool:
        """Whether it rises all the way, or falls."""
        low, high = sorted((self.start.z, self.end.z))
        return low < self.middle.z < high and not low <= self.turning <= high

    def place_at(self, z: float) -> complex:
        """Where it is at a height [mm] between its ends, if it is monotonic."""
        square, along = self._heights
        up = z - self.start.z
        root = math.sqrt(max(along**2 + 4.0 * square * up, 0.0))
        return self.at(2.0 * up / (along + math.copysign(root, self.end.z - self.start.z))).place

    def off_ends(self, start: Point, end: Point) -> float:
        """How far [mm] points are from its ends; infinite if it rises and falls."""
        if not self.is_monotonic:
            return math.inf
        pairs = ((self.start, start), (self.end, end))
        return max(math.hypot(abs(a.place - b.place), a.z - b.z) for a, b in pairs)
