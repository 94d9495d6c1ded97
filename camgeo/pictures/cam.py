"""The cam: disc with bore, pitch curve, base circle, and the roller or face at cam angle 0.

The disc is the real one: what is cut off from an undercut flank is drawn next to it. For a
conjugate pair the return disc and its roller are drawn over the main disc, dashed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import dropwhile, pairwise
from typing import Final

import numpy as np

from camgeo.design.pictured import FollowerSketch, TrimmedStretch
from camgeo.design.product import Product
from camgeo.errors import GeometryError, UndercutError
from camgeo.geometry.outline.path import Flank
from camgeo.numeric.arrays import BoolArray, ComplexArray, FloatArray
from camgeo.part.part import Boundary, Part
from camgeo.part.spec import text_name
from camgeo.pictures.model import (
    AUXILIARY,
    LEFT,
    LIMIT,
    LINE,
    RETURN_STYLE,
    RIGHT,
    SAMPLES,
    TOP,
    Area,
    Arrow,
    Axis,
    Circle,
    Entry,
    Figure,
    Fill,
    Frame,
    Inset,
    Legend,
    Line,
    Mark,
    Panel,
    Size,
    Style,
    Text,
    cam_angles,
    grid,
    plane,
)
from camgeo.units import MM_PER, TURN

SAGITTA = 1e-4
"""Sagitta of chords, relative to the base radius: far below the width of a printed line."""

PITCH_STYLE = Style(AUXILIARY, 1.0, (10.0, 3.0, 2.0, 3.0))
BASE_STYLE = Style(AUXILIARY, 0.8, (5.0, 4.0))
FACE = Style("black", 2.4)
GUIDE = Style("black", 2.4)
ROD = Style("black", 1.2)
CROSS = Style("black", 0.0, marker="+")
PIVOT = Style("black", 0.0, marker="o", face="white")
RETURN_CROSS = Style(RETURN_STYLE.color, 0.0, marker="+")

ARROW = np.radians(np.linspace(200.0, 320.0, 61))
"""Directions [rad] of the points of the arrow around the cam axis."""

KNIFE = 0.1
"""Radius at which a knife edge is drawn, relative to the base radius; it has none of its own."""

BOTTOM = 0.95
"""Lower margin [inch], with room for the legend."""

BELOW = 0.452
"""Distance of the legend below the axes [inch], with room for their label and numbers."""

SIZE = (7.0, 7.0)


def figure(product: Product, size: Size = SIZE) -> Figure:
    """The cam at cam angle 0, to scale, in the product's unit."""
    scale = 1.0 / MM_PER[product.unit]
    part, rolls = _part(product), product.cam.follower.has_pitch_curve
    cut_offs, sketch = product.pictured.trimmed_stretches, product.pictured.follower_sketch
    if part is None:
        marks, lines = whole_flanks(product, cut_offs, scale)
    else:
        marks, lines = whole_disc(part, scale, SAGITTA * product.cam.follower.base_radius)
    for second in product.others:
        other, return_lines = _return_disc(second, scale)
        marks, lines = [*marks, *other], [*lines, *return_lines]
    pitch = product.cam.disc.pitch_curve.point(cam_angles()) * scale
    if rolls:
        marks.append(Line(plane(pitch), PITCH_STYLE))
    base = product.cam.follower.base_radius * scale
    circle = base * np.exp(1j * cam_angles())
    marks.append(Line(plane(circle), BASE_STYLE))
    if cut_offs:
        marks += cut_off_marks(cut_offs, scale)
    roller, radius = complex(pitch[0]), _size(product) * scale
    if rolls:
        follower, end = _follower(product, sketch, roller, radius, scale)
    else:
        follower, end = _flat(sketch, roller, scale)
    arrow = 0.45 * base * np.exp(1j * ARROW)
    cross = 0.1 * base * np.array([-1.0, 1.0, 0.0, 1j, -1j])
    marks += follower
    marks.append(Arrow(plane(arrow[:: product.cam.rotation]), Style("black", 1.0), 12.0, layer=4.0))
    marks += [Line(plane(stroke), Style(AUXILIARY, 0.8)) for stroke in (cross[:2], cross[:2:-1])]
    rim = roller + radius * np.exp(1j * cam_angles())
    ends = [point * scale for point in sketch.face or ()]
    outlines = [*lines, circle, pitch, *(offcut.course * scale for offcut in cut_offs)]
    outlines += [np.array([roller, end, *ends]), rim]
    x, y = _limits(outlines)
    insets: tuple[Inset, ...] = ()
    if cut_offs:
        breadth = max(float(np.ptp(line.real)) for line in lines) / scale
        outlines += [cross, arrow, *(note(x, y) if part is None else ())]

        def window(middle: complex, width: float) -> list[Mark]:
            if part is None:
                return flanks_near(product, cut_offs, middle, width)
            return disc_near(part, middle, width)

        insets, x = enlarged(x, y, cut_offs, outlines, breadth, scale, window)
    frame = grid(size, (LEFT, RIGHT, TOP, BOTTOM))[0]
    panel = Panel(
        frame,
        Axis(x, f"x [{product.unit}]"),
        Axis(y, f"y [{product.unit}]"),
        (*marks, *insets),
        product.name,
        legend=_legend(product, part, cut_offs, _height(size, frame, x, y)),
        equal=True,
    )
    return Figure(size, (panel,))


