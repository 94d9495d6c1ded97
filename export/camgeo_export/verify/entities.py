"""What a drawing holds besides the shape of its curves: heights, widths, and what is not drawn."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Final

from camgeo.verifying.verification import Check, at_most, failed
from camgeo_export.dxf.items import Item, Tag
from camgeo_export.dxf.reader import Drawing
from camgeo_export.errors import FileError

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
