"""The table of polar coordinates and the motion diagram [mm of paper]."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.motion.extremes import lift_range
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray
from camgeo.product.product import Product
from camgeo.sheet.lettering import width_of
from camgeo.sheet.marks import Chain, Label, Mark, line, rectangle
from camgeo.sheet.words import Words
from camgeo.units import MM_PER, TURN

ROW: Final = 3.6
"""Height of a row of the table [mm]."""

HEAD: Final = 12.0
"""Height of the table's title and heading [mm]."""

LETTER: Final = 2.5

SAMPLES: Final = 361

DECIMALS: Final = {"mm": 3, "inch": 4}

GAP: Final = "-"
"""In place of a point that is not on the disc."""

Written = Callable[[float, int], str]
"""Writes a number with so many decimals."""


@dataclass(frozen=True, slots=True)
class Table:
    """Columns with their headings; every cell is text.

    Attributes
    ----------
    heads : of the columns.
    rows : from cam angle 0 on.
    """

    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def groups(self, number: int) -> int:
        """Rows of each of `number` groups side by side."""
        return math.ceil(len(self.rows) / number)

    def height(self, number: int) -> float:
        """Of the table in `number` groups [mm]."""
        return HEAD + ROW * self.groups(number)


def table_of(product: Product, words: Words, step: int, written: Written, *, centre: bool) -> Table:
    """Cam angle, lift, and polar coordinates of the point of contact at every `step` degrees.

    Of a groove, whose flanks are parallels of it, those of the roller's centre; with `centre` both,
    where both exist.
    """
    cam, unit = product.cam, product.unit
    degrees = np.arange(0.0, 360.0, step)
    phi = np.radians(degrees)
    lift = cam.drive.motion.jet(phi)[0]
    decimals, mm = DECIMALS[unit], MM_PER[unit]
    turning = cam.lift_unit == "rad"
    lifts = np.degrees(lift) if turning else lift / mm
    heads = [words.angle_head, words.swing_head if turning else f"{words.lift_head} {unit}"]
    columns = [[written(each, 0) for each in degrees.tolist()],
               [written(each, decimals) for each in lifts.tolist()]]  # fmt: skip
    pitch = cam.disc.pitch_curve.point(phi)
    if not cam.contact.closed_by_form:
        flank = cam.contact.main
        points = cam.disc.curve(flank).point(phi) if cam.follower.has_pitch_curve else pitch
        lost = _lost(product, phi)
        heads += [f"r {unit}", words.at_head]
        columns += _polar(points, mm, decimals, written, lost)
    if cam.follower.has_pitch_curve and (centre or cam.contact.closed_by_form):
        heads += [f"R {unit}", words.at_head]
        columns += _polar(pitch, mm, decimals, written, np.zeros(len(phi), dtype=bool))
    return Table(tuple(heads), tuple(zip(*columns, strict=True)))


def _polar(
    points: ComplexArray, mm: float, decimals: int, written: Written, lost: BoolArray
) -> list[list[str]]:
    radii = [written(each, decimals) for each in (np.abs(points) / mm).tolist()]
    turns = np.round(np.degrees(np.angle(points)) % 360.0, 3) % 360.0
    angles = [written(each, 3) for each in turns.tolist()]
    return [
        [GAP if away else each for each, away in zip(column, lost, strict=True)]
        for column in (radii, angles)
    ]


def _lost(product: Product, phi: FloatArray) -> BoolArray:
    """(n,) which cam angles belong to points of the flank that are cut off from the disc."""
    found = np.zeros(len(phi), dtype=bool)
    for cut in product.pictured.cut_off:
        found |= (phi - cut.start) % TURN < cut.end - cut.start
    return found


def table_marks(table: Table, title: str, top: complex, width: float, number: int) -> list[Mark]:
    """The table in `number` groups side by side, its upper left corner at `top`."""
    marks: list[Mark] = [Label(title, top - 4.5j, 3.5)]
    rows, group = table.groups(number), width / number
    wide = group / len(table.heads)
    begin = top - 6.0j
    for place in range(number):
        corner = begin + place * group
        own = table.rows[place * rows : (place + 1) * rows]
        if not own:
            break
        height = 6.0 + ROW * len(own)
        marks.append(rectangle(corner - 1j * height, group, height, "GRID"))
        marks.append(line(corner - 6.0j, corner - 6.0j + group, "EDGES"))
        for index, head in enumerate(table.heads):
            left = corner + wide * index
            if index:
                marks.append(line(left, left - 1j * height, "GRID"))
            marks.append(
                Label(head, left + complex(0.5 * wide, -4.3), LETTER, "centre", width=wide - 1.0)
            )
            for row, cells in enumerate(own):
                at = left + complex(wide - 1.2, -6.0 - ROW * (row + 1) + 0.5 * (ROW - LETTER))
                marks.append(Label(cells[index], at, LETTER, "right", width=wide - 1.6))
        for row in range(5, len(own), 5):
            level = corner - 1j * (6.0 + ROW * row)
            marks.append(line(level, level + group, "GRID"))
    return marks


def diagram(
    product: Product, words: Words, corner: complex, size: complex, written: Written
) -> list[Mark]:
    """The lift over the cam angle, in a box of `size` whose lower left corner is at `corner`."""
    drive, unit = product.cam.drive, product.unit
    turning = product.cam.lift_unit == "rad"
    factor = math.degrees(1.0) if turning else 1.0 / MM_PER[unit]
    phi = np.linspace(0.0, TURN, SAMPLES)
    values = drive.motion.jet(phi, "left")[0] * factor
    low, high = (each * factor for each in lift_range(drive.motion))
    low, high = min(low, 0.0), max(high, 0.0)
    decimals = DECIMALS[unit]
    texts = [written(each, decimals) for each in (low, high)]
    left = max(width_of(each, LETTER) for each in texts) + 4.0
    begin = corner + complex(left, 10.0)
    width, height = size.real - left - 2.0, size.imag - 20.0
    rise = height / (high - low) if high > low else 0.0
    head = words.swing_head if turning else f"{words.lift_head} {unit}"
    head = f"{words.motion}: {head}"
    marks: list[Mark] = [Label(head, corner + complex(0.0, size.imag - 4.0), 3.5)]
    marks.append(rectangle(begin, width, height, "GRID"))
    for angle in range(0, 361, 30):
        x = begin + width * angle / 360.0
        marks.append(line(x, x - 1.2j, "GRID"))
        marks.append(Label(str(angle), x - 4.4j, LETTER, "centre"))
    for joint in drive.joints:
        x = begin + width * joint / TURN
        if 0.0 < joint < TURN:
            marks.append(line(x, x + 1j * height, "CENTRE"))
    for value, text in {low: texts[0], high: texts[1]}.items():
        level = begin + 1j * rise * (value - low)
        marks.append(line(level - 1.2, level, "GRID"))
        marks.append(Label(text, level - complex(2.0, 0.5 * LETTER), LETTER, "right"))
    if low < 0.0 < high:
        level = begin - 1j * rise * low
        marks.append(line(level, level + width, "GRID"))
    marks.append(Label(words.angle, begin + complex(0.5 * width, -9.0), LETTER, "centre"))
    points = begin + width * phi / TURN + 1j * rise * (values - low)
    marks.append(Chain(points, np.zeros(len(points)), "DIAGRAM"))
    return marks
