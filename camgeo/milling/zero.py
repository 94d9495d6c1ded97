"""Where the coordinates of a program begin: on the cam axis or a corner of the blank, on a face."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from camgeo.errors import GeometryError
from camgeo.milling.holding import NOT, mirrored
from camgeo.milling.milling import AXIS, CORNERS, PART_TOP, GcodeSpec, Stock
from camgeo.milling.moves import Point
from camgeo.part.part import Part

if TYPE_CHECKING:
    pass


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
