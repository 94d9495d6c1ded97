"""Whether other programs can read a 3MF package: its parts, how they refer to each other, and what
the model holds.

The rules are those of the Open Packaging Conventions (ECMA-376, part 2) and of the 3MF core
specification, as strict readers like lib3mf apply them. The mesh itself is compared elsewhere.
"""

from __future__ import annotations

import io
import posixpath
import re
from collections.abc import Collection, Mapping, Sequence
from typing import Final
from xml.etree import ElementTree as ET

from camgeo.product.plate import Piece
from camgeo.reading import number_of
from camgeo.verifying.verification import Check, failed
from camgeo_export.errors import FileError
from camgeo_export.threemf.parts import PATH, PRODUCTION
from camgeo_export.threemf.writer import (
    CONTENT_TYPES,
    CONTENT_TYPES_PATH,
    CORE,
    MODEL_PATH,
    MODEL_RELATION,
    MODEL_TYPE,
    RELATIONSHIP_TYPE,
    RELATIONSHIPS,
    RELATIONSHIPS_PATH,
)

LANGUAGE: Final = "{http://www.w3.org/XML/1998/namespace}lang"

READ_EXTENSIONS: Final = (PRODUCTION,)
"""Namespaces of the extensions that a model may require: they only spread it over several files."""

ATTRIBUTES: Final[Mapping[str, Collection[str]]] = {
    "model": ("unit", LANGUAGE, "requiredextensions", "recommendedextensions", "thumbnail"),
    "metadata": ("name", "preserve", "type"),
    "metadatagroup": (),
    "resources": (),
    "basematerials": ("id",),
    "base": ("name", "displaycolor"),
    "object": ("id", "type", "name", "partnumber", "pid", "pindex", "thumbnail"),
    "mesh": (),
    "vertices": (),
    "vertex": ("x", "y", "z"),
    "triangles": (),
    "triangle": ("v1", "v2", "v3", "p1", "p2", "p3", "pid"),
    "components": (),
    "component": ("objectid", "transform"),
    "build": (),
    "item": ("objectid", "transform", "partnumber"),
}
"""Elements of the core specification, each with its attributes."""

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

TYPES: Final = ("model", "solidsupport", "support", "surface", "other")
"""Types of objects."""

METADATA: Final = (
    "Title", "Designer", "Description", "Copyright", "LicenseTerms", "Rating", "CreationDate",
    "ModificationDate", "Application",
)  # fmt: skip
"""Names of metadata without a namespace."""

IDENTIFIER: Final = re.compile(r"[A-Za-z_][\w.-]*")


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
        content = parts[path]
    except (SyntaxError, ValueError) as error:
        return [failed("package", str(error))]
    checks = [Check("package", "", path, ok=True)]
    try:
        _check_model(content, ours, name, plate)
    except (SyntaxError, ValueError) as error:
        return [*checks, failed("model", str(error))]
    return [*checks, Check("model", "", "valid", ok=True)]


def model_path(parts: Mapping[str, bytes]) -> str:
    """The part that holds the model; raises FileError unless the package leads to it."""
    for name in (CONTENT_TYPES_PATH, RELATIONSHIPS_PATH):
        if name not in parts:
            raise FileError(f"it has no {name}: other programs do not read it")
    relations = _children(parts, RELATIONSHIPS_PATH, RELATIONSHIPS, "Relationships")
    seen: set[str] = set()
    for relation in relations:
        key = relation.get("Id", "")
        if not IDENTIFIER.fullmatch(key) or key in seen:
            raise FileError(f"{RELATIONSHIPS_PATH}: the Id {key!r} is not valid, or appears twice")
        seen.add(key)
    targets = [each.get("Target", "") for each in relations if each.get("Type") == MODEL_RELATION]
    if len(targets) != 1:
        raise FileError(f"{RELATIONSHIPS_PATH}: {len(targets)} models are named, not one")
    path = targets[0].removeprefix("/")
    if not targets[0].startswith("/") or path not in parts:
        raise FileError(f"{RELATIONSHIPS_PATH}: the model {targets[0]!r} is not in the package")
    _check_types(parts, path)
    return path


def _children(parts: Mapping[str, bytes], path: str, namespace: str, root: str) -> list[ET.Element]:
    """The elements of a part, whose root must be `root` of the `namespace`."""
    try:
        found = ET.fromstring(parts[path])
    except SyntaxError as error:
        raise FileError(f"{path}: {error}") from None
    if found.tag != f"{{{namespace}}}{root}":
        raise FileError(f"{path}: its root is {found.tag}, not {root} of {namespace}")
    return list(found)


def _check_types(parts: Mapping[str, bytes], path: str) -> None:
    """The content types of the model and of the relationships are stated."""
    types: dict[tuple[str, str], str] = {}
    for each in _children(parts, CONTENT_TYPES_PATH, CONTENT_TYPES, "Types"):
        kind = each.tag.rpartition("}")[2]
        key = each.get({"Default": "Extension", "Override": "PartName"}.get(kind, ""), "").lower()
        if not key or (kind, key) in types:
            raise FileError(
                f"{CONTENT_TYPES_PATH}: {kind} {key!r} is not expected, or appears twice"
            )
        types[kind, key] = each.get("ContentType", "")
    for part, wanted in ((path, MODEL_TYPE), (RELATIONSHIPS_PATH, RELATIONSHIP_TYPE)):
        extension = posixpath.splitext(part.lower())[1].removeprefix(".")
        extension = extension or posixpath.basename(part).removeprefix(".")
        by_extension = types.get(("Default", extension), "")
        found = types.get(("Override", f"/{part.lower()}"), by_extension)
        if found != wanted:
            what = f"the type of {part} is {found or 'not stated'}"
            raise FileError(f"{CONTENT_TYPES_PATH}: {what}, not {wanted}")


