"""The contents of a sheet: lines, arcs, texts and dimensions, and their places. Nothing here draws.

Marks of the sheet itself are in millimetres of paper from its lower left corner; those of a view
are in millimetres of the part. Heights of texts are always those on paper.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import singledispatchmethod
from typing import Final, Literal

import numpy as np

from camgeo.check.finding import Finding
from camgeo.geometry.contour.contour import Contour
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray, frozen
from camgeo.units import MM_PER, LengthUnit, counted, listed

Layer = Literal[
    "OUTLINE", "HIDDEN", "SECTION", "EDGES", "CENTRE", "PITCH_CURVE", "BASE_CIRCLE",
    "HATCH", "DIMENSION", "SYMBOL", "TEXT", "FRAME", "GRID", "DIAGRAM", "ENGRAVING",
]  # fmt: skip
"""The meaning of a line. OUTLINE and HIDDEN are edges of the part seen from above, SECTION edges
that are cut, EDGES those visible behind the cut and other wide lines, ENGRAVING outlines of
letters."""

Across = Literal["left", "centre", "right"]

DIAMETER: Final = "%%c"
"""The diameter sign in the notation of CAD programs."""


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """Lines and arcs end to end.

    Attributes
    ----------
    vertices : (n,) complex points [mm].
    sweeps : (n,) angle of the arc from each vertex to the next [rad], 0 for a line. The last one
        counts only if the chain is closed.
    """

    vertices: ComplexArray
    sweeps: FloatArray
    layer: Layer
    closed: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "vertices", frozen(self.vertices, np.complex128))
        object.__setattr__(self, "sweeps", frozen(self.sweeps, np.float64))

    @staticmethod
    def along(contour: Contour, first: float, size: float, layer: Layer) -> Chain:
        """The stretch of a closed contour that begins at the length `first` and is `size` long
        [mm].

        `first` is less than the length of the whole contour; the stretch may pass its end.
        """
        lengths = contour.lengths
        starts = np.concatenate(([0.0], np.cumsum(lengths)))
        index = min(int(np.searchsorted(starts, first, side="right")) - 1, len(contour) - 1)
        inside = first - float(starts[index])
        vertices, sweeps, left = [], [], size
        while True:
            share = inside / lengths[index] if lengths[index] else 0.0
            step = min(left, float(lengths[index]) - inside)
            part = step / float(lengths[index]) if lengths[index] else 0.0
            vertices.append(_piece_point(contour, index, share))
            sweeps.append(float(contour.sweeps[index]) * part)
            left -= step  # of the stretch, until only rounding is left
            if left <= 1e-12 * size:
                vertices.append(_piece_point(contour, index, share + part))
                return Chain(np.array(vertices), np.array([*sweeps, 0.0]), layer)
            index, inside = (index + 1) % len(contour), 0.0


def _piece_point(contour: Contour, index: int, share: float) -> complex:
    """The point of a piece at a share of its length."""
    start, sweep = complex(contour.vertices[index]), float(contour.sweeps[index])
    if sweep == 0.0:
        return start + share * (complex(contour.ends[index]) - start)
    centre = complex(contour.centres[index])
    return centre + (start - centre) * cmath.exp(1j * sweep * share)


@dataclass(frozen=True, slots=True)
class Round:
    """A circle [mm]."""

    centre: complex
    radius: float
    layer: Layer

    @property
    def quarters(self) -> ComplexArray:
        """(4,) points at which the quarters of the circle begin [mm]."""
        return self.centre + self.radius * np.array([1.0, 1j, -1.0, -1j], np.complex128)


@dataclass(frozen=True, slots=True)
class Label:
    """A line of text.

    Attributes
    ----------
    place : where its base line begins, has its middle or ends, see `across` [mm].
    height : height of capitals [mm of paper].
    width : largest width [mm of paper], to which a longer text is narrowed; 0 for no limit.
    """

    text: str
    place: complex
    height: float = 2.5
    across: Across = "left"
    layer: Layer = "TEXT"
    width: float = 0.0

    @property
    def squeeze(self) -> float:
        """Factor by which the text is narrowed further to be within `width`; 1 if it fits."""
        wide = text_width(self.text, self.height)
        return 1.0 if not self.width or wide <= self.width else self.width / wide


@dataclass(frozen=True, slots=True, eq=False)
class Filled:
    """A filled polygon of three or four corners [mm]: arrowheads and datum triangles."""

    corners: tuple[complex, ...]
    layer: Layer = "SYMBOL"


@dataclass(frozen=True, slots=True, eq=False)
class Hatched:
    """A cut face, hatched inside its closed polygon [mm]."""

    corners: ComplexArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "corners", frozen(self.corners, np.complex128))


@dataclass(frozen=True, slots=True)
class Distance:
    """A linear dimension: the distance of two points of the part along a direction.

    Attributes
    ----------
    first, second : the points that it measures [mm].
    line : any point on the dimension line [mm].
    angle : direction of the dimension line [rad].
    prefix, suffix : text around the number, which is always measured and never stated.
    decimals : largest number of decimals; zeros at the end are not written.
    aside : distance of the text from the middle of the line, along it [mm of paper].
    bare : the end without an arrow, because a datum stands in its place: 1 or 2; 0 for neither.
    """

    first: complex
    second: complex
    line: complex
    angle: float = 0.0
    prefix: str = ""
    suffix: str = ""
    decimals: int = 3
    aside: float = 0.0
    bare: int = 0

    @property
    def measure(self) -> float:
        """The measured distance [mm of the part]."""
        along = complex(np.exp(1j * self.angle))
        return abs(((self.second - self.first) * along.conjugate()).real)


@dataclass(frozen=True, slots=True)
class Diameter:
    """A dimension of the diameter of a circle.

    A leader on a ray from the centre ends at the circle; the text stands on a horizontal line at
    its other end, after a diameter sign.

    Attributes
    ----------
    centre, radius : of the circle [mm].
    angle : direction of the ray [rad].
    reach : length of the leader [mm of paper].
    count : how many such circles there are.
    suffix : text after the number, which is always measured and never stated.
    decimals : largest number of decimals; zeros at the end are not written.
    """

    centre: complex
    radius: float
    angle: float
    reach: float = 8.0
    count: int = 1
    suffix: str = ""
    decimals: int = 3

    @property
    def prefix(self) -> str:
        """The text before the number: how many circles there are, and the diameter sign."""
        return f"{self.count}x {DIAMETER}" if self.count > 1 else DIAMETER

    @property
    def measure(self) -> float:
        """The measured diameter [mm of the part]."""
        return 2.0 * self.radius


LETTERS: Final = 3.5
"""Height of the texts of dimensions [mm of paper]."""


ARROW: Final = 3.0
"""Length of the arrows of dimensions [mm of paper]."""


LIFTED: Final = 0.8
"""Distance of texts above the dimension line, and gap beside arrows [mm of paper]."""


EXTENSION_GAP, EXTENSION_OVERSHOOT = 0.8, 1.5
"""Gap between the part and an extension line, and how far that line goes beyond the dimension line
[mm of paper]."""


Mark = Chain | Round | Label | Filled | Hatched | Distance | Diameter


@dataclass(frozen=True, slots=True)
class View:
    """A view of the part.

    Attributes
    ----------
    origin : place of the view's origin on the sheet [mm of paper].
    marks : [mm of the part].
    """

    origin: complex
    marks: tuple[Mark, ...]


@dataclass(frozen=True, slots=True)
class Sheet:
    """A whole sheet.

    Attributes
    ----------
    width, height : size of the trimmed sheet [mm].
    scale : millimetres of paper for each millimetre of the part.
    ratio : the scale as the title block states it, as "1:2".
    unit : unit of the dimensions.
    comma : whether the decimal sign is a comma.
    views : the views; the first one is the front view, whose origin is the cam axis.
    marks : marks on the sheet itself.
    """

    width: float
    height: float
    scale: float
    ratio: str
    unit: LengthUnit
    comma: bool
    views: tuple[View, ...]
    marks: tuple[Mark, ...] = ()

    @property
    def dimensions(self) -> tuple[Distance | Diameter, ...]:
        """The dimensions of all views."""
        marks = (mark for view in self.views for mark in view.marks)
        return tuple(mark for mark in marks if isinstance(mark, Distance | Diameter))

    def findings(self) -> Iterator[Finding]:
        """Warnings about what cannot be read, with a remedy."""
        texts = [text for view in self.views for text in across(view, self)]
        if texts:
            names = listed([f'"{text}"' for text in texts], NAMED)
            what = f"the drawing has lines across {counted(len(texts), 'text')} ({names})"
            yield Finding(READABLE, "warning", f"{what}: it needs a larger sheet or scale")
        small = list(dots(self))
        if small:
            width, middle = min(small, key=lambda each: each[0])
            mm = MM_PER[self.unit]
            place = f"({middle.real / mm:.4g} / {middle.imag / mm:.4g})"
            what = f"the drawing shows {counted(len(small), 'outline')} as a dot"
            sentence = (
                f"{what}, {width:.2g} mm wide on paper, at {place}: a larger scale shows more"
            )
            yield Finding(READABLE, "warning", sentence, width, DOT, "mm")


def dimension_text(mark: Distance | Diameter, unit: LengthUnit) -> str:
    """The text of a dimension, with a decimal point."""
    text = f"{mark.measure / MM_PER[unit]:.{mark.decimals}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return f"{mark.prefix}{text}{mark.suffix}"


def shelf_length(text: str) -> float:
    """Length of the line below the text of a diameter [mm of paper].

    It is that for letters which, before they are narrowed, are as wide as high.
    """
    return NARROWED * LETTERS * len(text.replace(DIAMETER, "O"))


def line(start: complex, end: complex, layer: Layer) -> Chain:
    """A straight line."""
    return path((start, end), layer)


def path(points: tuple[complex, ...], layer: Layer, *, closed: bool = False) -> Chain:
    """Straight lines from point to point."""
    return Chain(np.array(points), np.zeros(len(points)), layer, closed)


def rectangle(corner: complex, width: float, height: float, layer: Layer) -> Chain:
    """A rectangle by its lower left corner."""
    right, upward = complex(width), 1j * height
    return path(
        (corner, corner + right, corner + right + upward, corner + upward), layer, closed=True
    )


def moved(marks: Sequence[Mark], origin: complex, scale: float) -> list[Mark]:
    """Marks of paper as marks of a view, their own origin at `origin` of the part [mm]."""
    moved_marks: list[Mark] = []
    for mark in marks:
        if isinstance(mark, Chain):
            moved_marks.append(replace(mark, vertices=origin + mark.vertices / scale))
        elif isinstance(mark, Round):
            moved_marks.append(
                replace(mark, centre=origin + mark.centre / scale, radius=mark.radius / scale)
            )
        elif isinstance(mark, Label):
            moved_marks.append(replace(mark, place=origin + mark.place / scale))
        elif isinstance(mark, Filled):
            moved_marks.append(
                replace(mark, corners=tuple(origin + corner / scale for corner in mark.corners))
            )
    return moved_marks


# -- lettering ------------------------------------------------------------------------------------
# Widths of texts, by which a sheet is laid out.
#
# They are those of DejaVu Sans, with which sheets are drawn as PDF and SVG; fonts that CAD programs
# use in its place are narrower.


NARROWED: Final = 0.8
"""Width of the letters of a sheet, as a fraction of the font's."""

