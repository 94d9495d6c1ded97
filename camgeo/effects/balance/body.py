"""Mass and first moment of a disc: its boundaries times thickness and density."""

from __future__ import annotations

from itertools import groupby

from camgeo.errors import EffectError
from camgeo.outline.moments import Moments, path_moments, total
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.part import Boundary, Part


def disc_moments(part: Part, density: float, tolerance: float) -> Moments:
    """Mass [t] as the area, and mass times centre of mass [t mm] as the first moment.

    Parameters
    ----------
    part : its thickness must be known. Each boundary counts with the height of its walls.
    density : [t/mm^3].
    tolerance : of the integrals over the outlines, see `camgeo.outline.moments.path_moments`.
    """

    def of_boundary(boundary: Boundary) -> Moments:
        if isinstance(boundary, CurveBoundary):
            return path_moments(boundary.path, tolerance).counter_clockwise()
        if isinstance(boundary, ExactBoundary):
            return boundary.exact.moments.counter_clockwise()
        raise EffectError(
            f"the mass inside the boundary {boundary.name!r}, a {type(boundary).__name__}, is not"
            " known"
        )

    # Inside a boundary there is material all along its wall, inside of a hole there is none.
    return total(
        total(
            of_boundary(wall.boundary).scaled(-1.0 if wall.boundary.hole else 1.0) for wall in walls
        ).scaled(density * height)
        for height, walls in groupby(part.walls, lambda wall: wall.z1 - wall.z0)
    )
