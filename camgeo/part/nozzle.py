"""What a nozzle cannot make of a part: walls, radii and strokes narrower than what it lays down."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.check.finding import Finding, Severity
from camgeo.geometry.outline.outline import sure_bends
from camgeo.geometry.outline.path import Stretch
from camgeo.geometry.pieces import curvature_extremes
from camgeo.numeric.arrays import ComplexArray
from camgeo.part.boundaries import CurveBoundary
from camgeo.part.mass import Web
from camgeo.part.part import Boundary, Part, part_edges
from camgeo.units import TURN, at_cam_angles

if TYPE_CHECKING:
    from shapely import Polygon

WALL: Final = "print-wall"
RADIUS: Final = "print-radius"
STROKE: Final = "print-stroke"
"""Names of the findings."""

PERIMETERS: Final = 2
"""Number of nozzle widths below which a wall is worth a warning, as there is no line along each of
its sides."""

SAGITTA: Final = 2e-4
"""Tolerance of the chords by which strokes are measured [mm]; a stroke that is wider than the
nozzle less `SLACK` passes."""

SLACK: Final = 1e-3
"""See `SAGITTA` [mm]."""

DECIMALS: Final = 3
"""Decimals of the width of a stroke [mm], which is known no better."""

HALVINGS: Final = 12
"""Halvings of the range in which the width of a stroke lies."""


def nozzle_findings(part: Part, nozzle: float) -> Iterator[Finding]:
    """Findings, good and bad, on a part that is printed with lines of the width `nozzle` [mm].

    Raises
    ------
    UndercutError, ToleranceError
        If a boundary has no contour.
    """
    yield from _wall(part, nozzle)
    yield from _radius(part, nozzle)
    yield from _stroke(part, nozzle)


def _wall(part: Part, nozzle: float) -> Iterator[Finding]:
    """Report the thinnest wall: below one width of the nozzle it is not printed, below two widths
    it is a single line.
    """
    web, _ = Web.thinnest_webs(part, PERIMETERS * nozzle)
    if web is None:
        return
    least = PERIMETERS * nozzle
    severity: Severity = "ok"
    limit, verdict = least, f"at least {least:g} mm, {PERIMETERS} widths of the nozzle"
    if web.thickness < nozzle:
        severity, limit = "broken", nozzle
        verdict = f"below {nozzle:g} mm, the width of the nozzle: it will be missing"
    elif web.thickness < least:
        severity = "warning"
        verdict = f"below {least:g} mm, {PERIMETERS} widths of the nozzle: it will be a single line"
    sentence = (
        f"smallest printed wall {web.thickness:.6g} mm, between {web.one} and {web.other}, at"
        f" ({web.place.real:.4g}, {web.place.imag:.4g}) mm, {verdict}"
    )
    yield Finding(WALL, severity, sentence, web.thickness, limit, "mm")


def _radius(part: Part, nozzle: float) -> Iterator[Finding]:
    """Report the smallest radius of a flank; lines have round ends of half the nozzle's width."""
    flanks = [boundary for boundary in part.boundaries if isinstance(boundary, CurveBoundary)]
    if not flanks:
        return
    radius, bend, angle, name = min((*_tightest(boundary), boundary.name) for boundary in flanks)
    limit = 0.5 * nozzle
    what = f"smallest {bend} radius of the {name} {radius:.4g} mm"
    what = what if radius > 0.0 else f"the {name} has a corner"
    where = at_cam_angles(angle)
    if radius >= limit:
        yield Finding(
            RADIUS, "ok", f"{what} {where}, at least {limit:g} mm, half the nozzle", radius, limit,
            "mm", angle,
        )  # fmt: skip
        return
    becomes = "filled in" if bend == "concave" else "rounded off"
    sentence = f"{what} {where}, below {limit:g} mm, half the nozzle: it will be {becomes}"
    yield Finding(RADIUS, "warning", sentence, radius, limit, "mm", angle)


