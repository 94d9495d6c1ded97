"""Moves of a cutter: what a toolpath consists of and what a G-code writer prints; the course of its
centre along them, and the zero of a program that states them.

Millimetres, mm/min, Z = 0 on the upper face of the part, Z up. Positions are of the cutter's tip.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Annotated, Any, Final, Self

import numpy as np

from camgeo.errors import FileError, GeometryError
from camgeo.geometry.contour.contour import Pieces
from camgeo.geometry.contour.spline import Arc
from camgeo.milling.cut import Cut
from camgeo.milling.milling import (
    AXIS,
    CORNERS,
    END_MILL,
    FIRST_SIDE,
    PART_TOP,
    GcodeSpec,
    Heights,
    Stock,
    Text,
    Tool,
    mirrored,
)
from camgeo.numeric.arrays import ComplexArray, FloatArray, IntArray, phase, taken
from camgeo.numeric.checked import (
    LARGEST,
    CheckedFields,
    Floats,
    Integers,
    finite,
    instance,
    one_of,
    positive,
    value_text,
)
from camgeo.part.part import Part
from camgeo.reading import PROGRAM_LINES
from camgeo.units import MM_PER, LengthUnit

Point = tuple[float, float, float]

SWITCHES: Final = ("", "left", "right", "off")


def _require(point: Any, size: int) -> None:
    """Raise GeometryError unless `point` has `size` finite coordinates."""
    if not (isinstance(point, tuple) and len(point) == size):
        raise GeometryError(f"must be {size} coordinates", "toolpath", value_text(point))
    for coordinate in point:
        if type(coordinate) is not float or not -LARGEST <= coordinate <= LARGEST:
            finite("toolpath", coordinate, "mm")


@dataclass(frozen=True, slots=True)
class Rapid:
    """Traverse to `end` [mm] without cutting; moves either in Z or in XY, never in both."""

    end: Point

    def __post_init__(self) -> None:
        _require(self.end, 3)


@dataclass(frozen=True, slots=True)
class Feed:
    """Straight cut to `end` [mm] at `feed` [mm/min].

    `switch` is what it does to the controller's compensation of the cutter's radius: it leads onto
    its path with the cutter on the "left" or the "right" of what is programmed, it leads "off" it,
    or it changes nothing, "".
    """

    end: Point
    feed: float
    switch: str = ""

    def __post_init__(self) -> None:
        _require(self.end, 3)
        positive("toolpath", self.feed, "mm/min")
        one_of("toolpath", self.switch, SWITCHES)


@dataclass(frozen=True, slots=True)
class ArcFeed:
    """Circular cut to `end` [mm] around the axis through `centre` (x, y) [mm] at `feed` [mm/min].

    At most half a turn; `ccw` seen from +Z. If `end` has another Z, it is a helix of constant
    pitch.
    """

    end: Point
    centre: tuple[float, float]
    ccw: bool
    feed: float

    def __post_init__(self) -> None:
        _require(self.end, 3)
        _require(self.centre, 2)
        instance("toolpath", self.ccw, bool, "true or false")
        positive("toolpath", self.feed, "mm/min")


@dataclass(frozen=True, slots=True)
class Stop(CheckedFields):
    """A halt for the operator, at the clearance height, with the spindle off.

    `note` says what has to be done.
    """

    note: Annotated[Text, "toolpath"]


def too_long() -> FileError:
    """The error for a program that would not be read back."""
    return FileError(
        f"the program would have more than {PROGRAM_LINES:,} lines, the limit for a program that is"
        " read; a larger tolerance or a larger stepdown needs fewer"
    )


Move = Rapid | Feed | ArcFeed


@dataclass(frozen=True, slots=True)
class Operation:
    """One operation of the program, with all its passes; it can be restarted alone.

    Attributes
    ----------
    cut : what it cuts, with its tool.
    moves : in order; the first is a traverse to the clearance height above the first point, the
        last one leads up to that height again.

    Raises
    ------
    GeometryError
        With key "toolpath" if there is no cut, or it does not begin with a traverse.
    """

    cut: Cut
    moves: tuple[Move | Stop, ...]

    def __post_init__(self) -> None:
        instance("toolpath", self.cut, Cut, "a cut")
        instance("toolpath", self.moves, tuple, "a tuple of moves")
        if not self.moves or not isinstance(self.moves[0], Rapid):
            raise GeometryError(
                f"the operation {self.cut.name} must begin with a traverse",
                "toolpath",
                value_text(self.moves[:1]),
            )

    @property
    def travel(self) -> tuple[Move, ...]:
        """The moves without the halts between them."""
        return tuple(move for move in self.moves if not isinstance(move, Stop))

    @property
    def swept(self) -> tuple[Course, float]:
        """The course and the radius [mm] of the area that it clears for later operations, at the
        full radius of its tool: the point of a drill or a chamfer mill is left out.
        """
        course, tool = feed_course(self.moves), self.tool
        if tool.kind != END_MILL:
            point = tool.tip_length
            course = replace(course, from_z=course.from_z + point, to_z=course.to_z + point)
        return course, tool.radius

    @property
    def name(self) -> str:
        """The name of the operation, unique in the program."""
        return self.cut.name

    @property
    def tool(self) -> Tool:
        """The tool, as it is run in this operation."""
        return self.cut.tool


@dataclass(frozen=True, slots=True)
class Toolpath:
    """A whole milling program.

    Attributes
    ----------
    heights : of its traverses.
    operations : in the order of cutting, each with its own name.

    Raises
    ------
    GeometryError
        With key "toolpath", if two operations have the same name.
    """

    heights: Heights
    operations: tuple[Operation, ...]

    def __post_init__(self) -> None:
        instance("toolpath", self.heights, Heights, "heights")
        for operation in instance("toolpath", self.operations, tuple, "a tuple of operations"):
            instance("toolpath", operation, Operation, "an operation")
        names = [operation.cut.name for operation in self.operations]
        if len(set(names)) < len(names):
            raise GeometryError("each operation needs its own name", "toolpath", ", ".join(names))


# -- pieces ---------------------------------------------------------------------------------------
# Moves as lines and arcs in the plane.


def plane_piece(position: Point, move: Move) -> Arc:
    """The line or the arc in the plane of a move that begins at `position` [mm]."""
    start, end = complex(position[0], position[1]), complex(move.end[0], move.end[1])
    if not isinstance(move, ArcFeed):
        return Arc(start, end, 0.0, 0j)
    centre = complex(*move.centre)
    return Arc(start, end, arc_sweep(start - centre, end - centre, ccw=move.ccw), centre)


def arc_sweep(start: complex, end: complex, *, ccw: bool) -> float:
    """Signed angle [rad] from arm `start` to arm `end`, at most half a turn in that direction.

    An angle slightly below 0 is a rounded 0; one slightly beyond half a turn is not taken for a
    turn in the other direction.
    """
    turn = phase(end / start) * (1.0 if ccw else -1.0)
    if turn < -0.5 * math.pi:
        turn += 2.0 * math.pi
    turn = max(turn, 0.0)
    return turn if ccw else -turn


# -- course ---------------------------------------------------------------------------------------
# The course of a cutter: lines and arcs of its centre in the plane, with the heights of its tip.
#
# Exact to the rounding of a few operations: no piece is replaced by chords.


@dataclass(frozen=True, slots=True, eq=False)
class Course(Pieces):
    """The lines and arcs of a cutter's centre with the heights of its tip, in the order of cutting.

    Attributes
    ----------
    starts, ends, sweeps, centres : as of all pieces, at most half a turn each, so that the circle
        around its chord holds a piece; the ends are equal where the cutter moves along Z alone.
    from_z, to_z : (n,) Z of the tip [mm] at both ends of each piece, with a constant slope between.
    moves : (n,) index of the move that it is part of.
    """

    from_z: Floats
    to_z: Floats
    moves: Integers

    @property
    def highest(self) -> FloatArray:
        """(n,) largest Z of the tip [mm] on each piece."""
        return np.maximum(self.from_z, self.to_z)

    @property
    def lowest(self) -> FloatArray:
        """(n,) least Z of the tip [mm] on each piece."""
        return np.minimum(self.from_z, self.to_z)

    @property
    def cleared(self) -> FloatArray:
        """(n,) Z [mm] down to which all of a piece has been run: that of its higher end, and of a
        move along Z that of its lower one.
        """
        upright = (self.starts == self.ends) & (self.sweeps == 0.0)
        return np.where(upright, self.lowest, self.highest)

    def part(self, first: FloatArray, last: FloatArray) -> Course:
        """The part of each piece from the share `first` (n,) to the share `last` (n,) of its
        length.
        """
        pieces = self.subpieces(first, last)
        low, high = self._tip(first), self._tip(last)
        return Course(
            pieces.starts, pieces.ends, pieces.sweeps, pieces.centres, low, high, self.moves
        )

    def below(self, z: float) -> Course:
        """The parts of the pieces on which the tip is not above `z` [mm]."""
        course = taken(self, self.lowest <= z)
        if np.all(course.highest <= z):
            return course
        # Share of each piece at which it crosses the height; 1 for level pieces, which lie below
        # whole.
        rise = course.to_z - course.from_z
        share = np.divide(z - course.from_z, rise, out=np.ones(len(course)), where=rise != 0.0)
        share = np.clip(share, 0.0, 1.0)
        first = np.where(course.from_z > z, share, 0.0)
        lower = course.part(first, np.where(course.to_z > z, share, 1.0))
        # Rounding may put an end that lies on the height slightly above it.
        low, high = np.minimum(lower.from_z, z), np.minimum(lower.to_z, z)
        return Course(lower.starts, lower.ends, lower.sweeps, lower.centres, low, high, lower.moves)

    def _tip(self, shares: FloatArray) -> FloatArray:
        """(n,) Z [mm] at a share of the length of each piece."""
        inner = self.from_z + (self.to_z - self.from_z) * shares
        return np.where(shares == 1.0, self.to_z, inner)


def arc_sweeps(starts: ComplexArray, ends: ComplexArray, turns: FloatArray) -> FloatArray:
    """(n,) as `arc_sweep`, of arms (n,) and their directions (n,): 1 counter-clockwise, else -1."""
    angles = np.angle(ends / starts) * turns
    angles = np.where(angles < -0.5 * np.pi, angles + 2.0 * np.pi, angles)
    return turns * np.maximum(angles, 0.0)


def feed_course(moves: Iterable[Move | Stop], position: Point | None = None) -> Course:
    """The course of the feed moves; traverses cut nothing and are left out.

    Parameters
    ----------
    position : where the cutter stands before [mm]; None if the first move is a traverse.
    """
    points: list[Point] = []
    rows: list[tuple[int, float, float, float]] = []  # of the move, its centre, its direction
    for number, move in enumerate(moves):
        if isinstance(move, Stop):
            continue
        if position is not None and not isinstance(move, Rapid):
            points += (position, move.end)
            if isinstance(move, ArcFeed):
                rows.append((number, *move.centre, 1.0 if move.ccw else -1.0))
            else:
                rows.append((number, 0.0, 0.0, 0.0))
        position = move.end
    ends = np.array(points, dtype=np.float64).reshape(-1, 2, 3)
    columns = np.array(rows, dtype=np.float64).reshape(-1, 4)
    flat = ends[:, :, 0] + 1j * ends[:, :, 1]
    centres = columns[:, 1] + 1j * columns[:, 2]
    sweeps = np.zeros(len(columns))
    arcs = np.flatnonzero(columns[:, 3])
    if len(arcs):
        arms = flat[arcs] - centres[arcs, None]
        sweeps[arcs] = arc_sweeps(arms[:, 0], arms[:, 1], columns[arcs, 3])
    z, numbers = ends[:, :, 2], columns[:, 0].astype(np.intp)
    whole = Course(flat[:, 0], flat[:, 1], sweeps, centres, z[:, 0], z[:, 1], numbers)
    # A course has pieces of at most half a turn: longer arcs are divided, heights in proportion.
    index, first, last = whole.halves()
    return whole if len(index) == len(whole) else taken(whole, index).part(first, last)


def alike(course: Course) -> IntArray:
    """(n,) index of the first piece that equals each piece in the plane."""
    # Rows are compared by their bytes, as opaque keys: exactly, and far faster than by numbers.
    rows = np.column_stack((course.starts, course.ends, course.sweeps, course.centres))
    size = rows.dtype.itemsize * rows.shape[1]
    first: dict[bytes, int] = {}
    keys = np.ascontiguousarray(rows).view(f"V{size}")[:, 0].tolist()
    return np.array([first.setdefault(key, k) for k, key in enumerate(keys)], dtype=np.intp)


# -- zero -----------------------------------------------------------------------------------------
# Where the coordinates of a program begin: on the cam axis or a corner of the blank, on a face;
# and the blank from there, in words and as the box around it.


FACES: Final = {
    PART_TOP: "the upper face of the finished disc",
    "part-bottom": "the lower face of the finished disc",
    "blank-top": "the upper face of the blank",
    "blank-bottom": "the lower face of the blank",
}

TURNED_FACES: Final = {
    PART_TOP: "the lower face of the finished part, which lies up",
    "part-bottom": "the upper face of the finished part, which lies down",
    "blank-top": "the lower face of the blank, which lies up",
    "blank-bottom": "what lies lowest",
}
"""The names of these faces on the second side."""


@dataclass(frozen=True, slots=True)
class Zero:
    """The zero of a program, and how its work lies.

    Attributes
    ----------
    name, height : as in scenes.
    place : seen from the cam axis, in the part's coordinates [mm].
    z : above the upper face of the part [mm]; on the second side above its lower one.
    turned : the axis about which the work has been turned over; empty on the first side.
    """

    name: str = AXIS
    height: str = PART_TOP
    place: complex = 0j
    z: float = 0.0
    turned: str = FIRST_SIDE

    @classmethod
    def stated(cls, spec: GcodeSpec, stock: Stock, part: Part, turned: str = FIRST_SIDE) -> Self:
        """The zero that a scene asks for, of work that is `turned` over about an axis, or not.

        Raises
        ------
        GeometryError
            With key "output.gcode.zero", if the blank has no such corner.
        """
        place = 0j
        if spec.zero != AXIS:
            if stock.length is None or stock.width is None:
                raise GeometryError(
                    "needs a plate whose length and width are stated: there is no corner",
                    "output.gcode.zero",
                    f'"{spec.zero}"',
                )
            along, across = CORNERS[spec.zero]
            corner = 0.5 * complex(along * stock.length, across * stock.width)
            # Corners are named as the work lies on the machine; `place` is one of the part.
            place = stock.centre + mirrored(corner, turned)
        low, high = part.layers[0].z0, part.layers[-1].z1
        heights = {
            PART_TOP: 0.0,
            "part-bottom": low,
            "blank-top": high + stock.top,
            "blank-bottom": low - stock.bottom,
        }
        return cls(spec.zero, spec.zero_height, place, heights[spec.zero_height], turned)

    @property
    def is_of_the_part(self) -> bool:
        """Whether the program's coordinates are those of the part."""
        return self.name == AXIS and self.height == PART_TOP and not self.turned

    @property
    def sentence(self) -> str:
        """The place of the zero in words."""
        where = "the cam axis"
        if self.name != AXIS:
            where = f"the {self.name.replace('-', ' ')} corner of the blank"
        faces = TURNED_FACES if self.turned else FACES
        return f"X 0, Y 0 on {where}, Z 0 on {faces[self.height]}"

    def to_program(self, place: complex) -> complex:
        """A place of the part [mm] in the program's coordinates."""
        return mirrored(place - self.place, self.turned)

    def point_to_program(self, point: Point) -> Point:
        """A point of the part [mm] in the program's coordinates."""
        place = self.to_program(complex(point[0], point[1]))
        return place.real, place.imag, point[2] - self.z

    def to_part(self, place: complex) -> complex:
        """A place in the program's coordinates [mm] in those of the part."""
        return mirrored(place, self.turned) + self.place

    def box(self, stock: Stock, part: Part) -> tuple[Point, Point] | None:
        """The corners of the blank with the least and the largest coordinates [mm]; None if its
        outline is not known.
        """
        sides = (stock.length, stock.width) if stock.diameter is None else (stock.diameter,) * 2
        if sides[0] is None or sides[1] is None:
            return None
        corner, centre = 0.5 * complex(sides[0], sides[1]), self.to_program(stock.centre)
        low, high = _heights(stock, part)
        least, most = centre - corner, centre + corner
        return (least.real, least.imag, low - self.z), (most.real, most.imag, high - self.z)


