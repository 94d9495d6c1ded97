"""Outlines for the tests, trimmed ones made by hand: of the hard cases, and of cams with shocks.

Crossing points come from the reference, or from Newton's method here; nothing of the stage that
finds them is used.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial

import numpy as np
from scipy.interpolate import BSpline

from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.legs import TurnLeg, path_legs
from camgeo.geometry.contour.spline import Arc, CubicSpline, SplineContour
from camgeo.geometry.outline.path import Path, Pivot, Stretch, whole
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.mechanism.rollers import TranslatingRoller
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from tests.contour.cams import FLANKS, TURN, dwell, flank, move, outline, translating
from tests.measuring import DensePath
from tests.reference import hard_case, plan_of

SAGITTA = 3e-6
"""Of the dense chords by which is measured [mm], see `DensePath`: h < 5e-3 mm and kappa < 1/mm, at
other places shorter chords."""


def at(curve: WorkingCurve, angle: float, side: Side = "right") -> tuple[complex, complex]:
    """Point and unit tangent at one cam angle [rad]."""
    phi = np.array([angle])
    return complex(curve.point(phi, side)[0]), complex(curve.tangent(phi, side)[0])


def corner(curve: WorkingCurve, before: float, after: float, place: complex) -> Pivot:
    """The corner at `place` from the cam angle `before` to `after`, both of a stretch's ends."""
    arriving, leaving = at(curve, before, "left")[1], at(curve, after)[1]
    normal = 1j * curve.pitch.rotation * arriving
    return Pivot(place, 0.0, normal, float(np.angle(leaving / arriving)), before % TURN, after)


def kink(curve: WorkingCurve, angle: float) -> Pivot:
    """The roller's turn at a cam angle [rad] where the velocity jumps."""
    arriving, leaving = at(curve, angle, "left")[1], at(curve, angle)[1]
    centre = complex(curve.pitch.point(np.array([angle]))[0])
    normal = 1j * curve.pitch.rotation * arriving
    return Pivot(centre, curve.distance, normal, float(np.angle(leaving / arriving)), angle, angle)


def crossing(curve: WorkingCurve, one: float, other: float) -> tuple[float, float]:
    """Cam angles [rad] near `one` and `other` at which the curve crosses itself, by Newton."""
    for _ in range(20):
        first, along = at(curve, one)
        second, across = at(curve, other)
        one_pace, other_pace = curve.traced(np.array([one, other]))[2]
        rows = np.array([along * one_pace, -across * other_pace])
        matrix = np.stack((rows.real, rows.imag))
        ahead = second - first
        step = np.linalg.solve(matrix, np.array([ahead.real, ahead.imag]))
        one, other = one + float(step[0]), other + float(step[1])
    return one, other


@cache
def hard_curve(case: str) -> WorkingCurve:
    """Inner working curve of a hard case."""
    parameters, _ = hard_case(case)
    follower = TranslatingRoller(float(parameters["r_G"]), float(parameters["r_R"]))
    plan = plan_of(parameters, float(parameters["s_H"]))
    return WorkingCurve(PitchCurve(plan, follower, 1), -follower.roller_radius)


@cache
def swallow_tail() -> Path:
    """HC21c: a swallow tail cut off at the crossing."""
    curve, expected = hard_curve("HC21c"), hard_case("HC21c")[1]
    start = math.radians(float(expected["crossing_phi2_deg"]))
    end = math.radians(float(expected["crossing_phi1_deg"])) + TURN
    place = complex(*(float(part) for part in expected["crossing_point"]))
    return Path((Stretch(curve, start, end), corner(curve, end, start, place)))


@cache
def cut_off_lobe() -> Path:
    """HC22: a lobe cut off at its neck, on the line at 40 degrees."""
    curve, expected = hard_curve("HC22"), hard_case("HC22")[1]
    start = math.radians(float(expected["mirror_phi_deg"][0]))
    end = math.radians(float(expected["self_intersections_on_axis_phi_deg"][0])) + TURN
    place = float(expected["radial_position_mm"][0]) * np.exp(1j * math.radians(40.0))
    return Path((Stretch(curve, start, end), corner(curve, end, start, complex(place))))


@cache
def shocks(flank: int, rotation: int, roller: float = 8.0) -> Path:
    """Straight-line rise: at one end the roller turns about its centre, at the other a corner."""
    segments = (dwell(40), move(140, 15.0, "straight-line"), dwell(60), move(120, 0.0))
    pitch = translating(*segments, rotation=rotation).pitch
    curve = WorkingCurve(pitch, flank * roller)
    turns, cut = (40.0, 180.0) if flank < 0 else (180.0, 40.0)
    turn, middle = math.radians(turns), math.radians(cut)
    end, start = crossing(curve, middle - 0.02, middle + 0.02)
    place = at(curve, end)[0]
    if flank < 0:
        return Path(
            (
                Stretch(curve, start, turn + TURN),
                kink(curve, turn),
                Stretch(curve, turn, end),
                corner(curve, end, start, place),
            )
        )
    return Path(
        (
            Stretch(curve, start, turn),
            kink(curve, turn),
            Stretch(curve, turn, end + TURN),
            corner(curve, end + TURN, start, place),
        )
    )