def _tightest(boundary: CurveBoundary) -> tuple[float, str, float]:
    """Smallest radius of curvature of a flank [mm], whether the material is "convex" or "concave"
    there, and the cam angle [rad].
    """
    path = boundary.path
    curve = path.stretches[0].curve
    bends = curvature_extremes(curve.pitch)
    if curve.pitch.follower.has_pitch_curve:
        bends = sure_bends(curve, bends)
    # The radius of the parallel grows with that of the pitch curve, so its extremes are there too.
    with np.errstate(divide="ignore"):
        radii = 1.0 / bends.values + curve.distance
    # A parallel on the other side of the centre of curvature bends the same way.
    concave = (radii < 0.0) != boundary.hole
    candidates = [(math.inf, "convex", 0.0)]
    for radius, inward, angle in zip(radii, concave, bends.phi, strict=True):
        if any(_runs(stretch, float(angle)) for stretch in path.stretches) and math.isfinite(
            radius
        ):
            candidates.append((abs(float(radius)), "concave" if inward else "convex", float(angle)))
    for pivot in path.pivots:
        # On the side of its centre where the material is, a turn is convex.
        inward = (pivot.distance < 0.0) != boundary.hole
        bend = "concave" if inward and pivot.distance else "convex"
        candidates.append((abs(pivot.distance), bend, pivot.phi_start))
    return min(candidates)


def _runs(stretch: Stretch, angle: float) -> bool:
    """Whether the stretch passes the cam angle `angle` [rad]."""
    return (angle - stretch.start) % TURN <= stretch.end - stretch.start


def _stroke(part: Part, nozzle: float) -> Iterator[Finding]:
    """Report the narrowest stroke of a mark or an engraving, if the nozzle is too wide for it."""
    radius, narrowest = 0.5 * nozzle - SLACK, None
    for name, region in sunk(part):
        # Only what is narrower than all before is looked at closely.
        lost = unreached(region, radius) if radius > 0.0 else None
        if lost is not None:
            radius, place = _narrowest(region, radius, lost)
            narrowest = name, place
    if narrowest is None:
        return
    name, (x, y) = narrowest
    width = round(2.0 * radius, DECIMALS)
    sentence = (
        f"a stroke of the {name} is {width:.2g} mm wide at ({x:.4g}, {y:.4g}) mm, below"
        f" {nozzle:g} mm, the width of the nozzle: it will close up"
    )
    yield Finding(STROKE, "warning", sentence, width, nozzle, "mm")


def sunk(part: Part) -> list[tuple[str, Polygon]]:
    """The names and regions [mm] of all that is sunk into a face, except grooves."""
    import shapely  # few scenes state a nozzle

    by_height: dict[tuple[float, float], list[Boundary]] = {}
    blind = {edge.boundary.name for edge in part_edges(part) if edge.kind == "sunk"}
    for wall in part.walls:
        if wall.boundary.name in blind and not isinstance(wall.boundary, CurveBoundary):
            by_height.setdefault((wall.z0, wall.z1), []).append(wall.boundary)
    regions = []
    for boundaries in by_height.values():
        holes = [boundary for boundary in boundaries if boundary.hole]
        islands = [_polygon(boundary) for boundary in boundaries if not boundary.hole]
        for hole in holes:
            around = _polygon(hole)
            inside = shapely.union_all([island for island in islands if island.within(around)])
            parts = shapely.get_parts(around.difference(inside))
            regions += [(hole.name, region) for region in parts if region.area > 0.0]
    return regions


def _polygon(boundary: Boundary) -> Polygon:
    from shapely import Polygon

    points: ComplexArray = boundary.distance_fit(SAGITTA).contour.points(SAGITTA)
    return Polygon(np.column_stack((points.real, points.imag)))


def _narrowest(
    region: Polygon, radius: float, lost: tuple[float, float]
) -> tuple[float, tuple[float, float]]:
    """Half the least width [mm] of a region that a disc of `radius` [mm] does not fill, and its
    place.
    """
    low, high = 0.0, radius
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        here = unreached(region, middle)
        if here is None:
            low = middle
        else:
            high, lost = middle, here
    return high, lost


def unreached(region: Polygon, radius: float) -> tuple[float, float] | None:
    """A place of a region that a disc of `radius` [mm] cannot reach from within; None if it reaches
    all of it in one go.

    Corners do not count, nor does what is less than a diameter beyond the reach of the disc.
    """
    import shapely

    reachable = region.buffer(-radius)
    reached = reachable.buffer(radius)
    missing = region.difference(reached)
    pieces = shapely.get_parts(reachable)
    # The region is parted if the disc's centre cannot get everywhere, or cannot go round each hole:
    # then some stroke is too narrow, however short it is.
    parted = len(pieces) != 1 or len(pieces[0].interiors) != len(region.interiors)
    if not parted:
        missing = missing.difference(reached.buffer(2.0 * radius))
    if missing.is_empty:
        return None
    place = max(shapely.get_parts(missing), key=lambda piece: piece.area).representative_point()
    return place.x, place.y