FIRST: Final = 32
"""Code of the first character of `WIDTHS`, the space."""

WIDTHS: Final = (
    *(44, 55, 63, 115, 87, 130, 107, 38, 54, 54, 69, 115, 44, 49, 44, 46),
    *(87, 87, 87, 87, 87, 87, 87, 87, 87, 87, 46, 46, 115, 115, 115, 73),
    *(137, 94, 94, 96, 106, 87, 79, 106, 103, 40, 40, 90, 76, 118, 103, 108),
    *(83, 108, 95, 87, 84, 100, 94, 136, 94, 84, 94, 54, 46, 54, 115, 69),
    *(69, 84, 87, 75, 87, 84, 48, 87, 87, 38, 38, 79, 38, 134, 87, 84),
    *(87, 87, 56, 71, 54, 87, 81, 112, 81, 81, 72, 87, 46, 87, 115),
)
"""Widths of the characters from `FIRST` on, in per cent of the height of capitals."""

OTHER: Final = 115
"""Width of any other character, in per cent; few are wider."""


def text_width(text: str, height: float) -> float:
    """Width [mm] of a text whose capitals are `height` [mm] high."""
    places = (ord(letter) - FIRST for letter in text.replace("%%c", "O"))
    total = sum(WIDTHS[k] if 0 <= k < len(WIDTHS) else OTHER for k in places)
    return NARROWED * height * total / 100.0


