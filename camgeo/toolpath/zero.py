"""Where the coordinates of a program begin: on the cam axis or a corner of the blank, on a face."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from camgeo.errors import GeometryError
from camgeo.part.part import Part
from camgeo.toolpath.moves import Point
from camgeo.toolpath.spec import AXIS, CORNERS, PART_TOP, GcodeSpec
from camgeo.toolpath.stock import Stock

FACES: Final = {
    PART_TOP: "the upper face of the finished disc",
    "part-bottom": "the lower face of the finished disc",
    "blank-top": "the upper face of the blank",
    "blank-bottom": "the lower face of the blank",
}


@dataclass(frozen=True, slots=True)
class Zero:
    """The zero of a program.

    Attributes
    ----------
    name, height : as in scenes.
    place : seen from the cam axis [mm].
    z : above the upper face of the part [mm].
    """

    name: str = AXIS
    height: str = PART_TOP
    place: complex = 0j
    z: float = 0.0

    @property
    def point(self) -> Point:
        """Where it is in the part's coordinates [mm]."""
        return self.place.real, self.place.imag, self.z

    @property
    def is_of_the_part(self) -> bool:
        """Whether the program's coordinates are the part's own."""
        return self.name == AXIS and self.height == PART_TOP

    @property
    def sentence(self) -> str:
        """Where it is, in words."""
        where = "the cam axis"
        if self.name != AXIS:
            where = f"the {self.name.replace('-', ' ')} corner of the blank"
        return f"X 0, Y 0 on {where}, Z 0 on {FACES[self.height]}"

    def of(self, place: complex) -> complex:
        """A place of the part [mm] in the program's coordinates."""
        return place - self.place


OF_THE_PART: Final = Zero()


def zero_of(spec: GcodeSpec, stock: Stock, part: Part) -> Zero:
    """The zero that a scene asks for.

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
        place = stock.centre + 0.5 * complex(along * stock.length, across * stock.width)
    low, high = part.layers[0].z0, part.layers[-1].z1
    heights = {
        PART_TOP: 0.0,
        "part-bottom": low,
        "blank-top": high + stock.top,
        "blank-bottom": low - stock.bottom,
    }
    return Zero(spec.zero, spec.zero_height, place, heights[spec.zero_height])
