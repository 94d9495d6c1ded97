"""What all readers of files share: numbers and tokens, the layers of drawings, and which contour of
a file is which boundary of the part.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from typing import Final

import numpy as np

from camgeo.design.drawn import TOPOLOGY_TOLERANCE
from camgeo.design.product import Product
from camgeo.errors import FileError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.spline import CubicSpline, SplineContour, at
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.part.part import Boundary, Edge, edges_of
from camgeo.reading import COORDINATE, number_of
from camgeo.units import MM_PER, counted


def finite(text: str, name: str, line: int) -> float:
    """The number `text` in a line of the file `name`.

    Raises FileError if it is none, not finite, or beyond the limits of `camgeo.reading`.
    """
    number = number_of(text)
    if number is None:
        what = f"is not a finite number of at most {COORDINATE:g}"
        raise FileError(f"{name}, line {line}: {text[:40]!r} {what}")
    return number


TOKEN: Final = re.compile(r"""[^\s,;()<>="']+|[,;()<>="']""")

COMPUTED: Final = 1e-9
"""Share of its size, or of 1, by which a number of a file may differ on another processor."""

OF_ARCS: Final = 1e-5
"""The same where arcs have centres or radii: last digits of the ends of flat ones move them."""


def text_tokens(data: bytes, place: str = "") -> Iterator[tuple[str, str]]:
    """The words, numbers and marks of a text, each with its `place`, by default its line."""
    for number, line in enumerate(data.decode("utf-8", "replace").splitlines(), 1):
        where = place or f"line {number}"
        for token in TOKEN.findall(line):
            yield where, token


# -- matching -------------------------------------------------------------------------------------
# Assignment of a file's contours to the boundaries of the part.


LOOSE = 1e-3
"""Share of its extent within which the place of a contour is found."""

ALIKE = 0.05
"""Areas that differ by less than this fraction do not show which is which: that of a small hole is
known no better with a tolerance for the whole drawing."""

AnyContour = Contour | SplineContour


def deviation(contours: Sequence[AnyContour], boundaries: tuple[Boundary, ...]) -> float:
    """Proved bound [mm] on the distance between the `contours` of a file and the `boundaries`.

    A wrong pairing would show as a large deviation, never as a small one. Raises FileError unless
    there are as many contours as boundaries.
    """
    if len(contours) != len(boundaries):
        names = ", ".join(boundary.name for boundary in boundaries)
        found = counted(len(contours), "closed contour")
        raise FileError(f"{found}, expected {len(boundaries)}: {names}")
    outlines = [boundary.arcs(TOPOLOGY_TOLERANCE, "fast").contour for boundary in boundaries]
    pairs = zip(boundaries, paired(contours, outlines), strict=True)
    return max(boundary.deviation(contour.counter_clockwise()) for boundary, contour in pairs)


def paired(contours: Sequence[AnyContour], outlines: Sequence[Contour]) -> list[AnyContour]:
    """The contours of a file in the order of as many `outlines`, approximate polygons of the part.

    The order of the areas distinguishes boundaries that lie inside each other; those of about the
    same size, such as the holes of a bolt circle and letters, lie at different places.
    """
    (wanted, middles), (given, places) = map(_areas_and_middles, (outlines, contours))
    unsure = [TOPOLOGY_TOLERANCE * each.length for each in outlines]
    order = np.argsort(wanted, kind="stable").tolist()
    free = np.argsort(given, kind="stable").tolist()
    found: dict[int, AnyContour] = {}
    while order:
        alike = _alike([(wanted[k], unsure[k]) for k in order])
        ours, free = free[:alike], free[alike:]
        for k in order[:alike]:
            away = np.abs(places[ours] - middles[k])
            away += np.abs(np.sqrt(given[ours]) - np.sqrt(wanted[k]))
            found[k] = contours[ours.pop(int(np.argmin(away)))]
        order = order[alike:]
    return [found[k] for k in range(len(outlines))]


def _alike(areas: Sequence[tuple[float, float]]) -> int:
    """How many of the first of ascending areas [mm^2], each with its uncertainty, one cannot tell
    by their order from the one before.
    """
    limit, count = math.inf, 0
    for area, unsure in areas:
        if area - unsure > limit:
            break
        limit = area * (1.0 + ALIKE) + unsure
        count += 1
    return count


def _areas_and_middles(contours: Sequence[AnyContour]) -> tuple[FloatArray, ComplexArray]:
    """(n,), (n,) complex areas [mm^2] and middles [mm] of contours."""
    areas = np.array([abs(each.area) for each in contours])
    return areas, np.array([_middle(each) for each in contours])


def _middle(contour: AnyContour) -> complex:
    """Middle of its bounding box [mm]."""
    points = points_of(contour, LOOSE * reach_of(contour))
    sides = (points.real, points.imag)
    x, y = (0.5 * float(np.min(each) + np.max(each)) for each in sides)
    return complex(x, y)


def reach_of(contour: AnyContour) -> float:
    """Largest distance of its vertices, or of its control points, from the cam axis [mm]."""
    if isinstance(contour, SplineContour):
        return contour.reach
    return float(abs(contour.vertices).max())


PARTS = 16
"""Points per line or cubic."""


def farthest(
    polygon: Contour, contour: Contour | SplineContour, sagitta: float
) -> tuple[float, complex]:
    """Largest distance [mm] found between the two and its place [mm].

    In both directions; for splines, only from them to the polygon. Arcs are replaced by chords
    that lie within `sagitta` [mm] of them.
    """
    found = [_largest(polygon.vertices, points_of(contour, sagitta))]
    if isinstance(contour, Contour):
        found.append(_largest(contour.points(sagitta), polygon.vertices))
    return max(found, key=lambda each: each[0])


def points_of(contour: Contour | SplineContour, sagitta: float) -> ComplexArray:
    """(m,) complex [mm] points on the contour, in any order."""
    share = np.arange(PARTS) / PARTS
    if isinstance(contour, Contour):
        lines = contour.sweeps == 0.0
        starts, ends = contour.vertices[lines, None], contour.ends[lines, None]
        between = (starts + (ends - starts) * share).ravel()
        return np.concatenate((contour.points(sagitta), between))
    parts: list[ComplexArray] = []
    for strand in contour.strands:
        if isinstance(strand, CubicSpline):
            parts.append(at(strand.beziers, share).ravel())
        else:
            parts.append(strand.at(share))
    return np.concatenate(parts)


def _largest(course: ComplexArray, points: ComplexArray) -> tuple[float, complex]:
    """Largest distance of `points` from the closed polygon `course`, and where."""
    distances = distances_from(course, points)
    index = int(np.argmax(distances))
    return float(distances[index]), complex(points[index])


def distances_from(course: ComplexArray, points: ComplexArray) -> FloatArray:
    """(n,) distance of `points` from the closed polygon `course`."""
    import shapely

    ends = np.stack((course, np.roll(course, -1)), axis=1)
    sides = np.asarray(shapely.linestrings(np.stack((ends.real, ends.imag), axis=2)))
    tree = shapely.STRtree(sides)
    places = shapely.points(points.real, points.imag)
    index, distances = tree.query_nearest(places, return_distance=True, all_matches=False)
    nearest = np.zeros(len(points))
    nearest[index[0]] = distances
    return nearest


# -- layers ---------------------------------------------------------------------------------------
# Layers of drawings by depth: what is cut through, and what is not.


CUT: Final = "CUT"
"""Layer of the edges that go through the disc."""

WORDS: Final = {"sunk": "BLIND", "raised": "RAISED"}

BELOW: Final = "BELOW"

DIGITS: Final = 6
"""Significant digits of a depth in the name of a layer."""


def layer_name(edge: Edge, scale: float) -> str:
    """Layer of an edge: "CUT", or e.g. "BLIND_6", "BLIND_BELOW_2.5", "RAISED_12".

    The number is the depth or height, `scale` mm to the unit; there is none if the scene states
    none.
    """
    if edge.kind == "through":
        return CUT
    words = [WORDS[edge.kind]]
    if edge.below:
        words.append(BELOW)
    if edge.by:
        by = edge.by / scale
        words.append(np.format_float_positional(by, DIGITS, fractional=False, trim="-"))
    return "_".join(words)


def layered(product: Product) -> dict[str, tuple[Boundary, ...]]:
    """The boundaries of the part by layers, CUT first."""
    found: dict[str, tuple[Boundary, ...]] = {CUT: ()}
    for edge in edges_of(product.drawn.part):
        name = layer_name(edge, MM_PER[product.unit])
        found[name] = (*found.get(name, ()), edge.boundary)
    return found


def of_the_part(layers: Iterable[str]) -> set[str]:
    """Those of `layers` that are named like layers of a part's edges."""
    heads = tuple(f"{word}_" for word in WORDS.values())
    known = (CUT, *WORDS.values())
    return {name for name in layers if name in known or name.startswith(heads)}