def described(stock: Stock, part: Part, zero: Zero, unit: LengthUnit = "mm") -> str:
    """The blank in words, lengths in `unit`."""

    def length(mm: float) -> str:
        return f"{mm / MM_PER[unit]:g}"

    low, high = _heights(stock, part)
    height = f"{length(high - low)} {unit} high"
    if stock.diameter is not None:
        outline = f"round, diameter {length(stock.diameter)} {unit}"
    elif stock.length is not None and stock.width is not None:
        outline = f"plate, {length(stock.length)} x {length(stock.width)} {unit}"
    else:
        outline = "plate of unstated size"
    bore = "" if stock.bore is None else f", bore {length(stock.bore)} {unit}"
    where = f", its upper face at Z {length(high - zero.z)}"
    if zero.turned:
        where = f", what the first side has left of it, up to Z {length(high - zero.z)}"
    centre = zero.to_program(stock.centre)
    offset = f", its middle at X {length(centre.real)}, Y {length(centre.imag)}" if centre else ""
    return f"{outline}, {height}{bore}{where}{offset}"


def _heights(stock: Stock, part: Part) -> tuple[float, float]:
    """Z of the lower and the upper face of the blank above the upper face of the part [mm]."""
    return part.layers[0].z0 - stock.bottom, part.layers[-1].z1 + stock.top
