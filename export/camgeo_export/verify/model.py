"""What the model of a 3MF package must hold, by the clauses of the 3MF core specification 1.3.

The rules are those that strict readers like lib3mf apply to the core of a model; what extensions
add to it is not read. Coordinates and transforms are looked at before (`threemf.parts`), the mesh
itself is compared elsewhere.
"""

from __future__ import annotations

import io
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Final
from xml.etree import ElementTree as ET

from camgeo.wording import counted
from camgeo_export.errors import FileError
from camgeo_export.threemf.parts import PATH, PRODUCTION
from camgeo_export.threemf.writer import CORE

XML: Final = "{http://www.w3.org/XML/1998/namespace}"
LANGUAGE: Final = f"{XML}lang"
SPACE: Final = f"{XML}space"

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

TYPES: Final = ("model", "solidsupport", "support", "surface", "other")
"""Types of objects."""

METADATA: Final = (
    "Title", "Designer", "Description", "Copyright", "LicenseTerms", "Rating", "CreationDate",
    "ModificationDate", "Application",
)  # fmt: skip
"""Names of metadata without a namespace."""

COLOUR: Final = re.compile("#[0-9A-Fa-f]{6}([0-9A-Fa-f]{2})?")

LARGEST: Final = 2**31 - 1
"""Of ids and indices."""


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """A valid model.

    Attributes
    ----------
    root : its element.
    metadata : texts by name.
    objects : by their ids, in their order.
    items : what is built.
    """

    root: ET.Element
    metadata: Mapping[str, str]
    objects: Mapping[str, ET.Element]
    items: Sequence[ET.Element]


def fault(clause: str, what: str) -> FileError:
    """The error for what breaks a clause of the core specification."""
    return FileError(f"{what} (3MF core specification, {clause})")


def core(*tags: str) -> str:
    """The path of nested elements of the core specification."""
    return "/".join(f"{{{CORE}}}{tag}" for tag in tags)


def model_of(
    content: bytes,
    thumbnails: Collection[str] = (),
    own: Mapping[str, Collection[str]] | None = None,
) -> Model:
    """A model, if it is valid; raises FileError or SyntaxError with what is wrong.

    Parameters
    ----------
    thumbnails : names of the parts to which it has a relationship as a picture.
    own : its elements and their attributes, where it may have no others.
    """
    prefixes: dict[str, str] = {}
    root: ET.Element | None = None
    for event, item in ET.iterparse(io.BytesIO(content), events=("start-ns", "start")):
        if root is None and event == "start-ns":
            prefixes[item[0]] = item[1]
        elif root is None:
            root = item
    if root is None or root.tag != core("model"):
        raise FileError(f"its root is not the model of {CORE}")
    _check_elements(root, own or ATTRIBUTES, alone=own is not None)
    for prefix in root.get("requiredextensions", "").split():
        if prefixes.get(prefix) not in READ_EXTENSIONS:
            raise FileError(f"it requires the extension {prefix!r}, which is not read")
    for group in root.iter(core("metadatagroup")):
        _metadata(group, prefixes)
    metadata = _metadata(root, prefixes)
    order = [each.tag for each in root if each.tag in (core("resources"), core("build"))]
    if order != [core("resources"), core("build")]:
        raise fault("3.4", "it has not one element resources, and after it one element build")
    objects = _objects(root, thumbnails)
    return Model(root, metadata, objects, _items(root, objects))


def _check_elements(
    root: ET.Element, allowed: Mapping[str, Collection[str]], *, alone: bool
) -> None:
    """2.3.2: every element and attribute of the core namespace is known; there are no others if
    what is allowed stands `alone`.
    """
    name = core("")
    for each in root.iter():
        if SPACE in each.attrib:
            raise fault("2.3.4", "it has the attribute xml:space")
        if not each.tag.startswith(name):
            if alone:
                raise FileError(f"the element {each.tag} is not one of camgeo's")
            continue
        tag = each.tag.removeprefix(name)
        if tag not in allowed:
            raise fault("2.3.2", f"the element {tag} is not expected")
        for attribute in each.attrib:
            if attribute not in allowed[tag] and (alone or not attribute.startswith("{")):
                raise fault("2.3.2", f"the attribute {attribute} of {tag} is not expected")


def _metadata(holder: ET.Element, prefixes: Mapping[str, str]) -> dict[str, str]:
    """3.4.1: texts of the metadata by name. A name is there once, and one of `METADATA`, or has a
    namespace that the model declares.
    """
    found: dict[str, str] = {}
    for each in holder.findall(core("metadata")):
        name = each.get("name", "")
        prefix, colon, _ = name.partition(":")
        if name in found:
            raise fault("3.4.1", f"the metadata {name!r} appears twice")
        if prefix not in prefixes if colon else name not in METADATA:
            wanted = "neither one of 3MF's own nor of a namespace that the model declares"
            raise fault("3.4.1", f"the metadata {name!r} is {wanted}")
        found[name] = each.text or ""
    return found


