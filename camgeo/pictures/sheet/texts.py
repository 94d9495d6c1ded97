"""The texts of a sheet around its views: title block, notes, table and motion diagram."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields
from typing import Final

import numpy as np

from camgeo.design.judged_part import ANGLE
from camgeo.design.product import Product
from camgeo.kinematics.motion import lift_range
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray
from camgeo.part.spec import BOTH, LOWER, MAIN, UPPER, Chamfers, PartSpec
from camgeo.pictures.sheet.marks import (
    Chain,
    Label,
    Mark,
    Round,
    line,
    path,
    rectangle,
    text_width,
    texture,
)
from camgeo.pictures.sheet.section import ViewSubject
from camgeo.scene.formats.drawing import DrawingSpec, Language, SheetName
from camgeo.units import MM_PER, TURN, LengthUnit

# -- words ----------------------------------------------------------------------------------------
# The words on a sheet, in each language.


Words = Mapping[str, str]
"""Labels of the title block, headings and notes in one language, with braces for values."""

LANGUAGES: Final[tuple[Language, ...]] = ("en", "de")

TABLE: Final = {
    "owner": ("Legal owner", "Gesetzlicher Eigentümer"),
    "creator": ("Created by", "Erstellt von"),
    "approver": ("Approved by", "Genehmigt von"),
    "date": ("Date of issue", "Ausgabedatum"),
    "revision": ("Rev.", "Änd."),
    "document_type": ("Document type", "Dokumentenart"),
    "title": ("Title", "Titel"),
    "number": ("Identification number", "Sachnummer"),
    "sheet": ("Sheet", "Blatt"),
    "material": ("Material", "Werkstoff"),
    "hardness": ("Hardness", "Härte"),
    "tolerances": ("General tolerances", "Allgemeintoleranzen"),
    "edges": ("Edges ISO 13715", "Kanten ISO 13715"),
    "surface": ("Surface", "Oberfläche"),
    "scale": ("Scale", "Maßstab"),
    "size": ("Size", "Format"),
    "language": ("Lang.", "Spr."),
    "dimensions": ("Dimensions in", "Maße in"),
    "table": ("Polar coordinates", "Polarkoordinaten"),
    "motion": ("Motion diagram", "Bewegungsdiagramm"),
    "angle_head": ("Angle °", "Winkel °"),
    "swing_head": ("Swing °", "Schwenk °"),
    "lift_head": ("Lift", "Hub"),
    "at_head": ("at °", "bei °"),
    "angle": ("Cam angle in degrees", "Kurvenwinkel in Grad"),
    "notes": ("Notes", "Bemerkungen"),
    "design": ("Design {name}", "Entwurf {name}"),
    "return_disc": ("Design {name}, return disc", "Entwurf {name}, Gegenscheibe"),
    "roller": ("roller %%c{diameter}", "Rolle %%c{diameter}"),
    "knife_edge": ("knife edge", "Schneide"),
    "flat_face": ("flat face", "Tellerfläche"),
    "guided": (
        "Follower: {touching} on a guide, offset {offset}",
        "Abtrieb: {touching}, gerade geführt, Versatz {offset}",
    ),
    "rocking": (
        "Follower: {touching} on a rocker, pivot at ({x} / {y})",
        "Abtrieb: {touching} am Schwinghebel, Drehpunkt ({x} / {y})",
    ),
    "base": ("Base circle radius {radius}", "Grundkreisradius {radius}"),
    "clearance": (
        "groove wider than the roller by {clearance}",
        "Nut um {clearance} breiter als die Rolle",
    ),
    "mark": (
        "Timing mark {size}, {depth} deep, its middle at radius {radius} and {angle}°",
        "Zeitmarke {size}, {depth} tief, Mitte auf Radius {radius} bei {angle}°",
    ),
    "engraving": (
        (
            "Engraving in DejaVu Sans, capital letters {height} high, {depth} deep, its middle at"
            " radius {radius} and {angle}°"
        ),
        (
            "Gravur in DejaVu Sans, Großbuchstaben {height} hoch, {depth} tief, Mitte auf Radius"
            " {radius} bei {angle}°"
        ),
    ),
    "counterbore": (
        "Counterbores %%c{diameter}, {depth} deep from the upper end of the holes %%c{hole}.",
        "Flachsenkungen %%c{diameter}, {depth} tief vom oberen Ende der Bohrungen %%c{hole}.",
    ),
    "chamfers": ("Chamfers of 45°: {edges}.", "Fasen unter 45°: {edges}."),
    "set_screw": (
        (
            "Hole %%c{diameter} for a set screw, radial through the hub at {angle}°, its middle"
            " {height} from the {face} face of the disc (not drawn)"
        ),
        (
            "Bohrung %%c{diameter} für einen Gewindestift, radial durch die Nabe bei {angle}°,"
            " Mitte {height} von der {face} Fläche der Scheibe (nicht gezeichnet)"
        ),
    ),
    "pair": (
        (
            "Both discs in one piece: the zero of the return disc at {angle}° to that of the main"
            " disc, gap {gap}, spacer %%c{spacer}, {upper} above."
        ),
        (
            "Beide Scheiben in einem Teil: Null der Gegenscheibe unter {angle}° zur Null der"
            " Hauptscheibe, Abstand {gap}, Zwischenbund %%c{spacer}, {upper} oben."
        ),
    ),
    "pair_design": ("Design {name}, both discs", "Entwurf {name}, beide Scheiben"),
    "main_disc": ("main disc", "Hauptscheibe"),
    "other_disc": ("return disc", "Gegenscheibe"),
    "upper": ("upper", "oberen"),
    "lower": ("lower", "unteren"),
    "zero": (
        "The zero mark is cam angle 0; polar angles count from it, counter-clockwise in the view.",
        (
            "Die Nullmarke ist Kurvenwinkel 0; Polarwinkel zählen von ihr aus gegen den"
            " Uhrzeigersinn der Ansicht."
        ),
    ),
    "sense": ("The cam turns {sense} in the view.", "Die Kurve dreht in der Ansicht {sense}."),
    "ccw": ("counter-clockwise", "gegen den Uhrzeigersinn"),
    "cw": ("clockwise", "im Uhrzeigersinn"),
    "curve": (
        (
            "The flanks are the exact curve of the motion; this sheet shows it within {tolerance}"
            " {unit}. Manufacture from the CAD or NC data of the same scene."
        ),
        (
            "Die Flanken sind die exakte Kurve der Bewegung; dieses Blatt zeigt sie auf"
            " {tolerance} {unit} genau. Fertigung nach den CAD- oder NC-Daten derselben Szene."
        ),
    ),
    "polar": ("r: point of contact on the flank.", "r: Berührpunkt auf der Flanke."),
    "centre_polar": ("R: centre of the roller.", "R: Rollenmittelpunkt."),
    "next_sheet": (
        "Table of polar coordinates: next sheet.",
        "Tabelle der Polarkoordinaten: nächstes Blatt.",
    ),
    "reference": ("Dimensions in brackets are auxiliary.", "Eingeklammerte Maße sind Hilfsmaße."),
    "scene": ("Scene SHA-256 {scene}", "Szene SHA-256 {scene}"),
    "pitch": (
        "Pitch curve: long-dashed dotted line; base circle: double-dotted.",
        "Rollenmittelpunktsbahn: Strichpunktlinie; Grundkreis: Strich-Zweipunktlinie.",
    ),
    "base_circle": (
        "Base circle: long-dashed double-dotted line.",
        "Grundkreis: Strich-Zweipunktlinie.",
    ),
    "left_out": (
        "Pitch curve and base circle are far larger than the part and are not drawn.",
        "Rollenmittelpunktsbahn und Grundkreis, viel größer als das Teil, sind nicht gezeichnet.",
    ),
}
"""The words in the order of `LANGUAGES`."""

WORDS: Final[dict[Language, Words]] = {
    language: {key: words[place] for key, words in TABLE.items()}
    for place, language in enumerate(LANGUAGES)
}


CHAMFERED: Final[dict[Language, dict[str, str]]] = {
    "en": {
        "outline": "flanks",
        "rim": "rim",
        "bore": "bore",
        "hub": "hub",
        "bolt_circle": "bolt holes",
        "lightening_holes": "lightening holes",
        UPPER: "{edge} {width} on the upper side",
        LOWER: "{edge} {width} on the lower side",
        BOTH: "{edge} {width}",
    },
    "de": {
        "outline": "Flanken",
        "rim": "Rand",
        "bore": "Bohrung",
        "hub": "Nabe",
        "bolt_circle": "Schraubenlöcher",
        "lightening_holes": "Erleichterungslöcher",
        UPPER: "{edge} {width} oben",
        LOWER: "{edge} {width} unten",
        BOTH: "{edge} {width}",
    },
}
"""Names of edges with chamfers by their keys in the scene, and phrases by the side they are on."""


def decimal(number: str, language: Language) -> str:
    """A number with the decimal sign of the language."""
    return number.replace(".", ",") if language == "de" else number


# -- texts ----------------------------------------------------------------------------------------
# The layout of a sheet, and the room that is left for the views.


FURTHER: Final = 36
"""Largest number of rows of the table on the sheet of the views in A4; a longer one has its own."""

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
    def size(self) -> Size:
        """The size of the sheet."""
        return SIZES[self.spec.sheet]

    @property
    def _low(self) -> complex:
        return complex(LEFT, MARGIN)

    @property
    def _high(self) -> complex:
        return complex(self.size.width - MARGIN, self.size.height - MARGIN)

    @property
    def _left(self) -> float:
        return self._high.real - BLOCK_WIDTH

    @property
    def _is_wide(self) -> bool:
        return self.spec.sheet == "A3"

    @property
    def has_table_sheet(self) -> bool:
        """Whether the table of polar coordinates is on a sheet of its own."""
        return not self._is_wide and bool(self.spec.step) and 360 // self.spec.step > FURTHER

    def layout(
        self, tolerance: float, subject: ViewSubject
    ) -> tuple[tuple[Region, ...], list[Mark]]:
        """The regions that are left for the views, the best one first, and all other marks.

        On A3 everything but the views is in a column above the title block; on A4 it is stacked
        above the title block, with the views on top.
        """
        spec, words, width = self.spec, WORDS[self.spec.language], BLOCK_WIDTH - 4.0
        stated = drawing_notes(
            self.product, spec, tolerance, self._length, has_table_sheet=self.has_table_sheet,
            subject=subject,
        )  # fmt: skip
        lines = note_lines(stated, width)
        top = complex(self._left + 2.0, MARGIN + BLOCK_HEIGHT + notes_height(lines) + 1.0)
        marks = note_marks(lines, words["notes"], top, width)
        floor, ceiling = top.imag + 1.0, self._high.imag - 2.0
        if spec.step and not self.has_table_sheet:
            table = self._table(centre=self._is_wide)
            groups = 2 if self._is_wide else 3
            needed = table.height(groups)
            upper = ceiling if self._is_wide else floor + needed
            marks += table_marks(table, words["table"], complex(top.real, upper), width, groups)
            ceiling, floor = (upper - needed, floor) if self._is_wide else (ceiling, floor + needed)
        low = self._low.imag if self._is_wide else floor
        if spec.has_motion:
            size = complex(width, DIAGRAM[spec.sheet])
            corner = complex(top.real, floor)
            # Where the column of A3 has no room for the diagram, it is in the lower left corner.
            if self._is_wide and ceiling - floor < size.imag + 4.0:
                corner, low = self._low + complex(3.0, 5.0), self._low.imag + 5.0 + size.imag
            elif not self._is_wide:
                low += size.imag
            else:
                corner += 0.5j * (ceiling - floor - size.imag)
            marks += diagram(self.product, words, corner, size, self._written)
        right = self._left if self._is_wide else self._high.real
        region = Region(complex(self._low.real, low), complex(right, self._high.imag))
        if self._is_wide and not spec.step and not spec.has_motion:
            return (Region(complex(self._low.real, floor), self._high), region), marks
        return (region,), marks

    def table_sheet(self) -> list[Mark]:
        """The marks of a table on a sheet of its own, with all its columns."""
        title = WORDS[self.spec.language]["table"]
        corner = complex(self._left + 2.0, self._high.imag - 2.0)
        return table_marks(self._table(centre=True), title, corner, BLOCK_WIDTH - 4.0, 2)

    def frame_and_title(self, scale: str, sheet: tuple[int, int]) -> list[Mark]:
        """The frame, and the title block with its symbols.

        `sheet` is the number of the sheet, and the number of sheets.
        """
        spec, corner = self.spec, complex(self._left, MARGIN)
        marks = [*frame(self.size), *title_block(corner, spec, scale, self.product.unit, sheet)]
        if spec.edges:
            marks += edges(corner + complex(108.0, 19.0), spec.edges)
        if spec.surface:
            symbol_place = corner + complex(138.0, 18.8)
            marks += texture(symbol_place, spec.surface, 2.0)
            if spec.flank_surface:
                marks += others(symbol_place + texture_width(spec.surface, 2.0) + 4.0, 2.0)
        return marks

    def _table(self, *, centre: bool) -> TextTable:
        words = WORDS[self.spec.language]
        return polar_table(self.product, words, self.spec.step, self._written, centre=centre)

    def _written(self, value: float, decimals: int) -> str:
        """A number with a fixed number of decimals in the language of the sheet, without -0."""
        text = f"{value + 0.0:.{decimals}f}"
        text = text.removeprefix("-") if float(text) == 0.0 else text
        return decimal(text, self.spec.language)

    def _length(self, value: float) -> str:
        """A length [mm] in the unit of the drawing, without zeros at the end."""
        decimals = 4 if self.product.unit == "mm" else 5
        text = self._written(value / MM_PER[self.product.unit], decimals).rstrip("0")
        return text.rstrip(".,")


# -- notes ----------------------------------------------------------------------------------------
# The notes on a sheet: what it shows, and from what it was made.


LETTER = 2.5

STEP = 3.6
"""Distance between lines [mm]."""

SPARING: Final = 0.96
"""Fraction of a line that is used, as other fonts that programs use instead may be wider."""

Length = Callable[[float], str]
"""Function that writes a length [mm] in the unit of the drawing."""


def drawing_notes(
    product: Product,
    spec: DrawingSpec,
    tolerance: float,
    length: Length,
    *,
    has_table_sheet: bool,
    subject: ViewSubject,
) -> list[str]:
    """The notes as sentences in the language of the sheet.

    `has_table_sheet` says that the table is on the next sheet; `subject`, which curves are drawn
    and whether there are dimensions in brackets.
    """
    words, cam = WORDS[spec.language], product.cam
    name = product.scene.name
    if product.is_pair:
        notes = [words["pair_design"].format(name=name)]
        legend: list[str] = []
    else:
        notes = [(words["return_disc"] if product.position else words["design"]).format(name=name)]
        notes.append(_follower(product, spec, words, length))
        legend = _legend(product, spec, words, has_table_sheet=has_table_sheet, subject=subject)
    notes += _features(product.drawn.spec, words, length, spec)
    notes += _pair(product.scene.part, words, length)
    sense = words["sense"].format(sense=words["ccw"] if cam.rotation > 0 else words["cw"])
    notes.append(f"{words['zero']} {sense}")
    tolerance_text = decimal(f"{tolerance / MM_PER[product.unit]:.9f}".rstrip("0"), spec.language)
    notes.append(words["curve"].format(tolerance=tolerance_text, unit=product.unit))
    if subject.shape.outermost.circle is None:
        legend.append(words["reference"])
    if legend:
        notes.append(" ".join(legend))
    notes.append(words["scene"].format(scene=product.scene_hash))
    return notes


def _follower(product: Product, spec: DrawingSpec, words: Words, length: Length) -> str:
    """The note on what touches the disc, how it is guided, and the base circle."""
    cam, follower = product.cam, product.cam.follower
    touching = words["flat_face"]
    if follower.rolls:
        radius = follower.roller_radius
        touching = (
            words["roller"].format(diameter=length(2.0 * radius)) if radius else words["knife_edge"]
        )
    if follower.pivot is None:
        guidance = words["guided"].format(touching=touching, offset=length(follower.offset))
    else:
        x, y = length(follower.pivot.real), length(follower.pivot.imag)
        guidance = words["rocking"].format(touching=touching, x=x, y=y)
    base = words["base"].format(radius=length(follower.base_radius))
    if cam.contact.closed_by_form and cam.clearance:
        base += f"; {words['clearance'].format(clearance=length(cam.clearance))}"
    return f"{guidance}; {base[0].lower() if spec.language == 'en' else base[0]}{base[1:]}"


def _legend(
    product: Product,
    spec: DrawingSpec,
    words: Words,
    *,
    has_table_sheet: bool,
    subject: ViewSubject,
) -> list[str]:
    """The notes on the meaning of lines and of columns of the table."""
    cam, follower = product.cam, product.cam.follower
    legend = [words["pitch"] if subject.pitch is not None else words["base_circle"]]
    if subject.base_radius is None:
        legend = [words["left_out"]]
    if spec.step:
        if not cam.contact.closed_by_form:
            legend.append(words["polar"])
        if follower.has_pitch_curve and (
            spec.sheet == "A3" or has_table_sheet or cam.contact.closed_by_form
        ):
            legend.append(words["centre_polar"])
    if has_table_sheet:
        legend.append(words["next_sheet"])
    return legend


def _features(
    part: PartSpec | None, words: Words, length: Length, spec: DrawingSpec
) -> Iterator[str]:
    """Notes on what views and dimensions do not show: timing mark, counterbores, chamfers,
    engraving, and the hole of a set screw.
    """
    if part is None:
        return

    def degrees(angle: float) -> str:
        return decimal(f"{math.degrees(angle):.6g}", spec.language)

    if part.mark is not None:
        mark = part.mark
        size = f"%%c{length(mark.width)}"
        if mark.length is not None:
            size = f"{length(mark.width)} x {length(mark.length)}"
        yield words["mark"].format(
            size=size,
            radius=length(mark.radius),
            depth=length(mark.depth),
            angle=degrees(mark.angle),
        )
    if part.bolt_circle is not None and part.bolt_circle.counterbore is not None:
        wide = part.bolt_circle.counterbore
        yield words["counterbore"].format(
            diameter=length(wide.diameter),
            depth=length(wide.depth),
            hole=length(part.bolt_circle.hole),
        )
    if part.chamfers is not None:
        names = CHAMFERED[spec.language]
        stated = ((field.name, getattr(part.chamfers, field.name)) for field in fields(Chamfers))
        edges = (
            names[chamfer.edges].format(edge=names[name], width=length(chamfer.width))
            for name, chamfer in stated
            if chamfer is not None
        )
        yield words["chamfers"].format(edges="; ".join(edges))
    for text in part.engraving:
        yield words["engraving"].format(
            height=length(text.height),
            depth=length(text.depth),
            radius=length(text.radius),
            angle=degrees(text.angle),
        )
    if part.set_screw is not None and part.hub is not None:
        screw = part.set_screw
        yield words["set_screw"].format(
            diameter=length(screw.diameter),
            height=length(screw.height),
            angle=degrees(screw.angle),
            face=words["lower"] if part.hub.side == LOWER else words["upper"],
        )


def _pair(part: PartSpec | None, words: Words, length: Length) -> Iterator[str]:
    """The note on the position of both discs of a pair in one piece."""
    if part is None or part.pair is None:
        return
    pair = part.pair
    yield words["pair"].format(
        angle=f"{ANGLE:g}",
        gap=length(pair.gap),
        spacer=length(pair.spacer),
        upper=words["main_disc"] if pair.upper == MAIN else words["other_disc"],
    )


def wrapped(text: str, height: float, width: float) -> tuple[str, ...]:
    """The text in lines of at most `width` [mm], broken at spaces; longer words are not broken."""
    lines: list[str] = []
    for word in text.split(" "):
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and text_width(longer, height) <= width:
            lines[-1] = longer
        else:
            lines.append(word)
    return tuple(lines)


def note_lines(notes: list[str], width: float) -> list[tuple[str, bool]]:
    """The notes in lines of at most `width` [mm], each with whether it begins a note."""
    lines = []
    for note in notes:
        first, *rest = wrapped(note, LETTER, SPARING * (width - 6.0))
        lines += [(first, True), *((text, False) for text in rest)]
    return lines


def notes_height(lines: list[tuple[str, bool]]) -> float:
    """Height of the notes with their heading [mm]."""
    return 7.0 + STEP * len(lines)


def note_marks(
    lines: list[tuple[str, bool]], heading: str, top: complex, width: float
) -> list[Mark]:
    """The marks of numbered notes below `top`."""
    marks: list[Mark] = [Label(heading, top - 4.5j, 3.5)]
    number = 0
    for row, (text, begins) in enumerate(lines):
        place = top - 1j * (6.0 + STEP * row + LETTER)
        if begins:
            number += 1
            marks.append(Label(f"{number}", place, LETTER))
        marks.append(Label(text, place + 5.0, LETTER, width=width - 5.0))
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
"""Text in place of a point that is not on the disc."""

Written = Callable[[float, int], str]
"""Function that writes a number with so many decimals."""


@dataclass(frozen=True, slots=True)
class TextTable:
    """A table; every cell is text.

    Attributes
    ----------
    heads : headings of the columns.
    rows : rows from cam angle 0 on.
    """

    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def groups(self, number: int) -> int:
        """Number of rows of each of `number` groups side by side."""
        return math.ceil(len(self.rows) / number)

    def height(self, number: int) -> float:
        """Height of the table in `number` groups [mm]."""
        return HEAD + ROW * self.groups(number)


def polar_table(
    product: Product, words: Words, step: int, written: Written, *, centre: bool
) -> TextTable:
    """Cam angle, lift and polar coordinates of the point of contact at every `step` degrees.

    For a groove, whose flanks are parallels of the pitch curve, they are those of the roller's
    centre; with `centre` there are both, where both exist.
    """
    cam, unit = product.cam, product.unit
    degrees = np.arange(0.0, 360.0, step)
    phi = np.radians(degrees)
    lift = cam.drive.motion.jet(phi)[0]
    decimals, mm = DECIMALS[unit], MM_PER[unit]
    turning = cam.lift_unit == "rad"
    lifts = np.degrees(lift) if turning else lift / mm
    heads = [
        words["angle_head"],
        words["swing_head"] if turning else f"{words['lift_head']} {unit}",
    ]
    columns = [[written(value, 0) for value in degrees.tolist()],
               [written(value, decimals) for value in lifts.tolist()]]  # fmt: skip
    pitch = cam.disc.pitch_curve.point(phi)
    if not cam.contact.closed_by_form:
        flank = cam.contact.main
        points = cam.disc.curve(flank).point(phi) if cam.follower.has_pitch_curve else pitch
        lost = _lost(product, phi)
        heads += [f"r {unit}", words["at_head"]]
        columns += _polar(points, mm, decimals, written, lost)
    if cam.follower.has_pitch_curve and (centre or cam.contact.closed_by_form):
        heads += [f"R {unit}", words["at_head"]]
        columns += _polar(pitch, mm, decimals, written, np.zeros(len(phi), dtype=bool))
    return TextTable(tuple(heads), tuple(zip(*columns, strict=True)))


def _polar(
    points: ComplexArray, mm: float, decimals: int, written: Written, lost: BoolArray
) -> list[list[str]]:
    radii = [written(value, decimals) for value in (np.abs(points) / mm).tolist()]
    # The second remainder makes 0 of the 360 to which 359.9996 is rounded.
    turns = np.round(np.degrees(np.angle(points)) % 360.0, 3) % 360.0
    angles = [written(value, 3) for value in turns.tolist()]
    return [
        [GAP if away else cell for cell, away in zip(column, lost, strict=True)]
        for column in (radii, angles)
    ]


def _lost(product: Product, phi: FloatArray) -> BoolArray:
    """(n,) whether the points of the flank at the cam angles `phi` are cut off from the disc."""
    is_lost = np.zeros(len(phi), dtype=bool)
    for cut in product.pictured.trimmed_stretches:
        # Modulo a turn, as the range may pass cam angle 0.
        is_lost |= (phi - cut.start) % TURN < cut.end - cut.start
    return is_lost


def table_marks(
    table: TextTable, title: str, top: complex, width: float, number: int
) -> list[Mark]:
    """The marks of the table in `number` groups side by side, its upper left corner at `top`."""
    marks: list[Mark] = [Label(title, top - 4.5j, 3.5)]
    rows, group = table.groups(number), width / number
    wide = group / len(table.heads)
    begin = top - 6.0j
    for place in range(number):
        corner = begin + place * group
        group_rows = table.rows[place * rows : (place + 1) * rows]
        if not group_rows:
            break
        height = 6.0 + ROW * len(group_rows)
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
            for row, cells in enumerate(group_rows):
                cell_place = left + complex(
                    wide - 1.2, -6.0 - ROW * (row + 1) + 0.5 * (ROW - TABLE_LETTER)
                )
                marks.append(
                    Label(cells[index], cell_place, TABLE_LETTER, "right", width=wide - 1.6)
                )
        for row in range(5, len(group_rows), 5):
            level = corner - 1j * (6.0 + ROW * row)
            marks.append(line(level, level + group, "GRID"))
    return marks


def diagram(
    product: Product, words: Words, corner: complex, size: complex, written: Written
) -> list[Mark]:
    """The marks of the lift over the cam angle, in a box of `size` with its lower left `corner`."""
    drive, unit = product.cam.drive, product.unit
    turning = product.cam.lift_unit == "rad"
    factor = math.degrees(1.0) if turning else 1.0 / MM_PER[unit]
    phi = np.linspace(0.0, TURN, SAMPLES)
    # Left-hand values, as the last angle is the end of the revolution.
    values = drive.motion.jet(phi, "left")[0] * factor
    low, high = (lift * factor for lift in lift_range(drive.motion))
    low, high = min(low, 0.0), max(high, 0.0)
    decimals = DECIMALS[unit]
    texts = [written(value, decimals) for value in (low, high)]
    left = max(text_width(text, TABLE_LETTER) for text in texts) + 4.0
    begin = corner + complex(left, 10.0)
    width, height = size.real - left - 2.0, size.imag - 20.0
    rise = height / (high - low) if high > low else 0.0
    head = words["swing_head"] if turning else f"{words['lift_head']} {unit}"
    head = f"{words['motion']}: {head}"
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
    marks.append(Label(words["angle"], begin + complex(0.5 * width, -9.0), TABLE_LETTER, "centre"))
    points = begin + width * phi / TURN + 1j * rise * (values - low)
    marks.append(Chain(points, np.zeros(len(points)), "DIAGRAM"))
    return marks


# -- frame ----------------------------------------------------------------------------------------
# The sheet itself: trimmed size, frame and grid reference system (ISO 5457), and the title block
# (ISO 7200).


@dataclass(frozen=True, slots=True)
class Size:
    """The size of a sheet [mm], and the number of fields of its grid along each side."""

    width: float
    height: float
    columns: int
    rows: int


SIZES: Final[dict[SheetName, Size]] = {"A3": Size(420, 297, 8, 6), "A4": Size(210, 297, 4, 6)}

LEFT, MARGIN = 20.0, 10.0
"""Distance of the frame from the edge of the sheet, on the left for filing and on other sides
[mm]."""

BAND = 5.0
"""Width of the grid outside the frame [mm]."""

FIELD = 50.0
"""Length of a field of the grid; fields begin at the middle of the sheet [mm]."""

BLOCK_WIDTH, BLOCK_HEIGHT = 180.0, 38.0
"""Size of the title block [mm]."""

Row = tuple[float, float, tuple[tuple[str, str, float, float], ...]]
"""A row of the title block: bottom, height, and cells of label, text, width and letter height
[mm]."""


def frame(size: Size) -> list[Mark]:
    """Trimmed edge, frame, centring marks and grid, which on A4 is lettered on two sides only."""
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
    marks += [line(middle + BAND * way, middle, "FRAME") for middle, way in ends]
    both = size.columns > 4
    for number in range(size.columns):
        start = x + (number - 0.5 * size.columns) * FIELD
        field_ends = _clipped(start, FIELD, low.real, high.real)
        for side in (low.imag - BAND, high.imag) if both else (high.imag,):
            if number:
                marks.append(line(complex(start, side), complex(start, side + BAND), "GRID"))
            label_place = complex(0.5 * sum(field_ends), side + 1.25)
            marks.append(Label(str(number + 1), label_place, 2.5, "centre", "GRID"))
    for number in range(size.rows):
        start = y - (number - 0.5 * size.rows + 1.0) * FIELD
        field_ends = _clipped(start, FIELD, low.imag, high.imag)
        for side in (low.real - BAND, high.real) if both else (high.real,):
            if number:
                level = start + FIELD
                marks.append(line(complex(side, level), complex(side + BAND, level), "GRID"))
            label_place = complex(side + 0.5 * BAND, 0.5 * sum(field_ends) - 1.25)
            marks.append(Label("ABCDEF"[number], label_place, 2.5, "centre", "GRID"))
    return marks


def _clipped(start: float, length: float, low: float, high: float) -> tuple[float, float]:
    """Start and end of a field of the grid, cut off at the frame."""
    return max(start, low), min(start + length, high)


def title_block(
    corner: complex,
    spec: DrawingSpec,
    scale: str,
    unit: LengthUnit,
    sheet: tuple[int, int],
) -> list[Mark]:
    """The title block at its lower left corner; `sheet` is the sheet's number and their total."""
    words = WORDS[spec.language]
    numbered = f"{sheet[0]}/{sheet[1]}"
    rows: tuple[Row, ...] = (
        (28.0, 10.0, (
            (words["material"], spec.material, 52.0, 2.5),
            (words["hardness"], spec.hardness, 40.0, 2.5),
            (words["tolerances"], spec.general_tolerances, 52.0, 2.5),
            (words["scale"], scale, 18.0, 3.5),
            ("", "", 18.0, 2.5),
        )),
        (18.0, 10.0, (
            (words["owner"], spec.owner, 52.0, 2.5),
            (words["document_type"], spec.document_type, 52.0, 2.5),
            (words["edges"], "", 30.0, 2.5),
            (words["surface"], "", 28.0, 2.5),
            (words["dimensions"], unit, 18.0, 2.5),
        )),
        (9.0, 9.0, (
            (words["creator"], spec.creator, 52.0, 2.5),
            (words["approver"], spec.approver, 52.0, 2.5),
            (words["date"], spec.date, 30.0, 2.5),
            (words["revision"], spec.revision, 14.0, 2.5),
            (words["language"], spec.language, 14.0, 2.5),
            (words["size"], spec.sheet, 18.0, 2.5),
        )),
        (0.0, 9.0, (
            (words["title"], spec.title, 104.0, 3.5),
            (words["number"], spec.number, 58.0, 3.5),
            (words["sheet"], numbered, 18.0, 2.5),
        )),
    )  # fmt: skip
    marks: list[Mark] = [rectangle(corner, BLOCK_WIDTH, BLOCK_HEIGHT, "FRAME")]
    for bottom, height, cells in rows:
        left = 0.0
        for label, text, width, letter in cells:
            cell_corner = corner + complex(left, bottom)
            marks.append(rectangle(cell_corner, width, height, "GRID"))
            if label:
                head = cell_corner + complex(1.0, height - 2.6)
                marks.append(Label(label, head, 1.8, width=width - 2.0))
            if text:
                marks.append(
                    Label(text, cell_corner + complex(1.5, 1.3), letter, width=width - 3.0)
                )
            left += width
    marks += first_angle(corner + complex(171.0, 33.0))
    return marks


