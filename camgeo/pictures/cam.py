"""The cam: disc with bore, pitch curve, base circle, and the roller or face at cam angle 0.

The disc is the real one: what is cut off from an undercut flank is drawn next to it. For a
conjugate pair the return disc and its roller are drawn over the main disc, dashed.
"""

from __future__ import annotations

import numpy as np

from camgeo.design.pictured import CutOff, FollowerSketch
from camgeo.design.product import Product
from camgeo.errors import GeometryError, UndercutError
from camgeo.geometry.outline.path import Flank
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.part.part import Part
from camgeo.pictures import disc
from camgeo.pictures.model import (
    AUXILIARY,
    LEFT,
    LIMIT,
    LINE,
    RETURN_STYLE,
    RIGHT,
    SAMPLES,
    TOP,
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
"""Chords of the picture, relative to the base radius: far below a printed line."""

PITCH_STYLE = Style(AUXILIARY, 1.0, (10.0, 3.0, 2.0, 3.0))
BASE_STYLE = Style(AUXILIARY, 0.8, (5.0, 4.0))
FACE = Style("black", 2.4)
GUIDE = Style("black", 2.4)
ROD = Style("black", 1.2)
CROSS = Style("black", 0.0, marker="+")
PIVOT = Style("black", 0.0, marker="o", face="white")
RETURN_CROSS = Style(RETURN_STYLE.color, 0.0, marker="+")

ARROW = np.radians(np.linspace(200.0, 320.0, 61))
"""Directions [rad] of the arrow around the axis."""

KNIFE = 0.1
"""Size at which a knife edge, which has no size, is drawn, relative to the base radius."""

BOTTOM = 0.95
"""Margin below [inch], with room for the legend."""

BELOW = 0.452
"""Distance of the legend from the axes [inch], with room for their label and numbers."""

SIZE = (7.0, 7.0)


def figure(product: Product, size: Size = SIZE) -> Figure:
    """The cam at cam angle 0, to scale, in the product's unit."""
    scale = 1.0 / MM_PER[product.unit]
    part, rolls = _part(product), product.cam.follower.has_pitch_curve
    found, sketch = product.pictured.cut_off, product.pictured.follower_sketch
    if part is None:
        marks, lines = whole_flanks(product, found, scale)
    else:
        marks, lines = disc.whole(part, scale, SAGITTA * product.cam.follower.base_radius)
    for second in product.others:
        other, return_lines = _return_disc(second, scale)
        marks, lines = [*marks, *other], [*lines, *return_lines]
    pitch = product.cam.disc.pitch_curve.point(cam_angles()) * scale
    if rolls:
        marks.append(Line(plane(pitch), PITCH_STYLE))
    base = product.cam.follower.base_radius * scale
    circle = base * np.exp(1j * cam_angles())
    marks.append(Line(plane(circle), BASE_STYLE))
    if found:
        marks += disc.cut_off_marks(found, scale)
    roller, radius = complex(pitch[0]), _size(product) * scale
    if rolls:
        follower, end = _follower(product, sketch, roller, radius, scale)
    else:
        follower, end = _flat(sketch, roller, scale)
    arrow = 0.45 * base * np.exp(1j * ARROW)
    cross = 0.1 * base * np.array([-1.0, 1.0, 0.0, 1j, -1j])
    marks += follower
    marks.append(Arrow(plane(arrow[:: product.cam.rotation]), Style("black", 1.0), 12.0, layer=4.0))
    marks += [Line(plane(each), Style(AUXILIARY, 0.8)) for each in (cross[:2], cross[:2:-1])]
    rim = roller + radius * np.exp(1j * cam_angles())
    ends = [point * scale for point in sketch.face or ()]
    drawn = [*lines, circle, pitch, *(each.course * scale for each in found)]
    drawn += [np.array([roller, end, *ends]), rim]
    x, y = _limits(drawn)
    insets: tuple[Inset, ...] = ()
    if found:
        breadth = max(float(np.ptp(line.real)) for line in lines) / scale
        drawn += [cross, arrow, *(note(x, y) if part is None else ())]

        def window(middle: complex, width: float) -> list[Mark]:
            if part is None:
                return flanks_near(product, found, middle, width)
            return disc.near(part, middle, width)

        insets, x = disc.enlarged(x, y, found, drawn, breadth, scale, window)
    frame = grid(size, (LEFT, RIGHT, TOP, BOTTOM))[0]
    panel = Panel(
        frame,
        Axis(x, f"x [{product.unit}]"),
        Axis(y, f"y [{product.unit}]"),
        (*marks, *insets),
        product.name,
        legend=_legend(product, part, found, _height(size, frame, x, y)),
        equal=True,
    )
    return Figure(size, (panel,))


def _part(product: Product) -> Part | None:
    """None if there is no disc."""
    try:
        return product.drawn.part
    except UndercutError:
        return None


def _return_disc(second: Product, scale: float) -> tuple[list[Mark], list[ComplexArray]]:
    """Flank of the return disc, its roller at cam angle 0 with guide or lever; and the lines.

    The whole flank is drawn: its own picture shows what is cut off from it.
    """
    curves = second.cam.disc
    try:
        flank = curves.inner_curve.point(cam_angles()) * scale
    except GeometryError:  # the roller centre stands still in the cam, which the findings report
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
    product: Product, part: Part | None, found: tuple[CutOff, ...], height: float
) -> Legend:
    """The legend of axes of that `height` [inch]."""
    if part is None:
        edges, marked = Entry("flanks", FLANK), flank_names(product, found)
    else:
        edges = Entry("edges of the disc", disc.EDGE)
        marked = disc.cut_off_names("cut off") if found else []
    if product.others:
        edges = Entry("edges of the main disc", edges.style)
        marked = [Entry("return disc and its roller", RETURN_STYLE), *marked]
    follower, base = product.cam.follower, Entry("base circle", BASE_STYLE)
    if not follower.has_pitch_curve:
        drawn = [edges, base, Entry("face at φ = 0", FACE), *marked]
    else:
        name, marker = ("roller", "o") if follower.roller_radius > 0.0 else ("knife edge", "+")
        style = Style("black", 0.0, marker=marker, size=9.0, face="white")
        roller = Entry(f"{name} at φ = 0", style)
        drawn = [edges, Entry("pitch curve", PITCH_STYLE), base, roller, *marked]
    return Legend(tuple(drawn), "upper center", (0.5, -BELOW / height), 4, gap=0.0)


