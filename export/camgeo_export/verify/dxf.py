"""Verification of drawings: our own, and those of any CAD program."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Mapping
from typing import Final

from camgeo.design.product import Product
from camgeo.design.verify import (
    Check,
    Origin,
    ReadingOptions,
    at_most,
    failed,
    parse_tolerance,
    reported,
)
from camgeo.errors import CamgeoError, FileError, GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.exact import deviation_bound
from camgeo.geometry.contour.spline import SplineContour
from camgeo.reading import DRAWING, check_text
from camgeo.scene.formats.drawing import FORMAT as SHEET
from camgeo.scene.formats.dxf import FORMAT
from camgeo_export.drawing.writer import measure
from camgeo_export.dxf.reader import Drawing, Item, Tag, gap_steps, read_drawing
from camgeo_export.reading import CUT, NUMBER_SLACK, AnyContour, text_tokens
from camgeo_export.verify.plane import (
    Shape,
    all_checks,
    boundary_shapes,
    contour_checks,
    corners_of_contour,
)

HEAD_BYTES = 200_000
"""Part of a drawing that holds its header."""

FRAME: Final = re.compile(rb"\n *8\r?\nFRAME\r?\n")
"""An entity on a layer that only our sheets have."""

NAMES = {"4": "mm", "1": "inch"}
"""Names of the units that $INSUNITS states."""


class DxfVerifier:
    """Verifies a DXF drawing."""

    format = "dxf"
    slack = NUMBER_SLACK
    tokens = staticmethod(text_tokens)

    def origin(self, data: bytes) -> Origin:
        """The origin that the custom document properties state."""
        try:
            check_text(data, DRAWING, "the file")
        except FileError as error:
            return Origin(damage=str(error))
        properties = _properties(data)
        damage = "" if data.rstrip().endswith(b"EOF") else "not a complete DXF file: no EOF at end"
        if b"SECTION" not in data:
            damage = "not a DXF file: it has no section"
        if data.startswith(b"AutoCAD Binary DXF"):
            damage = "is a binary DXF; save it as text (ASCII)"
        return Origin(
            properties.get("camgeo", ""),
            properties.get("scene", ""),
            parse_tolerance(properties.get("tolerance mm", "")),
            damage,
            SHEET.name if _is_sheet(data) else "",
        )

    def checks(
        self, product: Product, data: bytes, reading: ReadingOptions, tolerance: float
    ) -> tuple[Check, ...]:
        """Unit, contents, and each closed contour against its boundary."""
        try:
            drawing = read_drawing(data, reading.name)
        except FileError as error:
            return (failed("file", str(error)),)
        checks = [_unit(drawing, reading)]
        if _is_sheet(data):
            try:  # the edges of the front view and the dimensions against the part
                largest = measure(product, data)
            except CamgeoError as error:
                return (*checks, failed("contents", str(error)))
            return (
                *checks,
                at_most("deviation", largest, tolerance, "mm", note="of edges and dimensions"),
            )
        try:
            gaps = gap_steps(tolerance)
            outlines = drawing.outlines(reading.layer, reading.unit, gaps).with_origin(
                reading.origin
            )
        except CamgeoError as error:
            return (*checks, failed("closure", str(error)))
        checks += [
            at_most("closure", outlines.gap, tolerance, "mm", note="largest gap between pieces"),
            *(reported("not compared", CUT, note=note) for note in outlines.notes),
            *flat_checks(
                drawing.curves_on_layer(reading.layer), drawing.scale(reading.unit), tolerance
            ),
        ]
        shapes = boundary_shapes(
            product.drawn.part.boundaries, product.drawn.base_radius, tolerance
        )
        if outlines.loose and len(outlines.contours) < len(shapes):
            checks.append(failed("closure", outlines.loose))
        outline = outlines.contours[0]
        axis = "" if isinstance(outline, SplineContour) else outlines.misplaced_bore(outline)
        if axis:
            checks.append(reported("axis", "elsewhere", note=axis))
        checks += all_checks(outlines.contours, shapes, tolerance, outlines.gap + outlines.followed)
        if "camgeo" in _properties(data) and product.options[FORMAT].auxiliary:
            checks += [*_auxiliary(product, drawing, tolerance), _centre(drawing, tolerance)]
        return tuple(checks)


def _properties(data: bytes) -> dict[str, str]:
    """The custom properties of a drawing, by their labels."""
    lines = [line.strip() for line in data[:HEAD_BYTES].decode("cp1252", "replace").split("\n")]
    # 9, $CUSTOMPROPERTYTAG, 1, label, 9, $CUSTOMPROPERTY, 1, value
    places = [k for k, line in enumerate(lines) if line == "$CUSTOMPROPERTYTAG"]
    return {lines[k + 2]: lines[k + 6] for k in places if k + 6 < len(lines)}


def _is_sheet(data: bytes) -> bool:
    """Whether a drawing is one of our sheets, rather than contours to cut."""
    return FRAME.search(data) is not None and "camgeo" in _properties(data)


def _unit(drawing: Drawing, reading: ReadingOptions) -> Check:
    """The report of the unit that the drawing states."""
    stated = drawing.value("$INSUNITS") or "0"
    if reading.unit is not None and stated == "0":
        return reported("unit", reading.unit, note="by --unit; the drawing does not state it")
    return reported("unit", NAMES.get(stated, f"$INSUNITS {stated}"))


def _auxiliary(product: Product, drawing: Drawing, tolerance: float) -> list[Check]:
    """The checks of the pitch curve, if there is one, and of the base circle of our drawings."""
    checks = []
    if product.drawn.has_pitch_curve:
        try:
            (pitch,) = drawing.contours("PITCH_CURVE", gap_steps(tolerance)[-1])
            checks += contour_checks(_pitch(product, tolerance), pitch, tolerance)
        except (CamgeoError, ValueError) as error:
            checks.append(failed("deviation", str(error), "pitch curve"))
    try:
        (circle,) = drawing.contours("BASE_CIRCLE")
        assert isinstance(circle, Contour)  # it is drawn as a circle
        value = deviation_bound(Contour.circle(product.drawn.base_radius), circle)
        checks.append(at_most("deviation", value, tolerance, "mm", "base circle"))
    except (CamgeoError, ValueError) as error:
        checks.append(failed("deviation", str(error), "base circle"))
    return checks


def _centre(drawing: Drawing, tolerance: float) -> Check:
    """The check of the mark of the cam axis: lines whose middles lie on it."""
    lines = [item for item in drawing.items if item.layer == "CENTRE" and item.kind == "LINE"]
    try:
        middles = [
            complex(line.number(10) + line.number(11), line.number(20) + line.number(21))
            for line in lines
        ]
        half = 0.5 * drawing.scale()
    except (FileError, ValueError) as error:
        return failed("deviation", str(error), "centre mark")
    distance = max((abs(middle) for middle in middles), default=math.inf)
    return at_most("deviation", half * distance, tolerance, "mm", "centre mark")


def _pitch(product: Product, tolerance: float) -> Shape:
    """The pitch curve; its area is of no interest.

    Its corners and length are those of a fit as fine as the drawing's, if not finer: a coarser one
    of a steep move may not be provable.
    """

    def deviation(contour: AnyContour) -> float:
        if not isinstance(contour, Contour):
            raise GeometryError("is drawn as a spline, which camgeo never does")
        return product.drawn.pitch_deviation(contour)

    def polygon(tolerance: float) -> Contour:
        points = product.drawn.pitch_contour(0.5 * tolerance).contour.points(0.5 * tolerance)
        return Contour.polygon(points)

    contour = product.drawn.pitch_contour(min(tolerance, 1e-3 * product.drawn.base_radius)).contour
    corners = corners_of_contour(contour)
    return Shape("pitch curve", deviation, polygon, corners, contour.length, None)


VERIFIER = DxfVerifier()


# -- entities -------------------------------------------------------------------------------------
# What a drawing holds besides the shape of its curves: heights, widths, and what is not drawn.


HEIGHTS: Final = (30, 31, 38)
"""Groups of a height: of a point, of a line's end, of a polyline."""

