"""Programs that turn points of a curve into chords, arcs or cubics, behind one interface.

Each is optional: without its package it is left out with a message. Their results are only counted
and sampled here; `contour.py` measures how good they are, in the same way for all.

- shapely: `simplify`, Douglas and Peucker's selection of the given points.
- OCCT (cadquery-ocp-novtk): `GCPnts_UniformDeflection` and `GCPnts_TangentialDeflection` for
  chords, `Geom2dConvert_ApproxArcsSegments` for arcs, `Geom2dAPI_PointsToBSpline` and
  `Geom2dConvert_ApproxCurve` for cubics. Where it needs a curve it gets the B-spline
  that `Geom2dAPI_Interpolate` lays through the points.
- scipy: `splprep`, whose knots FITPACK chooses, and `make_lsq_spline` with evenly spaced knots.
- fontTools: `qu2cu`, which merges quadratics to cubics; it gets one from each point to the next.
- ezdxf: `global_bspline_interpolation` through evenly spaced points, and the local one with exact
  tangents. It has no fit to a tolerance, and nothing that turns a curve into arcs.
- kurbo (kurbopy): `fit_to_bezpath`. It asks for points one by one and gets them from cubic
  Hermite pieces between the given points.
"""

from __future__ import annotations

import functools
import importlib
import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Final, Literal

import numpy as np

from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray

Form = Literal["chords", "arcs", "cubics"]

CUBIC: Final = 3

ANGLES: Final = (0.01, 0.1)
"""Largest angles [rad] between neighbours that are tried for OCCT's arcs."""

MANY: Final = 100_000
"""Pieces that OCCT may take."""

Sampler = Callable[[IntArray, FloatArray], ComplexArray]
"""Numbers of pieces and shares of them, 0 to 1, both (k,) -> points (k,) complex [mm]."""


@dataclass(frozen=True, slots=True)
class Shape:
    """The result of a fit: the number of its pieces, and their points."""

    pieces: int
    at: Sampler


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """What a peer gets of a curve.

    Attributes
    ----------
    points, tangents : (n,) complex [mm] and unit, evenly over the arc length, both ends included.
    closed : True if the last point is the first one again.
    """

    points: ComplexArray
    tangents: ComplexArray
    closed: bool

    def places(self) -> FloatArray:
        """(n,) [mm] arc lengths, by the chords."""
        return np.concatenate(([0.0], np.cumsum(np.abs(np.diff(self.points)))))

    def some(self, count: int) -> tuple[ComplexArray, ComplexArray]:
        """Points and tangents of `count` + 1 places evenly spaced."""
        index = np.round(np.linspace(0.0, len(self.points) - 1.0, count + 1)).astype(int)
        return self.points[index], self.tangents[index]


@dataclass(frozen=True, slots=True)
class Peer:
    """A program, and how it is called.

    Attributes
    ----------
    thin : it gets one of so many points of a sample.
    joints : how smooth its result is inside a smooth piece of the curve.
    knob : whether its parameter is a length [mm], as a tolerance, or a number of pieces.
    prepare : turns the sample into what it takes; not timed.
    fit : the call, that is timed.
    shape : reads its result; not timed.
    """

    name: str
    form: Form
    joints: str
    knob: Literal["length", "count"]
    prepare: Callable[[Sample], Any]
    fit: Callable[[Any, float], Any]
    shape: Callable[[Any], Shape]
    thin: int = 1


def module(name: str, package: str) -> Any:
    """The module `name`, or None with a message."""
    try:
        return importlib.import_module(name)
    except ImportError:
        print(f"{package} is left out: it is not installed (pip install {package})")
        return None


# -- shapes --------------------------------------------------------------------------------------


def chords(vertices: ComplexArray) -> Shape:
    """The straight pieces between `vertices` (n + 1,)."""
    sides = np.diff(vertices)
    return Shape(len(sides), lambda k, t: vertices[k] + sides[k] * t)


def arcs(
    starts: ComplexArray, ends: ComplexArray, sweeps: FloatArray, centres: ComplexArray
) -> Shape:
    """Lines, of sweep 0, and arcs; all (n,)."""

    def at(k: IntArray, t: FloatArray) -> ComplexArray:
        line = starts[k] + (ends - starts)[k] * t
        arc = centres[k] + (starts - centres)[k] * np.exp(1j * sweeps[k] * t)
        return np.where(sweeps[k] == 0.0, line, arc)

    return Shape(len(starts), at)


