"""Verification of drawings: our own, and those of any CAD program."""

from __future__ import annotations

import math
from dataclasses import replace

from camgeo.contour.contour import Contour
from camgeo.contour.exact import distance_between
from camgeo.contour.foreign import Outlines
from camgeo.contour.spline import SplineContour
from camgeo.errors import CamgeoError, GeometryError
from camgeo.formats.dxf import FORMAT
from camgeo.part.part import Boundary
from camgeo.product.product import Product
from camgeo.reading import DRAWING, check_text
from camgeo.verifying.verification import (
    Check,
    Origin,
    Reading,
    at_most,
    equal,
    failed,
    length_of,
    reported,
)
from camgeo_export.dxf.measure import MEASUREMENT
from camgeo_export.dxf.reader import Drawing, drawing_of, gaps_up_to
from camgeo_export.errors import FileError
from camgeo_export.layers import CUT, layered
from camgeo_export.matching import AnyContour
from camgeo_export.verify.entities import contents_check, flat_checks
from camgeo_export.verify.plane import contour_checks, matched
from camgeo_export.verify.shapes import Shape, corners_of_contour, shapes_of
from camgeo_export.verify.sheet import is_sheet, sheet_checks

HEAD_BYTES = 200_000
"""Part of a drawing that holds its header."""

AUXILIARY = ("PITCH_CURVE", "BASE_CIRCLE", "CENTRE")
"""Layers of our drawings besides those of the part, if auxiliary curves are drawn."""

EARLIER = "of an earlier version, which drew edges that do not go through on layer CUT too"

Boundaries = tuple[Boundary, ...]

NAMES = {"4": "mm", "1": "inch"}
"""Names of the units that $INSUNITS states."""


class DxfVerifier:
    """Verifies a DXF drawing."""

    format = "dxf"

    def origin(self, data: bytes) -> Origin:
        """From the custom document properties."""
        try:
            check_text(data, DRAWING, "the file")
        except FileError as error:
            return Origin(damage=str(error))
        lines = [line.strip() for line in data[:HEAD_BYTES].decode("cp1252", "replace").split("\n")]
        # 9, $CUSTOMPROPERTYTAG, 1, label, 9, $CUSTOMPROPERTY, 1, value
        places = [k for k, line in enumerate(lines) if line == "$CUSTOMPROPERTYTAG"]
        properties = {lines[k + 2]: lines[k + 6] for k in places if k + 6 < len(lines)}
        damage = "" if data.rstrip().endswith(b"EOF") else "not a complete DXF file: no EOF at end"
        if b"SECTION" not in data:
            damage = "not a DXF file: it has no section"
        if data.startswith(b"AutoCAD Binary DXF"):
            damage = "is a binary DXF; save it as text (ASCII)"
        return Origin(
            "camgeo" in properties,
            properties.get("scene", ""),
            length_of(properties.get("tolerance mm", "")),
            damage,
        )

    def checks(
        self, product: Product, data: bytes, reading: Reading, tolerance: float
    ) -> tuple[Check, ...]:
        """Unit, contents, and each closed contour against its boundary."""
        try:
            drawing = drawing_of(data, reading.name)
        except FileError as error:
            return (failed("file", str(error)),)
        checks = [_unit(drawing, product, reading)]
        if reading.ours and is_sheet(drawing):
            return (*checks, *sheet_checks(product, data, tolerance))
        layers = _layers_of(drawing, product) if reading.ours else {reading.layer: None}
        if reading.ours:
            checks.append(contents_check(drawing, (*map(str, layers), *_auxiliary_of(product))))
        if reading.ours and len(layers) == 1 < len(layered(product)):
            checks.append(reported("layers", CUT, note=EARLIER))
        try:
            read = {name: _contours(drawing, reading, name, tolerance) for name in layers}
        except CamgeoError as error:
            return (*checks, failed("closure", str(error)))
        gap = max(each.gap for each in read.values())
        checks.append(at_most("closure", gap, tolerance, "mm", note="largest gap between pieces"))
        notes = [note for each in read.values() for note in each.notes]
        checks += [reported("not compared", CUT, note=note) for note in notes]
        items = drawing.items if reading.ours else drawing.on(reading.layer)
        checks += flat_checks(items, drawing.scale(reading.unit), tolerance)
        for name, found in read.items():
            boundaries = layers[name] or product.drawn.part.boundaries
            shapes = shapes_of(boundaries, product.drawn.base_radius, tolerance)
            if found.loose and len(found.contours) < len(shapes):
                checks.append(failed("closure", found.loose))
            outline = found.contours[0]
            axis = "" if isinstance(outline, SplineContour) else found.off_axis(outline)
            if axis and not reading.ours:
                checks.append(reported("axis", "elsewhere", note=axis))
            pairs, count = matched(found.contours, shapes)
            checks.append(count if len(read) == 1 else replace(count, of=f"layer {name}"))
            for shape, contour in pairs:
                checks += contour_checks(shape, contour, tolerance, extra=gap + found.followed)
        if reading.ours and product.options[FORMAT].auxiliary:
            checks += _auxiliary(product, drawing, reading, tolerance)
            checks.append(_centre(drawing, tolerance))
        return tuple(checks)


