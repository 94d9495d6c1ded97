"""Where the coordinates of a program begin: on the cam axis or a corner of the blank, on a face;
and the blank from there, in words and as the box around it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from camgeo.errors import GeometryError
from camgeo.milling.milling import AXIS, CORNERS, NOT, PART_TOP, GcodeSpec, Stock, mirrored
from camgeo.milling.moves import Point
from camgeo.part.part import Part
from camgeo.units import MM_PER, LengthUnit

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
"""The same on the second side."""


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
    turned: str = NOT

    @property
    def is_of_the_part(self) -> bool:
        """Whether the program's coordinates are the part's own."""
        return self.name == AXIS and self.height == PART_TOP and not self.turned

    @property
    def sentence(self) -> str:
        """Where it is, in words."""
        where = "the cam axis"
        if self.name != AXIS:
            where = f"the {self.name.replace('-', ' ')} corner of the blank"
        faces = TURNED_FACES if self.turned else FACES
        return f"X 0, Y 0 on {where}, Z 0 on {faces[self.height]}"

    def of(self, place: complex) -> complex:
        """A place of the part [mm] in the program's coordinates."""
        return mirrored(place - self.place, self.turned)

    def of_point(self, point: Point) -> Point:
        """A point of the part [mm] in the program's coordinates."""
        place = self.of(complex(point[0], point[1]))
        return place.real, place.imag, point[2] - self.z

    def part_of(self, place: complex) -> complex:
        """A place in the program's coordinates [mm] in those of the part."""
        return mirrored(place, self.turned) + self.place


OF_THE_PART: Final = Zero()


def zero_of(spec: GcodeSpec, stock: Stock, part: Part, turned: str = NOT) -> Zero:
    """The zero that a scene asks for, of work that is `turned` over about an axis, or not.

    Raises
    ------
    GeometryError
        With key "output.gcode.zero", if the blank has no such corner.
    """
    place = 0j
    if spec.zero != AXIS:
        if stock.length is None or stock.width is None:
            message = "needs a plate whose length and width are stated: there is no corner"
            raise GeometryError(message, "output.gcode.zero", f'"{spec.zero}"')
        along, across = CORNERS[spec.zero]
        corner = 0.5 * complex(along * stock.length, across * stock.width)
        place = stock.centre + mirrored(corner, turned)
    low, high = part.layers[0].z0, part.layers[-1].z1
    heights = {
        PART_TOP: 0.0,
        "part-bottom": low,
        "blank-top": high + stock.top,
        "blank-bottom": low - stock.bottom,
    }
    return Zero(spec.zero, spec.zero_height, place, heights[spec.zero_height], turned)


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
    centre = zero.of(stock.centre)
    off = f", its middle at X {length(centre.real)}, Y {length(centre.imag)}" if centre else ""
    return f"{outline}, {height}{bore}{where}{off}"


def box(stock: Stock, part: Part, zero: Zero) -> tuple[Point, Point] | None:
    """The corners of the blank with the least and the largest coordinates [mm]; None if its outline
    is not known.
    """
    sides = (stock.length, stock.width) if stock.diameter is None else (stock.diameter,) * 2
    if sides[0] is None or sides[1] is None:
        return None
    corner, centre = 0.5 * complex(sides[0], sides[1]), zero.of(stock.centre)
    low, high = _heights(stock, part)
    least, most = centre - corner, centre + corner
    return (least.real, least.imag, low - zero.z), (most.real, most.imag, high - zero.z)


def _heights(stock: Stock, part: Part) -> tuple[float, float]:
    """Z of its faces above the upper face of the part [mm]."""
    return part.layers[0].z0 - stock.bottom, part.layers[-1].z1 + stock.top