# -- symbols --------------------------------------------------------------------------------------
# Symbols of technical drawings [mm of paper], made of lines so that every program shows them.


LETTER = 3.5
"""Height of letters in frames and at datums [mm of paper]."""

CELL = 7.0
"""Height of a frame, and least width of its cells [mm of paper]: twice the letters (ISO 7083)."""


def texture(tip: complex, text: str, letter: float = 2.5) -> list[Mark]:
    """Symbol of a surface texture (ISO 21920-1) by material removal, all in mm of paper.

    Its tip is at `tip`, its `text` has the height `letter`.
    """
    tall = 3.0 * letter
    left = tip + 1.4 * letter * complex(-math.tan(math.pi / 6.0), 1.0)
    level = tip + 1.4 * letter * complex(math.tan(math.pi / 6.0), 1.0)
    top = tip + tall * complex(math.tan(math.pi / 6.0), 1.0)
    end = top + text_width(text, letter) + 1.5
    return [
        path((left, tip, top, end), "SYMBOL"),
        line(left, level, "SYMBOL"),
        Label(text, top + complex(1.0, -1.5 * letter), letter, layer="SYMBOL"),
    ]


# -- placing ---------------------------------------------------------------------------------------
# Where dimensions and symbols stand: nothing is written across edges, lines or other texts.