def cubics(beziers: ComplexArray) -> Shape:
    """Cubics by their Bezier points (n, 4)."""

    def at(k: IntArray, t: FloatArray) -> ComplexArray:
        w = 1.0 - t
        b0, b1, b2, b3 = beziers[k].T
        points: ComplexArray = w**3 * b0 + 3.0 * w * t * (w * b1 + t * b2) + t**3 * b3
        return points

    return Shape(len(beziers), at)


def bspline(knots: FloatArray, controls: ComplexArray, degree: int = CUBIC) -> Shape:
    """A B-spline; each span of its knots that has a length is a piece."""
    from scipy.interpolate import BSpline

    inner = knots[degree : len(knots) - degree]
    low, high = inner[:-1], inner[1:]
    low, high = low[high > low], high[high > low]
    spline = BSpline(knots, controls, degree)

    def at(k: IntArray, t: FloatArray) -> ComplexArray:
        points: ComplexArray = spline(low[k] + (high - low)[k] * t)
        return points

    return Shape(len(low), at)


def joined(shapes: list[Shape]) -> Shape:
    """One after the other."""
    first = np.cumsum([0, *(shape.pieces for shape in shapes)])

    def at(k: IntArray, t: FloatArray) -> ComplexArray:
        points = np.empty(len(k), dtype=np.complex128)
        for shape, low, high in zip(shapes, first[:-1], first[1:], strict=True):
            own = (k >= low) & (k < high)
            points[own] = shape.at(k[own] - low, t[own])
        return points

    return Shape(int(first[-1]), at)


def columns(points: ComplexArray) -> FloatArray:
    """(n, 2) x and y."""
    return np.column_stack((points.real, points.imag))


# -- the peers -----------------------------------------------------------------------------------


def find_peers() -> list[Peer]:
    """The peers that are installed."""
    found: list[Peer] = []
    for package, name, make in (
        ("shapely", "shapely", _of_shapely),
        ("scipy", "scipy.interpolate", _of_scipy),
        ("fonttools", "fontTools.qu2cu", _of_fonttools),
        ("ezdxf", "ezdxf.math", _of_ezdxf),
        ("kurbopy", "kurbopy", _of_kurbo),
        ("cadquery-ocp-novtk", "OCP.Geom2dConvert", _of_occt),
    ):
        library = module(name, package)
        if library is not None:
            found += make(library)
    return found


def _of_shapely(shapely: Any) -> list[Peer]:
    def simplify(line: Any, tolerance: float) -> Any:
        return shapely.simplify(line, tolerance, preserve_topology=False)

    def shape(line: Any) -> Shape:
        vertices = shapely.get_coordinates(line)
        return chords(vertices[:, 0] + 1j * vertices[:, 1])

    return [
        Peer(
            "shapely simplify", "chords", "C0", "length",
            lambda sample: shapely.LineString(columns(sample.points)), simplify, shape,
        )
    ]  # fmt: skip


def _of_scipy(interpolate: Any) -> list[Peer]:
    def prepare(sample: Sample) -> tuple[FloatArray, FloatArray, bool]:
        return columns(sample.points), sample.places(), sample.closed

    def smoothed(given: tuple[FloatArray, FloatArray, bool], off: float) -> Any:
        points, places, closed = given
        (knots, controls, _), *_ = interpolate.splprep(
            points.T, u=places, s=len(points) * off * off, per=closed, full_output=True, quiet=2
        )[0]
        return knots, np.asarray(controls[0]) + 1j * np.asarray(controls[1])

    def even(given: tuple[FloatArray, FloatArray, bool], count: float) -> Any:
        points, places, _ = given
        inner = np.linspace(0.0, places[-1], int(count) + 1)
        knots = np.concatenate(([0.0] * CUBIC, inner, [places[-1]] * CUBIC))
        spline = interpolate.make_lsq_spline(places, points, knots, CUBIC)
        return knots, spline.c[:, 0] + 1j * spline.c[:, 1]

    def shape(result: tuple[FloatArray, ComplexArray]) -> Shape:
        return bspline(*result)

    return [
        Peer("scipy splprep", "cubics", "C2", "length", prepare, smoothed, shape),
        Peer("scipy make_lsq_spline", "cubics", "C2", "count", prepare, even, shape),
    ]


