"""Does a contour cross itself? Topology only, by shapely; no geometry comes from there."""

from __future__ import annotations

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.errors import UndercutError

SAGITTA = 1e-5
"""Chords for the test lie this share of the contour's length off its arcs."""


def crossing(contour: Contour) -> str | None:
    """Where the contour crosses itself, as shapely tells it; None if it does not."""
    from shapely import Polygon  # only where files are made: checks must not pay for it
    from shapely.validation import explain_validity

    points = contour.points(SAGITTA * contour.length)
    polygon = Polygon(np.column_stack((points.real, points.imag)))
    return None if polygon.is_valid else str(explain_validity(polygon))


def require_simple(contour: Contour, name: str) -> None:
    """Raise UndercutError, naming the place, if the contour called `name` crosses itself.

    A curve that is regular everywhere may still cross itself: two flanks closer than the roller's
    diameter cut each other off (global undercut).
    """
    place = crossing(contour)
    if place is not None:
        raise UndercutError(
            f"the {name} crosses itself ({place}): two of its flanks are closer"
            " than the roller allows (global undercut), no disc has this outline"
        )
