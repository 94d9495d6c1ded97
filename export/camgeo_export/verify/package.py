"""Whether other programs can read a 3MF package: its parts, and how they refer to each other; that
one of camgeo's holds what it should.

The rules are those of the Open Packaging Conventions (ECMA-376, part 2) and of the 3MF core
specification, as strict readers like lib3mf apply them; `verify.model` has those of the model.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final
from xml.etree import ElementTree as ET

from camgeo.product.plate import Piece
from camgeo.reading import number_of
from camgeo.verifying.verification import Check, failed
from camgeo_export.errors import FileError
from camgeo_export.threemf.writer import (
    CONTENT_TYPES,
    CONTENT_TYPES_PATH,
    MODEL_PATH,
    MODEL_RELATION,
    MODEL_TYPE,
    RELATIONSHIP_TYPE,
    RELATIONSHIPS,
    RELATIONSHIPS_PATH,
)
from camgeo_export.verify.model import LANGUAGE, core, fault, model_of

OUR_ATTRIBUTES: Final[Mapping[str, Collection[str]]] = {
    "model": ("unit", LANGUAGE),
    "metadata": ("name",),
    "resources": (),
    "object": ("id", "type", "name"),
    "mesh": (),
    "vertices": (),
    "vertex": ("x", "y", "z"),
    "triangles": (),
    "triangle": ("v1", "v2", "v3"),
    "build": (),
    "item": ("objectid",),
}
"""Those that our packages have."""

PLATE_ATTRIBUTES: Final[Mapping[str, Collection[str]]] = {
    **OUR_ATTRIBUTES,
    "basematerials": ("id",),
    "base": ("name", "displaycolor"),
    "object": ("id", "type", "name", "pid", "pindex"),
    "item": ("objectid", "transform"),
}
"""Those of our packages with a plate."""

IDENTIFIER: Final = re.compile(r"[A-Za-z_][\w.-]*")

SCHEME: Final = re.compile(r"[A-Za-z][\w+.-]*:")
"""How an address outside the package begins."""

THUMBNAIL: Final = f"{RELATIONSHIPS}/metadata/thumbnail"
PRINT_TICKET: Final = "http://schemas.microsoft.com/3dmanufacturing/2013/01/printticket"
TEXTURE: Final = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dtexture"
"""Types of relationships."""

PICTURES: Final = (THUMBNAIL, TEXTURE)
"""Those by which an object's thumbnail is named, the second one in older files."""

NEEDED: Final = (MODEL_RELATION, PRINT_TICKET, *PICTURES)
"""Those whose target must be in the package."""

ONCE: Final = {False: (MODEL_RELATION, THUMBNAIL), True: (PRINT_TICKET,)}
"""Those that a package has once, and those that a model has."""

TYPE_OF: Final[Mapping[str, Collection[str]]] = {
    MODEL_RELATION: (MODEL_TYPE,),
    THUMBNAIL: ("image/png", "image/jpeg"),
    PRINT_TICKET: ("application/vnd.ms-printing.printticket+xml",),
}
"""Content types of what relationships lead to (2.1.3 and appendix C)."""


def package_checks(
    parts: Mapping[str, bytes], ours: bool, name: str, plate: Sequence[Piece] = ()
) -> list[Check]:
    """That the package of these `parts` is complete and valid; one of `ours` must hold the part
    `name`, or the bodies of a `plate`.
    """
    try:
        path = model_path(parts)
        if ours:
            _require_our_parts(parts, path)
        pictures = [f"/{each.target}" for each in _relations(parts, path) if each.type in PICTURES]
    except (SyntaxError, ValueError) as error:
        return [failed("package", str(error))]
    checks = [Check("package", "", path, ok=True)]
    try:
        _check_model(parts[path], pictures, ours, name, plate)
    except (SyntaxError, ValueError) as error:
        return [*checks, failed("model", str(error))]
    return [*checks, Check("model", "", "valid", ok=True)]


def model_path(parts: Mapping[str, bytes]) -> str:
    """The part that holds the model; raises FileError unless the package leads to it, and all that
    it and the model refer to is there.
    """
    for name in (CONTENT_TYPES_PATH, RELATIONSHIPS_PATH):
        if name not in parts:
            raise FileError(f"it has no {name}: other programs do not read it")
    found = _relations(parts, "")
    models = [each.target for each in found if each.type == MODEL_RELATION]
    if len(models) != 1:
        raise FileError(f"{RELATIONSHIPS_PATH}: {len(models)} models are named, not one")
    types = _types(parts)
    for each in (*found, *_relations(parts, models[0])):
        _check_type(types, each.target, TYPE_OF.get(each.type, ()))
    _check_type(types, RELATIONSHIPS_PATH, (RELATIONSHIP_TYPE,))
    return models[0]


@dataclass(frozen=True, slots=True)
class _Relation:
    """A relationship: its type, and the part that it leads to."""

    type: str
    target: str