CLEAR: Final = 0.7
"""Width of the margin around a text in which no line is drawn [mm of paper]."""

UNREADABLE: Final = 1000.0
"""Cost of each text that is drawn across something, or that something is drawn across."""

EDGE_CROSSING, LINE_CROSSING, AXIS_CROSSING = 2.0, 1.0, 0.2
"""Costs of a crossing of an edge, of a crossing of another line, and of a text on a centre line."""

ROUNDS: Final = 4
"""Largest number of times that each place is chosen."""

Option = tuple[float, Sequence[Mark]]
"""Marks at a possible place, after the cost of the place itself."""

Options = Iterable[Option]


def cost(candidate: Ink, ink: Ink, enough: float = math.inf) -> float:
    """The cost of candidate marks next to all that is drawn already.

    It is not summed further once it has reached `enough`: the candidate is then no better.
    """
    total = 0.0
    for where in _unreadable(candidate, ink):
        total += UNREADABLE * int(np.count_nonzero(where))
        if total >= enough:
            return total
    strokes = np.concatenate([candidate.wide, candidate.thin])
    total += EDGE_CROSSING * (crossings(strokes, ink.wide) + crossings(candidate.wide, ink.thin))
    total += LINE_CROSSING * crossings(candidate.thin, ink.thin)
    total += LINE_CROSSING * int(np.count_nonzero(ink.bars.cut(strokes)))
    for rooms in (candidate.texts.around(CLEAR), candidate.frames):
        total += AXIS_CROSSING * int(np.count_nonzero(rooms.hit(ink.axes)))
    return total


def _unreadable(candidate: Ink, ink: Ink) -> Iterator[BoolArray]:
    """For each kind of conflict, which texts, frames and dimension lines are in conflict."""
    texts = candidate.texts.around(CLEAR)
    strokes = np.concatenate([candidate.wide, candidate.thin])
    lines = np.concatenate([ink.wide, ink.thin])
    yield texts.hit(lines)
    yield texts.overlap(ink.texts.around(CLEAR))
    yield texts.overlap(ink.frames)
    yield ink.texts.around(CLEAR).hit(strokes)
    yield candidate.bars.overlap(ink.bars)
    yield candidate.frames.overlap(ink.frames)
    yield candidate.frames.hit(lines)
    yield ink.frames.hit(strokes)
    yield candidate.texts.hit(strokes)
    # Only pairs above the diagonal: each pair once, and no text with itself.
    yield np.triu(candidate.texts.overlap(candidate.texts), 1)


def cheapest_marks(options: Options, ink: Ink, scale: float, unit: LengthUnit) -> tuple[Mark, ...]:
    """The marks of the option that costs least next to what is there; nothing without options.

    Options are in ascending order of their own cost.
    """
    best: tuple[Mark, ...] = ()
    least = math.inf
    for price, marks in options:
        # No later option can be better, as its own cost is at least this one's.
        if price >= least:
            break
        total = price + cost(measure_ink(marks, scale, unit), ink, least - price)
        if total < least:
            best, least = tuple(marks), total
    return best


def placed_marks(
    requests: Iterable[Options], fixed: Sequence[Mark], scale: float, unit: LengthUnit
) -> list[Mark]:
    """The fixed marks, and the marks of the best option of each request.

    Places are chosen one after the other. In further rounds, those are chosen again that became
    unreadable by later ones.
    """
    sorted_requests = [sorted(options, key=lambda option: option[0]) for options in requests]
    always = measure_ink(fixed, scale, unit)
    places: list[tuple[Mark, ...]] = [() for _ in sorted_requests]
    inks = [Ink() for _ in sorted_requests]
    for turn in range(ROUNDS):
        for number, options in enumerate(sorted_requests):
            # All other marks, including those of later requests from the round before.
            others = together([always, *inks[:number], *inks[number + 1 :]])
            if turn and cost(inks[number], others) < UNREADABLE:
                continue
            places[number] = cheapest_marks(options, others, scale, unit)
            inks[number] = measure_ink(places[number], scale, unit)
    return [*fixed, *(mark for marks in places for mark in marks)]