def _require_our_parts(parts: Mapping[str, bytes], path: str) -> None:
    own = (CONTENT_TYPES_PATH, RELATIONSHIPS_PATH, MODEL_PATH)
    foreign = [name for name in parts if name not in own]
    if foreign or path != MODEL_PATH:
        raise FileError(f"{foreign[0] if foreign else path} is not a part of camgeo's packages")


def _check_model(content: bytes, ours: bool, name: str, plate: Sequence[Piece]) -> None:
    """Raise FileError or SyntaxError unless the model is valid."""
    prefixes: dict[str, str] = {}
    root: ET.Element | None = None
    for event, item in ET.iterparse(io.BytesIO(content), events=("start-ns", "start")):
        if event == "start-ns":
            prefixes[item[0]] = item[1]
        elif root is None:
            root = item
    if root is None or root.tag != f"{{{CORE}}}model":
        raise FileError(f"its root is not the model of {CORE}")
    own = PLATE_ATTRIBUTES if plate else OUR_ATTRIBUTES
    _check_elements(root, own if ours else ATTRIBUTES, ours)
    for prefix in root.get("requiredextensions", "").split():
        if prefixes.get(prefix) not in READ_EXTENSIONS:
            raise FileError(f"it requires the extension {prefix!r}, which is not read")
    metadata = _metadata(root, prefixes)
    objects = _objects(root)
    items = root.findall(f"{{{CORE}}}build/{{{CORE}}}item")
    if len(root.findall(f"{{{CORE}}}build")) != 1 or not items:
        raise FileError("it builds nothing: its build has no item")
    for each in items:
        if PATH in each.attrib:
            raise FileError("it builds an object of another part, which is not read")
        if each.get("objectid", "") not in objects:
            raise FileError(f"it builds the object {each.get('objectid')!r}, which does not exist")
        found = objects[each.get("objectid", "")]
        if found.get("type", "model") != "model":
            raise FileError(
                f"the object that it builds is of type {found.get('type')!r}, not a model"
            )
    if ours and plate:
        _check_plate(root, list(objects.values()), items, plate)
        _check_title(metadata, name)
    elif ours:
        _check_ours(metadata, list(objects.values()), items, name)


def _check_elements(root: ET.Element, allowed: Mapping[str, Collection[str]], ours: bool) -> None:
    """Every element and attribute of the core namespace is known; ours has no others."""
    core = f"{{{CORE}}}"
    for each in root.iter():
        if not each.tag.startswith(core):
            if ours:
                raise FileError(f"the element {each.tag} is not one of camgeo's")
            continue
        tag = each.tag.removeprefix(core)
        if tag not in allowed:
            raise FileError(f"the element {tag} is not expected")
        for attribute in each.attrib:
            if attribute not in allowed[tag] and (ours or not attribute.startswith("{")):
                raise FileError(f"the attribute {attribute} of {tag} is not expected")


def _metadata(root: ET.Element, prefixes: Mapping[str, str]) -> dict[str, str]:
    """Texts of the metadata by name, each of which is known and there once."""
    found: dict[str, str] = {}
    for each in root.findall(f"{{{CORE}}}metadata"):
        name = each.get("name", "")
        prefix, colon, _ = name.partition(":")
        if name in found or (prefix not in prefixes if colon else name not in METADATA):
            raise FileError(f"the metadata {name!r} is not expected, or appears twice")
        found[name] = each.text or ""
    return found


def _objects(root: ET.Element) -> dict[str, ET.Element]:
    """The objects by their ids, which are positive whole numbers and unique."""
    found: dict[str, ET.Element] = {}
    for each in root.findall(f"{{{CORE}}}resources/{{{CORE}}}object"):
        key = each.get("id", "")
        if not re.fullmatch(r"[1-9]\d{0,8}", key) or key in found:
            raise FileError(f"the object id {key!r} is not valid, or appears twice")
        if each.get("type", "model") not in TYPES:
            raise FileError(f"{each.get('type')!r} is not a type of object")
        found[key] = each
    return found


def _check_ours(
    metadata: Mapping[str, str],
    objects: Sequence[ET.Element],
    items: Sequence[ET.Element],
    name: str,
) -> None:
    if len(objects) != 1 or len(items) != 1:
        raise FileError(f"it has {len(objects)} objects, built {len(items)} times, not one")
    _check_title(metadata, name)
    if objects[0].get("name") != name:
        raise FileError(f"its object is named {objects[0].get('name')!r}, not {name!r}")


def _check_title(metadata: Mapping[str, str], name: str) -> None:
    if metadata.get("Title") != name:
        raise FileError(f"its title is named {metadata.get('Title')!r}, not {name!r}")


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
    groups = root.findall(f"{{{CORE}}}resources/{{{CORE}}}basematerials")
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