def _part(product: Product) -> Part | None:
    """The part; None if there is no disc, because of undercut."""
    try:
        return product.drawn.part
    except UndercutError:
        return None


def _return_disc(second: Product, scale: float) -> tuple[list[Mark], list[ComplexArray]]:
    """Marks and lines of the return disc: flank, and roller at cam angle 0 with its lever.

    The whole flank is drawn; what is cut off from it is shown in its own picture.
    """
    curves = second.cam.disc
    try:
        flank = curves.inner_curve.point(cam_angles()) * scale
    except GeometryError:  # the roller centre stands still in the cam, which a finding reports
        flank = np.empty(0, dtype=np.complex128)
    roller = complex(curves.pitch_curve.point(np.zeros(1))[0] * scale)
    rim = roller + second.cam.follower.roller_radius * scale * np.exp(1j * cam_angles())
    sketch = second.pictured.follower_sketch
    lines = [flank, rim]
    if sketch.kind == "pivot":
        lines.append(np.array([roller, sketch.end * scale]))
    marks: list[Mark] = [Line(plane(line), RETURN_STYLE, layer=2.8) for line in lines]
    return [*marks, Line(plane([roller]), RETURN_CROSS, layer=2.8)], lines


def _legend(
    product: Product, part: Part | None, cut_offs: tuple[TrimmedStretch, ...], height: float
) -> Legend:
    """The legend below axes of that `height` [inch]."""
    if part is None:
        edges, marked = Entry("flanks", FLANK), flank_names(product, cut_offs)
    else:
        edges = Entry("edges of the disc", EDGE)
        marked = cut_off_names("cut off") if cut_offs else []
    if product.others:
        edges = Entry("edges of the main disc", edges.style)
        marked = [Entry("return disc and its roller", RETURN_STYLE), *marked]
    follower, base = product.cam.follower, Entry("base circle", BASE_STYLE)
    if not follower.has_pitch_curve:
        legend_entries = [edges, base, Entry("face at φ = 0", FACE), *marked]
    else:
        name, marker = ("roller", "o") if follower.roller_radius > 0.0 else ("knife edge", "+")
        style = Style("black", 0.0, marker=marker, size=9.0, face="white")
        roller = Entry(f"{name} at φ = 0", style)
        legend_entries = [edges, Entry("pitch curve", PITCH_STYLE), base, roller, *marked]
    return Legend(tuple(legend_entries), "upper center", (0.5, -BELOW / height), 4, gap=0.0)