def _interrupted(mark: Chain, rooms: Sequence[Boxes], lines: ComplexArray) -> Iterator[Mark]:
    """A straight line without its stretches inside boxes; `lines` is the line on paper."""
    start, end = (complex(vertex) for vertex in mark.vertices)
    spans = []
    for low, high in (room.spans(lines) for room in rooms):
        spans += [span for span in zip(low[:, 0].tolist(), high[:, 0].tolist(), strict=True)
                  if span[0] < span[1]]  # fmt: skip
    place = 0.0
    for first, last in sorted(spans):
        if first > place:
            yield line(start + place * (end - start), start + first * (end - start), mark.layer)
        place = max(place, last)
    if not spans:
        yield mark
    elif place < 1.0:
        yield line(start + place * (end - start), end, mark.layer)


# -- readable -------------------------------------------------------------------------------------
# What cannot be read on a sheet: texts with lines across them, and outlines that are mere dots.


READABLE: Final = "drawing-readable"

DOT: Final = 1.0
"""Width on paper below which an outline is a dot: twice the width of its line [mm]."""

SEEN: Final = ("OUTLINE", "HIDDEN")
"""Layers of the outlines of the part."""

NAMED: Final = 3
"""Largest number of texts that a sentence names."""


def across(view: View, sheet: Sheet) -> Iterator[str]:
    """The texts of a view across which something is drawn."""
    ink = measure_ink(view.marks, sheet.scale, sheet.unit)
    overlaps = ink.texts.overlap(ink.texts)
    np.fill_diagonal(overlaps, val=False)  # a text covers itself
    lines = np.concatenate([ink.wide, ink.thin])
    written = [mark for mark in view.marks if isinstance(mark, Label | Distance | Diameter)]
    for mark, poor in zip(written, ink.texts.hit(lines) | overlaps.any(axis=1), strict=True):
        if poor:
            text = mark.text if isinstance(mark, Label) else dimension_text(mark, sheet.unit)
            yield text.replace(DIAMETER, "Ø")


def dots(sheet: Sheet) -> Iterator[tuple[float, complex]]:
    """Outlines of the part that are mere dots: width [mm of paper] and middle [mm of the part]."""
    for view in sheet.views[:1]:
        for mark in view.marks:
            if isinstance(mark, Chain) and mark.closed and mark.layer in SEEN:
                low, high = measure_ink([mark], sheet.scale, sheet.unit).extent
                size = high - low
                if max(size.real, size.imag) < DOT:
                    yield max(size.real, size.imag), 0.5 * (low + high) / sheet.scale


# -- ink ------------------------------------------------------------------------------------------
# What marks cover on paper: boxes of texts, dimension lines, wide and thin lines [mm of paper].
#
# The origin is that of the view, or of the sheet. Arcs are approximated by chords within `SAGITTA`.


SAGITTA: Final = 0.01
"""Largest distance of chords from their arcs [mm of paper]."""


BAR: Final = 1.0
"""Half the width of a dimension line with its arrows [mm of paper]."""

WIDE: Final = frozenset(("OUTLINE", "HIDDEN", "SECTION", "EDGES", "FRAME", "ENGRAVING"))
"""Layers of edges, across which nothing may be written."""

AXES: Final = frozenset(("CENTRE", "PITCH_CURVE", "BASE_CIRCLE"))
"""Layers of lines that are interrupted at texts."""


