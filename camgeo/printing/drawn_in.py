"""Boundaries drawn into the material by a distance, each face parallel to what it was."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from camgeo.contour.parallel import parallel
from camgeo.contour.simple import require_simple
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError, UndercutError
from camgeo.outline.outline import real_outline
from camgeo.outline.path import Path
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.part import Boundary
from camgeo.printing.scaled import ScaledBoundary, scaled


def drawn_in(boundary: Boundary, distance: float, name: str) -> Boundary:
    """The boundary called `name` that lies `distance` [mm] farther in the material.

    Raises
    ------
    GeometryError
        If nothing, or not one piece, is left of what it bounds, or if it is neither the outline of
        a flank nor lines and arcs, at any scale.
    """
    if isinstance(boundary, ScaledBoundary):
        own = drawn_in(boundary.unscaled, distance / boundary.factor, name)
        return scaled(own, boundary.factor)
    if isinstance(boundary, ExactBoundary):
        exact = boundary.exact.counter_clockwise()
        try:
            moved = parallel(exact, distance if boundary.hole else -distance)
            require_simple(moved, boundary.name)
        except (GeometryError, UndercutError):
            raise _gone(boundary.name, distance) from None
        return ExactBoundary(name, boundary.hole, moved)
    if isinstance(boundary, CurveBoundary):
        path = _flank_within(boundary, distance)
        return CurveBoundary(name, boundary.hole, path, boundary.ledger)
    raise GeometryError(f"the {boundary.name} cannot be drawn in", key="part")


def _flank_within(boundary: CurveBoundary, distance: float) -> Path:
    """The outline of the disc without a rim of `distance` [mm].

    What a roller leaves of a disc, without such a rim, is what a roller larger in radius by it
    leaves; and of a disc that a face touches, what the face leaves that comes nearer by it.
    """
    flank = boundary.path.stretches[0].curve
    by = distance if boundary.hole else -distance
    if flank.pitch.follower.has_pitch_curve:
        within = WorkingCurve(flank.pitch, flank.distance + by)
    else:
        follower: Any = flank.pitch.follower  # a frozen dataclass
        names = [key.removeprefix("follower.") for key in follower.raised_by]
        try:
            moved = replace(follower, **{each: getattr(follower, each) + by for each in names})
        except GeometryError:
            raise _gone(boundary.name, distance) from None
        within = WorkingCurve(replace(flank.pitch, follower=moved), flank.distance)
    try:
        found = real_outline(within)
    except UndercutError:
        raise _gone(boundary.name, distance) from None
    if found.lobes and len(found.lobes) > len(real_outline(flank).lobes):
        message = f"drawn in by {distance:g} mm, the {boundary.name} falls into several pieces"
        raise GeometryError(message, key="part")
    return found.path


def _gone(name: str, distance: float) -> GeometryError:
    message = f"nothing is left of the {name}, or not as it was, when it is drawn in by"
    return GeometryError(f"{message} {abs(distance):g} mm", key="part")
