"""Measured points from a CSV file: x, y and, if it has them, normals nx, ny."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.numeric.arrays import ComplexArray, frozen
from camgeo.numeric.columns import Asked, Column, Columns, fault, read_columns
from camgeo.pickled import Pickled
from camgeo.reading import COORDINATE
from camgeo.units import MM_PER, LengthUnit

FEWEST: Final = 12
MOST: Final = 50_000

UNITS: Final[dict[str, LengthUnit]] = {
    "mm": "mm", "inch": "inch", "in": "inch", '"': "inch"
}  # fmt: skip

LENGTHS: Final = tuple(
    Column(name, (name, f"{name} measured", f"measured {name}"), tuple(UNITS), "mm or inch")
    for name in "xy"
)

NORMALS: Final = (Column("nx", ("nx", "i")), Column("ny", ("ny", "j")))

ASKED: Final = Asked(LENGTHS, NORMALS, FEWEST, MOST)


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredPoints(Pickled):
    """Points as measured.

    Attributes
    ----------
    points : (n,) complex [mm].
    normals : (n,) complex, as stated, of any length but 0; None if there are none.
    """

    points: ComplexArray
    normals: ComplexArray | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", frozen(self.points, np.complex128))
        if self.normals is not None:
            object.__setattr__(self, "normals", frozen(self.normals, np.complex128))


def places_of(found: Columns, file: str, unit: LengthUnit) -> ComplexArray:
    """(n,) complex [mm] the places in the first two columns, x and y; `unit` if they state none.

    Raises GeometryError with file and line if they have different units, or one is too large.
    """
    units = {UNITS[each.lower()] for each in found.units[:2] if each}
    if len(units) > 1:
        raise fault(file, found.lines[0], "", "x and y have different units; allowed: one")
    x, y = found.values[:2]
    for values in (x, y):
        beyond = np.flatnonzero(np.abs(values) > COORDINATE)
        if len(beyond):
            row = int(beyond[0])
            message = f"too large; allowed: coordinates up to {COORDINATE:g}"
            raise fault(file, found.lines[row], repr(float(values[row])), message)
    places: ComplexArray = (x + 1j * y) * MM_PER[units.pop() if units else unit]
    return places


def read_points(data: bytes | str, file: str, unit: LengthUnit = "mm") -> MeasuredPoints:
    """Read measured points.

    The format is that of `camgeo.numeric.columns`: x and y, or x, y, nx and ny; a heading may have
    further columns and may call the normals i and j, and may state mm or inch in brackets.

    Parameters
    ----------
    unit : of a file whose heading states none.

    Raises
    ------
    GeometryError
        With file and line, if the table is not as described, x and y have different units, a
        coordinate is too large or a normal is zero, or there are fewer than 12 different points.
    """
    found = read_columns(data, file, ASKED)
    points = places_of(found, file, unit)
    stated = found.values[len(LENGTHS) :]
    if len(np.unique(points)) < FEWEST:
        message = f"fewer than {FEWEST} different points; allowed: {FEWEST} or more"
        raise fault(file, found.lines[-1], "", message)
    if not len(stated):
        return MeasuredPoints(points)
    size = np.hypot(*stated)
    normals = np.divide(stated[0] + 1j * stated[1], size, out=np.zeros_like(points), where=size > 0)
    if not np.all(size > 0.0):
        row = int(np.flatnonzero(size == 0.0)[0])
        raise fault(file, found.lines[row], "", "a normal of no length; allowed: a direction")
    return MeasuredPoints(points, normals)