def _height(size: Size, frame: Frame, x: disc.Limits, y: disc.Limits) -> float:
    """Height [inch] of axes in `frame` whose units are equally long in both directions."""
    left, bottom, right, top = frame
    return min((top - bottom) * size[1], (right - left) * size[0] * (y[1] - y[0]) / (x[1] - x[0]))


def _size(product: Product) -> float:
    """Radius [mm] of the roller, or the size at which a knife edge is drawn."""
    return product.cam.follower.roller_radius or KNIFE * product.cam.follower.base_radius


def _follower(
    product: Product, sketch: FollowerSketch, roller: complex, radius: float, scale: float
) -> tuple[list[Mark], complex]:
    """The roller at cam angle 0 and the line to its pivot, or along its guide; the line's end."""
    end = sketch.end * scale
    along = (end - roller) / abs(end - roller)
    marks: list[Mark] = []
    if sketch.kind == "guide":
        end = roller + 3.5 * radius * along
        # a short bar on each side represents the guide
        for side in (0.3j, -0.3j):
            bar = (end + (side - 1.5) * radius * along, end + side * radius * along)
            marks.append(Line(plane(bar), GUIDE, layer=3.0))
    marks.append(Line(plane([roller, end]), ROD, layer=3.0))
    if product.cam.follower.roller_radius > 0.0:
        rim = Fill("white", "black", 1.2)
        marks.append(Circle((roller.real, roller.imag), radius, rim, layer=4.0))
    return [*marks, *_held(sketch, roller, end)], end


def _flat(sketch: FollowerSketch, contact: complex, scale: float) -> tuple[list[Mark], complex]:
    """The flat face at cam angle 0, with the stem along its guide or the lever to its pivot."""
    assert sketch.face is not None  # of a flat follower
    start, stop = (point * scale for point in sketch.face)
    end = sketch.end * scale
    # A follower that never moves needs no face length: its stem is at the contact.
    along = (stop - start) / abs(stop - start) if stop != start else 0j
    foot = start + along * ((end - start) * along.conjugate()).real
    marks: list[Mark] = [
        Line(plane([start, stop]), FACE, layer=3.0),
        Line(plane([foot, end]), ROD, layer=3.0),
    ]
    return [*marks, *_held(sketch, contact, end)], end


