"""Self-crossings and winding number of a contour. Topology only; no geometry comes from shapely."""

from __future__ import annotations

import numpy as np

from camgeo.contour.contour import Contour
from camgeo.errors import UndercutError

SAGITTA = 1e-5
"""Sagitta of the chords for the test, as a fraction of the contour's length."""


def crossing(contour: Contour) -> str | None:
    """Where the contour crosses itself, according to shapely; None if it does not."""
    from shapely import Polygon  # only for writing files: a check must not wait for its import
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


def winding_number(contour: Contour, point: complex) -> int:
    """Winding number of the contour about `point`, counter-clockwise positive.

    Exact: the turns of its chords, and its segments.

    The point must not lie on the contour.
    """
    pieces = contour.split(0.5 * np.pi)
    start, end = pieces.vertices - point, pieces.ends - point
    # Seen from a point between an arc and its chord, the arc goes round the other way than the
    # chord.
    inside = np.abs(point - pieces.centres) < pieces.radii
    beyond = (np.conj(end - start) * -start).imag * pieces.sweeps < 0.0
    between = np.where(inside & beyond, np.sign(pieces.sweeps), 0.0)
    chords = float(np.sum(np.angle(end * np.conj(start)))) / (2.0 * np.pi)
    return round(chords + float(np.sum(between)))