def _height(size: Size, frame: Frame, x: Limits, y: Limits) -> float:
    """Height [inch] of axes that shrink within `frame` to have one scale in both directions."""
    left, bottom, right, top = frame
    return min((top - bottom) * size[1], (right - left) * size[0] * (y[1] - y[0]) / (x[1] - x[0]))


def _size(product: Product) -> float:
    """Radius [mm] of the roller, or that at which a knife edge is drawn."""
    return product.cam.follower.roller_radius or KNIFE * product.cam.follower.base_radius


def _follower(
    product: Product, sketch: FollowerSketch, roller: complex, radius: float, scale: float
) -> tuple[list[Mark], complex]:
    """The roller at cam angle 0 with its arm or guide, and where the line of that ends."""
    end = sketch.end * scale
    along = (end - roller) / abs(end - roller)
    marks: list[Mark] = []
    if sketch.kind == "guide":
        end = roller + 3.5 * radius * along
        # A short bar on each side stands for the guide.
        for side in (0.3j, -0.3j):
            bar = (end + (side - 1.5) * radius * along, end + side * radius * along)
            marks.append(Line(plane(bar), GUIDE, layer=3.0))
    marks.append(Line(plane([roller, end]), ROD, layer=3.0))
    if product.cam.follower.roller_radius > 0.0:
        rim = Fill("white", "black", 1.2)
        marks.append(Circle((roller.real, roller.imag), radius, rim, layer=4.0))
    return [*marks, *_held(sketch, roller, end)], end


def _flat(sketch: FollowerSketch, contact: complex, scale: float) -> tuple[list[Mark], complex]:
    """The flat face at cam angle 0 with its stem or lever, and where the line of that ends."""
    assert sketch.face is not None  # as it is a flat follower
    start, stop = (point * scale for point in sketch.face)
    end = sketch.end * scale
    # A follower that never moves needs no length of face, so its stem is at the contact.
    along = (stop - start) / abs(stop - start) if stop != start else 0j
    foot = start + along * ((end - start) * along.conjugate()).real
    marks: list[Mark] = [
        Line(plane([start, stop]), FACE, layer=3.0),
        Line(plane([foot, end]), ROD, layer=3.0),
    ]
    return [*marks, *_held(sketch, contact, end)], end


def _held(sketch: FollowerSketch, contact: complex, end: complex) -> list[Mark]:
    """Marks of the roller's centre or contact point, and of the pivot if there is one."""
    marks: list[Mark] = [Line(plane([contact]), CROSS, layer=5.0)]
    if sketch.kind == "pivot":
        marks.append(Line(plane([end]), PIVOT, layer=5.0))
    return marks


def _limits(outlines: list[ComplexArray]) -> tuple[Limits, Limits]:
    """Limits of x and y around all that is drawn."""
    points = np.concatenate(outlines)
    reach = 0.06 * max(float(np.ptp(points.real)), float(np.ptp(points.imag)))
    left, right, low, high = (
        float(edge(coordinates))
        for coordinates in (points.real, points.imag)
        for edge in (np.min, np.max)
    )
    return (left - reach, right + reach), (low - reach, high + reach)


# -- flanks ---------------------------------------------------------------------------------------
# The flanks where there is no disc: the full curves, with undercut marked.


FLANK = Style(LINE, 1.0)
UNDERCUT = Style(LIMIT, 2.2, (1.5, 0.8))
CUSP = Style(LIMIT, 0.0, marker="D", size=4.2, edge="white", edge_width=0.6)

OF_UNDERCUT, OF_CUSP = "undercut-", "cusp-"
"""Prefixes of the names of findings on undercut, which end with the name of the flank."""

RANGE = 721
"""Number of points in a range of cam angle."""

WINDOW_RATIO = 4.0
"""How far an inset shows the flank beyond what is cut off, relative to the cam angle of that."""


