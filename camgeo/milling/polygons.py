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
    """The area within an odd number of `contours`, arcs as chords within `fineness` [mm]."""
    area: Area = NOTHING
    for contour in contours:
        ring = contour.points(fineness)
        if len(ring) > 2:
            ring_area = shapely.Polygon(np.column_stack((ring.real, ring.imag)))
            area = shapely.symmetric_difference(area, shapely.make_valid(ring_area))
    return area


def grown(area: Area, distance: float) -> Area:
    """`area` grown by `distance` [mm] on all sides, or shrunk if that is negative.

    Round corners are chords within a hundredth of the distance.
    """
    # 6 chords a quarter: 1 - cos(pi / 24) is 0.0086.
    return shapely.buffer(area, distance, quad_segs=6)


def parts(area: Area) -> list[Area]:
    """The polygons of an area, without lines and points."""
    return [
        part
        for part in shapely.get_parts(shapely.make_valid(area)).tolist()
        if part.geom_type == "Polygon" and part.area > 0.0
    ] if not area.is_empty else []  # fmt: skip