def cusp() -> Path:
    """HC21a: a cusp in one point, nothing to cut off."""
    return whole(hard_curve("HC21a"))


PATHS: dict[str, Callable[[], Path]] = {
    "swallow tail": swallow_tail,
    "cut-off lobe": cut_off_lobe,
    "inner shocks": lambda: shocks(-1, 1),
    "inner shocks, clockwise": lambda: shocks(-1, -1),
    "outer shocks": lambda: shocks(1, 1),
    "outer shocks, clockwise": lambda: shocks(1, -1),
    "cusp": cusp,
}


def flank_path(scene: str, side: int) -> Path:
    return whole(flank(scene, side))


FLANK_PATHS: dict[str, Callable[[], Path]] = {
    scene: partial(flank_path, scene, side) for scene, side in FLANKS
}


OUTLINES = {**PATHS, **FLANK_PATHS}
"""Trimmed outlines, and whole flanks of fixture scenes by the name of the scene."""


def dense_path(path: Path, count: int = 60_000) -> ComplexArray:
    """Points of the whole path, spaced evenly to a factor of two along each element."""
    found: list[ComplexArray] = []
    for element in path.elements:
        if isinstance(element, Stretch):
            rough = np.linspace(element.start, element.end, 4_001)
            steps = np.abs(np.diff(element.curve.point(rough))) + 1e-6
            length = np.concatenate(([0.0], np.cumsum(steps)))
            t = np.interp(np.linspace(0.0, length[-1], count), length, rough)
            t = np.union1d(t, rough)
            last = element.curve.point(t[-1:], "left")
            found.append(np.append(element.curve.point(t[:-1]), last))
        else:
            turned = np.exp(1j * element.sweep * np.linspace(0.0, 1.0, count // 10))
            found.append(element.centre + element.distance * element.normal * turned)
    points = np.concatenate(found)
    kept: ComplexArray = points[points != np.roll(points, -1)]
    return kept


EACH = 60
"""Points a cubic."""


def curve_of(spline: CubicSpline) -> BSpline:
    """The same as scipy's."""
    return BSpline(spline.knots, spline.controls, 3)


def parameters(spline: CubicSpline, each: int = EACH) -> FloatArray:
    """Dense parameters, the ends of all spans among them."""
    places = np.unique(spline.knots)
    part = np.arange(each) / each
    inner = (places[:-1, None] + np.diff(places)[:, None] * part).ravel()
    return np.append(inner, places[-1])


def points_of(strand: CubicSpline | Arc, each: int = EACH) -> ComplexArray:
    """Dense points, both ends included."""
    if isinstance(strand, CubicSpline):
        found: ComplexArray = curve_of(strand)(parameters(strand, each))
        return found
    part = np.linspace(0.0, 1.0, min(20 * each, 40_000))
    if strand.sweep:
        turned = np.exp(1j * strand.sweep * part)
        return np.asarray(strand.centre + (strand.start - strand.centre) * turned)
    return np.asarray(strand.start + (strand.end - strand.start) * part)


def spline_points(contour: SplineContour, each: int = EACH) -> ComplexArray:
    """Dense points of a whole contour with cubics."""
    return np.concatenate([points_of(strand, each)[:-1] for strand in contour.strands])


@dataclass(frozen=True)
class Dense:
    """A path by dense points, for distances in both directions."""

    points: ComplexArray
    path: DensePath

    @classmethod
    def of(cls, path: Path) -> Dense:
        points = dense_path(path)
        return cls(points, DensePath(points))

    def measured(self, contour: Contour | SplineContour, points: int = 8_000) -> float:
        """Largest distance found by dense sampling in both directions, at most the true one but for
        `SAGITTA`."""
        some = self.points[:: max(1, len(self.points) // points)]
        if isinstance(contour, SplineContour):
            found = spline_points(contour, 2000 if len(contour) < 40 else 500)
            there, back = DensePath(found).distances(some), self.path.distances(found[::11])
        else:
            there = outline(contour).distances(some)
            back = self.path.distances(outline(contour).dense(points))
        return max(float(np.max(there)), float(np.max(back)))


@cache
def dense_of(name: str) -> Dense:
    """One of `OUTLINES` by dense points."""
    return Dense.of(OUTLINES[name]())


def break_count(path: Path) -> int:
    """Places at which smooth pieces, dwells and turns of `path` meet; at least the one at which a
    contour begins.
    """
    return sum(1 if isinstance(leg, TurnLeg) else len(leg.pieces) for leg in path_legs(path))