def _unit(drawing: Drawing, product: Product, reading: Reading) -> Check:
    """The unit that the drawing states; in our own it must be the scene's."""
    stated = drawing.value("$INSUNITS") or "0"
    name = NAMES.get(stated)
    if name is None:
        if reading.unit is not None and stated == "0":
            return reported("unit", reading.unit, note="by --unit; the drawing does not state it")
        return (
            reported("unit", f"$INSUNITS {stated}")
            if not reading.ours
            else failed("unit", f"$INSUNITS is {stated}, which is not {product.unit}")
        )
    if not reading.ours:
        return reported("unit", name)
    if drawing.value("$MEASUREMENT") != MEASUREMENT[product.unit]:
        return failed("unit", f"$MEASUREMENT does not say {product.unit}")
    return equal("unit", name, product.unit, note=f"the scene is in {product.unit}")


def _layers_of(drawing: Drawing, product: Product) -> dict[str | None, Boundaries | None]:
    """The boundaries on each layer of the part in one of our drawings.

    Earlier versions drew all of them on layer CUT.
    """
    layers: dict[str | None, Boundaries | None] = {}
    layers.update(layered(product))
    earlier = set(layers).isdisjoint({item.layer for item in drawing.items} - {CUT})
    return {CUT: None} if earlier else layers


def _auxiliary_of(product: Product) -> tuple[str, ...]:
    """The layers that our writer makes besides those of the part."""
    if not product.options[FORMAT].auxiliary:
        return ()
    pitch = product.drawn.has_pitch_curve
    return tuple(name for name in AUXILIARY if pitch or name != "PITCH_CURVE")


def _contours(drawing: Drawing, reading: Reading, layer: str | None, tolerance: float) -> Outlines:
    """The closed contours of `layer`; in one of our drawings there is nothing else."""
    found = drawing.outlines(layer, reading.unit, gaps_up_to(tolerance), strict=reading.ours)
    return found.about(reading.origin)


def _auxiliary(
    product: Product, drawing: Drawing, reading: Reading, tolerance: float
) -> list[Check]:
    """The pitch curve, if there is one, and the base circle of our drawings."""
    checks = []
    if product.drawn.has_pitch_curve:
        try:
            (pitch,) = _contours(drawing, reading, "PITCH_CURVE", tolerance).contours
            checks += contour_checks(_pitch(product, tolerance), pitch, tolerance)
        except (CamgeoError, ValueError) as error:
            checks.append(failed("deviation", str(error), "pitch curve"))
    try:
        (circle,) = _contours(drawing, reading, "BASE_CIRCLE", tolerance).contours
        assert isinstance(circle, Contour)  # it is drawn as a circle
        exact = Contour.circle(product.drawn.base_radius)
        value = distance_between(exact, circle)
        checks.append(at_most("deviation", value, tolerance, "mm", "base circle"))
    except (CamgeoError, ValueError) as error:
        checks.append(failed("deviation", str(error), "base circle"))
    return checks


def _centre(drawing: Drawing, tolerance: float) -> Check:
    """The mark of the cam axis: lines whose middles lie on it."""
    lines = [each for each in drawing.items if each.layer == "CENTRE" and each.kind == "LINE"]
    try:
        middles = [
            complex(each.number(10) + each.number(11), each.number(20) + each.number(21))
            for each in lines
        ]
        half = 0.5 * drawing.scale()
    except (FileError, ValueError) as error:
        return failed("deviation", str(error), "centre mark")
    off = max((abs(middle) for middle in middles), default=math.inf)
    return at_most("deviation", half * off, tolerance, "mm", "centre mark")


def _pitch(product: Product, tolerance: float) -> Shape:
    """The pitch curve; its area is of no interest.

    Its corners and length are those of a fit as fine as the drawing's, if not finer: a coarser one
    of a steep move may not be provable.
    """

    def deviation(contour: AnyContour) -> float:
        if not isinstance(contour, Contour):
            raise GeometryError("is drawn as a spline, which camgeo never does")
        return product.drawn.pitch_deviation(contour)

    def polygon(within: float) -> Contour:
        points = product.drawn.pitch_contour(0.5 * within).contour.points(0.5 * within)
        return Contour.polygon(points)

    fine = min(tolerance, 1e-3 * product.drawn.base_radius)
    contour = product.drawn.pitch_contour(fine).contour
    corners = corners_of_contour(contour)
    return Shape("pitch curve", deviation, polygon, corners, contour.length, None)


VERIFIER = DxfVerifier()
