"""What a page has painted of a cam, compared with the exact curves of the scene's text."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import shapely

from camgeo.app.designing.work import PAPER, SEEN, SHARE
from camgeo.design.design import Design
from camgeo.numeric.arrays import ComplexArray
from camgeo.part.part import Boundary
from camgeo.pictures.mechanism import CHORDS, animation, disc_parts
from camgeo.units import TURN
from tests.judges.programs_of_others import Refusal

WIDTH, HEIGHT = 640.0, 520.0
"""Of the picture at most [points] (mechanism.ts)."""

COURSE: Final = 0.03
"""By how much a written line may pass a point of its curve [points] (course.ts)."""

STEP: Final = 0.01
"""To which coordinates are written [points] (svg.ts)."""

SINGLE: Final = 1e-6
"""By how much coordinates are off on their way, relative to the picture (designing.packing)."""

SAMPLES: Final = 40_001
"""Points of an exact pitch curve."""

FINE: Final = 1e-2
"""How near points of an exact boundary are to it, relative to the chords that are painted."""


@dataclass(frozen=True)
class Frame:
    """What a picture shows: its lower left and upper right corner [mm]."""

    low: complex
    high: complex

    @property
    def scale(self) -> float:
        size = self.high - self.low
        return min(WIDTH / size.real, HEIGHT / size.imag)

    @property
    def size(self) -> tuple[float, float]:
        """Width and height [points]."""
        size = (self.high - self.low) * self.scale
        return size.real, size.imag

    @property
    def thinning(self) -> float:
        """By how much a thinned line may be off [mm], see `camgeo.app.designing.work`."""
        size = self.high - self.low
        return SEEN * max(size.real, size.imag) / PAPER

    @property
    def writing(self) -> float:
        """By how much the page may be off what it is sent [mm]."""
        size = self.high - self.low
        return (COURSE + STEP / math.sqrt(2.0)) / self.scale + SINGLE * abs(size)

    def places(self, path: str) -> list[ComplexArray]:
        """The strokes of a path [mm], each closed if it says so."""
        found = []
        for stroke in path.split("M")[1:]:
            numbers = np.array(re.findall(r"-?[\d.]+", stroke), np.float64).reshape(-1, 2)
            points = numbers[:, 0] + 1j * (self.size[1] - numbers[:, 1])
            places = np.asarray(self.low + points / self.scale, np.complex128)
            found.append(_closed(places) if "Z" in stroke else places)
        return found


def frame_of(design: Design) -> Frame:
    """Of the picture of a design on which nothing is held."""
    turn = animation(design.disc)
    return Frame(turn.low, turn.high)


def farthest(design: Design, painted: Mapping[str, Any], frame: Frame | None = None) -> float:
    """The largest distance of an exact curve and the painted one, as a share of what is stated.

    Parameters
    ----------
    design : of the text that is on the page.
    painted : what the page has drawn, see `tests.judges.chromium_designer.PAINTED`.
    frame : of the picture, if that was held while something was dragged.

    Raises
    ------
    Refusal
        If a curve is farther off than is stated, or is not there.
    """
    frame = frame or frame_of(design)
    if np.max(np.abs(np.subtract(painted["size"], frame.size))) > STEP:
        raise Refusal(f"the picture is {painted['size']} points and not {frame.size}")
    strokes = [stroke for path in painted["paths"] for stroke in frame.places(path)]
    worst = 0.0
    for name, exact, stated in _curves(design, frame):
        near = min((apart(exact, each, stated) for each in strokes), default=np.inf)
        if not near <= stated:
            raise Refusal(f"the {name} is not painted within {stated:.2g} mm of its exact curve")
        worst = max(worst, near / stated)
    return worst


def apart(exact: ComplexArray, painted: ComplexArray, near: float) -> float:
    """The largest distance [mm] of either curve from the other; infinite if their extents already
    differ by much more than `near`.
    """
    ends = [[each.real.min(), each.real.max(), each.imag.min(), each.imag.max()]
            for each in (exact, painted)]  # fmt: skip
    if len(painted) < 2 or np.abs(np.subtract(ends[0], ends[1])).max() > 4.0 * near:
        return np.inf
    middles = 0.5 * (painted[1:] + painted[:-1])
    there = _distance(exact, np.concatenate((painted, middles)))
    return max(there, _distance(painted, exact))


def _distance(line: ComplexArray, points: ComplexArray) -> float:
    """The largest distance of any of the points from a polygon [mm]."""
    polygon = shapely.LineString(np.column_stack((line.real, line.imag)))
    shapely.prepare(polygon)
    return float(np.max(shapely.distance(polygon, shapely.points(points.real, points.imag))))


def _curves(design: Design, frame: Frame) -> Iterator[tuple[str, ComplexArray, float]]:
    """Name, points along it [mm] and the stated distance [mm] of each exact curve."""
    cam = design.disc.cam
    chords = CHORDS * cam.follower.base_radius
    rounding = SHARE * frame.thinning + frame.writing
    parts = disc_parts(design.disc)
    whole = {each.name: each for part in parts[:1] for layer in part.layers
             for each in layer.boundaries}  # fmt: skip
    for name, boundary in whole.items():
        yield name, _exact(boundary, FINE * chords), chords + rounding
    for part in parts[1:]:
        boundary = part.outermost
        yield boundary.name, _exact(boundary, FINE * chords), chords + frame.thinning + rounding
    if cam.follower.has_pitch_curve:
        exact = cam.disc.pitch_curve.point(np.linspace(0.0, TURN, SAMPLES))
        yield "pitch curve", exact, frame.thinning + rounding


def _exact(boundary: Boundary, tolerance: float) -> ComplexArray:
    """Points along a boundary, chords between them within `tolerance` [mm] of it, and closed."""
    return _closed(boundary.arcs(0.5 * tolerance, "fast").contour.points(0.5 * tolerance))


def _closed(points: ComplexArray) -> ComplexArray:
    return np.append(points, points[:1])
