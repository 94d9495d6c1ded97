"""Tangential lead-in and lead-out: arcs that join a closed path without a corner."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.errors import GeometryError

CHECKED_POINTS = 33
"""Points of a lead that are checked for gouging."""

SMALLEST_SHARE = 1.0 / 64.0
"""A lead is halved down to this fraction of its room before it is given up."""


@dataclass(frozen=True, slots=True)
class Lead:
    """Arcs onto and off a path at its first point, counter-clockwise.

    Attributes
    ----------
    start, end : complex [mm] where the lead-in begins and the lead-out ends.
    centre : complex [mm], of both arcs.
    """

    start: complex
    end: complex
    centre: complex


def started(contour: Contour, index: int) -> Contour:
    """The same contour, starting in the middle of its piece `index`, an arc or a line."""
    contour = contour.rolled(index)
    sweep, centre = contour.sweeps[0], contour.centres[0]
    middle = 0.5 * (contour.vertices[0] + contour.ends[0])
    if sweep != 0.0:
        middle = centre + (contour.vertices[0] - centre) * np.exp(0.5j * sweep)
    return Contour(
        np.concatenate(([middle], contour.vertices[1:], contour.vertices[:1])),
        np.concatenate(([0.5 * sweep], contour.sweeps[1:], [0.5 * sweep])),
        np.concatenate(([centre], contour.centres[1:], [centre])),
    )


def start_tangent(contour: Contour) -> complex:
    """Unit tangent at the contour's first vertex, in its direction."""
    sweep, start = float(contour.sweeps[0]), complex(contour.vertices[0])
    if sweep == 0.0:
        along = complex(contour.ends[0]) - start
    else:
        along = 1j * np.sign(sweep) * (start - complex(contour.centres[0]))
    return along / abs(along)


def quarter_circle_lead(path: Contour, room: float) -> Lead:
    """Quarter circles on the free side, the left, of at most `room` [mm], clear of the path.

    Raises
    ------
    GeometryError
        If even a small lead would cut into the part.
    """
    import shapely

    point, tangent = complex(path.vertices[0]), start_tangent(path)
    outline = path.points(1e-4 * path.length)
    region = shapely.Polygon(np.column_stack((outline.real, outline.imag)))
    free_is_outside = path.area < 0.0
    radius = room
    while radius >= SMALLEST_SHARE * room:
        centre = point + radius * (1j * tangent)
        half = np.linspace(-0.5 * np.pi, 0.5 * np.pi, CHECKED_POINTS)
        points = centre + (point - centre) * np.exp(1j * half)
        points = np.delete(points, CHECKED_POINTS // 2)
        inside = shapely.contains_xy(region, points.real, points.imag)
        if not np.any(inside == free_is_outside):
            return Lead(centre - radius * tangent, centre + radius * tangent, centre)
        radius /= 2.0
    raise GeometryError(
        "there is no room for a tangential lead-in next to the outline; a smaller cutter may help",
        key="tool",
    )