def _relations(parts: Mapping[str, bytes], source: str) -> list[_Relation]:
    """The relationships of a part, or of the package, whose name is empty.

    By OPC (ECMA-376-2, 9.3) each has an identifier of its own. By 2.1.1 of the core specification
    none leads out of the package, no two of a type lead to one part, and what must be there is; by
    2.1.2 to 2.1.4 there is one at most of the types in `ONCE`.
    """
    folder, name = posixpath.split(source)
    path = posixpath.join(folder, "_rels", f"{name}.rels")
    seen: set[str] = set()
    found: dict[_Relation, _Relation] = {}  # by what there may be once
    for element in _children(parts, path, RELATIONSHIPS, "Relationships") if path in parts else ():
        key, kind, target = (element.get(word, "") for word in ("Id", "Type", "Target"))
        if not IDENTIFIER.fullmatch(key) or key in seen:
            raise FileError(f"{path}: the Id {key!r} is not valid, or appears twice")
        seen.add(key)
        if not target or element.get("TargetMode") == "External" or SCHEME.match(target):
            raise fault("2.1.1", f"{path}: the target {target!r} is not in the package")
        whole = target if kind == MODEL_RELATION else posixpath.join("/", folder, target)
        relation = _Relation(kind, posixpath.normpath(whole).removeprefix("/"))
        if kind in NEEDED and (whole[0] != "/" or relation.target not in parts):
            raise fault("2.1.1", f"{path}: the target {target!r} is not in the package")
        once = replace(relation, target="") if kind in ONCE[bool(source)] else relation
        if once in found:
            raise fault("2.1", f"{path}: it has two relationships of the type {kind}")
        found[once] = relation
    return list(found.values())


def _children(parts: Mapping[str, bytes], path: str, namespace: str, root: str) -> list[ET.Element]:
    """The elements of a part, whose root must be `root` of the `namespace`."""
    try:
        found = ET.fromstring(parts[path])
    except SyntaxError as error:
        raise FileError(f"{path}: {error}") from None
    if found.tag != f"{{{namespace}}}{root}":
        raise FileError(f"{path}: its root is {found.tag}, not {root} of {namespace}")
    return list(found)


def _types(parts: Mapping[str, bytes]) -> dict[tuple[str, str], str]:
    """The content types that are stated, by extension or by part."""
    types: dict[tuple[str, str], str] = {}
    for each in _children(parts, CONTENT_TYPES_PATH, CONTENT_TYPES, "Types"):
        kind = each.tag.rpartition("}")[2]
        key = each.get({"Default": "Extension", "Override": "PartName"}.get(kind, ""), "").lower()
        if not key or (kind, key) in types:
            raise FileError(
                f"{CONTENT_TYPES_PATH}: {kind} {key!r} is not expected, or appears twice"
            )
        types[kind, key] = each.get("ContentType", "")
    return types


def _check_type(types: Mapping[tuple[str, str], str], part: str, allowed: Collection[str]) -> None:
    """That the content type of a part is one of those that its kind may have, if there are any."""
    extension = posixpath.splitext(part.lower())[1].removeprefix(".")
    extension = extension or posixpath.basename(part).removeprefix(".")
    by_extension = types.get(("Default", extension), "")
    found = types.get(("Override", f"/{part.lower()}"), by_extension)
    if allowed and found not in allowed:
        what = f"the type of {part} is {found or 'not stated'}"
        raise FileError(f"{CONTENT_TYPES_PATH}: {what}, not {' or '.join(allowed)}")


def _require_our_parts(parts: Mapping[str, bytes], path: str) -> None:
    own = (CONTENT_TYPES_PATH, RELATIONSHIPS_PATH, MODEL_PATH)
    foreign = [name for name in parts if name not in own]
    if foreign or path != MODEL_PATH:
        raise FileError(f"{foreign[0] if foreign else path} is not a part of camgeo's packages")


def _check_model(
    content: bytes, thumbnails: Collection[str], ours: bool, name: str, plate: Sequence[Piece]
) -> None:
    """Raise FileError or SyntaxError unless the model is valid, and ours as it should be."""
    if not ours:
        model_of(content, thumbnails)
        return
    model = model_of(content, own=PLATE_ATTRIBUTES if plate else OUR_ATTRIBUTES)
    objects = list(model.objects.values())
    if any(each.get("type", "model") != "model" for each in objects):
        raise FileError("not all of its objects are models")
    if model.metadata.get("Title") != name:
        raise FileError(f"its title is named {model.metadata.get('Title')!r}, not {name!r}")
    if plate:
        _check_plate(model.root, objects, model.items, plate)
    else:
        _check_one(objects, model.items, name)


def _check_one(objects: Sequence[ET.Element], items: Sequence[ET.Element], name: str) -> None:
    if len(objects) != 1 or len(items) != 1:
        raise FileError(f"it has {len(objects)} objects, built {len(items)} times, not one")
    if objects[0].get("name") != name:
        raise FileError(f"its object is named {objects[0].get('name')!r}, not {name!r}")


def _check_plate(
    root: ET.Element,
    objects: Sequence[ET.Element],
    items: Sequence[ET.Element],
    plate: Sequence[Piece],
) -> None:
    """Each body is there once, with its name and colour, and stands where it should."""
    if len(objects) != len(plate) or len(items) != len(plate):
        found = f"{len(objects)} objects, built {len(items)} times"
        raise FileError(f"it has {found}, not the {len(plate)} of the plate")
    groups = root.findall(core("resources", "basematerials"))
    colours = [dict(base.attrib) for group in groups for base in group]
    if colours != [{"name": each.name, "displaycolor": each.colour} for each in plate]:
        raise FileError("its colours are not those of the bodies on the plate")
    own = groups[0].get("id", "")
    for number, (each, item, piece) in enumerate(zip(objects, items, plate, strict=True)):
        if each.get("name") != piece.name:
            raise FileError(f"an object is named {each.get('name')!r}, not {piece.name!r}")
        if (each.get("pid"), each.get("pindex")) != (own, str(number)):
            raise FileError(f"the {piece.name} has not its colour")
        words = item.get("transform", "").split(" ")
        wanted = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, piece.x, piece.y, 0.0]
        if item.get("objectid") != each.get("id") or [number_of(word) for word in words] != wanted:
            raise FileError(f"the {piece.name} does not stand at ({piece.x:g}, {piece.y:g}) mm")
