"""Areas between walls and the outline of the blank, each cleared by the strategy that its walls ask
for: an outside, a hole, a ring between two walls, or a face without walls.
"""

from __future__ import annotations

from camgeo.contour.contour import Effort
from camgeo.errors import GeometryError
from camgeo.toolpath.cut import AreaCut, Cut
from camgeo.toolpath.moves import Heights, Move


def clear(cut: Cut, heights: Heights, tolerance: float, effort: Effort) -> list[Move]:  # noqa: ARG001  all strategies are called alike
    """The moves that clear an area; its paths are fitted fast, and coarsely within the allowance.

    Raises
    ------
    GeometryError
        If the cutter is too large for the area, or no strategy clears an area with such walls.
    """
    if not isinstance(cut, AreaCut):
        raise TypeError(f"{cut.name}: the strategy {cut.strategy} clears an area")
    holes = [wall for wall in cut.walls if wall.hole]
    solids = [wall for wall in cut.walls if not wall.hole]
    match solids, holes:
        case [], []:
            from camgeo.toolpath.strategies.face import face  # few programs clear areas

            return face(cut, heights, tolerance)
        case [solid], []:
            from camgeo.toolpath.strategies.outside import outside

            return outside(cut, solid, heights, tolerance)
        case [], [hole]:
            from camgeo.toolpath.strategies.inside import inside

            return inside(cut, hole, heights, tolerance)
        case [solid], [hole]:
            from camgeo.toolpath.strategies.ring import ring

            return ring(cut, solid, hole, heights, tolerance)
    names = ", ".join(wall.name for wall in cut.walls)
    raise GeometryError("an area has at most one wall around it and one within it", "part", names)
