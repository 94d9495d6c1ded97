"""The whole sheet of one disc: its parts and their places."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from fractions import Fraction
from typing import Final

import numpy as np

from camgeo.design.judged_part import ANGLE
from camgeo.design.product import Product
from camgeo.errors import GeometryError, SceneError
from camgeo.kinematics.motion import lift_range
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray
from camgeo.part.spec import LOWER, MAIN, Chamfers, PartSpec
from camgeo.pictures.sheet import front
from camgeo.pictures.sheet.marks import (
    Chain,
    Diameter,
    Distance,
    Label,
    Mark,
    Sheet,
    View,
    edges,
    first_angle,
    line,
    others,
    rectangle,
    texture,
    texture_width,
    width_of,
    wrapped,
)
from camgeo.pictures.sheet.placing import ink_of
from camgeo.pictures.sheet.views import Drawn, drawn_of, front_view, section_view
from camgeo.pictures.sheet.words import CHAMFERED, WORDS, Words
from camgeo.scene.formats.drawing import DrawingSpec, SheetName
from camgeo.units import MM_PER, TURN, LengthUnit

BETWEEN: Final = 6.0
"""Between front view and section, with all that belongs to them, and farther where there is room,
up to `SPREAD` [mm]."""

SPREAD: Final = 20.0

DWARFED: Final = 4
"""How many times larger a part is without pitch curve and base circle for them to be left out."""

EDGE: Final = 1.5
"""Around the views [mm]."""


def sheets_of(product: Product, tolerance: float) -> tuple[Sheet, ...]:
    """The sheets of a disc, whose edges lie within `tolerance` [mm]: the views are on the first
    one, and a table that does not fit there is on the next.

    Raises
    ------
    SceneError
        With the key of `[drawing]` that is at fault, if not all of it fits.
    """
    try:
        return _sheets_of(product, tolerance)
    except GeometryError as error:
        if not error.key.startswith("drawing."):
            raise
        scene = product.scene
        fault = scene.stated.scene.fault(tuple(error.key.split(".")), error.message)
        fault = fault if fault.value else replace(fault, value=error.value)
        raise SceneError([fault], scene.source.file) from error


def _sheets_of(product: Product, tolerance: float) -> tuple[Sheet, ...]:
    spec = product.scene.drawing
    each = 2 if Texts(product, spec).is_apart else 1
    if product.is_pair:  # the sheets of its discs have their curves
        spec = replace(spec, step=0, motion=False, scale="")
    drawn = drawn_of(product, tolerance)
    texts = Texts(product, spec)
    regions, marks = texts.beside(tolerance, drawn)
    scale, views = _fitted(drawn, regions, product, spec)
    if not spec.scale and _may_fit(drawn.alone, regions, DWARFED * float(scale)):
        bare, bare_marks = texts.beside(tolerance, drawn.alone)
        larger, bare_views = _fitted(drawn.alone, bare, product, spec)
        if larger >= DWARFED * scale:
            scale, views, marks = larger, bare_views, bare_marks
    contents = [(views, marks)]
    if texts.is_apart:
        contents.append(((), texts.table_apart()))
    last = len(product.judgement.cams) * each + is_in_one_piece(product)
    first = last if product.is_pair else product.position * each + 1
    return tuple(
        _sheet(product, spec, scale, own, drawn_on, (first + number, last))
        for number, (own, drawn_on) in enumerate(contents)
    )


def is_in_one_piece(product: Product) -> bool:
    """Whether the disc is one piece with another."""
    part = product.scene.part
    return part is not None and part.pair is not None


def _sheet(
    product: Product, spec: DrawingSpec, scale: Fraction, views: tuple[View, ...],
    marks: list[Mark], numbered: tuple[int, int],
) -> Sheet:  # fmt: skip
    """A sheet with its frame and title block."""
    size = SIZES[spec.sheet]
    corner = complex(size.width - MARGIN - BLOCK_WIDTH, MARGIN)
    all_marks = [*marks, *frame(size)]
    all_marks += title_block(corner, spec, spelled(scale), product.unit, numbered)
    if spec.edges:
        all_marks += edges(corner + block_place("edges"), spec.edges)
    if spec.surface:
        at = corner + block_place("surface")
        all_marks += texture(at, spec.surface, 2.0)
        if spec.flank_surface:
            all_marks += others(at + texture_width(spec.surface, 2.0) + 4.0, 2.0)
    dashed = tuple(front.in_dashes(all_marks, 1.0))
    comma = spec.language == "de"
    return Sheet(size.width, size.height, float(scale), product.unit, comma, views, dashed)


@dataclass(frozen=True, slots=True)
class _Laid:
    """Views at a scale, by their origins: the first one's at 0 [mm of paper].

    Attributes
    ----------
    views : the front view, and of a part with thickness the section to its right, as near as may
        be.
    low, high : corners of all that they show.
    """

    views: tuple[View, ...]
    low: complex
    high: complex

    def fits(self, region: Region) -> bool:
        """Whether they fit in a region."""
        spare = self.spare(region)
        return spare.real >= 0.0 and spare.imag >= 0.0

    def spare(self, region: Region) -> complex:
        """What a region is larger."""
        return region.size - (self.high - self.low) - complex(2.0 * EDGE, 2.0 * EDGE)

    def placed(self, region: Region) -> tuple[View, ...]:
        """The views in the middle of a region, the section farther away if there is room."""
        spare = self.spare(region)
        apart = min(spare.real / 3.0, SPREAD) if len(self.views) > 1 else 0.0
        aside = 0.5 * (spare.real - apart)
        at = region.low - self.low + complex(EDGE + aside, EDGE + 0.5 * spare.imag)
        return tuple(replace(each, at=each.at + at + number * apart)
                     for number, each in enumerate(self.views))  # fmt: skip


def _laid(drawn: Drawn, scale: float, product: Product, spec: DrawingSpec) -> _Laid:
    marks = tuple(front_view(drawn, scale, product, spec))
    low, high = ink_of(marks, scale, product.unit).extent
    views = [View(0j, marks)]
    if drawn.cut:
        cut = tuple(section_view(drawn, scale, product, spec))
        left, right = ink_of(cut, scale, product.unit).extent
        at = high.real + BETWEEN - left.real
        views.append(View(complex(at), cut))
        low = complex(low.real, min(low.imag, left.imag))
        high = complex(at + right.real, max(high.imag, right.imag))
    return _Laid(tuple(views), low, high)


def _fitted(
    drawn: Drawn, regions: Sequence[Region], product: Product, spec: DrawingSpec
) -> tuple[Fraction, tuple[View, ...]]:
    """The stated scale, or the largest standard one at which the views fit, and the views."""
    asked = scale_of(spec.scale) if spec.scale else None
    tried = scales() if asked is None else (asked,)
    for scale in tried:
        if _may_fit(drawn, regions, float(scale)):
            laid = _laid(drawn, float(scale), product, spec)
            for region in filter(laid.fits, regions):
                return scale, laid.placed(region)
    if asked is None:
        message = "leaves no room for the views; leave out table or diagram, or take A3"
        raise GeometryError(message, key="drawing.sheet", value=spec.sheet)
    largest, _ = _fitted(drawn, regions, product, replace(spec, scale=""))
    message = f'does not fit on the sheet: at most "{spelled(largest)}" does'
    raise GeometryError(message, key="drawing.scale", value=spec.scale)


def _may_fit(drawn: Drawn, regions: Sequence[Region], scale: float) -> bool:
    """Whether the part itself fits, without anything around it."""
    low, high = drawn.box
    size = high - low + (drawn.shape.part.thickness if drawn.cut else 0.0)
    rooms = [region.size / scale for region in regions]
    return any(size.real <= room.real and size.imag <= room.imag for room in rooms)


def measured(sheet: Sheet) -> tuple[Distance | Diameter, ...]:
    """All dimensions of a sheet."""
    return tuple(
        mark for view in sheet.views for mark in view.marks if isinstance(mark, Distance | Diameter)
    )


# -- scales ---------------------------------------------------------------------------------------
# Standard scales (ISO 5455).


LARGEST: Final = 50

SMALLEST: Final = 100_000


def scales() -> tuple[Fraction, ...]:
    """Millimetres of paper for each of the part, the largest first."""
    sizes = [step * 10**power for power in range(6) for step in (1, 2, 5)]
    up = [Fraction(size) for size in sizes if size <= LARGEST]
    down = [Fraction(1, size) for size in sizes if 1 < size <= SMALLEST]
    return (*reversed(up), *down)


def spelled(scale: Fraction) -> str:
    """As it stands in the title block, "1:2"."""
    return f"{scale.numerator}:{scale.denominator}"


def scale_of(text: str) -> Fraction:
    """The scale that is spelled so."""
    first, _, second = text.partition(":")
    return Fraction(int(first), int(second))


# -- texts ----------------------------------------------------------------------------------------
# The texts of a sheet around its views, and the room that they leave.


FURTHER: Final = 36
"""Most rows of the table beside the views on A4; a longer one has a further sheet."""

DIAGRAM: Final[dict[SheetName, float]] = {"A3": 48.0, "A4": 36.0}
"""Height of the motion diagram [mm]."""


@dataclass(frozen=True, slots=True)
class Region:
    """A rectangle of the sheet by two corners [mm]."""

    low: complex
    high: complex

    @property
    def size(self) -> complex:
        """Width and height."""
        return self.high - self.low


@dataclass(frozen=True, slots=True)
class Texts:
    """Notes, table and motion diagram of a disc, around its views."""

    product: Product
    spec: DrawingSpec

    @property
    def _low(self) -> complex:
        return complex(LEFT, MARGIN)

    @property
    def _high(self) -> complex:
        size = SIZES[self.spec.sheet]
        return complex(size.width - MARGIN, size.height - MARGIN)

    @property
    def _left(self) -> float:
        return self._high.real - BLOCK_WIDTH

    @property
    def _is_wide(self) -> bool:
        return self.spec.sheet == "A3"

    @property
    def is_apart(self) -> bool:
        """Whether the table is on a sheet of its own."""
        return not self._is_wide and bool(self.spec.step) and 360 // self.spec.step > FURTHER

    def beside(self, tolerance: float, drawn: Drawn) -> tuple[tuple[Region, ...], list[Mark]]:
        """The regions that are left for the views, the better one first, and all other marks."""
        spec, words, width = self.spec, WORDS[self.spec.language], BLOCK_WIDTH - 4.0
        stated = notes_of(self.product, spec, tolerance, self._length, apart=self.is_apart,
                                drawn=drawn)  # fmt: skip
        lines = lines_of(stated, width)
        top = complex(self._left + 2.0, MARGIN + BLOCK_HEIGHT + height_of(lines) + 1.0)
        marks = marks_of(lines, words.notes, top, width)
        floor, ceiling = top.imag + 1.0, self._high.imag - 2.0
        if spec.step and not self.is_apart:
            table = self._table(centre=self._is_wide)
            groups = 2 if self._is_wide else 3
            needed = table.height(groups)
            upper = ceiling if self._is_wide else floor + needed
            marks += table_marks(table, words.table, complex(top.real, upper), width, groups)
            ceiling, floor = (upper - needed, floor) if self._is_wide else (ceiling, floor + needed)
        low = self._low.imag if self._is_wide else floor
        if spec.has_motion:
            size = complex(width, DIAGRAM[spec.sheet])
            corner = complex(top.real, floor)
            if self._is_wide and ceiling - floor < size.imag + 4.0:
                corner, low = self._low + complex(3.0, 5.0), self._low.imag + 5.0 + size.imag
            elif not self._is_wide:
                low += size.imag
            else:
                corner += 0.5j * (ceiling - floor - size.imag)
            marks += diagram(self.product, words, corner, size, self._written)
        right = self._left if self._is_wide else self._high.real
        found = Region(complex(self._low.real, low), complex(right, self._high.imag))
        if self._is_wide and not spec.step and not spec.has_motion:
            return (Region(complex(self._low.real, floor), self._high), found), marks
        return (found,), marks

    def table_apart(self) -> list[Mark]:
        """The table on a sheet of its own, with all that it can state."""
        title = WORDS[self.spec.language].table
        corner = complex(self._left + 2.0, self._high.imag - 2.0)
        return table_marks(self._table(centre=True), title, corner, BLOCK_WIDTH - 4.0, 2)

    def _table(self, *, centre: bool) -> Table:
        words = WORDS[self.spec.language]
        return table_of(self.product, words, self.spec.step, self._written, centre=centre)

    def _written(self, value: float, decimals: int) -> str:
        text = f"{value + 0.0:.{decimals}f}"
        text = text.removeprefix("-") if float(text) == 0.0 else text
        return text.replace(".", ",") if self.spec.language == "de" else text

    def _length(self, value: float) -> str:
        decimals = 4 if self.product.unit == "mm" else 5
        text = self._written(value / MM_PER[self.product.unit], decimals).rstrip("0")
        return text.rstrip(".,")


# -- notes ----------------------------------------------------------------------------------------
# The notes on a sheet: what it shows, and by what it was made.


LETTER = 2.5

STEP = 3.6
"""From line to line [mm]."""

SPARING: Final = 0.96
"""How much of a line is used: fonts that programs take in place of ours may be wider."""

Length = Callable[[float], str]
"""Writes a length [mm] in the unit of the drawing."""


def notes_of(
    product: Product,
    spec: DrawingSpec,
    tolerance: float,
    length: Length,
    *,
    apart: bool,
    drawn: Drawn,
) -> list[str]:
    """The sentences, in the language of the sheet; `apart` says that the table is on the next one,
    `drawn` which curves there are and whether dimensions are in brackets.
    """
    words, cam = WORDS[spec.language], product.cam
    name = product.scene.name
    if product.is_pair:
        found = [words.pair_design.format(name=name)]
        legend: list[str] = []
    else:
        found = [(words.return_disc if product.position else words.design).format(name=name)]
        found.append(_follower(product, spec, words, length))
        legend = _legend(product, spec, words, apart=apart, drawn=drawn)
    found += _features(product.drawn.spec, words, length, spec)
    found += _pair(product.scene.part, words, length)
    sense = words.sense.format(sense=words.ccw if cam.rotation > 0 else words.cw)
    found.append(f"{words.zero} {sense}")
    shown = f"{tolerance / MM_PER[product.unit]:.9f}".rstrip("0")
    if spec.language == "de":
        shown = shown.replace(".", ",")
    found.append(words.curve.format(tolerance=shown, unit=product.unit))
    if drawn.shape.outermost.circle is None:
        legend.append(words.reference)
    if legend:
        found.append(" ".join(legend))
    found.append(words.scene.format(scene=product.scene_hash))
    return found


def _follower(product: Product, spec: DrawingSpec, words: Words, length: Length) -> str:
    """What touches the disc, how it is guided, and the base circle."""
    cam, follower = product.cam, product.cam.follower
    touching = words.flat_face
    if follower.rolls:
        radius = follower.roller_radius
        touching = (
            words.roller.format(diameter=length(2.0 * radius)) if radius else words.knife_edge
        )
    if follower.pivot is None:
        found = words.guided.format(touching=touching, offset=length(follower.offset))
    else:
        x, y = length(follower.pivot.real), length(follower.pivot.imag)
        found = words.rocking.format(touching=touching, x=x, y=y)
    base = words.base.format(radius=length(follower.base_radius))
    if cam.contact.closed_by_form and cam.clearance:
        base += f"; {words.clearance.format(clearance=length(cam.clearance))}"
    return f"{found}; {base[0].lower() if spec.language == 'en' else base[0]}{base[1:]}"


def _legend(
    product: Product, spec: DrawingSpec, words: Words, *, apart: bool, drawn: Drawn
) -> list[str]:
    """What lines and columns are."""
    cam, follower = product.cam, product.cam.follower
    legend = [words.pitch if drawn.pitch is not None else words.base_circle]
    if drawn.base_radius is None:
        legend = [words.left_out]
    if spec.step:
        if not cam.contact.closed_by_form:
            legend.append(words.polar)
        if follower.has_pitch_curve and (spec.sheet == "A3" or apart or cam.contact.closed_by_form):
            legend.append(words.centre_polar)
    if apart:
        legend.append(words.next_sheet)
    return legend


def _features(
    part: PartSpec | None, words: Words, length: Length, spec: DrawingSpec
) -> Iterator[str]:
    """What views and dimensions leave open: a timing mark, counterbores, and the hole of a
    set screw.
    """
    if part is None:
        return

    def degrees(angle: float) -> str:
        text = f"{math.degrees(angle):.6g}"
        return text.replace(".", ",") if spec.language == "de" else text

    if part.mark is not None:
        mark = part.mark
        size = f"%%c{length(mark.width)}"
        if mark.length is not None:
            size = f"{length(mark.width)} x {length(mark.length)}"
        yield words.mark.format(
            size=size,
            radius=length(mark.radius),
            depth=length(mark.depth),
            angle=degrees(mark.angle),
        )
    if part.bolt_circle is not None and part.bolt_circle.counterbore is not None:
        wide = part.bolt_circle.counterbore
        yield words.counterbore.format(
            diameter=length(wide.diameter),
            depth=length(wide.depth),
            hole=length(part.bolt_circle.hole),
        )
    if part.chamfers is not None:
        names = CHAMFERED[spec.language]
        stated = ((field.name, getattr(part.chamfers, field.name)) for field in fields(Chamfers))
        edges = (
            names[each.edges].format(edge=names[name], width=length(each.width))
            for name, each in stated
            if each is not None
        )
        yield words.chamfers.format(edges="; ".join(edges))
    for text in part.engraving:
        yield words.engraving.format(
            height=length(text.height),
            depth=length(text.depth),
            radius=length(text.radius),
            angle=degrees(text.angle),
        )
    if part.set_screw is not None and part.hub is not None:
        screw = part.set_screw
        yield words.set_screw.format(
            diameter=length(screw.diameter),
            height=length(screw.height),
            angle=degrees(screw.angle),
            face=words.lower if part.hub.side == LOWER else words.upper,
        )


def _pair(part: PartSpec | None, words: Words, length: Length) -> Iterator[str]:
    """How the disc stands to the other one of a pair in one piece."""
    if part is None or part.pair is None:
        return
    pair = part.pair
    yield words.pair.format(
        angle=f"{ANGLE:g}",
        gap=length(pair.gap),
        spacer=length(pair.spacer),
        upper=words.main_disc if pair.upper == MAIN else words.other_disc,
    )


def lines_of(notes: list[str], width: float) -> list[tuple[str, bool]]:
    """The notes in lines at most `width` [mm] wide, and whether each begins a note."""
    found = []
    for note in notes:
        first, *rest = wrapped(note, LETTER, SPARING * (width - 6.0))
        found += [(first, True), *((text, False) for text in rest)]
    return found


def height_of(lines: list[tuple[str, bool]]) -> float:
    """Height of the notes with their heading [mm]."""
    return 7.0 + STEP * len(lines)


def marks_of(lines: list[tuple[str, bool]], heading: str, top: complex, width: float) -> list[Mark]:
    """The notes, numbered, below `top`."""
    marks: list[Mark] = [Label(heading, top - 4.5j, 3.5)]
    number = 0
    for row, (text, begins) in enumerate(lines):
        at = top - 1j * (6.0 + STEP * row + LETTER)
        if begins:
            number += 1
            marks.append(Label(f"{number}", at, LETTER))
        marks.append(Label(text, at + 5.0, LETTER, width=width - 5.0))
    return marks


# -- course ---------------------------------------------------------------------------------------
# The table of polar coordinates and the motion diagram [mm of paper].


ROW: Final = 3.6
"""Height of a row of the table [mm]."""

HEAD: Final = 12.0
"""Height of the table's title and heading [mm]."""