@dataclass(frozen=True, slots=True, eq=False)
class Boxes:
    """Rectangles by their middles, unit vectors along them, and half their widths and heights.

    Attributes
    ----------
    middles, alongs : (n,) complex middles [mm of paper], and unit vectors along the width.
    halves : (n,) half the width as real, and half the height as imaginary part [mm of paper].
    """

    middles: ComplexArray
    alongs: ComplexArray
    halves: ComplexArray

    def __post_init__(self) -> None:
        for name in ("middles", "alongs", "halves"):
            object.__setattr__(self, name, frozen(getattr(self, name), np.complex128))

    def __len__(self) -> int:
        return len(self.middles)

    def around(self, by: float) -> Boxes:
        """The boxes enlarged by `by` on all sides [mm of paper]."""
        return Boxes(self.middles, self.alongs, self.halves + complex(by, by))

    @property
    def corners(self) -> ComplexArray:
        """(n, 4) complex corners, counter-clockwise [mm of paper]."""
        signs = np.array([1 + 1j, -1 + 1j, -1 - 1j, 1 - 1j])
        spread = (
            self.halves.real[:, None] * signs.real + 1j * self.halves.imag[:, None] * signs.imag
        )
        points: ComplexArray = self.middles[:, None] + self.alongs[:, None] * spread
        return points

    def spans(self, lines: ComplexArray) -> tuple[FloatArray, FloatArray]:
        """(n, k) shares of each of k straight lines, (k, 2), between which they are in each box.

        A line is nowhere inside a box if the first share is not less than the second one.
        """
        # In the coordinates of each box its sides are parallel to the axes: the shares inside are
        # those between both pairs of sides (slab method).
        turn = self.alongs.conj()[:, None]
        start = (lines[None, :, 0] - self.middles[:, None]) * turn
        step = (lines[:, 1] - lines[:, 0])[None, :] * turn
        low, high = np.zeros(start.shape), np.ones(start.shape)
        for position, way, half in ((start.real, step.real, self.halves.real[:, None]),
                              (start.imag, step.imag, self.halves.imag[:, None])):  # fmt: skip
            with np.errstate(divide="ignore", invalid="ignore"):
                one, other = (-half - position) / way, (half - position) / way
            # A line parallel to a pair of sides is between them everywhere or nowhere; 2 and -1
            # make the range of shares empty.
            still = way == 0.0
            outside = still & (np.abs(position) >= half)
            near = np.where(still, np.where(outside, 2.0, 0.0), np.minimum(one, other))
            far = np.where(still, np.where(outside, -1.0, 1.0), np.maximum(one, other))
            low, high = np.maximum(low, near), np.minimum(high, far)
        return low, high

    def cut(self, lines: ComplexArray) -> BoolArray:
        """(n, k) whether each of k straight lines, (k, 2), goes through each box."""
        low, high = self.spans(lines)
        inside: BoolArray = low < high
        return inside

    def hit(self, lines: ComplexArray) -> BoolArray:
        """(n,) whether any of k straight lines, (k, 2), goes through each box."""
        hits: BoolArray = np.any(self.cut(lines), axis=1)
        return hits

    def overlap(self, other: Boxes) -> BoolArray:
        """(n, k) whether each of the boxes overlaps each of the others.

        They do unless a line along a side of one of them separates them (separating axes).
        """
        offsets = self.middles[:, None] - other.middles[None, :]
        separated = np.zeros(offsets.shape, dtype=bool)
        for axes in (self.alongs[:, None], other.alongs[None, :]):
            for axis in (axes, 1j * axes):
                # Sum of half the extents of both boxes along the axis.
                reach = np.zeros(offsets.shape)
                for boxes, shape in ((self, (-1, 1)), (other, (1, -1))):
                    along = boxes.alongs.reshape(shape) * np.conj(axis)
                    halves = boxes.halves.reshape(shape)
                    reach += halves.real * np.abs(along.real) + halves.imag * np.abs(along.imag)
                separated |= np.abs((offsets * np.conj(axis)).real) >= reach
        return ~separated


def boxes(rectangles: Sequence[tuple[complex, complex, float, float]]) -> Boxes:
    """Boxes from tuples of middle, unit vector along it, width and height [mm of paper]."""
    if not rectangles:
        return NONE
    middles, alongs, widths, heights = zip(*rectangles, strict=True)
    halves = 0.5 * np.array(widths) + 0.5j * np.array(heights)
    return Boxes(np.array(middles), np.array(alongs), halves)


NONE: Final = Boxes(*(np.zeros(0, dtype=np.complex128) for _ in range(3)))


NO_LINES: Final[ComplexArray] = frozen(np.zeros((0, 2)), np.complex128)


