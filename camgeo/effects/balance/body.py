"""Mass and first moment of a disc: its boundaries times thickness and density."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from camgeo.contour.moments import contour_moments
from camgeo.errors import EffectError
from camgeo.outline.moments import Moments, path_moments, total
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from camgeo.part.part import Boundary, Part

MomentsOf = Callable[[Boundary], Moments]


def disc_moments(part: Part, density: float, tolerance: float) -> Moments:
    """Mass [t] as the area, and mass times centre of mass [t mm] as the first moment.

    Parameters
    ----------
    part : its thickness must be known. The boundaries go through; the groove is sunk between its
        flanks by the depth of the groove.
    density : [t/mm^3].
    tolerance : of the integrals over the outlines, see `camgeo.outline.moments.path_moments`.
    """
    assert part.thickness is not None  # the effect declares it among its keys

    def of_boundary(boundary: Boundary) -> Moments:
        if isinstance(boundary, CurveBoundary):
            return path_moments(boundary.path, tolerance).counter_clockwise()
        if isinstance(boundary, ExactBoundary):
            return contour_moments(boundary.exact).counter_clockwise()
        raise EffectError(
            f"the mass inside the boundary {boundary.name!r}, a {type(boundary).__name__}, is not"
            " known"
        )

    through = _material(part.through, of_boundary).scaled(density * part.thickness)
    if not part.groove:
        return through
    # Seen from the groove its flanks bound what is left standing: the sign is the other one.
    return total((through, _material(part.groove, of_boundary).scaled(density * part.groove_depth)))


def _material(boundaries: Sequence[Boundary], of_boundary: MomentsOf) -> Moments:
    """What is inside of the boundaries, holes taken off."""
    return total(of_boundary(each).scaled(-1.0 if each.hole else 1.0) for each in boundaries)