def _of_fonttools(qu2cu: Any) -> list[Peer]:
    def prepare(sample: Sample) -> list[tuple[complex, ...]]:
        start, end = sample.points[:-1], sample.points[1:]
        t0, t1 = sample.tangents[:-1], sample.tangents[1:]
        chord = end - start
        cross = (np.conj(t0) * t1).imag
        # Where the tangents meet; the middle where they are parallel.
        straight = np.abs(cross) < 1e-9
        reach = (np.conj(chord) * t1).imag / np.where(straight, 1.0, cross)
        within = ~straight & (reach > 0.0) & (reach < np.abs(chord))
        middle = np.where(within, start + reach * t0, 0.5 * (start + end))
        return [tuple(map(complex, each)) for each in zip(start, middle, end, strict=True)]

    def merged(quadratics: list[tuple[complex, ...]], tolerance: float) -> Any:
        return qu2cu.quadratic_to_curves(quadratics, tolerance, all_cubic=True)

    def shape(curves: list[tuple[complex, ...]]) -> Shape:
        return cubics(np.array(curves, dtype=np.complex128))

    # Its time grows with the third power of their number.
    return [Peer("fontTools qu2cu", "cubics", "G1", "length", prepare, merged, shape, thin=6)]


def _of_ezdxf(ezdxf: Any) -> list[Peer]:
    def prepare(sample: Sample) -> Sample:
        return sample

    def through(sample: Sample, count: float) -> Any:
        points, tangents = sample.some(int(count))
        ends = [(t.real, t.imag) for t in tangents[[0, -1]]]
        return ezdxf.global_bspline_interpolation(columns(points).tolist(), CUBIC, ends)

    def local(sample: Sample, count: float) -> Any:
        points, tangents = sample.some(int(count))
        given = columns(points).tolist(), columns(tangents).tolist()
        return ezdxf.local_cubic_bspline_interpolation(given[0], tangents=given[1])

    def shape(spline: Any) -> Shape:
        controls = np.array([complex(v.x, v.y) for v in spline.control_points])
        return bspline(np.array(spline.knots()), controls, spline.degree)

    return [
        Peer("ezdxf global", "cubics", "C2", "count", prepare, through, shape),
        Peer("ezdxf local", "cubics", "C1", "count", prepare, local, shape),
    ]


class _Hermite:
    """A curve as kurbo asks for it: over 0 to 1, cubic pieces between the points of a sample."""

    def __init__(self, kurbo: Any, sample: Sample) -> None:
        self.point, self.vector = kurbo.Point, kurbo.Vec2
        self.count = len(sample.points) - 1
        self.points = [complex(z) for z in sample.points]
        size = sample.places()[-1] / self.count
        self.slopes = [complex(size * t) for t in sample.tangents]

    def sample_pt_deriv(self, t: float) -> tuple[Any, Any]:
        place = min(max(t, 0.0), 1.0) * self.count
        k = min(int(place), self.count - 1)
        u = place - k
        w = 1.0 - u
        a, b, p, q = self.points[k], self.points[k + 1], self.slopes[k], self.slopes[k + 1]
        z = a * (w * w * (1.0 + 2.0 * u)) + b * (u * u * (1.0 + 2.0 * w)) + u * w * (w * p - u * q)
        d = 6.0 * u * w * (b - a) + p * (w * (1.0 - 3.0 * u)) + q * (u * (1.0 - 3.0 * w))
        d *= self.count
        return self.point(z.real, z.imag), self.vector(d.real, d.imag)

    def sample_pt_tangent(self, t: float, _sign: float) -> tuple[Any, Any]:
        return self.sample_pt_deriv(t)

    def break_cusp(self, _start: float, _end: float) -> None:
        return None


def _of_kurbo(kurbo: Any) -> list[Peer]:
    def prepare(sample: Sample) -> _Hermite:
        return _Hermite(kurbo, sample)

    def shape(path: Any) -> Shape:
        pieces = []
        for cubic in path.segments():
            pieces.append([complex(p.x, p.y) for p in (cubic.p0, cubic.p1, cubic.p2, cubic.p3)])
        return cubics(np.array(pieces))

    fit = kurbo.fit_to_bezpath
    return [Peer("kurbo fit_to_bezpath", "cubics", "G1", "length", prepare, fit, shape)]