def _held(sketch: FollowerSketch, contact: complex, end: complex) -> list[Mark]:
    """Roller centre or contact, and the pivot if there is one."""
    marks: list[Mark] = [Line(plane([contact]), CROSS, layer=5.0)]
    if sketch.kind == "pivot":
        marks.append(Line(plane([end]), PIVOT, layer=5.0))
    return marks


def _limits(drawn: list[ComplexArray]) -> tuple[disc.Limits, disc.Limits]:
    """Limits of x and y around all that is drawn."""
    points = np.concatenate(drawn)
    reach = 0.06 * max(float(np.ptp(points.real)), float(np.ptp(points.imag)))
    left, right, low, high = (
        float(edge(each)) for each in (points.real, points.imag) for edge in (np.min, np.max)
    )
    return (left - reach, right + reach), (low - reach, high + reach)


# -- flanks ---------------------------------------------------------------------------------------
# The flanks if there is no disc: the full curves, with undercut marked.


FLANK = Style(LINE, 1.0)
UNDERCUT = Style(LIMIT, 2.2, (1.5, 0.8))
CUSP = Style(LIMIT, 0.0, marker="D", size=4.2, edge="white", edge_width=0.6)

OF_UNDERCUT, OF_CUSP = "undercut-", "cusp-"
"""Prefixes of the names of findings on undercut; the name of the flank follows."""

RANGE = 721
"""Points per range of cam angle."""

BESIDE = 4.0
"""How far a window shows a flank on either side of the cut-off part, relative to its cam angle."""


def whole_flanks(
    product: Product, found: tuple[CutOff, ...], scale: float
) -> tuple[list[Mark], list[ComplexArray]]:
    """The flanks in use with their cusps and loops, the reason that there is no disc."""
    lines = []
    for flank in product.cam.contact.flanks:
        for start, end in _left(found, flank):
            try:
                lines.append(_points(product, flank, np.linspace(start, end, SAMPLES)) * scale)
            except GeometryError:  # the roller centre stands still in the cam
                continue
    marks: list[Mark] = [Line(plane(points), FLANK) for points in lines]
    for what, start, end in _undercut(product) if not found else ():
        points = _points(product, what, np.linspace(start, end, RANGE)) * scale
        marks.append(Line(plane(points), UNDERCUT))
    for what, place in _cusps(product):
        cusp = _points(product, what, np.array([place])) * scale
        marks.append(Line(plane(cusp), CUSP, layer=2.6))
    marks.append(Text("no outline: undercut", (0.02, 0.98), 9.0, "panel", up="top"))
    return marks, lines


def flanks_near(
    product: Product, found: tuple[CutOff, ...], middle: complex, width: float
) -> list[Mark]:
    """What lies in and near the square of side `width` [mm] around `middle`, in mm."""
    shares = np.linspace(0.0, 1.0, RANGE)
    reach = BESIDE * max(each.end - each.start for each in found)
    marks: list[Mark] = []
    for flank in {each.flank: None for each in found}:
        for start, end in _left(found, flank):
            length = min(reach, end - start)
            for phi in (start + length * shares, end - length * shares):
                line = disc.line_near(_points(product, flank, phi), middle, width)
                marks.append(Line(plane(line), FLANK))
    return marks


def flank_names(product: Product, found: tuple[CutOff, ...]) -> list[Entry]:
    """Names for the legend: what is marked."""
    marked = disc.cut_off_names("would be cut off") if found else []
    if not found and _undercut(product):
        marked.append(Entry("undercut", UNDERCUT))
    if _cusps(product):
        marked.append(Entry("cusp", CUSP))
    return marked


def note(x: disc.Limits, y: disc.Limits) -> list[ComplexArray]:
    """Lines around the text in the corner of a picture with these limits."""
    (left, right), (_, high) = x, y
    height = 0.03 * (right - left)
    return [np.array([left, left + 12.0 * height]) + 1j * (high - down) for down in (0.0, height)]


def _left(found: tuple[CutOff, ...], flank: str) -> list[tuple[float, float]]:
    """Ranges of cam angle [rad] of a flank that would not be cut off."""
    own = sorted((each.start, each.end) for each in found if each.flank == flank)
    if not own:
        return [(0.0, TURN)]
    following = [*(start for start, _ in own[1:]), own[0][0] + TURN]
    pairs = [(end, start) for (_, end), start in zip(own, following, strict=True)]
    return [(start, end) for start, end in pairs if end > start]


def _undercut(product: Product) -> list[tuple[str, float, float]]:
    """Flank and cam angles [rad] of each range that undercuts."""
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