TABLE_LETTER: Final = 2.5

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
                Label(
                    head, left + complex(0.5 * wide, -4.3), TABLE_LETTER, "centre", width=wide - 1.0
                )
            )
            for row, cells in enumerate(own):
                at = left + complex(wide - 1.2, -6.0 - ROW * (row + 1) + 0.5 * (ROW - TABLE_LETTER))
                marks.append(Label(cells[index], at, TABLE_LETTER, "right", width=wide - 1.6))
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
    left = max(width_of(each, TABLE_LETTER) for each in texts) + 4.0
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
        marks.append(Label(str(angle), x - 4.4j, TABLE_LETTER, "centre"))
    for joint in drive.joints:
        x = begin + width * joint / TURN
        if 0.0 < joint < TURN:
            marks.append(line(x, x + 1j * height, "CENTRE"))
    for value, text in {low: texts[0], high: texts[1]}.items():
        level = begin + 1j * rise * (value - low)
        marks.append(line(level - 1.2, level, "GRID"))
        marks.append(Label(text, level - complex(2.0, 0.5 * TABLE_LETTER), TABLE_LETTER, "right"))
    if low < 0.0 < high:
        level = begin - 1j * rise * low
        marks.append(line(level, level + width, "GRID"))
    marks.append(Label(words.angle, begin + complex(0.5 * width, -9.0), TABLE_LETTER, "centre"))
    points = begin + width * phi / TURN + 1j * rise * (values - low)
    marks.append(Chain(points, np.zeros(len(points)), "DIAGRAM"))
    return marks