class _Occt:
    """The calls and types of OCCT."""

    def __init__(self, convert: Any) -> None:
        self.convert = convert
        names = ("collections", "gp", "Geom2d", "Geom2dAPI", "Geom2dAdaptor", "GeomAbs", "GCPnts")
        self.lists, self.gp, self.geom, self.api, self.adaptor, kinds, self.points = (
            importlib.import_module(f"OCP.{name}") for name in names
        )
        self.smooth = kinds.GeomAbs_Shape

    def array(self, sample: Sample, kind: str = "Array1_gp_Pnt2d") -> Any:
        """The points."""
        found = getattr(self.lists, kind)(1, len(sample.points))
        for k, z in enumerate(sample.points, 1):
            found.SetValue(k, self.gp.gp_Pnt2d(z.real, z.imag))
        return found

    def curve(self, sample: Sample) -> Any:
        """The B-spline through the points, with the tangents at both ends."""
        points = self.array(sample, "HArray1_gp_Pnt2d")
        laid = self.api.Geom2dAPI_Interpolate(points, False, 1e-12)
        laid.Load(*(self.gp.gp_Vec2d(t.real, t.imag) for t in sample.tangents[[0, -1]]), True)
        laid.Perform()
        return laid.Curve()

    def adapted(self, sample: Sample) -> Any:
        """The same, as other calls want it."""
        return self.adaptor.Geom2dAdaptor_Curve(self.curve(sample))

    def uniform(self, line: Any, tolerance: float) -> Any:
        return self.points.GCPnts_UniformDeflection(line, tolerance, True)

    def tangential(self, line: Any, tolerance: float) -> Any:
        # The limit of the angle, 1 rad, is beyond any chord's.
        return self.points.GCPnts_TangentialDeflection(line, 1.0, tolerance, 2, 1e-12, 1e-12)

    def arcs(self, angle: float, line: Any, tolerance: float) -> Any:
        return self.convert.Geom2dConvert_ApproxArcsSegments(line, tolerance, angle).GetResult()

    def approximated(self, points: Any, tolerance: float) -> Any:
        smooth = self.smooth.GeomAbs_C2
        return self.api.Geom2dAPI_PointsToBSpline(points, CUBIC, CUBIC, smooth, tolerance).Curve()

    def converted(self, curve: Any, tolerance: float) -> Any:
        # With C2 it uses degree 5, whatever is allowed.
        smooth = self.smooth.GeomAbs_C1
        return self.convert.Geom2dConvert_ApproxCurve(curve, tolerance, smooth, MANY, CUBIC).Curve()

    def chords_of(self, result: Any) -> Shape:
        found = [result.Value(k) for k in range(1, result.NbPoints() + 1)]
        return chords(np.array([complex(p.X(), p.Y()) for p in found]))

    def arcs_of(self, result: Any) -> Shape:
        rows = []
        for piece in result:
            low, high = piece.FirstParameter(), piece.LastParameter()
            start, end = piece.Value(low), piece.Value(high)
            ends = (complex(start.X(), start.Y()), complex(end.X(), end.Y()))
            base = piece.BasisCurve()
            if isinstance(base, self.geom.Geom2d_Circle):
                middle = base.Location()
                sense = 1.0 if base.Circ2d().IsDirect() else -1.0
                rows.append((*ends, sense * (high - low), complex(middle.X(), middle.Y())))
            else:
                rows.append((*ends, 0.0, 0j))
        starts, lasts, sweeps, centres = (np.array(column) for column in zip(*rows, strict=True))
        return arcs(starts, lasts, sweeps.real, centres)

    def spline_of(self, result: Any) -> Shape:
        if result.Degree() > CUBIC or result.IsRational():
            raise ValueError("no cubic spline")
        places = range(1, result.NbKnots() + 1)
        knots = np.array([result.Knot(k) for k in places])
        poles = [result.Pole(k) for k in range(1, result.NbPoles() + 1)]
        controls = np.array([complex(p.X(), p.Y()) for p in poles])
        knots = np.repeat(knots, [result.Multiplicity(k) for k in places])
        return bspline(knots, controls, result.Degree())