def whole_flanks(
    product: Product, cut_offs: tuple[TrimmedStretch, ...], scale: float
) -> tuple[list[Mark], list[ComplexArray]]:
    """Marks and lines of the flanks in use, with the cusps and loops because of which there is no
    disc.
    """
    lines = []
    for flank in product.cam.contact.flanks:
        for start, end in _remaining_ranges(cut_offs, flank):
            try:
                lines.append(_points(product, flank, np.linspace(start, end, SAMPLES)) * scale)
            except GeometryError:  # the roller centre stands still in the cam
                continue
    marks: list[Mark] = [Line(plane(points), FLANK) for points in lines]
    for what, start, end in _undercut(product) if not cut_offs else ():
        points = _points(product, what, np.linspace(start, end, RANGE)) * scale
        marks.append(Line(plane(points), UNDERCUT))
    for what, place in _cusps(product):
        cusp = _points(product, what, np.array([place])) * scale
        marks.append(Line(plane(cusp), CUSP, layer=2.6))
    marks.append(Text("no outline: undercut", (0.02, 0.98), 9.0, "panel", up="top"))
    return marks, lines


def flanks_near(
    product: Product, cut_offs: tuple[TrimmedStretch, ...], middle: complex, width: float
) -> list[Mark]:
    """What lies in and near the square of side `width` [mm] around `middle`, in mm."""
    shares = np.linspace(0.0, 1.0, RANGE)
    reach = WINDOW_RATIO * max(offcut.end - offcut.start for offcut in cut_offs)
    marks: list[Mark] = []
    for flank in {offcut.flank: None for offcut in cut_offs}:
        for start, end in _remaining_ranges(cut_offs, flank):
            length = min(reach, end - start)
            for phi in (start + length * shares, end - length * shares):
                line = line_near(_points(product, flank, phi), middle, width)
                marks.append(Line(plane(line), FLANK))
    return marks


def flank_names(product: Product, cut_offs: tuple[TrimmedStretch, ...]) -> list[Entry]:
    """Entries of the legend for what is marked on the flanks."""
    marked = cut_off_names("would be cut off") if cut_offs else []
    if not cut_offs and _undercut(product):
        marked.append(Entry("undercut", UNDERCUT))
    if _cusps(product):
        marked.append(Entry("cusp", CUSP))
    return marked


def note(x: Limits, y: Limits) -> list[ComplexArray]:
    """Lines around the text in the upper left corner, so that an inset does not cover it."""
    (left, right), (_, high) = x, y
    height = 0.03 * (right - left)
    return [np.array([left, left + 12.0 * height]) + 1j * (high - down) for down in (0.0, height)]


def _remaining_ranges(
    cut_offs: tuple[TrimmedStretch, ...], flank: str
) -> list[tuple[float, float]]:
    """Ranges of cam angle [rad] of a flank that would remain, were there a disc."""
    cut_ranges = sorted((offcut.start, offcut.end) for offcut in cut_offs if offcut.flank == flank)
    if not cut_ranges:
        return [(0.0, TURN)]
    # What remains lies between the end of a range and the start of the next, once around.
    following = [*(start for start, _ in cut_ranges[1:]), cut_ranges[0][0] + TURN]
    pairs = [(end, start) for (_, end), start in zip(cut_ranges, following, strict=True)]
    return [(start, end) for start, end in pairs if end > start]


def _undercut(product: Product) -> list[tuple[str, float, float]]:
    """Flank and cam angles [rad] of each range that undercuts."""
    # A range through cam angle 0 ends beyond a full turn.
    return [
        (finding.name.removeprefix(OF_UNDERCUT), start, end if end > start else end + TURN)
        for finding in product.findings
        if finding.name.startswith(OF_UNDERCUT) and finding.cam_range is not None
        for start, end in [finding.cam_range]
    ]


def _cusps(product: Product) -> list[tuple[str, float]]:
    """Flank and cam angle [rad] of each cusp without undercut."""
    return [
        (finding.name.removeprefix(OF_CUSP), finding.cam_angle)
        for finding in product.findings
        if finding.name.startswith(OF_CUSP) and finding.cam_angle is not None
    ]


