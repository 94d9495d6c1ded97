"""Parallels of contours of lines and arcs that keep their corners, as mitres do."""

from __future__ import annotations

import math
from itertools import count
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray
from camgeo.units import TURN

SAG: Final = 1.21
"""Largest distance of the root of a linear function from its chord, by that in the middle: at most
(1 + sqrt 2) / 2, where the root is 0 at one end."""

SMOOTH: Final = 1e-9
"""Sine of the angle between two pieces up to which their joint is not a corner."""


def parallel(contour: Contour, distance: float) -> Contour:
    """The lines and arcs of a counter-clockwise contour, each `distance` [mm] farther out, up to
    where neighbours meet: corners stay corners.

    Raises
    ------
    GeometryError
        If a piece turns inside out, or neighbours do not meet.
    """
    starts, round_ = contour.vertices, contour.sweeps != 0.0
    ahead, sharp = _start_directions(contour), corners(contour)
    radii = contour.radii + np.sign(contour.sweeps) * distance
    if np.any(round_ & (radii <= 0.0)):
        raise _parallel_error(distance)
    # The contour runs counter-clockwise, so that outside is on the right of its direction.
    shifted = starts - 1j * distance * ahead
    vertices = shifted.copy()
    for k in np.flatnonzero(sharp).tolist():
        carriers = [
            (complex(contour.centres[j]), float(radii[j]))
            if round_[j]
            else (complex(shifted[j]), complex(ahead[j]))
            for j in (k - 1, k)
        ]
        vertices[k] = _meeting_point(carriers[0], carriers[1], complex(starts[k]), distance)
    sweeps = _sweeps(contour, vertices, ahead, distance)
    return Contour(vertices, sweeps, contour.centres)


Carrier = tuple[complex, complex | float]
"""A line by a point and its unit direction, complex; a circle by centre and radius, a float."""


def _meeting_point(one: Carrier, other: Carrier, near: complex, distance: float) -> complex:
    """Where two lines or circles meet, next to `near`."""
    if isinstance(one[1], float) and isinstance(other[1], float):
        centre_line = other[0] - one[0]
        centre_distance = abs(centre_line)
        # Along the line of centres to the common chord of the circles; concentric ones have none.
        along = (
            (centre_distance**2 + one[1] ** 2 - other[1] ** 2) / (2.0 * centre_distance)
            if centre_distance
            else math.inf
        )
        points = _either_side(one[0], centre_line / (centre_distance or 1.0), along, one[1])
    elif isinstance(one[1], float) or isinstance(other[1], float):
        (centre, radius), (point, direction) = sorted(
            (one, other), key=lambda carrier: not isinstance(carrier[1], float)
        )
        assert isinstance(radius, float)
        foot = ((centre - point) * np.conj(direction)).real
        away = point + foot * direction - centre
        # In the direction of the foot, the line is at its distance from the centre.
        unit = away / abs(away) if abs(away) > 0.0 else 1j * direction
        points = _either_side(centre, unit, abs(away), radius)
    else:
        cross = (np.conj(one[1]) * other[1]).imag
        share = (np.conj(other[0] - one[0]) * other[1]).imag / cross
        return complex(one[0] + share * one[1])
    if not points:
        raise _parallel_error(distance)
    return min(points, key=lambda point: abs(point - near))


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
                raise _parallel_error(distance)
            continue
        start, end = vertices[k] - contour.centres[k], ends[k] - contour.centres[k]
        # Counted in the sense of the sweep, in [0, 2 pi).
        turned = float(np.angle(end / start)) * np.sign(sweep) % TURN
        near = abs(sweep)
        # Ends of whole turns may be rounded to either side.
        turned = min((turned, turned + TURN), key=lambda angle: abs(angle - near))
        if abs(turned - near) > 0.25 * TURN or not turned > 0.0:
            raise _parallel_error(distance)
        sweeps[k] = math.copysign(turned, sweep)
    return sweeps


def _start_directions(contour: Contour) -> ComplexArray:
    """(n,) unit direction at the start of each piece."""
    turned = 1j * np.sign(contour.sweeps) * (contour.vertices - contour.centres)
    ahead = np.where(contour.sweeps != 0.0, turned, contour.ends - contour.vertices)
    return np.asarray(ahead / np.abs(ahead))


def corners(contour: Contour) -> BoolArray:
    """(n,) whether the piece before each vertex comes to it in another direction."""
    ahead = _start_directions(contour)
    # Turned by the sweep, the direction at the start of a piece is that at its end.
    leaving = np.roll(ahead * np.exp(1j * contour.sweeps), 1)
    return np.asarray(np.abs((np.conj(leaving) * ahead).imag) > SMOOTH)


def count_steps(contour: Contour, distance: float, limit: float) -> int:
    """Least number of equal steps to a parallel between which corners leave the chords of the
    parabolas along which they slide by at most `limit` [mm].
    """

    def corner_error(step: float) -> float:
        # The root of a linear function bends most where it is smallest: in its first step.
        middle, end = (parallel(contour, shift).vertices for shift in (0.5 * step, step))
        return SAG * float(np.max(np.abs(middle - 0.5 * (contour.vertices + end))))

    return next(steps for steps in count(1) if corner_error(distance / steps) <= limit)


def _parallel_error(distance: float) -> GeometryError:
    return GeometryError(
        f"the contour has no parallel with the same pieces at {abs(distance):g} mm", key="part"
    )