def first_angle(middle: complex) -> list[Mark]:
    """The symbol of first-angle projection (ISO 5456-2), about 16 mm wide and 8 mm high."""
    left, right = middle - 6.5, middle - 0.5
    cone = (left - 1.5j, right - 3.0j, right + 3.0j, left + 1.5j)
    rings = middle + 4.5
    return [
        path(cone, "SYMBOL", closed=True),
        Round(rings, 1.5, "SYMBOL"),
        Round(rings, 3.0, "SYMBOL"),
        line(left - 0.8, right + 0.8, "CENTRE"),
        line(rings - 3.8, rings + 3.8, "CENTRE"),
        line(rings - 3.8j, rings + 3.8j, "CENTRE"),
    ]


def texture_width(text: str, letter: float = 2.5) -> float:
    """Width of the symbol of `texture`, from its tip to its right end [mm]."""
    return 3.0 * letter * math.tan(math.pi / 6.0) + text_width(text, letter) + 1.5


def others(tip: complex, letter: float = 2.5) -> list[Mark]:
    """The basic symbol in brackets with its tip at `tip`.

    After the texture of all surfaces it says that some surfaces have another one.
    """
    aside = 1.4 * letter * complex(math.tan(math.pi / 6.0), 1.0)
    end = tip + 2.6 * letter * complex(math.tan(math.pi / 6.0), 1.0)
    low = tip + 0.3j * letter
    return [
        path((tip - aside.conjugate(), tip, end), "SYMBOL"),
        Label("(", low - 1.2 * letter, 1.6 * letter, "right", "SYMBOL"),
        Label(")", low + 1.8 * letter, 1.6 * letter, "left", "SYMBOL"),
    ]


def edges(corner: complex, text: str, letter: float = 2.5) -> list[Mark]:
    """The symbol of ISO 13715 for edges of undefined shape, with its corner at `corner`."""
    tip = corner + complex(2.0, 2.0) * letter / 2.5
    return [
        path((corner - 1.5, corner, corner - 1.5j), "SYMBOL"),
        path((corner, tip, tip + text_width(text, letter) + 1.0), "SYMBOL"),
        Label(text, tip + complex(0.7, 0.8), letter, layer="SYMBOL"),
    ]