def _points(product: Product, flank: str, phi: FloatArray) -> ComplexArray:
    return product.cam.disc.curve(Flank(flank)).point(phi)


# -- disc ------------------------------------------------------------------------------------------
# The disc as a body, filled and with its edges: all of it, or the part within an inset.


BODY = Fill("#e4e8ec", width=0.0)
GROOVE = Fill("#c2cad3", width=0.0)
EDGE = Style(LINE, 1.6)
LETTER = Style(LINE, 0.4)

FINE = 1e-3
"""Sagitta of chords in an inset, relative to its side."""


def whole_disc(
    part: Part, scale: complex, sagitta: float, *, sampled: bool = False
) -> tuple[list[Mark], list[ComplexArray]]:
    """Marks and rings of the part, with `scale` units per mm and chords within `sagitta` [mm].

    A complex scale rotates the part. If `sampled`, the chords are within `sagitta` only where the
    flanks were sampled, which is faster; otherwise the flanks are fits with a proved deviation.
    """
    marks: list[Mark] = []
    edges: list[Mark] = []
    outlines: list[ComplexArray] = []
    for boundaries, fill in _areas(part):
        rings = [ring * scale for ring in _rings(boundaries, sagitta, sampled=sampled)]
        marks.append(_area(rings, fill))
        outlines += rings
        for boundary, ring in zip(boundaries, rings, strict=True):
            style = _style(boundary)
            edges.append(Area((plane(ring),), Fill(edge=style.color, width=style.width)))
    return [*marks, *edges], outlines


def _style(boundary: Boundary) -> Style:
    """The style of the edge along a boundary: thin for letters, whose strokes are narrow."""
    return LETTER if text_name(boundary.name) else EDGE


def disc_behind(part: Part, scale: complex, sagitta: float, *, sampled: bool = False) -> list[Mark]:
    """The outline of the second disc of a conjugate pair over the first one, see `whole_disc`."""
    return [
        Line(plane(np.append(ring, ring[:1]) * scale), RETURN_STYLE, layer=3.0)
        for ring in _rings((part.outermost,), sagitta, sampled=sampled)
    ]


def disc_near(part: Part, middle: complex, width: float) -> list[Mark]:
    """What lies in and near the square of side `width` [mm] around `middle`, in mm."""
    sagitta = FINE * width
    marks: list[Mark] = []
    for boundaries, fill in _areas(part):
        rings = _rings(boundaries, sagitta)
        inside = [clipped(ring, middle, 2.0 * width) for ring in rings]
        inside = [ring for ring in inside if len(ring)]
        if inside:
            marks.append(_area(inside, fill))
        for boundary, ring in zip(boundaries, rings, strict=True):
            edge = line_near(np.append(ring, ring[:1]), middle, width)
            marks.append(Line(plane(edge), _style(boundary)))
    return marks


def _areas(part: Part) -> list[tuple[tuple[Boundary, ...], Fill]]:
    """The areas to be filled as seen from above, each with its filling.

    The first is the lowest layer of the disc; then follow, upwards, what is sunk into it and what
    stands on it.
    """
    disc = part.outermost
    seen = list(dropwhile(lambda layer: disc not in layer.boundaries, part.layers))
    areas = [(seen[0].boundaries, BODY)]
    for lower, upper in pairwise(seen):
        if disc not in upper.boundaries:
            areas.append((upper.boundaries, BODY))
            continue
        begins = tuple(
            boundary for boundary in upper.boundaries if boundary not in lower.boundaries
        )
        areas.append((begins, GROOVE))
    return areas


def _rings(
    boundaries: tuple[Boundary, ...], sagitta: float, *, sampled: bool = False
) -> list[ComplexArray]:
    """Points [mm] of each boundary."""
    rings = []
    for boundary in boundaries:
        contour = boundary.sampled(sagitta) if sampled else boundary.arcs(sagitta).contour
        rings.append(contour.points(sagitta))
    return rings