def _of_occt(convert: Any) -> list[Peer]:
    occt = _Occt(convert)
    rows: tuple[tuple[str, Form, str, Any, Any, Any], ...] = (
        ("UniformDeflection", "chords", "C0", occt.adapted, occt.uniform, occt.chords_of),
        ("TangentialDeflection", "chords", "C0", occt.adapted, occt.tangential, occt.chords_of),
        ("PointsToBSpline", "cubics", "C2", occt.array, occt.approximated, occt.spline_of),
        ("ApproxCurve", "cubics", "C1", occt.curve, occt.converted, occt.spline_of),
        *(
            (
                f"ApproxArcsSegments {angle:g}", "arcs", "G1", occt.adapted,
                functools.partial(occt.arcs, angle), occt.arcs_of,
            )
            for angle in ANGLES
        ),
    )  # fmt: skip
    return [
        Peer(f"OCCT {name}", form, joints, "length", prepare, fit, shape)
        for name, form, joints, prepare, fit, shape in rows
    ]


# -- the fewest pieces ---------------------------------------------------------------------------

STEPS: Final = 8
"""Halvings of a bracket: of a factor of four they leave half a per cent."""

WIDEN: Final = 4.0
"""Factor by which a parameter of a length is changed until a bracket is found."""

MOST: Final = 1000
"""Pieces at most, where their number is the parameter: half of the points at least."""

TRIES: Final = 4
"""Such changes at most: what asks for a tolerance 256 times smaller does not hold any."""


@dataclass(frozen=True, slots=True)
class Found:
    """The parameter with the fewest pieces; `off` [mm] is the measured deviation.

    `spent` [s] is what all calls of the search took, without the measuring; `whole` is False if it
    ran out of time: there may be a better one.
    """

    parameter: float
    shape: Shape
    off: float
    spent: float = 0.0
    whole: bool = True


class _Search:
    """Tries of one peer, and the best of them."""

    def __init__(
        self, peer: Peer, given: Any, off: Callable[[Shape], float], tolerance: float, until: float
    ) -> None:
        self.peer, self.given, self.off = peer, given, off
        self.tolerance, self.until = tolerance, until
        self.best: Found | None = None
        self.spent = 0.0

    def late(self) -> bool:
        """True if the time is over."""
        return time.perf_counter() > self.until

    def good(self, parameter: float) -> bool:
        """Whether the fit with this parameter is near enough."""
        began = time.perf_counter()
        try:
            result = self.peer.fit(self.given, parameter)
            self.spent += time.perf_counter() - began
            shape = self.peer.shape(result)
        except Exception:  # of any kind, by any library: it is no fit
            return False
        away = self.off(shape)
        if not away <= self.tolerance:
            return False
        best = self.best
        if best is None or (shape.pieces, away) < (best.shape.pieces, best.off):
            self.best = Found(parameter, shape, away)
        return True

    def largest_length(self) -> None:
        """The largest parameter of a length that is near enough."""
        start = self.tolerance
        reached = self.good(start)
        for _ in range(TRIES):
            following = start * WIDEN if reached else start / WIDEN
            if self.good(following) != reached:
                break
            if self.late():
                return
            start = following
        else:
            return
        low, high = min(start, following), max(start, following)
        for _ in range(STEPS):
            if self.late():
                return
            middle = math.sqrt(low * high)
            low, high = (middle, high) if self.good(middle) else (low, middle)

    def least_count(self, guess: int) -> None:
        """The least number of pieces that is near enough."""
        low, high = 0, max(2, guess)
        while not self.good(high):
            low, high = high, 2 * high
            if high > MOST or self.late():
                return
        while high - low > 1 and not self.late():
            middle = (low + high) // 2
            low, high = (low, middle) if self.good(middle) else (middle, high)


def fewest(
    peer: Peer,
    given: Any,
    off: Callable[[Shape], float],
    tolerance: float,
    guess: int,
    patience: float,
) -> Found | None:
    """By bisection of the peer's own parameter, the fewest pieces no farther off than `tolerance`;
    of equally many those with the least deviation. None where it does not come that near.

    Parameters
    ----------
    off : measured deviation of a shape [mm].
    guess : pieces to begin with.
    patience : time [s] after which the best that was found counts.
    """
    search = _Search(peer, given, off, tolerance, time.perf_counter() + patience)
    if peer.knob == "count":
        search.least_count(guess)
    else:
        search.largest_length()
    if search.best is None:
        return None
    return replace(search.best, spent=search.spent, whole=not search.late())