# -- frame ----------------------------------------------------------------------------------------
# The sheet itself: trimmed size, frame and grid (ISO 5457), and the title block (ISO 7200).


@dataclass(frozen=True, slots=True)
class Size:
    """A sheet: width and height [mm], and the fields of its grid along each."""

    width: float
    height: float
    columns: int
    rows: int


SIZES: Final[dict[SheetName, Size]] = {"A3": Size(420, 297, 8, 6), "A4": Size(210, 297, 4, 6)}

LEFT, MARGIN = 20.0, 10.0
"""Of the frame, on the left for filing and on the other sides [mm]."""

BAND = 5.0
"""Width of the grid outside the frame [mm]."""

FIELD = 50.0
"""Length of a field of the grid, from the middle of the sheet [mm]."""

BLOCK_WIDTH, BLOCK_HEIGHT = 180.0, 38.0
"""Of the title block [mm]."""

Row = tuple[float, float, tuple[tuple[str, str, float, float], ...]]
"""Bottom and height of a row of the title block, and its cells: label, text, width, letters."""


def frame(size: Size) -> list[Mark]:
    """Trimmed edge, frame, centring marks and grid; an A4 sheet has letters on two sides only."""
    low, high = complex(LEFT, MARGIN), complex(size.width - MARGIN, size.height - MARGIN)
    inner, outer = high - low, high - low + complex(2 * BAND, 2 * BAND)
    marks: list[Mark] = [
        rectangle(0j, size.width, size.height, "GRID"),
        rectangle(low, inner.real, inner.imag, "FRAME"),
        rectangle(low - complex(BAND, BAND), outer.real, outer.imag, "GRID"),
    ]
    x, y = 0.5 * size.width, 0.5 * size.height
    ends = ((complex(x, low.imag), -1j), (complex(x, high.imag), 1j),
            (complex(low.real, y), -1.0), (complex(high.real, y), 1.0))  # fmt: skip
    marks += [line(at + BAND * way, at, "FRAME") for at, way in ends]
    both = size.columns > 4
    for number in range(size.columns):
        start = x + (number - 0.5 * size.columns) * FIELD
        ends_at = _clipped(start, FIELD, low.real, high.real)
        for side in (low.imag - BAND, high.imag) if both else (high.imag,):
            if number:
                marks.append(line(complex(start, side), complex(start, side + BAND), "GRID"))
            at = complex(0.5 * sum(ends_at), side + 1.25)
            marks.append(Label(str(number + 1), at, 2.5, "centre", "GRID"))
    for number in range(size.rows):
        start = y - (number - 0.5 * size.rows + 1.0) * FIELD
        ends_at = _clipped(start, FIELD, low.imag, high.imag)
        for side in (low.real - BAND, high.real) if both else (high.real,):
            if number:
                level = start + FIELD
                marks.append(line(complex(side, level), complex(side + BAND, level), "GRID"))
            at = complex(side + 0.5 * BAND, 0.5 * sum(ends_at) - 1.25)
            marks.append(Label("ABCDEF"[number], at, 2.5, "centre", "GRID"))
    return marks


