"""Areas as polygons: for what cutters pass over, for pictures, rests and collisions.

Arcs become chords within a `fineness` [mm], and so do the round ends of what is swept, so that an
area is off by up to twice that at its edge. GEOS thins its own input as well: below 1e-5 mm a
finer one gains nothing. Verdicts on the flanks of a part are exact ones, by its parallels.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

import numpy as np
import shapely

from camgeo.geometry.contour.contour import Contour

Area = Any
"""A polygon or several, of shapely, which has no types."""

NOTHING: Final = shapely.Polygon()


def polygon(contours: Iterable[Contour], fineness: float) -> Area:
    """What lies within an odd number of `contours`."""
    found: Area = NOTHING
    for contour in contours:
        ring = contour.points(fineness)
        if len(ring) > 2:
            ring_area = shapely.Polygon(np.column_stack((ring.real, ring.imag)))
            found = shapely.symmetric_difference(found, shapely.make_valid(ring_area))
    return found


def grown(area: Area, distance: float) -> Area:
    """`area` with all that is nearer than `distance` [mm], or without its rim if that is negative.

    Round corners are chords within a hundredth of it.
    """
    return shapely.buffer(area, distance, quad_segs=6)


def parts(area: Area) -> list[Area]:
    """The polygons of an area, without lines and points."""
    return [
        each
        for each in shapely.get_parts(shapely.make_valid(area)).tolist()
        if each.geom_type == "Polygon" and each.area > 0.0
    ] if not area.is_empty else []  # fmt: skip