def _objects(root: ET.Element, thumbnails: Collection[str]) -> dict[str, ET.Element]:
    """3.4.2: the objects by id. An id is unique among all resources, and what refers to a resource
    comes after it (3.4).
    """
    objects: dict[str, ET.Element] = {}
    groups: dict[str, int] = {}  # how many properties each has
    for each in root.iterfind(core("resources") + "/*"):
        key, own = each.get("id", ""), each.tag.startswith(core(""))
        if not 1 <= _number(key) <= LARGEST:
            if own:
                raise fault("3.4.2", f"the resource id {key!r} is not valid")
            continue  # not a resource: an extension may have other elements here
        if key in objects or key in groups:
            raise fault("3.4.2", f"the resource id {key!r} appears twice")
        if each.tag == core("object"):
            _check_object(each, objects, groups, thumbnails)
            objects[key] = each
        else:
            groups[key] = len(each)
    for base in root.iterfind(core("resources", "basematerials", "base")):
        if not COLOUR.fullmatch(base.get("displaycolor", "")):
            raise fault("5.1.1", f"{base.get('displaycolor')!r} is not a colour #RRGGBB")
    return objects


def _check_object(
    each: ET.Element,
    objects: Mapping[str, ET.Element],
    groups: Mapping[str, int],
    thumbnails: Collection[str],
) -> None:
    """4: an object is a mesh or has components; it refers to objects and groups before it."""
    name = f"the object {each.get('id')}"
    if each.get("type", "model") not in TYPES:
        raise fault("4", f"{each.get('type')!r} is not a type of object")
    shapes = [*each.findall(core("mesh")), *each.findall(core("components"))]
    if len(shapes) != 1:
        raise fault("4", f"{name} has {len(shapes)} meshes or lists of components, not one")
    picture = each.get("thumbnail")
    if picture is not None and picture not in thumbnails:
        raise fault("4", f"the thumbnail {picture!r} of {name} is not a part that the model names")
    if "pindex" in each.attrib and "pid" not in each.attrib:
        raise fault("4", f"{name} has a pindex and no pid")
    _check_properties(each, each.get("pid"), ("pindex",), groups, "4", name)
    for component in each.iterfind(core("components", "component")):
        other = component.get("objectid", "")
        if PATH not in component.attrib and other not in objects:
            raise fault(
                "4.2.1", f"{name} has the component {other!r}, which is no object before it"
            )
    count = len(each.findall(core("mesh", "vertices", "vertex")))
    for triangle in each.iterfind(core("mesh", "triangles", "triangle")):
        corners = [_number(triangle.get(corner)) for corner in ("v1", "v2", "v3")]
        if min(corners) < 0 or max(corners) >= count or len({*corners}) != len(corners):
            stated = ", ".join(str(triangle.get(corner)) for corner in ("v1", "v2", "v3"))
            wanted = f"not three different ones of its {counted(count, 'vertex', 'vertices')}"
            raise fault("4.1.4.1", f"a triangle of {name} has the corners {stated}, {wanted}")
        if len(triangle.attrib) > len(corners):
            pid = triangle.get("pid", each.get("pid"))
            _check_properties(triangle, pid, ("p1", "p2", "p3"), groups, "4.1.4.1", name)


def _check_properties(
    element: ET.Element,
    pid: str | None,
    indices: Sequence[str],
    groups: Mapping[str, int],
    clause: str,
    name: str,
) -> None:
    """That an element has properties of a group that there is."""
    if pid is None:
        return
    if pid not in groups:
        raise fault(clause, f"{name} has the properties {pid!r}, which do not come before it")
    for index in indices:
        if index in element.attrib and not 0 <= _number(element.get(index)) < groups[pid]:
            known = counted(groups[pid], "property", "properties")
            raise fault(clause, f"{name} has {index} = {element.get(index)!r} of {known}")


def _number(text: str | None) -> int:
    """A whole number from 0; -1 for any other text."""
    found = (text or "").strip()
    return int(found) if found.isascii() and found.isdecimal() else -1


def _items(root: ET.Element, objects: Mapping[str, ET.Element]) -> list[ET.Element]:
    """3.4.3: what is built, at least one object, and none of type "other", by itself or within
    another one.
    """
    items = root.findall(core("build", "item"))
    if not items:
        raise FileError("it builds nothing: its build has no item")
    others: set[str] = set()
    for key, each in objects.items():
        inner = [one.get("objectid") for one in each.iterfind(core("components", "component"))]
        if any(one in others for one in inner) or (not inner and each.get("type") == "other"):
            others.add(key)
    for item in items:
        key = item.get("objectid", "")
        if PATH in item.attrib:
            raise FileError("it builds an object of another part, which is not read")
        if key not in objects:
            raise fault("3.4.3.1", f"it builds the object {key!r}, which does not exist")
        if key in others:
            raise fault("3.4.3.1", f"it builds the object {key!r}, which is of type 'other'")
    return items
