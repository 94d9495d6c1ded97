"""What an operation cuts, exactly, before any tolerance.

Five kinds: along a closed path of the cutter's centre, over an area between boundaries, at points,
along a line, and within the strokes of letters. All refer to boundaries of the part, and none knows
the scene.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Annotated, Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.values import Radius
from camgeo.milling.milling import (
    COMPUTED,
    DRILL,
    CompensationWord,
    Obstacle,
    Rounds,
    Tabs,
    Text,
    Tool,
    Truth,
)
from camgeo.numeric.checked import (
    array,
    check_fields,
    finite,
    hold,
    instance,
    instances,
    number,
    point,
    positive,
    value_text,
)
from camgeo.part.part import Boundary, BoundaryField, boundary_tuple

SLACK: Final = 0.05
"""Deviation of a roughing path, as a share of its allowance."""

MOST_SLACK: Final = 0.02
"""Largest deviation of a roughing path [mm], unless the program's tolerance is larger."""

Size = Annotated[float, partial(number, least=0.0, unit="mm")]
"""A length [mm] from 0 up; a computed one may be as near to 0 as doubles are."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cut:
    """One operation to be planned, with what all kinds have in common.

    Attributes
    ----------
    name : its identity, unique in the program and stated in the file.
    strategy : how it is cut, a name in `camgeo.milling.strategies.STRATEGIES`.
    tool : the one that cuts it, with feeds, speed, stepdown and stepover as they are for this cut.
    top : Z of the upper face of the material that it meets [mm], at least the first depth.
    depths : Z of each pass [mm], descending.
    allowance : left on the walls [mm] for a later cut.
    obstacles : clamps and screws to be cleared, above whose tops only traverses go.
    climb : whether the material is on the right of the cutter, or else on its left, in the part's
        coordinates. With a cutter that turns clockwise that is climb milling; where the work is
        turned over the machine runs the mirror image, and it is conventional.
    stop : what the operator does before it, after a programmed stop; empty without one.
    note : for the operator, or empty.

    Raises
    ------
    GeometryError
        With key "toolpath" if a text, the tool or an obstacle is invalid, or the depths do not
        descend below the top.
    """

    name: Annotated[Text, "toolpath"]
    strategy: Annotated[Text, "toolpath"]
    tool: Tool
    top: Annotated[float, finite, "toolpath"]
    depths: tuple[float, ...]
    allowance: Annotated[Size, "toolpath"] = 0.0
    obstacles: tuple[Obstacle, ...] = ()
    climb: Annotated[Truth, "toolpath"] = True
    stop: Annotated[Text, "toolpath"] = ""
    note: Annotated[Text, "toolpath"] = ""

    def __post_init__(self) -> None:
        check_fields(self)
        depths = array("toolpath", instance("toolpath", self.depths, tuple, "a tuple of depths"))
        if not len(depths) or not np.all(np.diff(depths) < 0.0) or depths[0] > self.top:
            raise GeometryError(
                f"must be descending depths below {self.top:g} mm",
                "toolpath",
                value_text(self.depths),
            )
        entries = instance("toolpath", self.obstacles, tuple, "a tuple of obstacles")
        obstacles = instances("toolpath", entries, (Obstacle,), "obstacles")
        hold(self, depths=tuple(depths.tolist()), obstacles=obstacles)

    @property
    def bottom(self) -> float:
        """Z of the last pass [mm]."""
        return self.depths[-1]

    @property
    def contact_radius(self) -> float:
        """Radius of the cutter where it meets a wall [mm]."""
        return self.tool.radius

    @property
    def produced(self) -> tuple[str, ...]:
        """Names of the part's boundaries along which it cuts."""
        return ()


@dataclass(frozen=True, slots=True, kw_only=True)
class ContourCut(Cut):
    """A cut along a closed path of the cutter's centre: a finish, a slot, a chamfer.

    Attributes
    ----------
    centre : the exact closed path of the cutter's centre, the allowance included, and the slack,
        so that what is left is no less than the allowance. If it is a hole, as inside a bore, climb
        milling runs it counter-clockwise, else clockwise.
    right, left : names of the part's boundaries produced on either side of the cutter, seen in the
        direction of climb milling; empty where none is produced.
    room : largest radius of the arcs that lead onto and off the path [mm]; 0 for none, where the
        cutter enters along the path itself.
    rest : what earlier operations have left beside the path [mm]: a cutter that must not plunge
        comes down no nearer to the path.
    slack : by how much the path may be off, if that is more than the tolerance [mm]; 0 for a
        finish.
    cleared : whether the material beside the path, as far as leads go, is gone down to the last
        depth: then the cutter may go straight down there.
    springs : rounds at the last depth after the first one there, which remove what deflection left.
    contact : radius at which the cutter meets the wall [mm], where its feed is held; 0 for that of
        the tool, less for a cone.
    edge : name of the boundary whose upper edge a cone takes off, if that is what is cut.
    width : of that chamfer on the face [mm].
    tabs : bridges to leave, or None.
    compensation : "computed"; "wear", the computed path with the wear of the tool's table on
        top; "control", the boundary itself, offset by the controller.

    Raises
    ------
    GeometryError
        As `Cut`; with key "part" if the centre's path is not a boundary.
    """

    centre: BoundaryField
    right: Annotated[Text, "toolpath"] = ""
    left: Annotated[Text, "toolpath"] = ""
    room: Annotated[Size, "toolpath"] = 0.0
    rest: Annotated[Size, "toolpath"] = 0.0
    slack: Annotated[Size, "toolpath"] = 0.0
    cleared: Annotated[Truth, "toolpath"] = False
    springs: Annotated[Rounds, "toolpath"] = 0
    contact: Annotated[Radius, "toolpath"] = 0.0
    edge: Annotated[Text, "toolpath"] = ""
    width: Annotated[Radius, "toolpath"] = 0.0
    tabs: Tabs | None = None
    compensation: Annotated[CompensationWord, "toolpath"] = COMPUTED

    @property
    def contact_radius(self) -> float:
        """Radius of the cutter where it meets the wall [mm]; smaller for a cone."""
        return self.contact or self.tool.radius

    @property
    def produced(self) -> tuple[str, ...]:
        """Names of the boundaries on both sides of the path, as far as it produces them."""
        return tuple(name for name in (self.right, self.left) if name)