def _clipped(start: float, length: float, low: float, high: float) -> tuple[float, float]:
    return max(start, low), min(start + length, high)


def title_block(
    corner: complex,
    spec: DrawingSpec,
    scale: str,
    unit: LengthUnit,
    sheet: tuple[int, int],
) -> list[Mark]:
    """The title block by its lower left corner; `sheet` is its number and how many there are."""
    words = WORDS[spec.language]
    numbered = f"{sheet[0]}/{sheet[1]}"
    rows: tuple[Row, ...] = (
        (28.0, 10.0, (
            (words.material, spec.material, 52.0, 2.5),
            (words.hardness, spec.hardness, 40.0, 2.5),
            (words.tolerances, spec.general_tolerances, 52.0, 2.5),
            (words.scale, scale, 18.0, 3.5),
            ("", "", 18.0, 2.5),
        )),
        (18.0, 10.0, (
            (words.owner, spec.owner, 52.0, 2.5),
            (words.document_type, spec.document_type, 52.0, 2.5),
            (words.edges, "", 30.0, 2.5),
            (words.surface, "", 28.0, 2.5),
            (words.dimensions, unit, 18.0, 2.5),
        )),
        (9.0, 9.0, (
            (words.creator, spec.creator, 52.0, 2.5),
            (words.approver, spec.approver, 52.0, 2.5),
            (words.date, spec.date, 30.0, 2.5),
            (words.revision, spec.revision, 14.0, 2.5),
            (words.language, spec.language, 14.0, 2.5),
            (words.size, spec.sheet, 18.0, 2.5),
        )),
        (0.0, 9.0, (
            (words.title, spec.title, 104.0, 3.5),
            (words.number, spec.number, 58.0, 3.5),
            (words.sheet, numbered, 18.0, 2.5),
        )),
    )  # fmt: skip
    marks: list[Mark] = [rectangle(corner, BLOCK_WIDTH, BLOCK_HEIGHT, "FRAME")]
    for bottom, height, cells in rows:
        left = 0.0
        for label, text, width, letter in cells:
            at = corner + complex(left, bottom)
            marks.append(rectangle(at, width, height, "GRID"))
            if label:
                head = at + complex(1.0, height - 2.6)
                marks.append(Label(label, head, 1.8, width=width - 2.0))
            if text:
                marks.append(Label(text, at + complex(1.5, 1.3), letter, width=width - 3.0))
            left += width
    marks += first_angle(corner + complex(171.0, 33.0))
    return marks


def block_place(name: str) -> complex:
    """Where the symbol in the cell of "edges" or "surface" has its tip, from the block's corner."""
    return {"edges": complex(108.0, 19.0), "surface": complex(138.0, 18.8)}[name]
