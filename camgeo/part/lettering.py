"""Engraved texts: their letters in place, as boundaries, clear of each other."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations, pairwise
from typing import Any, Final

import numpy as np

from camgeo.errors import GeometryError, ToleranceError
from camgeo.geometry.contour.contour import (
    Contour,
    Effort,
    Fit,
    Pieces,
    crossing,
    least_distance,
    winding_number,
)
from camgeo.geometry.contour.cubic_proof import approximating_arcs
from camgeo.geometry.contour.exact import ROUNDING, distance_between
from camgeo.geometry.contour.legs import too_many
from camgeo.geometry.contour.proof import ENOUGH
from camgeo.geometry.contour.spline import Arc, CubicSpline, SplineContour, SplineFit, elevated
from camgeo.geometry.outline.path import (
    Moments,
    SecondMoments,
    quadratic_moments,
    quadratic_second_moments,
)
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, frozen, grouped
from camgeo.numeric.checked import array, check_fields
from camgeo.part.boundaries import MAX_CHORDS, Hole, Name, once
from camgeo.part.glyphs import glyph, kerning
from camgeo.part.part import Size
from camgeo.part.spec import CIRCLE, ENGRAVING, LETTER, OUTWARD, Engraving
from camgeo.record import Pickled
from camgeo.units import TURN

COARSEST: Final = 0.004
"""Of the fits of an outline, as a share of the height of capital letters: strokes are an eighth of
it wide."""

APART: Final = 0.01
"""By which outlines must at least lie apart, as a share of the height of capital letters."""


FAR: Final = 1.5
"""Of the distances at which letters can touch, beyond which they need not be compared; it covers
how far arcs bulge beyond their ends."""


@dataclass(frozen=True, slots=True, eq=False)
class Letter:
    """A letter in place.

    Attributes
    ----------
    character : which it is.
    place : its middle [mm], at half the height of capital letters.
    boundaries : its outlines, holes and what stands within them, by which it is cut.
    contours : these as lines and arcs.
    deviation : of these [mm].
    """

    character: str
    place: complex
    boundaries: tuple[LetterBoundary, ...]
    contours: tuple[Contour, ...]
    deviation: float

    @property
    def where(self) -> str:
        """Which letter, and where it is."""
        return f'"{self.character}" at X {self.place.real:.4g}, Y {self.place.imag:.4g} mm'


def lettered(texts: Sequence[Engraving]) -> tuple[tuple[Letter, ...], ...]:
    """The letters of each text.

    Raises
    ------
    GeometryError
        With the key of the text, if the font lacks a character, letters or their outlines touch, or
        a text goes round the cam axis more than once.
    """
    found = tuple(_letters(text, number) for number, text in enumerate(texts, start=1))
    letters = [(number, each) for number, text in enumerate(found, start=1) for each in text]
    for first, second in _near([each for _, each in letters]):
        (_, one), (number, other) = letters[first], letters[second]
        apart = least_distance(Pieces.around(one.contours), Pieces.around(other.contours))
        if apart <= APART * texts[number - 1].height:
            message = f"the {other.where} touches the {one.where}"
            raise GeometryError(message, key=f"part.{ENGRAVING}[{number}]")
    return found


def _near(letters: Sequence[Letter]) -> list[tuple[int, int]]:
    """The pairs of letters that may touch, by their numbers, in order."""
    places = np.array([each.place for each in letters])
    reaches = np.array(
        [
            max(float(np.max(np.abs(contour.vertices - each.place))) for contour in each.contours)
            for each in letters
        ]
    )
    near = np.abs(places[:, None] - places) <= FAR * (reaches[:, None] + reaches)
    pairs: list[tuple[int, int]] = [(one, other) for one, other in np.argwhere(np.triu(near, 1))]
    return pairs


def _letters(text: Engraving, number: int) -> tuple[Letter, ...]:
    key = f"part.{ENGRAVING}[{number}]"
    found = []
    for count, (character, place, along) in enumerate(_places(text, key), start=1):
        middle = 0.5 * glyph(character).advance + 0.5j
        outlines = [
            place + text.height * along * (each - middle) for each in glyph(character).outlines
        ]
        if outlines:
            name = f"{ENGRAVING} {number}{LETTER}{count}"
            found.append(_letter(character, place, outlines, name, text, key))
    return tuple(found)


def _places(text: Engraving, key: str) -> Iterator[tuple[str, complex, complex]]:
    """Each character with its place [mm] and the direction in which it is read there.

    Along a circle letters have the distances of straight text where they are nearest to the cam
    axis, at their feet or at their tops.
    """
    advances = [glyph(each).advance for each in text.text]
    moved = [0.0, *(kerning(*pair) for pair in pairwise(text.text))]
    starts = np.cumsum(moved) + np.concatenate(([0.0], np.cumsum(advances)[:-1]))
    first, last = _ink(text.text, starts)
    sizes = text.height * (starts + 0.5 * np.array(advances) - 0.5 * (first + last))
    ray = cmath.exp(1j * text.angle)
    outward = text.tops == OUTWARD
    if text.along != CIRCLE:
        way = ray * (-1j if outward else 1j)
        if text.turn is not None:
            way = cmath.exp(1j * text.turn)
        for character, size in zip(text.text, sizes.tolist(), strict=True):
            yield character, text.radius * ray + size * way, way
        return
    radius = text.radius - 0.5 * text.height
    if text.height * (last - first) >= TURN * radius:
        message = (
            f"{text.height * (last - first):.4g} mm of text do not fit around"
            f" {TURN * radius:.4g} mm, the circle on which the letters are nearest to the cam axis"
        )
        raise GeometryError(message, key=f"{key}.radius", value=f"{text.radius:g}")
    for character, size in zip(text.text, sizes.tolist(), strict=True):
        turned = ray * cmath.exp((-1j if outward else 1j) * size / radius)
        yield character, text.radius * turned, turned * (-1j if outward else 1j)


def _ink(text: str, starts: ComplexArray) -> tuple[float, float]:
    """Where what is drawn of a straight text begins and ends, in heights of capital letters."""
    ends = [
        (start + float(np.min(each.real)), start + float(np.max(each.real)))
        for character, start in zip(text, starts.tolist(), strict=True)
        for each in glyph(character).outlines
    ]
    return min((low for low, _ in ends), default=0.0), max((high for _, high in ends), default=0.0)


def _letter(
    character: str,
    place: complex,
    outlines: list[ComplexArray],
    name: str,
    text: Engraving,
    key: str,
) -> Letter:
    """A letter of its outlines, by turns holes and what stands within them."""
    coarsest = COARSEST * text.height
    made = [
        LetterBoundary(f"{name} outline {number}", True, each, coarsest)
        for number, each in enumerate(outlines, start=1)
    ]
    fits = [each.beside(coarsest) for each in made]
    contours = [fit.contour for fit in fits]
    for one, other in combinations(contours, 2):
        apart = least_distance(Pieces.around([one]), Pieces.around([other]))
        if apart <= APART * text.height:
            message = f'outlines of "{character}" touch each other, which cannot be engraved'
            raise GeometryError(message, key=f"{key}.text", value=text.text)
    boundaries = []
    for boundary, contour in zip(made, contours, strict=True):
        start = complex(contour.vertices[0])
        around = sum(
            winding_number(other, start) != 0 for other in contours if other is not contour
        )
        boundaries.append(boundary if around % 2 == 0 else replace(boundary, hole=False))
    deviation = max(fit.deviation for fit in fits)
    return Letter(character, place, tuple(boundaries), tuple(contours), deviation)


# -- letter boundary ------------------------------------------------------------------------------
# Outlines of letters as boundaries: closed chains of quadratic Bezier curves and lines.


ARCS: Final = "unchecked arcs"
"""Key of fits that may cross themselves."""

CLAMPED: Final = np.repeat((0.0, 1.0), 4)
"""Knots of a spline of one cubic."""

SHARPNESS: Final = 0.005
"""Largest share of a measured distance that is due to the arcs by which it is measured."""

FIRST: Final = 2.5e-4
"""Tolerance of these arcs to begin with, as a share of the coarsest one of fits."""

FINEST: Final = 1e-10
"""How near to the outline these arcs come at most, as a share of its distance from the cam axis,
and no nearer than a proof needs."""

FOREIGN: Final = 1e-5
"""Tolerance of the arcs by which splines of others are measured, as a share of the coarsest one."""

CLOSE: Final = 1e-3
"""Distance of the points of two outlines, as a share of their size, up to which they are taken to
have been written as one and the same; beyond it they are compared as curves."""


@dataclass(frozen=True, slots=True, eq=False)
class LetterBoundary(Pickled):
    """A closed outline of a letter as a boundary, see `camgeo.part.part.Boundary`.

    Attributes
    ----------
    pieces : (n, 3) complex [mm], the Bezier points of quadratic curves, end to end; of a line the
        middle one lies halfway. Counter-clockwise once made.
    coarsest : tolerance [mm] beyond which fits become no coarser, so that the narrow strokes of a
        letter, and letters side by side, stay apart.
    known : the fits already made, by form and tolerance, and the deviations already found.
    """

    name: Name
    hole: Hole
    pieces: ComplexArray
    coarsest: Size
    known: dict[Any, Any] = field(default_factory=dict, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        check_fields(self)
        pieces = np.asarray(self.pieces, dtype=np.complex128)
        array("part", np.abs(pieces), 2)
        closed = pieces.shape[1:] == (3,) and np.array_equal(
            pieces[:, 2], np.roll(pieces[:, 0], -1)
        )
        if not closed:
            raise GeometryError(
                "must be quadratic curves, end to end and closed", "part", self.name
            )
        if quadratic_moments(pieces).area < 0.0:
            pieces = pieces[::-1, ::-1]
        object.__setattr__(self, "pieces", frozen(pieces, np.complex128))

    @property
    def curve(self) -> SplineContour:
        """The same outline: each quadratic curve as a cubic, which has the same points."""
        if "curve" not in self.known:
            cubics = elevated(self.pieces)
            self.known["curve"] = SplineContour(
                tuple(
                    Arc(complex(cubic[0]), complex(cubic[3]), 0.0, 0j)
                    if straight
                    else CubicSpline(CLAMPED, cubic)
                    for cubic, straight in zip(cubics, self._straight, strict=True)
                )
            )
        known: SplineContour = self.known["curve"]
        return known

    @property
    def _straight(self) -> BoolArray:
        start, middle, end = self.pieces.T
        straight: BoolArray = middle == 0.5 * (start + end)
        return straight

    def arcs(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """Lines and arcs with their ends on the outline, the same at either effort."""
        return self._fit("arcs", tolerance)

    def beside(self, tolerance: float) -> Fit:
        """Like `arcs`."""
        return self._arcs(tolerance)

    def polyline(self, tolerance: float, effort: Effort = "fewest") -> Fit:
        """Straight pieces with vertices on the outline, the same at either effort."""
        return self._fit("polyline", tolerance)

    def sampled(self, tolerance: float) -> Contour:
        """The same straight pieces."""
        return self.polyline(tolerance).contour

    def spline(self, tolerance: float, effort: Effort = "fewest") -> SplineFit:
        """The outline itself."""
        self._fit("arcs", tolerance)  # which shows that it does not cross itself
        return SplineFit(self.curve, 0.0, tolerance)

    def _fit(self, form: str, tolerance: float) -> Fit:
        """A fit; GeometryError if it crosses itself, ToleranceError if rounding forbids it."""
        if (form, tolerance) not in self.known:
            found = self._arcs(tolerance) if form == "arcs" else self._chords(tolerance)
            if crossing(found.contour) is not None:
                raise GeometryError(f"the {self.name} crosses itself", key="part", value=self.name)
            if found.deviation > tolerance:
                message = f"coordinates round too much for the {self.name}"
                raise ToleranceError(message, tolerance, found.deviation)
            self.known[form, tolerance] = found
        known: Fit = self.known[form, tolerance]
        return known

    def _arcs(self, tolerance: float) -> Fit:
        if (ARCS, tolerance) not in self.known:
            found = approximating_arcs(self.curve, min(tolerance, self.coarsest))
            self.known[ARCS, tolerance] = Fit(found.contour, found.apart, tolerance)
        known: Fit = self.known[ARCS, tolerance]
        return known

    def _chords(self, tolerance: float) -> Fit:
        """A quadratic curve leaves the chord of 1/n of it by at most 1/(4 n^2) of the distance
        between its middle point and that of its chord, and at the same share of both.
        """
        start, middle, end = self.pieces.T
        bend = 0.25 * np.abs(start - 2.0 * middle + end)
        aim = min(tolerance, self.coarsest)
        counts = np.maximum(1.0, np.ceil(np.sqrt(bend / aim)))
        if np.sum(counts) > MAX_CHORDS:
            raise too_many(MAX_CHORDS, "straight pieces", tolerance)
        index, number = grouped(counts.astype(np.intp))
        t = number / counts[index]
        vertices = _at(self.pieces[index], t)
        rounding = 2.0 * ROUNDING * float(np.max(np.abs(self.pieces)))
        return Fit(
            Contour.polygon(np.where(number == 0, start[index], vertices)),
            float(np.max(bend / counts**2)) + rounding,
            tolerance,
        )

    def deviation(self, contour: Contour | SplineContour) -> float:
        """Proved bound [mm], by the arcs of both; of the same curves by their control points."""
        return once(self.known, contour, lambda: self._deviation(contour))

    def _deviation(self, contour: Contour | SplineContour) -> float:
        if isinstance(contour, SplineContour):
            apart = _between_points(self.curve, contour.counter_clockwise())
            if apart <= CLOSE * self.curve.length:
                return apart + 2.0 * ROUNDING * self.curve.reach
            by_arcs = approximating_arcs(contour, FOREIGN * self.coarsest)
            return self._deviation(by_arcs.contour) + by_arcs.apart
        share, finest = FIRST * self.coarsest, max(FINEST * self.curve.reach, ENOUGH)
        while True:
            fine = self._arcs(share)
            reached = distance_between(fine.contour, contour)
            if fine.deviation <= SHARPNESS * reached or share <= finest:
                return reached + fine.deviation
            share = max(finest, min(0.1 * share, SHARPNESS * reached))

    def offset(self, distance: float) -> LetterBoundary:
        """GeometryError: strokes are narrower than most cutters, and their corners are sharp."""
        raise GeometryError(f"no cutter runs along the {self.name}", key="part", value=self.name)

    @property
    def corner_radius(self) -> None:
        """See `camgeo.part.part.Boundary`: there are no parallels."""
        return None

    def inset(self, distance: float, name: str) -> LetterBoundary:
        """GeometryError: letters have corners, along which there is no smooth parallel."""
        raise GeometryError(f"there is no chamfer along the {self.name}", key="part", value=name)

    def moments(self, tolerance: float) -> Moments:
        """Exact but for rounding, see `camgeo.part.part.Boundary`."""
        return quadratic_moments(self.pieces)

    def second_moments(self, tolerance: float) -> SecondMoments:
        """Exact but for rounding, see `camgeo.part.part.Boundary`."""
        return quadratic_second_moments(self.pieces)

    def farthest(self) -> tuple[float, float | None]:
        """See `camgeo.part.part.Boundary`; no cam angle belongs to a point of it."""
        return max(self._radii()), None

    def nearest(self) -> float:
        """See `camgeo.part.part.Boundary`."""
        around = winding_number(self._arcs(self.coarsest).contour, 0j)
        return min(self._radii()) if around else 0.0

    def _radii(self) -> list[float]:
        """Distances from the cam axis of the ends of pieces, and where they are least or largest
        in between: where x x' = 0, a cubic.
        """
        start, middle, end = self.pieces.T
        a, b = start - 2.0 * middle + end, 2.0 * (middle - start)
        found: list[float] = np.abs(start).tolist()
        for k in range(len(start)):
            p, q, r = complex(a[k]), complex(b[k]), complex(start[k])
            cubic = [
                2.0 * abs(p) ** 2,
                3.0 * (p.conjugate() * q).real,
                2.0 * (p.conjugate() * r).real + abs(q) ** 2,
                (q.conjugate() * r).real,
            ]
            turns = np.roots(cubic).real
            inside = turns[(turns > 0.0) & (turns < 1.0)]
            found += [abs((p * t + q) * t + r) for t in inside.tolist()]
        return found


def _at(pieces: ComplexArray, t: FloatArray) -> ComplexArray:
    """(n,) points of quadratic curves (n, 3) at `t` (n,)."""
    w = 1.0 - t
    weights = np.stack((w * w, 2.0 * w * t, t * t), axis=1)
    points: ComplexArray = np.sum(weights * pieces, axis=1)
    return points


def _between_points(one: SplineContour, other: SplineContour) -> float:
    """Largest distance [mm] of the control points of two outlines of as many strands of the same
    kinds; infinite of others. Curves lie within it, for each point is a mean of these.
    """
    kinds = [[type(each) for each in contour.strands] for contour in (one, other)]
    count = len(one.strands)
    if len(other.strands) != count:
        return math.inf
    starts = np.array([complex(each.start) for each in other.strands])
    first = int(np.argmin(np.abs(starts - one.strands[0].start)))
    if kinds[0] != kinds[1][first:] + kinds[1][:first]:
        return math.inf
    largest = 0.0
    for k in range(count):
        mine, theirs = one.strands[k], other.strands[(first + k) % count]
        if isinstance(mine, CubicSpline) and isinstance(theirs, CubicSpline):
            if not np.array_equal(theirs.knots, mine.knots):
                return math.inf
            largest = max(largest, float(np.max(np.abs(mine.controls - theirs.controls))))
        elif isinstance(theirs, Arc) and theirs.sweep:
            return math.inf
        largest = max(largest, abs(mine.start - theirs.start), abs(mine.end - theirs.end))
    return largest
