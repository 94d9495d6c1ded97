"""The boundaries of a part's features with their heights, by school geometry: dense points, areas
and lengths, without any of the code that builds parts."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from camgeo.numeric.arrays import ComplexArray
from camgeo.part.spec import DShaft, Holes, Keyway, Mark, PartSpec
from tests.measuring import DensePath

TURN = 2.0 * math.pi

DENSE = 60_000
"""Points of a flank."""

ROUND = 20_000
"""Points of a circle, of the arcs of a bore or a mark: chords of one of 75 mm lie 1e-6 mm off."""


def _none() -> ComplexArray:
    return np.zeros(0, dtype=np.complex128)


@dataclass(frozen=True)
class Exact:
    """One exact boundary of the part."""

    name: str
    points: ComplexArray
    area: float
    length: float
    corners: ComplexArray = field(default_factory=_none)

    @cached_property
    def path(self) -> DensePath:
        return DensePath(self.points)

    @cached_property
    def centroid(self) -> complex:
        """Of the dense polygon."""
        start, end = self.points, np.roll(self.points, -1)
        cross = (start.conj() * end).imag
        return complex(np.sum((start + end) * cross) / (3.0 * np.sum(cross)))


@dataclass(frozen=True)
class Span:
    """A boundary from the height `low` to `high` above the lowest face [mm]; of a hole the material
    lies outside it.

    `layer` is that of the drawing, with `{:g}` for `away`, the height from the disc's face [mm].
    """

    exact: Exact
    low: float
    high: float
    hole: bool
    layer: str = "CUT"
    away: float = 0.0

    @property
    def volume(self) -> float:
        """What it adds to the part [mm^3]."""
        return (-1.0 if self.hole else 1.0) * self.exact.area * (self.high - self.low)


def circle(name: str, radius: float, middle: complex = 0j) -> Exact:
    points = middle + radius * np.exp(1j * np.linspace(0.0, TURN, ROUND, endpoint=False))
    return Exact(name, points, math.pi * radius**2, TURN * radius)


def bore(spec: PartSpec) -> Exact:
    """The bore, with its keyway or flat."""
    assert spec.bore is not None
    radius = spec.bore / 2.0
    if spec.d_shaft is not None:
        return _flattened(radius, spec.d_shaft)
    if spec.keyway is not None:
        return _slotted(radius, spec.keyway)
    return circle("bore", radius)


def _slotted(radius: float, keyway: Keyway) -> Exact:
    """Its area: the circle and the slot up to its bottom, less what is under the arc."""
    half, bottom = keyway.width / 2.0, radius + keyway.depth
    reach, opening = math.sqrt(radius**2 - half**2), math.asin(half / radius)
    arc = radius * np.exp(1j * np.linspace(opening, TURN - opening, ROUND))
    slot = np.array([bottom - 1j * half, bottom + 1j * half])
    points = np.concatenate((arc, slot)) * np.exp(1j * keyway.angle)
    area = math.pi * radius**2 + keyway.width * bottom - half * reach - radius**2 * opening
    length = radius * (TURN - 2.0 * opening) + 2.0 * (bottom - reach) + keyway.width
    return Exact("bore", points, area, length)


def _flattened(radius: float, flat: DShaft) -> Exact:
    """The circle less the segment beyond the flat."""
    half = math.acos((flat.across - radius) / radius)
    arc = np.exp(1j * np.linspace(half, TURN - half, ROUND))
    points = radius * arc * cmath.exp(1j * flat.angle)
    area = radius**2 * (math.pi - half + math.sin(half) * math.cos(half))
    return Exact("bore", points, area, radius * (TURN - 2.0 * half + 2.0 * math.sin(half)))


def mark(given: Mark) -> Exact:
    """A dot, or a slot: a rectangle and two half circles."""
    along, half = cmath.exp(1j * given.angle), given.width / 2.0
    if given.length is None:
        return circle("mark", half, given.radius * along)
    straight = given.length - given.width
    turned = half * np.exp(1j * np.linspace(-math.pi / 2.0, math.pi / 2.0, ROUND // 2))
    ends = np.concatenate((straight / 2.0 + turned, -straight / 2.0 - turned))
    points = np.asarray(along * (given.radius + ends), dtype=np.complex128)
    area = straight * given.width + math.pi * half**2
    return Exact("mark", points, area, 2.0 * straight + TURN * half)


def holes(given: Holes | None, name: str) -> list[Exact]:
    if given is None:
        return []
    first, step = given.angle, TURN / given.count
    return [
        circle(name, given.hole / 2.0, cmath.rect(given.circle / 2.0, first + k * step))
        for k in range(given.count)
    ]


def spans(spec: PartSpec, flanks: dict[str, Exact], contact: str) -> list[Span]:
    """All boundaries of the part, from the `flanks` of its contact, "inner" and "outer"."""
    assert spec.thickness is not None
    sides = () if spec.hub is None else {"both": ("upper", "lower")}.get(
        spec.hub.side, (spec.hub.side,)
    )  # fmt: skip
    height = spec.hub.height if spec.hub is not None else 0.0
    low = height if "lower" in sides else 0.0
    top = low + spec.thickness
    high = top + (height if "upper" in sides else 0.0)
    if contact == "inner":
        found = [Span(flanks["inner"], low, top, hole=False)]
    else:
        assert spec.rim is not None
        found = [Span(circle("rim", spec.rim / 2.0), low, top, hole=False)]
    if contact == "outer":
        found.append(Span(flanks["outer"], low, top, hole=True))
    elif spec.bore is not None:
        found.append(Span(bore(spec), 0.0, high, hole=True))
    if contact == "groove":
        assert spec.groove_depth is not None
        floor, layer = top - spec.groove_depth, "BLIND_{:.6g}"
        found.append(Span(flanks["inner"], floor, top, False, layer, spec.groove_depth))
        found.append(Span(flanks["outer"], floor, top, True, layer, spec.groove_depth))
    if spec.hub is not None:
        hub = circle("hub", spec.hub.diameter / 2.0)
        if "upper" in sides:
            found.append(Span(hub, top, high, False, "RAISED_{:.6g}", height))
        if "lower" in sides:
            found.append(Span(hub, 0.0, low, False, "RAISED_BELOW_{:.6g}", height))
    for given, name in ((spec.bolt_circle, "bolt hole"), (spec.lightening_holes, "hole")):
        found += [Span(each, low, top, hole=True) for each in holes(given, name)]
    if spec.mark is not None:
        floor = top - spec.mark.depth
        found.append(Span(mark(spec.mark), floor, top, True, "BLIND_{:.6g}", spec.mark.depth))
    return found
