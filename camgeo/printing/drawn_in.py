"""Boundaries drawn into the material by a distance, each face parallel to what it was."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, Final

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.contour.simple import require_simple
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError, UndercutError
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.outline.outline import real_outline
from camgeo.outline.path import Path
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.part import Boundary
from camgeo.printing.scaled import ScaledBoundary, scaled
from camgeo.units import TURN

SMOOTH: Final = 1e-9
"""Sine of the angle between two pieces up to which their joint is not a corner."""


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


def parallel(contour: Contour, distance: float) -> Contour:
    """The lines and arcs of a counter-clockwise contour, each `distance` [mm] farther out, up to
    where neighbours meet: corners stay corners.

    Raises
    ------
    GeometryError
        If a piece turns inside out, or neighbours do not meet.
    """
    starts, ends = contour.vertices, contour.ends
    round_ = contour.sweeps != 0.0
    signs = np.sign(contour.sweeps)
    arms = starts - contour.centres
    ahead = np.where(round_, 1j * signs * arms, ends - starts)
    ahead /= np.abs(ahead)
    # Turned by the sweep, the direction at its start is that at its end.
    leaving = ahead * np.exp(1j * contour.sweeps)
    radii = contour.radii + signs * distance
    if np.any(round_ & (radii <= 0.0)):
        raise _gone("contour", distance)
    shifted = starts - 1j * distance * ahead
    corners = []
    for k in range(len(contour)):
        before = k - 1
        turn = (np.conj(leaving[before]) * ahead[k]).imag
        if abs(turn) <= SMOOTH:
            corners.append(complex(shifted[k]))
            continue
        carriers = [
            (complex(contour.centres[j]), float(radii[j]))
            if round_[j]
            else (complex(shifted[j]), complex(ahead[j]))
            for j in (before, k)
        ]
        corners.append(_meeting(carriers[0], carriers[1], complex(starts[k]), distance))
    vertices = np.array(corners)
    sweeps = _sweeps(contour, vertices, ahead, distance)
    return Contour(vertices, sweeps, contour.centres)


Carrier = tuple[complex, complex | float]
"""A line by a point and its unit direction, complex; a circle by centre and radius, a float."""


def _meeting(one: Carrier, other: Carrier, near: complex, distance: float) -> complex:
    """Where two lines or circles meet, next to `near`."""
    if isinstance(one[1], float) and isinstance(other[1], float):
        between = other[0] - one[0]
        apart = abs(between)
        along = (apart**2 + one[1] ** 2 - other[1] ** 2) / (2.0 * apart) if apart else math.inf
        found = _either_side(one[0], between / (apart or 1.0), along, one[1])
    elif isinstance(one[1], float) or isinstance(other[1], float):
        (centre, radius), (point, direction) = sorted((one, other), key=_is_line)
        assert isinstance(radius, float)
        foot = ((centre - point) * np.conj(direction)).real
        away = point + foot * direction - centre
        # In the direction of the foot, the line is at its distance from the centre.
        unit = away / abs(away) if abs(away) > 0.0 else 1j * direction
        found = _either_side(centre, unit, abs(away), radius)
    else:
        cross = (np.conj(one[1]) * other[1]).imag
        share = (np.conj(other[0] - one[0]) * other[1]).imag / cross
        return complex(one[0] + share * one[1])
    if not found:
        raise _gone("contour", distance)
    return min(found, key=lambda point: abs(point - near))


def _is_line(carrier: Carrier) -> bool:
    return not isinstance(carrier[1], float)


def _either_side(
    centre: complex, unit: complex, along: float, radius: float
) -> tuple[complex, ...]:
    """The points of a circle at `along` [mm] in the direction `unit`; none if it is smaller."""
    if abs(along) > radius:
        return ()
    aside = math.sqrt((radius - along) * (radius + along))
    return centre + (along + 1j * aside) * unit, centre + (along - 1j * aside) * unit


def _sweeps(
    contour: Contour, vertices: ComplexArray, ahead: ComplexArray, distance: float
) -> FloatArray:
    """(n,) [rad] by which the moved pieces turn; none may turn back."""
    ends = np.roll(vertices, -1)
    sweeps = contour.sweeps.copy()
    for k, sweep in enumerate(contour.sweeps):
        if sweep == 0.0:
            if ((ends[k] - vertices[k]) * np.conj(ahead[k])).real <= 0.0:
                raise _gone("contour", distance)
            continue
        start, end = vertices[k] - contour.centres[k], ends[k] - contour.centres[k]
        turned = float(np.angle(end / start)) * np.sign(sweep) % TURN
        near = abs(sweep)
        # Ends of whole turns may be rounded to either side.
        turned = min((turned, turned + TURN), key=lambda each: abs(each - near))
        if abs(turned - near) > 0.25 * TURN or not turned > 0.0:
            raise _gone("contour", distance)
        sweeps[k] = math.copysign(turned, sweep)
    return sweeps


def _gone(name: str, distance: float) -> GeometryError:
    message = f"nothing is left of the {name}, or not as it was, when it is drawn in by"
    return GeometryError(f"{message} {abs(distance):g} mm", key="part")