@dataclass(frozen=True, slots=True, kw_only=True)
class AreaCut(Cut):
    """The removal of all material between walls, or between walls and the outline of the blank.

    The area lies on the side of each wall without material, within the stock. The cutter's edge
    stays off every wall by the allowance; its centre may leave the area where no wall is, across
    the outline of the stock and over what is cleared.

    Attributes
    ----------
    walls : boundaries of the part, each a hole or not: a bore alone is a hole to be opened, an
        outline alone is to be laid free of the stock, two flanks enclose a groove; none at all is
        a face, cleared all over.
    stock : outline of the blank; None if walls enclose the area.
    cleared : holes that are there already, down to the last depth.
    stepover : largest distance between neighbouring paths [mm].
    slot : width of the slot along the first wall that the area is [mm]; 0 of any other area.

    Raises
    ------
    GeometryError
        As `Cut`; with key "part" if a wall is not a boundary; with key "toolpath" if there is
        neither a wall nor a stock, or the stepover exceeds the cutter's diameter.
    """

    walls: Annotated[tuple[Boundary, ...], boundary_tuple, "toolpath"]
    stock: BoundaryField | None = None
    cleared: Annotated[tuple[Boundary, ...], boundary_tuple, "toolpath"] = ()
    stepover: Annotated[float, positive, "toolpath"]
    slot: Annotated[Radius, "toolpath"] = 0.0

    def __post_init__(self) -> None:
        Cut.__post_init__(self)
        if not self.walls and self.stock is None:
            raise GeometryError("an area needs a wall or the outline of the blank", "toolpath")
        if self.stepover > self.tool.diameter:
            raise GeometryError(
                f"must be at most the cutter's diameter, {self.tool.diameter:g} mm",
                "toolpath",
                f"{self.stepover:g}",
            )

    @property
    def produced(self) -> tuple[str, ...]:
        """Names of the walls of the cut."""
        return tuple(wall.name for wall in self.walls)


@dataclass(frozen=True, slots=True, kw_only=True)
class PointCut(Cut):
    """Cuts straight down at points: holes, drilled in pecks, one for each of the `depths`.

    Attributes
    ----------
    points : complex [mm].
    holes : names of the part's boundaries produced.

    Raises
    ------
    GeometryError
        As `Cut`; with key "toolpath" if there are no points.
    """

    points: tuple[complex, ...]
    holes: tuple[str, ...] = ("bore",)

    def __post_init__(self) -> None:
        Cut.__post_init__(self)
        points = instance("toolpath", self.points, tuple, "a tuple of points")
        if not points:
            raise GeometryError("needs a point", "toolpath", value_text(points))
        holes = instance("toolpath", self.holes, tuple, "a tuple of names")
        instances("toolpath", holes, (str,), "names")
        hold(self, points=tuple(point("toolpath", place, "mm") for place in points))

    @property
    def sinking(self) -> float:
        """Feed along Z into the material [mm/min]."""
        return self.tool.feed if self.tool.kind == DRILL else self.tool.plunge_feed

    @property
    def produced(self) -> tuple[str, ...]:
        """Names of the boundaries of its holes."""
        return self.holes


@dataclass(frozen=True, slots=True, kw_only=True)
class LineCut(Cut):
    """A cut along a line of the cutter's centre, as wide as the cutter: an engraved mark.

    Attributes
    ----------
    start, end : of the line [mm].
    slot : name of the part's boundary produced.

    Raises
    ------
    GeometryError
        As `Cut`; with key "toolpath" if the line has no length.
    """

    start: Annotated[complex, point, "toolpath"]
    end: Annotated[complex, point, "toolpath"]
    slot: Annotated[Text, "toolpath"] = ""

    def __post_init__(self) -> None:
        Cut.__post_init__(self)
        if self.start == self.end:
            raise GeometryError("needs a line with a length", "toolpath", value_text(self.start))

    @property
    def produced(self) -> tuple[str, ...]:
        """Name of the boundary of the mark."""
        return (self.slot,) if self.slot else ()


@dataclass(frozen=True, slots=True, kw_only=True)
class LetterCut(Cut):
    """The strokes of letters, as far as a round cutter reaches into them without leaving them.

    Attributes
    ----------
    walls : the outlines of the letters, holes and what stands within them.
    stepover : largest distance between neighbouring paths [mm].

    Raises
    ------
    GeometryError
        As `Cut`; with key "part" if a wall is not a boundary.
    """

    walls: Annotated[tuple[Boundary, ...], boundary_tuple, "toolpath"]
    stepover: Annotated[float, positive, "toolpath"]

    @property
    def produced(self) -> tuple[str, ...]:
        """Names of the walls of the cut."""
        return tuple(wall.name for wall in self.walls)


def roughing_slack(allowance: float) -> float:
    """Deviation [mm] that the path of a roughing may have which leaves `allowance` [mm]."""
    return min(SLACK * allowance, MOST_SLACK)