THICKNESS: Final = 39

WIDTHS: Final[Mapping[str, Collection[int]]] = {
    "LWPOLYLINE": (40, 41, 43),
    "POLYLINE": (40, 41),
    "VERTEX": (40, 41),
}
"""Groups of a width, by the kind of the entity."""


def flat_checks(items: Iterable[Item], scale: float, limit: float) -> list[Check]:
    """Checks that `items` lie at height 0 and have no width and no thickness, within `limit` [mm].

    `scale` is in mm per unit of the drawing.
    """
    worst = {name: at_most(name, 0.0, limit, "mm") for name in ("elevation", "thickness", "width")}
    for entity in (entity for item in items for entity in (item, *item.vertices)):
        wide = WIDTHS.get(entity.kind, ())
        for tag in entity.tags:
            name = "elevation" if tag.code in HEIGHTS else "width" if tag.code in wide else ""
            name = "thickness" if tag.code == THICKNESS else name
            if name and worst[name].value is not None:
                worst[name] = max(
                    worst[name], _limit_check(name, entity, tag, scale, limit), key=_size
                )
    return list(worst.values())


def _limit_check(name: str, item: Item, tag: Tag, scale: float, limit: float) -> Check:
    try:
        value = abs(item.value(tag)) * scale
    except FileError as error:
        return failed(name, str(error))
    note = f"line {tag.line}: {item.kind} on layer {item.layer}"
    return at_most(name, value, limit, "mm", note="" if value <= limit else note)


def _size(check: Check) -> float:
    return check.value if isinstance(check.value, float) else math.inf
