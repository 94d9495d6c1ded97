"""Verification of drawings: our own, and those of any CAD program."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Final

from camgeo.design.product import Product
from camgeo.design.verify import Check, Origin, Reading, at_most, equal, failed, length_of, reported
from camgeo.errors import CamgeoError, FileError, GeometryError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.contour.exact import distance_between
from camgeo.geometry.contour.foreign import Outlines
from camgeo.geometry.contour.spline import SplineContour
from camgeo.part.part import Boundary
from camgeo.reading import DRAWING, check_text
from camgeo.scene.formats.dxf import FORMAT
from camgeo_export.drawing.writer import measure
from camgeo_export.dxf.items import Item, Tag
from camgeo_export.dxf.measure import MEASUREMENT
from camgeo_export.dxf.reader import Drawing, drawing_of, gaps_up_to
from camgeo_export.reading import CUT, AnyContour, layered
from camgeo_export.verify.plane import Shape, contour_checks, corners_of_contour, matched, shapes_of

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

COMMON: Final = (5, 8, 100, 330)
"""Groups of all our entities: handle, layer, subclass, owner."""

OURS: Final[Mapping[str, tuple[Collection[int], Sequence[str]]]] = {
    "LWPOLYLINE": ((10, 20, 42, 70, 90), ("AcDbPolyline",)),
    "CIRCLE": ((10, 20, 30, 40), ("AcDbCircle",)),
    "ARC": ((10, 20, 30, 40, 50, 51), ("AcDbCircle", "AcDbArc")),
    "LINE": ((10, 20, 30, 11, 21, 31), ("AcDbLine",)),
    "SPLINE": ((10, 20, 30, 40, 70, 71, 72, 73, 74), ("AcDbSpline",)),
}
"""Groups that our entities have besides those, and their subclasses after AcDbEntity."""

DEFAULTS: Final[Mapping[int, Collection[str]]] = {
    6: ("BYLAYER", "ByLayer"),
    38: ("0.0",),
    39: ("0.0",),
    43: ("0.0",),
    48: ("1.0",),
    60: ("0",),
    62: ("256",),
    210: ("0.0",),
    220: ("0.0",),
    230: ("1.0",),
    370: ("-1",),
}
"""Groups that may be stated with the value that holds by default."""

VALUES: Final[Mapping[tuple[str, int], str]] = {
    ("LWPOLYLINE", 70): "1",
    ("SPLINE", 70): "8",
    ("SPLINE", 74): "0",
}
"""Values of groups: a polyline is closed; a spline is planar, neither closed nor rational, and has
no fit points."""

STATED: Final[Mapping[str, Collection[int]]] = {"LWPOLYLINE": (90,), "SPLINE": (72, 73)}
"""Numbers of points, without which an entity is not valid although it can be read."""

MARKS: Final = 2
"""Lines of the mark of the cam axis."""

VERSION: Final = "AC1024"
"""Of the format of our drawings."""

HEADER: Final[Mapping[str, str]] = {"$ACADVER": VERSION, "$TILEMODE": "1", "$INSBASE": "0.0"}
"""Header variables of our drawings besides the units: the version; that the model space opens; that
a block made of the drawing is placed by its origin."""


def flat_checks(items: Iterable[Item], scale: float, limit: float) -> list[Check]:
    """That `items` lie at height 0 and have neither width nor thickness, within `limit` [mm].

    `scale` is in mm per unit of the drawing.
    """
    worst = {name: at_most(name, 0.0, limit, "mm") for name in ("elevation", "thickness", "width")}
    for each in (each for item in items for each in (item, *item.vertices)):
        wide = WIDTHS.get(each.kind, ())
        for tag in each.tags:
            name = "elevation" if tag.code in HEIGHTS else "width" if tag.code in wide else ""
            name = "thickness" if tag.code == THICKNESS else name
            if name and worst[name].value is not None:
                worst[name] = max(worst[name], _at_most(name, each, tag, scale, limit), key=_size)
    return list(worst.values())


def _at_most(name: str, item: Item, tag: Tag, scale: float, limit: float) -> Check:
    try:
        value = abs(item.value(tag)) * scale
    except FileError as error:
        return failed(name, str(error))
    note = f"line {tag.line}: {item.kind} on layer {item.layer}"
    return at_most(name, value, limit, "mm", note="" if value <= limit else note)


def _size(check: Check) -> float:
    return check.value if isinstance(check.value, float) else math.inf


def contents_check(drawing: Drawing, layers: Sequence[str]) -> Check:
    """That one of our drawings holds what our writer draws on `layers`, and nothing else."""
    try:
        _check_header(drawing)
        _check_layers(drawing, layers)
        _check_entities(drawing, layers)
    except FileError as error:
        return failed("contents", str(error))
    return Check("contents", "", f"{len(drawing.items)} entities", ok=True)


def _check_header(drawing: Drawing) -> None:
    for variable, wanted in HEADER.items():
        if (found := drawing.value(variable)) != wanted:
            raise FileError(f"{variable} is {found or 'not stated'}, not {wanted}")


def _check_layers(drawing: Drawing, layers: Sequence[str]) -> None:
    """Each layer is there once, and is neither off nor frozen nor locked."""
    for name in layers:
        records = [each for each in drawing.layers if each.text(2) == name]
        if len(records) != 1:
            raise FileError(f"the layer {name} appears {len(records)} times, not once")
        (record,) = records
        if record.number(70, 0.0) != 0.0 or record.number(62, 7.0) < 0.0:
            raise FileError(f"line {record.line}: the layer {name} is off, frozen or locked")
        if record.number(290, 1.0) != 1.0 or record.text(6, "Continuous").lower() != "continuous":
            raise FileError(f"line {record.line}: the layer {name} is not plotted as full lines")


def _check_entities(drawing: Drawing, layers: Sequence[str]) -> None:
    handles: set[str] = set()
    owners: set[str] = set()
    for item in drawing.items:
        codes = [tag.code for tag in item.tags]
        where = f"line {item.line}: {item.kind} on layer {item.layer}"
        if item.layer not in layers or item.kind not in OURS:
            raise FileError(f"{where} is not part of the drawing")
        groups, subclasses = OURS[item.kind]
        for tag in item.tags:
            known = tag.code in groups or tag.code in COMMON
            if not known and tag.value not in DEFAULTS.get(tag.code, ()):
                raise FileError(f"line {tag.line}: {item.kind} has the group {tag.code}")
            if VALUES.get((item.kind, tag.code), tag.value) != tag.value:
                what = f"{item.kind} has {tag.value} as its group {tag.code}"
                raise FileError(f"line {tag.line}: {what}")
        for code in (5, 8, 330, *STATED.get(item.kind, ())):
            if codes.count(code) != 1:
                raise FileError(f"{where} has the group {code} {codes.count(code)} times, not once")
        if [tag.value for tag in item.tags if tag.code == 100] != ["AcDbEntity", *subclasses]:
            raise FileError(f"{where} has other subclasses (group 100)")
        handle = item.text(5)
        if handle in handles:
            raise FileError(f"{where} has no handle of its own")
        handles.add(handle)
        owners.add(item.text(330))
    if len(owners) > 1:
        raise FileError(f"its entities have {len(owners)} owners, not one")
    missing = [name for name in layers if all(each.layer != name for each in drawing.items)]
    if missing:
        raise FileError(f"nothing on layer {', '.join(missing)}")
    marks = sum(each.layer == "CENTRE" for each in drawing.items)
    if "CENTRE" in layers and marks != MARKS:
        raise FileError(f"{marks} entities on layer CENTRE, not {MARKS}")


# -- sheet ----------------------------------------------------------------------------------------
# Verification of a sheet: its edges, and what its dimensions state.


FRAME: Final = "FRAME"
"""A layer that only sheets have."""


def is_sheet(drawing: Drawing) -> bool:
    """Whether a drawing of ours is a sheet, rather than contours to cut."""
    return any(item.layer == FRAME for item in drawing.items)


def sheet_checks(product: Product, data: bytes, tolerance: float) -> tuple[Check, ...]:
    """The edges of the front view and the dimensions against the part."""
    try:
        largest = measure(product, data)
    except CamgeoError as error:
        return (failed("contents", str(error)),)
    return (at_most("deviation", largest, tolerance, "mm", note="of edges and dimensions"),)