@dataclass(frozen=True, slots=True, eq=False)
class Ink:
    """What some marks cover on paper.

    Attributes
    ----------
    texts : boxes around texts.
    bars : boxes around dimension lines with their arrows.
    frames : rectangles with a letter or a value in each.
    wide, thin, axes : (n, 2) complex ends of straight lines: edges; lines of dimensions and
        symbols; lines that are interrupted at texts.
    """

    texts: Boxes = NONE
    bars: Boxes = NONE
    frames: Boxes = NONE
    wide: ComplexArray = field(default_factory=lambda: NO_LINES)
    thin: ComplexArray = field(default_factory=lambda: NO_LINES)
    axes: ComplexArray = field(default_factory=lambda: NO_LINES)

    @property
    def extent(self) -> tuple[complex, complex]:
        """Lower left and upper right corner of all that is covered [mm of paper]."""
        points = np.concatenate([self.texts.corners.ravel(), self.wide.ravel(), self.thin.ravel(),
                                 self.axes.ravel()])  # fmt: skip
        low = complex(points.real.min(), points.imag.min())
        return low, complex(points.real.max(), points.imag.max())

    def cleared(self, marks: Iterable[Mark], scale: float) -> Iterator[Mark]:
        """The marks, kept off the texts and frames of this ink.

        Straight lines of `AXES` are interrupted there, and short chains of them are left out.
        """
        rooms = (self.texts.around(CLEAR), self.frames)
        for mark in marks:
            if not (isinstance(mark, Chain) and mark.layer in AXES):
                yield mark
                continue
            lines = chords(scale * mark.vertices, mark.sweeps, closed=mark.closed)
            if len(mark.vertices) == 2 and not mark.sweeps[0]:
                yield from _interrupted(mark, rooms, lines)
            elif not any(np.any(room.cut(lines)) for room in rooms):
                yield mark


def together(inks: Iterable[Ink]) -> Ink:
    """The area that all `inks` cover together."""
    all_inks = list(inks)

    def joined_boxes(kind: str) -> Boxes:
        parts = [getattr(ink, kind) for ink in all_inks]
        return Boxes(
            *(np.concatenate([getattr(b, name) for b in parts]) for name in Boxes.__slots__)
        )

    def joined_lines(kind: str) -> ComplexArray:
        return np.concatenate([NO_LINES, *(getattr(ink, kind) for ink in all_inks)])

    texts, bars, frames = map(joined_boxes, ("texts", "bars", "frames"))
    return Ink(
        texts, bars, frames, joined_lines("wide"), joined_lines("thin"), joined_lines("axes")
    )


def crossings(one: ComplexArray, other: ComplexArray) -> int:
    """Number of crossings of straight lines (n, 2) with others (k, 2); touching does not count."""
    if not len(one) or not len(other):
        return 0
    a, b = one[:, None, 0], one[:, None, 1]
    c, d = other[None, :, 0], other[None, :, 1]

    def side(start: ComplexArray, end: ComplexArray, point: ComplexArray) -> FloatArray:
        area: FloatArray = ((end - start).conj() * (point - start)).imag
        return area

    # Two lines cross if the ends of each lie on different sides of the other.
    across = (side(a, b, c) * side(a, b, d) < 0.0) & (side(c, d, a) * side(c, d, b) < 0.0)
    return int(np.count_nonzero(across))


def measure_ink(marks: Iterable[object], scale: float, unit: LengthUnit) -> Ink:
    """What marks cover at a `scale` [mm of paper per mm of the marks]."""
    paper = _Paper(scale, unit)
    return together([Ink(), *map(paper.ink, marks)])


def _lines(layer: str, lines: ComplexArray) -> Ink:
    if layer in WIDE:
        return Ink(wide=lines)
    return Ink(axes=lines) if layer in AXES else Ink(thin=lines)