def _area(rings: list[ComplexArray], fill: Fill) -> Area:
    """The area between `rings`, of which the largest is the outer one and the others are holes."""
    outer = max(rings, key=_signed_area)
    return Area(tuple(plane(ring if ring is outer else ring[::-1]) for ring in rings), fill)


def _signed_area(ring: ComplexArray) -> float:
    """The area of a polygon by the shoelace formula, positive if it is counter-clockwise."""
    return 0.5 * float(np.sum((ring.conj() * np.roll(ring, -1)).imag))


# -- cut off --------------------------------------------------------------------------------------
# What is cut off from a flank: dashed in a colour of its own, with its corner marked, and enlarged.
#
# A swallowtail is often only a thousandth of the disc wide; an inset then shows the largest one.


CUT: Final = "#c05a00"
"""Colour of what is not on the disc; in a grey print it lies between those of lines and grid."""

COURSE: Final = Style(CUT, 1.1, (3.0, 1.6))
CORNER: Final = Style(CUT, 0.0, marker="D", size=4.2, edge="white", edge_width=0.6)

SMALL: Final = 0.05
"""What is cut off is enlarged if it is smaller than this fraction of the disc,"""

TINIEST: Final = 1e-5
"""but larger than this one: below, the edges next to it would need contours finer than any
file's."""

MARGIN: Final = 1.9
"""Side of the square that the inset shows, as a multiple of what is cut off."""

SIDES: Final = (0.34, 0.28, 0.22)
"""Sides tried for the inset, as fractions of the picture's smaller side."""

WORTH: Final = 3.0
"""Distance by which an inset may lie farther away for each unit by which its side is longer."""

RIM: Final = 0.07
TITLE: Final = 0.16
"""Space kept free around and above the inset, as fractions of its side."""

PLACES: Final = 13
"""Number of positions tried for the inset in each direction."""

Limits = tuple[float, float]

Window = Callable[[complex, float], list[Mark]]
"""Function that draws what lies around a point [mm], in a square of the given side [mm]."""


def cut_off_marks(cut_offs: Sequence[TrimmedStretch], scale: float) -> list[Mark]:
    """Marks of what is cut off, and of its corners, with `scale` units per mm."""
    corners = np.array([offcut.corner for offcut in cut_offs]) * scale
    return [
        *(Line(plane(offcut.course * scale), COURSE, layer=2.5) for offcut in cut_offs),
        Line(plane(corners), CORNER, layer=2.6),
    ]


def cut_off_names(label: str) -> list[Entry]:
    """Entries of the legend; `label` names the dashed line."""
    return [Entry(label, COURSE), Entry("corner", CORNER)]


def enlarged(
    x: Limits,
    y: Limits,
    cut_offs: tuple[TrimmedStretch, ...],
    outlines: list[ComplexArray],
    size: float,
    scale: float,
    window: Window,
) -> tuple[tuple[Inset, ...], Limits]:
    """An inset of the largest part that is cut off, if it is small, in a free area.

    Parameters
    ----------
    x, y : limits of the picture.
    outlines : lines [unit of the picture] that must not be covered.
    size : of the disc [mm].
    scale : units of the picture per mm; the inset is drawn in mm.
    window : draws what is not cut off into the inset.

    Returns
    -------
    The inset, if any, and the limits of x, wider if room had to be made.
    """
    largest = max(cut_offs, key=_extent)
    extent = _extent(largest)
    if not TINIEST * size < extent < SMALL * size:
        return (), x
    place, side, x = _room(x, y, outlines, largest.corner * scale)
    middle, width = _middle(largest), MARGIN * extent
    times = side / (width * scale)
    corner = (middle - 0.5 * (1 + 1j) * width) * scale
    panel = Panel(
        (0.0, 0.0, 1.0, 1.0),
        Axis((middle.real - 0.5 * width, middle.real + 0.5 * width), ticks=()),
        Axis((middle.imag - 0.5 * width, middle.imag + 0.5 * width), ticks=()),
        (*window(middle, width), *cut_off_marks(cut_offs, 1.0)),
        f"{float(f'{times:.2g}'):,.0f} times as large",
        title_size=7.5,
        title_gap=2.5,
    )
    seen = corner.real, corner.imag, width * scale
    return (Inset(panel, place, side, seen, Style(CUT, 0.7)),), x


