"""Whether one of our STEP files holds what its writer makes of a part, and nothing else."""

from __future__ import annotations

from camgeo.part.part import Part
from camgeo.verifying.verification import Check, failed, length_of
from camgeo_export.errors import FileError
from camgeo_export.part21.curves import Axes, Geometry
from camgeo_export.part21.model import Entity, Model
from camgeo_export.part21.parabola import Point
from camgeo_export.part21.solid import Solid
from camgeo_export.part21.text import Exchange, Record
from camgeo_export.verify.shell import is_flat

SCHEMA = "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }"

ORIGIN = Axes(Point(0j, 0.0), Point(0j, 1.0))
"""Where the solid is."""

UNCERTAINTY = 1e-7
"""That our files state [mm]."""

ROUNDING = 1e-9
"""By how much it may be off, relative, where the unit is another."""

ROOTS = {
    "SHAPE_DEFINITION_REPRESENTATION": 1,
    "APPLICATION_PROTOCOL_DEFINITION": 1,
    "PRODUCT_RELATED_PRODUCT_CATEGORY": 1,
}
"""What nothing refers to, and how many there are."""

FRAME = {
    "SHAPE_DEFINITION_REPRESENTATION": {0: "PRODUCT_DEFINITION_SHAPE"},
    "PRODUCT_DEFINITION_SHAPE": {2: "PRODUCT_DEFINITION"},
    "PRODUCT_DEFINITION": {2: "PRODUCT_DEFINITION_FORMATION", 3: "PRODUCT_DEFINITION_CONTEXT"},
    "PRODUCT_DEFINITION_FORMATION": {2: "PRODUCT"},
    "PRODUCT_DEFINITION_CONTEXT": {1: "APPLICATION_CONTEXT"},
    "PRODUCT_CONTEXT": {1: "APPLICATION_CONTEXT"},
    "APPLICATION_PROTOCOL_DEFINITION": {3: "APPLICATION_CONTEXT"},
}
"""What describes the product, with the types that its parameters refer to."""

LISTS = {
    "SHAPE_DEFINITION_REPRESENTATION": "ADVANCED_BREP_SHAPE_REPRESENTATION",
    "PRODUCT": "PRODUCT_CONTEXT",
    "PRODUCT_RELATED_PRODUCT_CATEGORY": "PRODUCT",
}
"""The same, of the last parameter, which may be a list of one."""

UNITS = ((None, "RADIAN"), (None, "STERADIAN"), ("MILLI", "METRE"))
"""The units of the SI, prefix and name."""


def header_of(exchange: Exchange, kind: str) -> Record:
    """A record of the header; FileError unless there is one."""
    found = [record for record in exchange.header if record.kind == kind]
    if len(found) != 1:
        raise FileError(f"the header has {kind} {len(found)} times, expected once")
    return found[0]


def contents_check(exchange: Exchange, model: Model, solid: Solid, part: Part, name: str) -> Check:
    """The schema, the product, the names of faces, and that nothing else is there."""
    try:
        _check_frame(exchange, solid, name)
        _check_product(model, solid, name)
        _check_roots(model)
        _check_names(solid, part)
    except FileError as error:
        return failed("contents", str(error))
    return Check("contents", "", f"{len(model.instances)} entities", ok=True)


def _check_frame(exchange: Exchange, solid: Solid, name: str) -> None:
    if header_of(exchange, "FILE_SCHEMA").values != ((SCHEMA,),):
        raise FileError("the schema is not that of our files")
    values = header_of(exchange, "FILE_DESCRIPTION").values
    lines = values[0] if values and isinstance(values[0], tuple) else ()
    last = lines[-1] if lines else None
    if not isinstance(last, str) or length_of(last.removeprefix("tolerance ")) is None:
        raise FileError("the description states no tolerance")
    if solid.products != (name,) or solid.name != name:
        raise FileError(f"the product is {', '.join(solid.products)[:60]!r}, not {name!r}")
    stated = solid.uncertainty
    if stated is None or abs(stated / UNCERTAINTY - 1.0) > ROUNDING:
        raise FileError(f"the uncertainty is {stated or 0.0:g} mm, not {UNCERTAINTY:g} mm")


def _check_product(model: Model, solid: Solid, name: str) -> None:
    """What describes the product, its units, and that the solid is where it is drawn."""
    for kind, places in FRAME.items():
        for each in model.all_of(kind):
            for place, wanted in places.items():
                model.entity(each.ref(place), wanted)
    for kind, wanted in LISTS.items():
        for each in model.all_of(kind):
            last = len(each.values) - 1
            listed = last >= 0 and isinstance(each.values[last], tuple)
            for ref in each.refs(last) if listed else (each.ref(last),):
                model.entity(ref, wanted)
    product = only(model, "PRODUCT")
    if product.text(0) != name:
        raise product.fault(f"has the number {product.text(0)[:60]!r}, not {name!r}")
    units = [unit.values for unit in model.all_of("SI_UNIT")]
    if len(units) != len(UNITS) or any(unit not in units for unit in UNITS):
        raise FileError("the units are not millimetre, radian and steradian")
    shape = only(model, "ADVANCED_BREP_SHAPE_REPRESENTATION")
    items = shape.refs(1)
    placed = len(items) == 2 and items[1] == solid.number
    if not placed or Geometry(model, 1.0).axes(items[0]) != ORIGIN:
        raise shape.fault("does not hold the solid in the axes of the part")


def only(model: Model, kind: str) -> Entity:
    """The only instance of a type; FileError unless there is one."""
    found = model.all_of(kind)
    if len(found) != 1:
        raise FileError(f"{len(found)} times {kind}, expected one")
    return found[0]


def _check_roots(model: Model) -> None:
    """Whatever is there belongs to the solid, its product or their units."""
    roots = model.all_of(*ROOTS)
    for kind, count in ROOTS.items():
        found = sum(root.kind == kind for root in roots)
        if found != count:
            raise FileError(f"{found} times {kind}, expected {count}")
    left = model.instances.keys() - model.reached(*(root.number for root in roots))
    if left:
        first = min(left)
        kind = model.instances[first][0].kind
        raise FileError(f"#{first}, {kind}, belongs to nothing; {len(left)} such entities")


def _check_names(solid: Solid, part: Part) -> None:
    """Walls have the names of boundaries, chamfers those of their edges, level faces those of
    levels; each is there.
    """
    walls = {face.name for face in solid.faces if not is_flat(face)}
    flat = {face.name for face in solid.faces if is_flat(face)}
    for found, wanted in (
        (walls, {each.name for each in part.outlines}),
        (flat, {level.name for level in part.levels}),
    ):
        if found != wanted:
            odd = sorted(found ^ wanted)[0][:60]
            raise FileError(f"the faces are named otherwise than the part's: {odd!r}")
