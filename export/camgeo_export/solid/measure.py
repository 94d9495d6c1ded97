"""A mesh read back, split into the boundaries of the part and compared with them."""

from __future__ import annotations

import numpy as np

from camgeo.errors import FileError, GeometryError
from camgeo.numeric.arrays import FloatArray, IntArray
from camgeo.part.part import Part
from camgeo.units import counted
from camgeo_export.reading import deviation
from camgeo_export.verify.body import (
    border_loops,
    contours_of,
    merged,
    polygon,
    slopes_of,
    sloping,
    solid_checks,
    upright,
)

SAME = 1e-6
"""Share of its size by which the heights of the edges of a chamfer may be rounded in a file."""


def measure(part: Part, vertices: FloatArray, triangles: IntArray) -> float:
    """Largest proved deviation [mm] of a body from the `part` that it should be, in the plane and
    in height.

    `vertices` (n, 3) [mm] and `triangles` (m, 3) as in the file. Raises FileError unless
    they form one closed, outward oriented body of flat faces, upright walls and chamfers.
    """
    try:
        wanted = part.levels
    except GeometryError as error:
        raise FileError(f"no body to compare this with: {error.message}") from None
    if not np.isfinite(vertices).all():
        raise FileError("the mesh has coordinates that are not finite")
    vertices, triangles = merged(vertices, triangles)
    corners = vertices[triangles]
    flat = (corners[:, :, 2] == corners[:, :1, 2]).all(axis=1)
    slopes = slopes_of(part)
    within = SAME * (1.0 + np.abs(vertices).max())
    numbers = sloping(vertices, triangles, ~flat, slopes, within)
    walls = upright(corners[~flat & (numbers < 0)])
    for check in (*solid_checks(vertices, triangles), walls):
        if not check.ok:
            raise FileError(f"the mesh fails the check '{check.name}': {check.note}")
    heights = sorted(set(corners[flat][:, 0, 2].tolist()))
    if len(heights) != len(wanted):
        raise FileError(f"flat faces at {counted(len(heights), 'height')}, expected {len(wanted)}")
    largest = 0.0
    for height, exact in zip(heights, wanted, strict=True):
        level = triangles[flat & (corners[:, 0, 2] == height)]
        contours = [polygon(vertices[loop]) for loop in border_loops(level)]
        off = abs(height - (exact.z - wanted[0].z))
        largest = max(largest, off, deviation(contours, exact.boundaries))
    for number, slope in enumerate(slopes):
        found = contours_of(vertices, triangles[numbers == number])
        for place, contours in enumerate(found):
            largest = max(largest, deviation(contours, slope.edges(place)))
    return largest