def clipped(ring: ComplexArray, middle: complex, width: float) -> ComplexArray:
    """The closed `ring` clipped to the square of side `width` around `middle`, side by side
    (Sutherland and Hodgman).
    """
    for outward in (1.0, 1j, -1.0, -1j):
        if not len(ring):
            break
        beyond = ((ring - middle) * np.conj(outward)).real - 0.5 * width
        following = np.roll(beyond, -1)
        inside = beyond <= 0.0
        crosses = inside != (following <= 0.0)
        share = np.divide(beyond, beyond - following, out=np.zeros_like(beyond), where=crosses)
        border_points = ring + share * (np.roll(ring, -1) - ring)
        # Each vertex that is inside is kept, and after it the crossing of its edge, if there is
        # one.
        pairs = np.column_stack((ring, border_points)).ravel()
        ring = pairs[np.column_stack((inside, crosses)).ravel()]
    return ring


def line_near(line: ComplexArray, middle: complex, width: float) -> ComplexArray:
    """The open `line`, with NaN where it is outside a square three times as wide as `width`."""
    away = line - middle
    inside: BoolArray = np.maximum(np.abs(away.real), np.abs(away.imag)) < 1.5 * width
    return np.where(inside, line, complex(np.nan, np.nan))


def _extent(part: TrimmedStretch) -> float:
    """The longer side of the box around a trimmed stretch [mm]."""
    return float(max(np.ptp(part.course.real), np.ptp(part.course.imag)))


def _middle(part: TrimmedStretch) -> complex:
    course = part.course
    x, y = (
        (np.max(coordinates) + np.min(coordinates)) / 2.0
        for coordinates in (course.real, course.imag)
    )
    return complex(x, y)


def _room(
    x_limits: Limits, y_limits: Limits, outlines: list[ComplexArray], target: complex
) -> tuple[tuple[float, float], float, Limits]:
    """Lower left corner and side of a free square for the inset, and the limits of x.

    The picture is made wider if nothing is free. `target` is what the inset enlarges, near which it
    should be.
    """
    (left, right), (low, high) = x_limits, y_limits
    smaller = min(right - left, high - low)
    points = np.concatenate([_evenly(line, 0.01 * smaller) for line in outlines])
    candidates = []
    for side in (share * smaller for share in SIDES):
        rim, title = RIM * side, TITLE * side
        for x in np.linspace(left + rim, right - side - rim, PLACES):
            across = points[(points.real > x - rim) & (points.real < x + side + rim)].imag
            for y in np.linspace(low + rim, high - side - title, PLACES):
                if not np.any((across > y - rim) & (across < y + side + title)):
                    distance = abs(complex(x, y) + 0.5 * (1 + 1j) * side - target)
                    candidates.append((distance - WORTH * side, float(x), float(y), side))
    if candidates:
        _, x, y, side = min(candidates)
        return (x, y), side, x_limits
    side = SIDES[0] * smaller
    y = min(max(target.imag - 0.5 * side, low + RIM * side), high - (1.0 + TITLE) * side)
    return (right - RIM * side, y), side, (left, right + side)


def _evenly(line: ComplexArray, step: float) -> ComplexArray:
    """Points along `line`, at most `step` apart."""
    lengths = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(line)))))
    places = np.linspace(0.0, lengths[-1], max(2, int(lengths[-1] / step) + 2))
    points: ComplexArray = np.interp(places, lengths, line)
    return points