@dataclass(frozen=True, slots=True)
class _Paper:
    """Computes what a mark covers on paper at a scale."""

    scale: float
    unit: LengthUnit

    @singledispatchmethod
    def ink(self, mark: object) -> Ink:
        """What a mark covers."""
        raise TypeError(f"{type(mark).__name__} is not a mark")

    @ink.register
    def _(self, mark: Chain) -> Ink:
        corners = self.scale * mark.vertices
        line_ink = _lines(mark.layer, chords(corners, mark.sweeps, closed=mark.closed))
        # A closed symbol with four corners is a frame, across which nothing may be drawn.
        if mark.layer == "SYMBOL" and mark.closed and len(corners) == 4:
            low, across, upper = complex(corners[0]), complex(corners[1]), complex(corners[3])
            along = (across - low) / abs(across - low)
            box = (0.5 * (across + upper), along, abs(across - low), abs(upper - low))
            return replace(line_ink, frames=boxes([box]))
        return line_ink

    @ink.register
    def _(self, mark: Round) -> Ink:
        corners = self.scale * mark.quarters
        return _lines(mark.layer, chords(corners, np.full(4, 0.5 * np.pi), closed=True))

    @ink.register
    def _(self, mark: Filled) -> Ink:
        corners = self.scale * np.array(mark.corners, np.complex128)
        return Ink(thin=np.stack([corners, np.roll(corners, -1)], axis=1))

    @ink.register
    def _(self, _mark: Hatched) -> Ink:
        return Ink()  # its edges are marks of their own

    @ink.register
    def _(self, mark: Label) -> Ink:
        wide = text_width(mark.text, mark.height) * mark.squeeze
        shift = {"left": 0.5, "centre": 0.0, "right": -0.5}[mark.across] * wide
        middle = self.scale * mark.place + complex(shift, 0.5 * mark.height)
        return Ink(texts=boxes([(middle, 1.0, wide, mark.height)]))

    @ink.register
    def _(self, mark: Distance) -> Ink:
        along = cmath.rect(1.0, mark.angle)
        base = self.scale * mark.line
        ends = [self.scale * mark.first, self.scale * mark.second]
        feet = [base + along * ((end - base) * along.conjugate()).real for end in ends]
        lines = []
        for end, foot in zip(ends, feet, strict=True):
            length = abs(foot - end)
            if length > EXTENSION_GAP:
                way = (foot - end) / length
                lines.append((end + EXTENSION_GAP * way, foot + EXTENSION_OVERSHOOT * way))
        low, high = sorted(((foot - feet[0]) * along.conjugate()).real for foot in feet)
        if high - low < 2.0 * ARROW + LIFTED:  # arrows outside, each with a tail
            low, high = low - 2.0 * ARROW, high + 2.0 * ARROW
        wide = text_width(dimension_text(mark, self.unit), LETTERS)
        middle = 0.5 * (feet[0] + feet[1])
        text_place = ((middle - feet[0]) * along.conjugate()).real + mark.aside
        if mark.aside:
            low, high = min(low, text_place - 0.5 * wide), max(high, text_place + 0.5 * wide)
        lines.append((feet[0] + low * along, feet[0] + high * along))
        lifted = middle + along * (mark.aside + 1j * (LIFTED + 0.5 * LETTERS))
        # A little shorter, so that dimension lines that meet end to end do not overlap.
        bar = (feet[0] + 0.5 * (low + high) * along, along, high - low - 0.1, 2.0 * BAR)
        return Ink(boxes([(lifted, along, wide, LETTERS)]), boxes([bar]), thin=np.array(lines))

    @ink.register
    def _(self, mark: Diameter) -> Ink:
        tip = self.scale * (mark.centre + cmath.rect(mark.radius, mark.angle))
        knee = tip + cmath.rect(mark.reach, mark.angle)
        text = dimension_text(mark, self.unit)
        shelf = shelf_length(text)
        end = knee + (shelf if knee.real > tip.real else -shelf)
        middle = 0.5 * (knee + end) + 1j * (LIFTED + 0.5 * LETTERS)
        start = tip + cmath.rect(0.5, mark.angle)
        lines = np.array([(start, knee), (knee, end)])
        return Ink(boxes([(middle, 1.0, text_width(text, LETTERS), LETTERS)]), thin=lines)


def chords(vertices: ComplexArray, sweeps: FloatArray, *, closed: bool) -> ComplexArray:
    """(n, 2) chords of lines and arcs end to end, within `SAGITTA`."""
    if len(vertices) == 2 and not closed and not sweeps[0]:
        return vertices[None, :]
    starts, ends = vertices, np.roll(vertices, -1)
    if not closed:
        starts, ends, sweeps = starts[:-1], ends[:-1], sweeps[:-1]
    bent = sweeps != 0.0
    # A chord of the sagitta h on an arc of the radius r spans the angle 2 arccos(1 - h/r).
    half = np.where(bent, 0.5 * sweeps, 1.0)
    radii = np.where(bent, 0.5 * np.abs(ends - starts) / np.abs(np.sin(half)), 1.0)
    step = np.where(bent, 2.0 * np.arccos(np.maximum(1.0 - SAGITTA / radii, 0.0)), 1.0)
    counts = np.where(bent, np.ceil(np.abs(sweeps) / step), 1.0).astype(np.int64)
    counts = np.maximum(counts, 1)
    index = np.repeat(np.arange(len(starts)), counts)
    number = np.arange(len(index)) - np.repeat(np.cumsum(counts) - counts, counts)
    shares = np.stack([number, number + 1], axis=1) / counts[index, None]
    chord = (ends - starts)[index, None]
    angle = sweeps[index, None]
    # The point at a share s of an arc: start + chord (e^(i s angle) - 1) / (e^(i angle) - 1).
    with np.errstate(divide="ignore", invalid="ignore"):
        turned = np.expm1(1j * angle * shares) / np.expm1(1j * angle)
    chord_ends: ComplexArray = starts[index, None] + chord * np.where(
        bent[index, None], turned, shares
    )
    return chord_ends
