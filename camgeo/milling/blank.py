"""The blank of a program, from the program's zero: in words, and the box around it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from camgeo.milling.milling import Stock
from camgeo.milling.moves import Point
from camgeo.milling.zero import Zero
from camgeo.part.part import Part
from camgeo.units import MM_PER, LengthUnit

if TYPE_CHECKING:
    pass


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
