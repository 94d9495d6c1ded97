"""Mass properties of a part, and the thinnest material between its boundaries.

The body has a uniform density. Each face around it contributes what its boundary encloses between
its heights, with the sign of its material side, so any list of layers is covered.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations, groupby
from typing import Final

import numpy as np

from camgeo.geometry.contour.contour import (
    Contour,
    Pieces,
    distances,
    least_distance,
    winding_number,
)
from camgeo.geometry.outline.exact_flank import ExactFlank
from camgeo.geometry.outline.path import Flank, Moments
from camgeo.numeric.checked import CheckedFields, Floats
from camgeo.numeric.quadrature import gauss, nodes_for_singularity
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.part import Band, Boundary, Layer, Part
from camgeo.part.spec import text_name

TOLERANCE: Final = 1e-10
"""Tolerance of the integrals over each boundary, a share, see
`camgeo.geometry.outline.path.Path.moments`."""

NODES: Final = 3
"""Nodes of the Gauss rule over the height of a chamfer without corners."""


@dataclass(frozen=True, slots=True, eq=False)
class Solid(CheckedFields):
    """A part as a body of uniform density, in cam coordinates with z upward, 0 on the upper face of
    the disc.

    Attributes
    ----------
    volume : volume [mm^3].
    centre : (3,) centre of mass [mm].
    inertia : (3, 3) inertia tensor about the centre of mass, for a density of 1 [mm^5]: moments of
        inertia in the diagonal, products with a minus sign off it.
    axial : moment of inertia about the cam axis, for a density of 1 [mm^5].
    share : estimate of the relative error of volume and moment of inertia about the cam axis.
    centre_error : estimate of the error of the centre of mass in the plane [mm].
    """

    volume: float
    centre: Floats
    inertia: Floats
    axial: float
    share: float
    centre_error: float

    @staticmethod
    def from_part(part: Part, tolerance: float = TOLERANCE) -> Solid:
        """The part as a body; raises GeometryError like `Part.require_heights`."""
        part.require_heights()
        volume, first, second, axial = [], [], [], []
        volume_errors, first_errors, axial_errors = [], [], []
        for part_slice in _slices(part):
            # A boundary counts with what it encloses, a hole negatively.
            sign = -1.0 if part_slice.section.hole else 1.0
            plane = part_slice.section.moments(tolerance).scaled(sign)
            plane2 = part_slice.section.second_moments(tolerance).scaled(sign)
            height, z1, z2 = part_slice.height, part_slice.first, part_slice.second
            x, y = plane.first.real, plane.first.imag
            # From the polar second moment of x + i y and that of its square.
            xx, yy = (0.5 * (plane2.polar + turn * plane2.square.real) for turn in (1.0, -1.0))
            xy = 0.5 * plane2.square.imag
            volume.append(plane.area * height)
            first.append((x * height, y * height, plane.area * z1))
            second.append((xx * height, yy * height, plane.area * z2, xy * height, x * z1, y * z1))
            axial.append(plane2.polar * height)
            volume_errors.append(plane.area_error * height)
            first_errors.append(plane.first_error * height)
            axial_errors.append(plane2.polar_error * height)
        whole = math.fsum(volume)
        centre = np.array([math.fsum(column) for column in zip(*first, strict=True)]) / whole
        xx, yy, zz, xy, xz, yz = (math.fsum(column) for column in zip(*second, strict=True))
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        # Steiner: from second moments about the origin to those about the centre of mass.
        inertia -= whole * np.outer(centre, centre)
        turning, unsure = math.fsum(axial), math.fsum(volume_errors) / whole
        return Solid(
            volume=whole,
            centre=centre,
            inertia=np.trace(inertia) * np.eye(3) - inertia,
            axial=turning,
            share=max(unsure, math.fsum(axial_errors) / turning),
            centre_error=math.fsum(first_errors) / whole + unsure * float(np.hypot(*centre[:2])),
        )


@dataclass(frozen=True, slots=True)
class _Slice:
    """A section with its weights in the integrals of 1, z and z^2 over the height z.

    Attributes
    ----------
    section : the boundary of the section.
    height, first, second : the weights [mm], [mm^2] and [mm^3].
    """

    section: Boundary
    height: float
    first: float
    second: float


def _slices(part: Part) -> Iterator[_Slice]:
    """The sections over which integrals of a part are taken.

    An upright face has one, a chamfer those at the nodes of a Gauss rule. What a parallel of a
    smooth boundary encloses is a polynomial of its distance: the area of degree 2, the first
    moments of 3, the second ones of 4. With the powers of z no integrand is above degree 4, and the
    rule is exact up to 5. At mitred corners more nodes are exact up to rounding, see
    `camgeo.part.boundaries.corner_radius`.
    """
    for band in part.bands:
        if band.is_upright:
            yield _Slice(
                band.wall, *((band.z1**power - band.z0**power) / power for power in (1, 2, 3))
            )
            continue
        yield from _sections(band)


def _sections(band: Band) -> Iterator[_Slice]:
    """The sections of a chamfer over which integrals are taken."""
    radius = band.wall.corner_radius
    nodes = NODES if radius is None else nodes_for_singularity(-1.0 - radius / band.width)
    places, half, weights = gauss(np.array([band.z0]), np.array([band.z1]), nodes)
    for z, share in zip(places[0].tolist(), (half[0] * weights).tolist(), strict=True):
        yield _Slice(band.section(z), share, share * z, share * z * z)


def chamfer_volume(band: Band, tolerance: float = TOLERANCE) -> float:
    """Volume that a chamfer encloses [mm^3], positive for the chamfer of a hole as well."""
    return math.fsum(
        section.height * section.section.moments(tolerance).area for section in _sections(band)
    )


def section_area(layer: Layer, tolerance: float = TOLERANCE) -> float:
    """Area of the material in a layer [mm^2]."""
    return Moments.total(_material(boundary, tolerance) for boundary in layer.boundaries).area


def disc_moments(part: Part, density: float, tolerance: float) -> Moments:
    """Mass [t] as the area, and mass times centre of mass [t mm] as the first moment.

    Parameters
    ----------
    part : with known thickness. Each boundary counts with the height of its faces.
    density : [t/mm^3].
    tolerance : share, for the integrals over the outlines, see
        `camgeo.geometry.outline.path.Path.moments`.
    """
    return Moments.total(
        Moments.total(_material(part_slice.section, tolerance) for part_slice in slices).scaled(
            density * height
        )
        for height, slices in groupby(_slices(part), lambda part_slice: part_slice.height)
    )


def _material(boundary: Boundary, tolerance: float) -> Moments:
    """What a boundary adds to the moments of the material: negative for a hole."""
    return boundary.moments(tolerance).scaled(-1.0 if boundary.hole else 1.0)


def largest_diameter(part: Part) -> tuple[float, float | None]:
    """Diameter of the circle about the cam axis that the part sweeps [mm]; if a flank is farthest,
    with the cam angle [rad] at which its farthest place is in contact, else with None.
    """
    outer = [boundary.farthest() for boundary in part.boundaries if not boundary.hole]
    radius, place = max(outer, key=lambda farthest: farthest[0])
    return 2.0 * radius, place


# -- webs -----------------------------------------------------------------------------------------
# The thinnest material between two boundaries of a part.


TOLERANCES: Final = (1e-2, 1e-4, 1e-6)
"""Tolerances of the contours of flanks [mm], each tried if the one before leaves a comparison open.
"""

SHARE: Final = 0.1
"""Least thickness of a web as a share of the diameter of the larger hole beside it: a ring of that
wall bears at its bore, by Lame's equations, 5.5 times the pressure there as hoop stress.
"""

POINTS: Final = 400
"""Number of points along a hole by which the place of a web is determined."""

STEP: Final = 0.1
"""Sweep of the arcs [rad] by whose ends circles about holes are determined."""


Size = Callable[[float, float], float]
"""What webs are compared by, as a function of thickness and usual thickness [mm]."""


@dataclass(frozen=True, slots=True)
class Web:
    """Material between two boundaries.

    Attributes
    ----------
    one, other : names of the boundaries, of which the other one is a hole.
    thickness : the smallest distance between them [mm], exact of lines and arcs, beside a circle
        about the cam axis, and where a circle or corner of a hole is nearest to a flank; else
        within the second of `TOLERANCES`, or the last if that decides how it compares.
    usual : thickness that it should have [mm], by `SHARE`; 0 beside flanks alone, whose loads
        decide it.
    place : point on the hole where the web is thinnest [mm], as exact as the eye needs it.
    """

    one: str
    other: str
    thickness: float
    usual: float
    place: complex

    @staticmethod
    def thinnest_webs(part: Part, limit: float | None = None) -> tuple[Web | None, Web | None]:
        """The web of the smallest thickness, and the web that is thinnest as a share of its usual
        thickness.

        The first is as exact as its comparison with the `limit` [mm] takes, or with its usual
        thickness if there is no limit; None if the part has no holes. The second is None with a
        limit, or if no web has a usual thickness.

        Raises
        ------
        UndercutError, ToleranceError
            If a boundary has no contour.
        """
        sizes = (_thickness, _share) if limit is None else (_thickness,)
        best: dict[Size, tuple[float, float, Web]] = {}
        for one, hole in _pairs(part):
            usual, least = _usual(one, hole), _least(one, hole)
            # A lower bound above the best value so far spares the comparison of contours.
            beaten = [size for size in sizes if size in best and size(least, usual) > best[size][0]]
            if len(beaten) == len(sizes) or not _has_material(one, hole):
                continue
            web = _web(one, hole, usual, usual if limit is None else limit)
            for size in sizes:
                new = size(web.thickness, usual), web.thickness, web
                if size not in best or new[:2] < best[size][:2]:
                    best[size] = new
        thinnest, slimmest = (
            best[size][2] if size in best else None for size in (_thickness, _share)
        )
        return thinnest, slimmest if slimmest is not None and slimmest.usual else None

    @staticmethod
    def surely_thick(part: Part, limit: float | None = None) -> bool:
        """Whether circles about the boundaries suffice to show that no web is thinner than the
        `limit` [mm], or than its usual thickness if that is None; raises like `thinnest_webs`.
        """
        return all(
            _least(one, hole) >= (_usual(one, hole) if limit is None else limit)
            for one, hole in _pairs(part)
        )


def _thickness(thickness: float, _: float) -> float:
    return thickness


def _share(thickness: float, usual: float) -> float:
    return thickness / usual if usual else math.inf


def _pairs(part: Part) -> Iterator[tuple[Boundary, Boundary]]:
    """Pairs of boundaries of a layer of which at least the second is a hole, each pair once."""
    known: set[tuple[str, str]] = set()
    for layer in part.layers:
        for pair in combinations(_load_bearing(layer), 2):
            one, hole = pair if pair[1].hole else pair[::-1]
            names = one.name, hole.name
            if hole.hole and names not in known:
                known.add(names)
                yield one, hole


def _load_bearing(layer: Layer) -> list[Boundary]:
    """The boundaries of a layer without those of letters, beside which no load is borne."""
    return [boundary for boundary in layer.boundaries if not text_name(boundary.name)]


def _least(one: Boundary, hole: Boundary) -> float:
    """A lower bound of the thickness of a web [mm], from circles about two holes, or about the cam
    axis within an outline and around a hole.
    """
    if not one.hole:
        return max(0.0, one.nearest() - hole.farthest()[0])
    circles = []
    for boundary in (one, hole):
        fit = boundary.distance_fit(TOLERANCES[0])
        fine = fit.contour.split(STEP)
        middle = complex(np.mean(fine.vertices))
        # The circle must hold the arcs between their ends as well, which bulge by the sagitta.
        sagitta = float(np.max(fine.radii)) * (1.0 - math.cos(0.5 * STEP))
        reach = float(np.max(np.abs(fine.vertices - middle))) + sagitta
        circles.append((middle, reach))
    (a, reach_a), (b, reach_b) = circles
    return max(0.0, abs(a - b) - reach_a - reach_b)


def _has_material(one: Boundary, hole: Boundary) -> bool:
    """Whether there is material between two boundaries of a section, if others are ignored."""
    a, b = (boundary.distance_fit(TOLERANCES[0]).contour for boundary in (one, hole))
    if one.hole:
        return not (_inside(a, b) or _inside(b, a))
    return _inside(b, a)


def _inside(contour: Contour, around: Contour) -> bool:
    return winding_number(around, complex(contour.vertices[0])) != 0


def _web(one: Boundary, hole: Boundary, usual: float, compared: float) -> Web:
    exact = None if one.hole else _concentric_web(one, hole)
    # If the thickness is known exactly, contours only show its place, and the coarsest suffice.
    for tolerance in TOLERANCES[1:] if exact is None else TOLERANCES[:1]:
        fits = [boundary.distance_fit(tolerance) for boundary in (one, hole)]
        a, b = (Pieces.around([fit.contour]) for fit in fits)
        distance = least_distance(a, b) if exact is None else exact
        unsure = sum(fit.deviation for fit in fits)
        if exact is not None or abs(distance - compared) > unsure:
            break
    if exact is None:
        distance = _flank_web(one, hole, distance, unsure)
    around = fits[1].contour
    points = around.points(around.length / POINTS**2)
    place = complex(points[np.argmin(distances(points, a))])
    return Web(one.name, hole.name, distance, usual, place)


def _flank_web(one: Boundary, hole: Boundary, distance: float, unsure: float) -> float:
    """The web [mm] between a flank and lines and arcs, by the feet of their corners and centres on
    the flank; `apart`, which is within `unsure` of it, where none of these is nearest.
    """
    flank, other = (one, hole) if isinstance(one, CurveBoundary) else (hole, one)
    if not isinstance(flank, CurveBoundary) or not isinstance(other, ExactBoundary):
        return distance
    exact = other.exact
    # Nearest to the flank is a corner, or the point of an arc in line with its centre and the foot.
    arcs = exact.sweeps != 0.0
    points = np.concatenate((exact.vertices, exact.centres[arcs]))
    radii = np.concatenate((np.zeros(len(exact)), exact.radii[arcs]))
    feet = ExactFlank(flank.path, Flank.INNER).feet(points)
    webs = np.abs(feet.distances) - radii
    webs = webs[np.abs(webs - distance) <= unsure]
    return float(np.min(webs)) if len(webs) else distance


def _concentric_web(one: Boundary, hole: Boundary) -> float | None:
    """Thickness [mm] of the web between `one` and a hole within it, if either is a circle about the
    cam axis; else None.
    """
    radius = _radius(hole)
    if radius is not None:
        return one.nearest() - radius
    radius = _radius(one)
    return None if radius is None else radius - hole.farthest()[0]


def _radius(boundary: Boundary) -> float | None:
    """Radius [mm] of a boundary that is a circle about the cam axis; None for any other."""
    if not isinstance(boundary, ExactBoundary):
        return None
    exact = boundary.exact
    if exact.arc_count < len(exact) or np.any(exact.centres != 0.0):
        return None
    return float(exact.radii[0])


def _usual(one: Boundary, hole: Boundary) -> float:
    """Usual thickness of a web [mm], by the circle of the same area as the larger hole."""
    holes = [
        boundary
        for boundary in (one, hole)
        if boundary.hole and isinstance(boundary, ExactBoundary)
    ]
    areas = [abs(boundary.exact.area) for boundary in holes]
    return SHARE * 2.0 * math.sqrt(max(areas, default=0.0) / math.pi)
