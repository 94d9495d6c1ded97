"""The whole sheet of one disc: its views with dimensions and symbols, and their places."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Final

import numpy as np

from camgeo.design.product import Product
from camgeo.errors import GeometryError, SceneError
from camgeo.geometry.contour.contour import Contour
from camgeo.part.part import WRITTEN_SHARE
from camgeo.pictures.sheet import section as dimensions
from camgeo.pictures.sheet.marks import (
    CELL,
    LETTER,
    Chain,
    Filled,
    Label,
    Layer,
    Mark,
    Options,
    Round,
    Sheet,
    View,
    line,
    measure_ink,
    moved,
    placed_marks,
    rectangle,
    text_width,
    texture,
)
from camgeo.pictures.sheet.section import Shape, ViewSubject
from camgeo.pictures.sheet.texts import (
    Region,
    Texts,
    decimal,
)
from camgeo.scene.formats.drawing import DrawingSpec
from camgeo.units import MM_PER, LengthUnit

VIEW_GAP: Final = 6.0
"""Least distance between front view and section, with all that belongs to them [mm of paper]."""

SPREAD: Final = 20.0
"""Largest distance by which they are farther apart where there is room [mm of paper]."""

DWARFED: Final = 4
"""Pitch curve and base circle are left out if the scale is larger by this factor without them."""

EDGE: Final = 1.5
"""Margin around the views [mm of paper]."""


def build_sheets(product: Product, tolerance: float) -> tuple[Sheet, ...]:
    """The sheets of a disc, with edges within `tolerance` [mm].

    The views are on the first sheet; a table that does not fit there is on the next one.

    Raises
    ------
    SceneError
        With the key of `[drawing]` that has to be changed, if the contents do not fit.
    """
    try:
        return _build_sheets(product, tolerance)
    except GeometryError as error:
        if not error.key.startswith("drawing."):
            raise
        scene = product.scene
        fault = scene.stated.scene.fault(tuple(error.key.split(".")), error.message)
        fault = fault if fault.value else replace(fault, value=error.value)
        raise SceneError([fault], scene.source.file) from error


def _build_sheets(product: Product, tolerance: float) -> tuple[Sheet, ...]:
    """The sheets; `build_sheets` adds the scene to errors."""
    spec = product.scene.drawing
    sheets_per_disc = 2 if Texts(product, spec).has_table_sheet else 1
    if product.is_pair:  # the sheets of its discs have their curves
        spec = replace(spec, step=0, motion=False, scale="")
    subject = view_subject(product, tolerance)
    texts = Texts(product, spec)
    regions, marks = texts.layout(tolerance, subject)
    scale, views = _fitted(subject, regions, product, spec)
    # A small part of a large mechanism may be drawn far larger without pitch curve and base circle.
    if not spec.scale and _may_fit(subject.alone, regions, DWARFED * float(scale)):
        bare, bare_marks = texts.layout(tolerance, subject.alone)
        larger, bare_views = _fitted(subject.alone, bare, product, spec)
        if larger >= DWARFED * scale:
            scale, views, marks = larger, bare_views, bare_marks
    contents = [(views, marks)]
    if texts.has_table_sheet:
        contents.append(((), texts.table_sheet()))
    # Sheets are numbered over all discs of the design; one of both discs in one piece is the last.
    last = len(product.judgement.cams) * sheets_per_disc + is_in_one_piece(product)
    first = last if product.is_pair else product.position * sheets_per_disc + 1
    return tuple(
        _sheet(product, spec, scale, sheet_views, sheet_marks, (first + number, last))
        for number, (sheet_views, sheet_marks) in enumerate(contents)
    )


def is_in_one_piece(product: Product) -> bool:
    """Whether the disc is in one piece with another one."""
    part = product.scene.part
    return part is not None and part.pair is not None


def _sheet(
    product: Product, spec: DrawingSpec, scale: Fraction, views: tuple[View, ...],
    marks: list[Mark], numbered: tuple[int, int],
) -> Sheet:  # fmt: skip
    """A sheet with its frame and title block."""
    texts, ratio = Texts(product, spec), spelled(scale)
    size, all_marks = texts.size, [*marks, *texts.frame_and_title(ratio, numbered)]
    dashed_marks = tuple(in_dashes(all_marks, 1.0))
    comma = spec.language == "de"
    return Sheet(
        size.width, size.height, float(scale), ratio, product.unit, comma, views, dashed_marks
    )


@dataclass(frozen=True, slots=True)
class _Laid:
    """Views at a scale, with the origin of the first one at 0 [mm of paper].

    Attributes
    ----------
    views : the front view, and for a part with thickness the section to its right, at the least
        distance.
    low, high : lower left and upper right corner of all that they show.
    """

    views: tuple[View, ...]
    low: complex
    high: complex

    def fits(self, region: Region) -> bool:
        """Whether the views fit in a region."""
        spare = self.spare(region)
        return spare.real >= 0.0 and spare.imag >= 0.0

    def spare(self, region: Region) -> complex:
        """Width and height of a region beyond those that the views need; negative if they do not
        fit.
        """
        return region.size - (self.high - self.low) - complex(2.0 * EDGE, 2.0 * EDGE)

    def placed(self, region: Region) -> tuple[View, ...]:
        """The views in the middle of a region, with the section farther away if there is room."""
        spare = self.spare(region)
        gap = min(spare.real / 3.0, SPREAD) if len(self.views) > 1 else 0.0
        aside = 0.5 * (spare.real - gap)
        shift = region.low - self.low + complex(EDGE + aside, EDGE + 0.5 * spare.imag)
        return tuple(replace(view, origin=view.origin + shift + number * gap)
                     for number, view in enumerate(self.views))  # fmt: skip


def _laid(subject: ViewSubject, scale: float, product: Product, spec: DrawingSpec) -> _Laid:
    """The views at a scale, side by side."""
    marks = tuple(front_view(subject, scale, product, spec))
    low, high = measure_ink(marks, scale, product.unit).extent
    views = [View(0j, marks)]
    if subject.cut:
        cut = tuple(section_view(subject, scale, product, spec))
        left, right = measure_ink(cut, scale, product.unit).extent
        cut_origin = high.real + VIEW_GAP - left.real
        views.append(View(complex(cut_origin), cut))
        low = complex(low.real, min(low.imag, left.imag))
        high = complex(cut_origin + right.real, max(high.imag, right.imag))
    return _Laid(tuple(views), low, high)


def _fitted(
    subject: ViewSubject, regions: Sequence[Region], product: Product, spec: DrawingSpec
) -> tuple[Fraction, tuple[View, ...]]:
    """The stated scale, or else the largest standard one at which the views fit, and the views."""
    stated = parse_scale(spec.scale) if spec.scale else None
    candidates = scales() if stated is None else (stated,)
    for scale in candidates:
        if _may_fit(subject, regions, float(scale)):
            laid = _laid(subject, float(scale), product, spec)
            for region in filter(laid.fits, regions):
                return scale, laid.placed(region)
    if stated is None:
        message = "leaves no room for the views; leave out table or diagram, or take A3"
        raise GeometryError(message, key="drawing.sheet", value=spec.sheet)
    largest, _ = _fitted(subject, regions, product, replace(spec, scale=""))
    message = f'does not fit on the sheet: at most "{spelled(largest)}" does'
    raise GeometryError(message, key="drawing.scale", value=spec.scale)


def _may_fit(subject: ViewSubject, regions: Sequence[Region], scale: float) -> bool:
    """Whether the part itself fits, without dimensions; a quick check before views are laid out."""
    low, high = subject.box
    size = high - low + (subject.shape.part.thickness if subject.cut else 0.0)
    rooms = [region.size / scale for region in regions]
    return any(size.real <= room.real and size.imag <= room.imag for room in rooms)


# -- scales ---------------------------------------------------------------------------------------
# Standard scales (ISO 5455).


LARGEST: Final = 50

SMALLEST: Final = 100_000


def scales() -> tuple[Fraction, ...]:
    """The standard scales, as millimetres of paper for each of the part, the largest first."""
    sizes = [step * 10**power for power in range(6) for step in (1, 2, 5)]
    enlargements = [Fraction(size) for size in sizes if size <= LARGEST]
    reductions = [Fraction(1, size) for size in sizes if 1 < size <= SMALLEST]
    return (*reversed(enlargements), *reductions)


def spelled(scale: Fraction) -> str:
    """The scale as the title block states it, as "1:2"."""
    return f"{scale.numerator}:{scale.denominator}"


def parse_scale(text: str) -> Fraction:
    """The scale from text as "1:2"."""
    first, _, second = text.partition(":")
    return Fraction(int(first), int(second))


# -- views ----------------------------------------------------------------------------------------
# The front view and the section, with dimensions and symbols.


PLANE_LETTER: Final = 5.0
"""Height of the letters at the cutting plane [mm of paper]."""

LEAST_RADIUS: Final = 24.0
"""Least radius of the arrow in the sense of rotation [mm of paper]."""

ALL_AROUND: Final = 1.5
"""Radius of the circle that extends a tolerance to all of a closed flank [mm of paper]."""

ARROW_SPAN: Final = math.radians(13.0)
"""Half of the angle that the arrow in the sense of rotation spans [rad]."""

TITLE: Final = 5.0
"""Least distance from the upper edge of the part to the title of the section [mm of paper]."""


def view_subject(product: Product, tolerance: float) -> ViewSubject:
    """What the views of a disc show, with curves within `tolerance` [mm]."""
    contents = product.drawn
    shape = Shape.from_part(contents.part, tolerance, contents.effort)
    cut = tuple(dimensions.section(shape)) if shape.has_heights else ()
    edges = tuple(dimensions.edges_above(shape, tolerance, contents.effort))
    if product.is_pair:
        return ViewSubject(shape, None, None, cut, product.unit, edges)
    pitch = None
    if contents.has_pitch_curve:
        pitch = contents.pitch_contour(WRITTEN_SHARE * tolerance).contour
    return ViewSubject(shape, pitch, contents.base_radius, cut, product.unit, edges)


def front_view(
    subject: ViewSubject, scale: float, product: Product, spec: DrawingSpec
) -> list[Mark]:
    """The part from above, with the origin in the cam axis."""
    shape, unit = subject.shape, product.unit
    low, high = subject.box
    reach = max(abs(complex(x, y)) for x in (low.real, high.real) for y in (low.imag, high.imag))
    bench = dimensions.Bench(spec, unit, scale, reach)
    fixed: list[Mark] = []
    if subject.pitch is not None:
        fixed += dashed(subject.pitch, scale, "PITCH_CURVE", DASH_DOT)
    if subject.base_radius is not None:
        fixed.append(Round(0j, subject.base_radius, "BASE_CIRCLE"))
    fixed += _cross(low, high, scale)
    fixed += pattern_centres(shape, scale)
    fixed += shape.outlines
    fixed += subject.edges
    if subject.cut:
        fixed += _plane(low, high, scale)
    # Earlier requests choose their places first.
    requests: list[Options] = []
    rounds = dimensions.find_diameters(shape)
    for diameter in rounds:
        if diameter.keyway is not None:
            requests.append(dimensions.keyway_width(diameter.keyway, bench))
            requests.append(dimensions.keyway_depth(diameter.keyway, bench))
    requests += [dimensions.flat_options(diameter.edge, bench) for diameter in rounds]
    requests += [dimensions.round_options(diameter, bench) for diameter in rounds
                 if not subject.cut or not dimensions.in_section(diameter)]  # fmt: skip
    requests += dimensions.hole_requests(shape, bench)
    requests.append(_zero_mark(subject, scale))
    requests += dimensions.overall(shape, (low, high), bench)
    requests += [_flank(subject, scale, spec), _sense(subject, product.cam.rotation, scale)]
    return _cleared(placed_marks(requests, fixed, scale, unit), scale, unit)


def _cleared(marks: list[Mark], scale: float, unit: LengthUnit) -> list[Mark]:
    """The marks of a view, with centre lines in dashes and kept off texts and frames."""
    return list(measure_ink(marks, scale, unit).cleared(in_dashes(marks, scale), scale))


def _cross(low: complex, high: complex, scale: float) -> list[Mark]:
    """Centre lines through the cam axis, beyond all that is shown."""
    far = BEYOND / scale
    return [
        line(complex(low.real - far, 0.0), complex(high.real + far, 0.0), "CENTRE"),
        line(complex(0.0, low.imag - far), complex(0.0, high.imag + far), "CENTRE"),
    ]


def _reach(subject: ViewSubject, first: float, last: float) -> float:
    """Largest distance from the cam axis of what is drawn between two polar angles [mm]."""
    contours = [edge.contour for edge in subject.shape.edges]
    contours += [] if subject.pitch is None else [subject.pitch]
    points = np.concatenate([contour.points(0.001 * subject.shape.size) for contour in contours])
    middle, half = 0.5 * (first + last), 0.5 * (last - first)
    near = np.abs(np.angle(points * cmath.exp(-1j * middle))) <= half + 0.02
    return max(float(np.max(np.abs(points[near]), initial=0.0)), subject.base_radius or 0.0)


def _zero_mark(subject: ViewSubject, scale: float) -> Options:
    """The places of a wide stroke at cam angle 0, outside of all that is drawn there."""
    nearest = _reach(subject, -0.03, 0.03) + 4.5 / scale
    for farther in range(0, 40, 2):
        start = nearest + farther / scale
        text = Label("0°", complex(start, 1.5 / scale), 2.5, layer="SYMBOL")
        yield 0.1 * farther, [line(complex(start), complex(start + 6.0 / scale), "EDGES"), text]


def arrow(tip: complex, direction: complex, layer: Layer = "SYMBOL", size: float = 3.0) -> Filled:
    """An arrowhead of `size` that points along the unit vector `direction`."""
    back, side = tip - size * direction, size / 6.0 * 1j * direction
    return Filled((tip, back + side, back - side), layer)


def _sense(subject: ViewSubject, rotation: int, scale: float) -> Options:
    """The places of an arrow in the sense of rotation around the view, the first on the lower
    right.
    """
    for number, middle in enumerate(np.radians([-49.0, -131.0, 49.0, 131.0, -30.0, 30.0])):
        first, last = middle - ARROW_SPAN, middle + ARROW_SPAN
        start, end = (first, last) if rotation > 0 else (last, first)
        least = max(_reach(subject, first, last) + 5.0 / scale, LEAST_RADIUS / scale)
        for farther in range(0, 40, 4):
            radius = least + farther / scale
            begin, tip = cmath.rect(radius, start), cmath.rect(radius, end)
            # The head has the direction of the arc 1.5 mm of paper before the tip, so it lies along
            # it.
            way = 1j * rotation * tip / radius
            chord = way * cmath.exp(-1j * rotation * 1.5 / (radius * scale))
            head = moved([arrow(0j, chord, size=4.0)], tip, scale)
            yield 0.5 * number + 0.1 * farther, [arc(0j, begin, end - start, "EDGES"), *head]


def arc(centre: complex, start: complex, sweep: float, layer: Layer) -> Chain:
    """An arc from `start` that turns by `sweep` [rad], in pieces of at most a quarter turn.

    Some programs draw half circles on the wrong side.
    """
    count = math.ceil(abs(sweep) / (0.5 * math.pi) - 1e-9)
    turns = np.exp(1j * sweep * np.arange(count + 1) / count)
    sweeps = np.full(count + 1, sweep / count)
    return Chain(centre + (start - centre) * turns, sweeps, layer)


def _plane(low: complex, high: complex, scale: float) -> list[Mark]:
    """The ends of the cutting plane A-A, with arrows in the viewing direction."""
    marks: list[Mark] = []
    for y, way in ((low.imag, -1.0), (high.imag, 1.0)):
        start = complex(0.0, y + way * (BEYOND + 0.5) / scale)
        end = start + 5j * way / scale
        marks.append(line(start, end, "SECTION"))
        tail = end - 9.0 / scale
        marks.append(line(tail, end, "SYMBOL"))
        marks += moved([arrow(0j, 1.0 + 0j, size=4.0)], end - 0.2 / scale, scale)
        place = tail - complex(1.0, (0.5 + 0.5 * way) * PLANE_LETTER - 0.5 * way) / scale
        marks.append(Label("A", place, PLANE_LETTER, "right", "SYMBOL"))
    return marks


def _flank(subject: ViewSubject, scale: float, spec: DrawingSpec) -> Options:
    """The places of profile tolerance and texture of the flanks, with a leader to the flank."""
    if spec.flank_tolerance is None and not spec.flank_surface:
        return
    points = _flank_edge(subject).points(0.0005 * subject.shape.size)
    above = subject.box[1].imag + 4.0 / scale
    stated = {sense: _stated(subject, sense, spec) for sense in (-1.0, 1.0)}
    for number, degrees in enumerate((120, 130, 110, 140, 150, 100, 70, 60, 50)):
        way = cmath.rect(1.0, math.radians(degrees))
        foot = complex(points[np.argmin(np.abs(np.angle(points / way)))])
        head = moved([arrow(0j, -way, size=3.0)], foot, scale)
        for higher in range(0, 60, 4):
            # The leader ends above the view, and is at least 4 mm of paper long.
            level = above + higher / scale
            knee = foot + way * max((level - foot.imag) / way.imag, 4.0 / scale)
            leader = line(foot + 1.0 / scale * way, knee, "SYMBOL")
            stated_marks = moved(stated[math.copysign(1.0, way.real)], knee, scale)
            yield 0.3 * number + 0.1 * higher, [*head, leader, *stated_marks]


def _stated(subject: ViewSubject, sense: float, spec: DrawingSpec) -> list[Mark]:
    """Tolerance and texture, to the left or to the right (`sense`) of the leader [mm of paper]."""
    shelf = sense * 4.0
    marks: list[Mark] = [line(0j, complex(shelf), "SYMBOL")]
    wide, flanks = 0.0, sum(edge.is_flank for edge in subject.shape.edges)
    if spec.flank_tolerance is not None:
        value = f"{spec.flank_tolerance / MM_PER[subject.unit]:.6f}".rstrip("0").rstrip(".")
        value = decimal(value, spec.language)
        names = ["A", "B"][: _datums(subject)]
        wide = frame_width(value, names)
        corner = complex(shelf + min(sense * wide, 0.0), -0.5 * CELL)
        marks += tolerance_frame(corner, value, names)
        marks.append(Round(0j, ALL_AROUND, "SYMBOL"))
        if flanks > 1:
            marks.append(Label(f"{flanks}x", corner + 1j * (CELL + 1.0), 3.5, layer="SYMBOL"))
    if spec.flank_surface:
        size = text_width(spec.flank_surface, 2.5) + 6.0
        left = -max(size, 0.6 * wide) if sense < 0.0 else 9.0
        marks += texture(
            complex(shelf + left, 0.5 * CELL if wide else 0.0), spec.flank_surface, 2.5
        )
    return marks


def _flank_edge(subject: ViewSubject) -> Contour:
    """The contour of the flank; for a groove that of the inner one."""
    flanks = (edge for edge in subject.shape.edges if edge.is_flank)
    return next(flanks, subject.shape.outermost).contour


def _datums(subject: ViewSubject) -> int:
    """Number of datums of the part: A for its bore, B for its keyway."""
    bores = [
        diameter
        for diameter in dimensions.find_diameters(subject.shape)
        if diameter.edge.boundary.hole and diameter.edge.boundary.name == "bore"
    ]
    return 0 if not bores else 2 if bores[0].keyway is not None else 1


def section_view(
    subject: ViewSubject, scale: float, product: Product, spec: DrawingSpec
) -> list[Mark]:
    """The section, with the origin where the cam axis meets the lowest face."""
    shape, unit = subject.shape, product.unit
    thick = shape.part.thickness
    bench = dimensions.Bench(spec, unit, scale, shape.size)
    far = BEYOND / scale
    fixed: list[Mark] = [line(complex(-far), complex(thick + far), "CENTRE")]
    fixed += dimensions.bevelled(subject.cut, shape)
    fixed += dimensions.hole_centres(shape, scale)
    requests = [*dimensions.heights(shape, subject.cut, subject.box, bench),
                *dimensions.diameters(dimensions.find_diameters(shape), thick, bench)]  # fmt: skip
    marks = placed_marks(requests, fixed, scale, unit)
    top = measure_ink(marks, scale, unit).extent[1].imag
    title = complex(0.5 * thick, max(top + 4.0, subject.box[1].imag * scale + TITLE) / scale)
    marks.append(Label("A-A", title, PLANE_LETTER, "centre", "SYMBOL"))
    return _cleared(marks, scale, unit)


SINK = 0.5 * (CELL - LETTER)
"""Height of the base line of letters above the lower edge of their frame [mm of paper]."""


def tolerance_frame(corner: complex, value: str, datums: Sequence[str]) -> list[Mark]:
    """A frame of ISO 1101 for the profile of a surface, by its lower left corner."""
    marks: list[Mark] = []
    widths = [CELL, text_width(value, LETTER) + 3.0, *(CELL for _ in datums)]
    start = corner
    for width in widths:
        marks.append(rectangle(start, width, CELL, "SYMBOL"))
        start += width
    middle = corner + complex(0.5 * CELL, 2.2)
    half = 2.2
    marks.append(line(middle - half, middle + half, "SYMBOL"))
    marks.append(arc(middle, middle + half, math.pi, "SYMBOL"))
    start = corner + CELL
    for text, width in zip((value, *datums), widths[1:], strict=True):
        marks.append(Label(text, start + complex(0.5 * width, SINK), LETTER, "centre", "SYMBOL"))
        start += width
    return marks


def frame_width(value: str, datums: Sequence[str]) -> float:
    """Width of a tolerance frame [mm of paper]."""
    return CELL * (1 + len(datums)) + text_width(value, LETTER) + 3.0


# -- front -----------------------------------------------------------------------------------------
# Centre lines, pitch curve and base circle of the front view, and their dashes.


DASH_DOT = (8.4, 1.05, 0.25, 1.05)
"""Line 04.1 of ISO 128-2 for a line width of 0.35: dash, gap, dot, gap [mm of paper]."""

DASH_DOTS = (8.4, 1.05, 0.25, 1.05, 0.25, 1.05)
"""Line 05.1 of ISO 128-2: the same with two dots."""

PATTERNS = {"CENTRE": DASH_DOT, "BASE_CIRCLE": DASH_DOTS}

BEYOND = 4.0
"""How far centre lines extend beyond what they belong to [mm of paper]."""


def pattern_centres(shape: Shape, scale: float) -> list[Mark]:
    """Centre lines of round boundaries off the cam axis: radial and along their pitch circle."""
    marks: list[Mark] = []
    circles: set[float] = set()
    holes = shape.holes
    for centre, radius in holes:
        outward = centre / abs(centre)
        far = radius + dimensions.SMALL_BEYOND / scale
        marks.append(line(centre - far * outward, centre + far * outward, "CENTRE"))
        if sum(math.isclose(abs(hole), abs(centre), rel_tol=1e-9) for hole, _ in holes) > 1:
            if not any(math.isclose(circle, abs(centre), rel_tol=1e-9) for circle in circles):
                circles.add(abs(centre))
                marks.append(Round(0j, abs(centre), "CENTRE"))
        else:
            across = far * 1j * outward
            marks.append(line(centre - across, centre + across, "CENTRE"))
    return marks


def in_dashes(marks: Iterable[Mark], scale: float) -> Iterator[Mark]:
    """The marks of a view, with its centre lines and auxiliary curves in dashes and dots.

    Each dash is a line of its own: many programs do not know line patterns, have them in another
    size, or begin them anew at each vertex, so that a curve of short arcs would be drawn solid.
    """
    for mark in marks:
        pattern = PATTERNS.get(getattr(mark, "layer", ""))
        if pattern is None or isinstance(mark, Label):
            yield mark
        elif isinstance(mark, Round):
            circle = Contour.circle(mark.radius, mark.centre)
            yield from dashed(circle, scale, mark.layer, pattern)
        elif isinstance(mark, Chain) and len(mark.vertices) == 2:
            yield from _dashed_line(mark, scale, pattern)
        else:
            yield mark


def dashed(
    contour: Contour, scale: float, layer: Layer, pattern: Sequence[float]
) -> Iterator[Chain]:
    """A closed contour in dashes and dots, with a whole number of patterns around it."""
    total = float(np.cumsum(contour.lengths)[-1])
    # The pattern is stretched so that a whole number of it fits.
    count = max(1, round(total * scale / sum(pattern)))
    share = total / (count * sum(pattern))
    ends = _dashes(pattern, count * len(pattern), share, -0.5 * pattern[0] * share)
    for place, size in ends:
        yield Chain.along(contour, place % total, size, layer)


def dashed_stretch(mark: Chain, scale: float, pattern: Sequence[float]) -> Iterator[Chain]:
    """A chain of lines and arcs in dashes.

    A closed chain has a whole number of patterns around it, an open one has a dash at each end. A
    chain that is too short for a gap stays as it is.
    """
    contour = Contour.through(mark.vertices, mark.sweeps)
    if mark.closed:
        yield from dashed(contour, scale, mark.layer, pattern)
        return
    length = float(np.sum(contour.lengths[:-1]))
    count = round((length * scale - pattern[0]) / sum(pattern))
    if count < 1:
        yield mark
        return
    share = length / (count * sum(pattern) + pattern[0])
    for place, size in _dashes(pattern, count * len(pattern) + 1, share):
        yield Chain.along(contour, place, min(size, length - place), mark.layer)


def _dashed_line(mark: Chain, scale: float, pattern: Sequence[float]) -> Iterator[Chain]:
    """A straight line in dashes that begins and ends with one; a short line is a single dash."""
    start, end = (complex(vertex) for vertex in mark.vertices)
    count = round((abs(end - start) * scale - pattern[0]) / sum(pattern))
    if count < 1:
        yield mark
        return
    share = 1.0 / (count * sum(pattern) + pattern[0])
    for place, size in _dashes(pattern, count * len(pattern) + 1, share):
        way = end - start
        yield line(start + place * way, start + (place + size) * way, mark.layer)


def _dashes(
    pattern: Sequence[float], pieces: int, share: float, place: float = 0.0
) -> Iterator[tuple[float, float]]:
    """Start and length of each dash among `pieces` dashes and gaps in turn, scaled by `share`."""
    for number in range(pieces):
        size = pattern[number % len(pattern)] * share
        if number % 2 == 0:
            yield place, size
        place += size
