"""Verification of 3MF packages, ours and others."""

from __future__ import annotations

import graphlib
import io
import posixpath
import re
import struct
import zipfile
import zlib
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain
from typing import Final
from xml.etree import ElementTree as ET

import numpy as np

from camgeo.design.plate import PlatePiece, plate_pieces
from camgeo.design.product import Product
from camgeo.design.verify import Check, Origin, ReadingOptions, failed, parse_tolerance, unit_check
from camgeo.errors import FileError
from camgeo.numeric.arrays import FloatArray, IntArray
from camgeo.reading import COORDINATE, FACETS, Limits, beyond, check_size, parse_number
from camgeo.units import counted
from camgeo_export.reading import NUMBER_SLACK, text_tokens
from camgeo_export.verify.body import body_checks, checks_of_body, compensation_checks

PACKAGE: Final = Limits("3MF package", 16_000_000)

MEMBERS: Final = 1_000
"""Most files in a package."""

OBJECTS: Final = 1_000
"""Most objects of a package."""

UNPACKED: Final = 40_000_000
"""Most bytes of all files of a package, unpacked."""

RATIO: Final = 200
"""Factor by which a file of a package may grow on unpacking; meshes grow tenfold."""

ELEMENTS: Final = 250_000
"""Most elements of the XML in a package, opening and closing tags counted as one."""

ATTRIBUTES: Final = 800_000
"""Most attributes of all these elements."""

TAG: Final = 4_000
"""Most characters of one of their tags."""

CORE: Final = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
CONTENT_TYPES: Final = "http://schemas.openxmlformats.org/package/2006/content-types"
RELATIONSHIPS: Final = "http://schemas.openxmlformats.org/package/2006/relationships"
MODEL_TYPE: Final = "application/vnd.ms-package.3dmanufacturing-3dmodel+xml"
RELATIONSHIP_TYPE: Final = "application/vnd.openxmlformats-package.relationships+xml"
MODEL_RELATION: Final = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
MODEL_PATH: Final = "3D/3dmodel.model"
CONTENT_TYPES_PATH: Final = "[Content_Types].xml"
RELATIONSHIPS_PATH: Final = "_rels/.rels"
"""Names of the specifications, repeated rather than shared with the writer, so that an error there
shows here."""

MM_PER_UNIT = {
    "micron": 1e-3,
    "millimeter": 1.0,
    "centimeter": 10.0,
    "inch": 25.4,
    "foot": 304.8,
    "meter": 1000.0,
}
"""Units of the 3MF core specification; a model without one is in millimetres."""

SHORT = {"millimeter": "mm"}

MODEL = ".model"

OURS = "camgeo "
"""How the name of the application begins in our packages."""


class ThreeMfVerifier:
    """Verifies a 3MF package."""

    format = "3mf"
    slack = NUMBER_SLACK

    def tokens(self, data: bytes) -> Iterator[tuple[str, str]]:
        """The tokens of the elements of all parts."""
        for name, part in sorted(unpack_parts(data).items()):
            yield name, name
            for number, element in enumerate(part.split(b"<")):
                yield from text_tokens(element, f"{name}, element {number}")

    def origin(self, data: bytes) -> Origin:
        """The origin that the metadata of the model state."""
        try:
            parts = unpack_parts(data)
            check_bodies(parts)
            _, metadata = _head(parts)
        except (SyntaxError, FileError) as error:
            return Origin(damage=f"not a complete 3MF package: {error}")
        application = metadata.get("Application", "")
        return Origin(
            application.removeprefix(OURS) if application.startswith(OURS) else "",
            metadata.get("camgeo:scene", ""),
            parse_tolerance(metadata.get("camgeo:tolerance", "")),
        )

    def checks(
        self, product: Product, data: bytes, reading: ReadingOptions, tolerance: float
    ) -> tuple[Check, ...]:
        """Package, unit, and the body against the part."""
        parts = unpack_parts(data)
        valid = package_checks(parts)
        unit, metadata = _head(parts)
        plate = plate_pieces(product) if metadata.get("Application", "").startswith(OURS) else ()
        check = unit_check(SHORT.get(unit, unit), reading)
        scale = MM_PER_UNIT.get(unit)
        if scale is None:
            return (*valid, check, failed("unit", f"{unit!r} is not a unit of 3MF"))
        if plate:
            checks = plate_checks(plate, parts, _model(parts), scale, tolerance)
            return (*valid, check, *compensation_checks(product), *checks)
        # A name that trimesh looks for, before all others, and that no part of a package has.
        whole = packed({f"/{MODEL_PATH}": _model(parts), **parts})
        compare = partial(body_checks, product, tolerance=tolerance)
        return (*valid, check, *_mesh_checks(whole, scale, compare))


def _head(parts: Mapping[str, bytes]) -> tuple[str, dict[str, str]]:
    """Unit and metadata of the model; raises FileError or SyntaxError if there is none."""
    model = _model(parts)
    metadata: dict[str, str] = {}
    unit = "millimeter"
    for event, element in ET.iterparse(io.BytesIO(model), events=("start", "end")):
        if event == "start" and element.tag == core("model"):
            unit = element.get("unit", unit)
        elif event == "start" and element.tag in (core("resources"), core("build")):
            break
        elif event == "end" and element.tag == core("metadata"):
            metadata[element.get("name", "")] = element.text or ""
    return unit, metadata


def _model(parts: Mapping[str, bytes]) -> bytes:
    """The model that the package leads to: there may be others, in other units. The first one of a
    package that is not valid, which its checks report.
    """
    try:
        return parts[model_path(parts)]
    except FileError:
        models = [part for name, part in parts.items() if name.lower().endswith(MODEL)]
    if not models:
        raise FileError("it contains no model")
    return models[0]


def _mesh_checks(
    data: bytes, scale: float, compare: Callable[[FloatArray, IntArray], list[Check]]
) -> list[Check]:
    """The checks that `compare` makes of the vertices (n, 3) [mm] and triangles (m, 3) of a package
    whose unit is `scale` [mm]; a failed one if it has no mesh.
    """
    import trimesh  # a build measures its meshes without

    try:
        with np.errstate(all="ignore"):  # transforms may overflow, which is seen in the vertices
            mesh = trimesh.load_mesh(io.BytesIO(data), file_type="3mf", process=False)
        vertices, triangles = np.array(mesh.vertices), np.array(mesh.faces)
    except Exception as error:  # what trimesh raises for damaged files is not documented
        return [failed("file", f"no mesh: {error}")]
    return compare(vertices * scale, triangles)


VERIFIER = ThreeMfVerifier()


# -- parts ----------------------------------------------------------------------------------------
# The parts of a 3MF package, unpacked within limits, and a check of what its bodies consist of.
#
# A damaged package, one that unpacks to more than allowed, and XML that refers to anything outside
# itself are refused before they are parsed.


NAME: Final = "the package"

ENTRY: Final = b"PK\x01\x02"
"""First bytes of the entry of a file in the directory of a package."""

METHODS: Final = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""Compressions that 3MF allows."""

ENCRYPTED: Final = 0x1

DAMAGED: Final = (
    *(zipfile.BadZipFile, zlib.error, struct.error, EOFError),
    *(ValueError, OSError, OverflowError),  # places outside the file, names
)
"""Errors of zipfile at a package that cannot be unpacked."""

SMALL: Final = 100_000
"""Bytes of a part that may be packed at any ratio."""

PARSED: Final = (".model", ".rels", ".xml")
"""Endings of the parts that are parsed."""

ENCODING: Final = re.compile(rb"(?:\xef\xbb\xbf)?\s*<\?xml[^>]{0,200}encoding\s*=\s*['\"]([^'\"]*)")

LONG: Final = re.compile(rb"<[^<>!?][^<>]{%d}" % TAG)
"""A tag of too many characters; comments may be long."""

UTF8: Final = (b"utf-8", b"utf8")

PRODUCTION: Final = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
"""Namespace of the extension that spreads a model over several parts."""

PATH: Final = f"{{{PRODUCTION}}}path"
"""Attribute that says in which part the object of a component or an item is."""

VERTEX: Final = f"{{{CORE}}}vertex"
"""Tag of a vertex of a mesh; those of extensions, such as slices, have other coordinates."""

TRANSFORM: Final = 12
"""Numbers of a transform (3.3 of the 3MF core specification)."""

Key = tuple[str, str]
"""Part and id of an object."""


def unpack_parts(data: bytes) -> dict[str, bytes]:
    """The parts of a package by name; FileError if it is damaged or beyond the limits."""
    check_size(len(data), PACKAGE, NAME)
    count = data.count(ENTRY)
    if count > MEMBERS:
        raise beyond(NAME, counted(count, "part"), MEMBERS, PACKAGE)
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as package:
            entries = package.infolist()
            _check_entries(entries)
            parts = {entry.filename: _unpacked(package, entry) for entry in entries}
    except FileError:
        raise
    except DAMAGED as error:
        raise FileError(f"cannot be unpacked: {error}") from None
    _check_xml({name: part for name, part in parts.items() if name.lower().endswith(PARSED)})
    return parts


def _check_entries(entries: Collection[zipfile.ZipInfo]) -> None:
    """Raise FileError unless all parts have proper names, and may be unpacked."""
    seen: set[str] = set()
    for entry in entries:
        name = entry.filename
        if name.startswith("/") or "\\" in name or ".." in name.split("/") or "\0" in name:
            raise FileError(f"the name {name[:60]!r} leads out of the package")
        if name.lower() in seen:
            raise FileError(f"it has two parts named {name[:60]}")
        seen.add(name.lower())
        if entry.flag_bits & ENCRYPTED:
            raise FileError(f"the part {name[:60]} is encrypted")
        if entry.compress_type not in METHODS:
            method = f"the compression method {entry.compress_type}"
            raise FileError(f"the part {name[:60]} has {method}, which 3MF does not allow")
        if entry.file_size > max(RATIO * entry.compress_size, SMALL):
            ratio = (
                f"unpacks to {entry.file_size / max(entry.compress_size, 1):,.0f} times its size"
            )
            raise FileError(f"the part {name[:60]} {ratio}; allowed: {RATIO} times")
    total = sum(entry.file_size for entry in entries)
    if total > UNPACKED:
        raise beyond(NAME, counted(total, "byte") + " unpacked", UNPACKED, PACKAGE)


def _unpacked(package: zipfile.ZipFile, entry: zipfile.ZipInfo) -> bytes:
    """A part; no more of it is unpacked than the directory states."""
    with package.open(entry) as stream:
        data = stream.read(entry.file_size + 1)
    if len(data) != entry.file_size:
        raise FileError(f"the part {entry.filename[:60]} is not as long as the package states")
    return data


def _check_xml(parts: Mapping[str, bytes]) -> None:
    """Raise FileError unless the parts may be parsed: UTF-8, without references, not too many
    elements.
    """
    for name, content in parts.items():
        declaration = ENCODING.match(content)
        if (declaration is not None and declaration[1].lower() not in UTF8) or b"\0" in content:
            raise FileError(f"{name}: is not encoded as UTF-8")
        if b"<!DOCTYPE" in content or b"<!ENTITY" in content:
            raise FileError(f"{name}: has a document type declaration, which 3MF forbids")
        if LONG.search(content) is not None:
            raise FileError(f"{name}: has a tag of more than {TAG:,} characters")
    # Counted before anything is parsed: an element has two tags at most.
    for what, mark, most in (
        ("tag", b"<", 2 * ELEMENTS),
        ("attribute", b"=", ATTRIBUTES),
    ):
        count = sum(content.count(mark) for content in parts.values())
        if count > most:
            raise beyond(NAME, counted(count, what), most, PACKAGE)


def packed(parts: Mapping[str, bytes]) -> bytes:
    """A package of these parts, not compressed."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as package:
        for name, part in parts.items():
            package.writestr(zipfile.ZipInfo(name), part)
    return stream.getvalue()


def check_bodies(parts: Mapping[str, bytes]) -> None:
    """Check the objects that a package builds, before any of them is read.

    Raises
    ------
    FileError
        If an object contains itself, the objects with all their copies have too many facets, or a
        coordinate is too large. SyntaxError if a model is no XML.
    """
    facets: dict[Key, int] = {}
    inside: dict[Key, list[Key]] = {}
    built: list[Key] = []
    for name, content in parts.items():
        if not name.lower().endswith(".model"):
            continue
        for kind, key, number, inner in _bodies(content, name):
            if kind == "item":
                built += inner
                continue
            if len(facets) >= OBJECTS:
                raise beyond(NAME, f"more than {OBJECTS:,} objects", OBJECTS, PACKAGE)
            facets[key] = facets.get(key, 0) + number
            inside.setdefault(key, []).extend(inner)
    absent = next((key for key in (*built, *chain(*inside.values())) if key not in facets), None)
    if absent is not None:
        raise FileError(f"it builds the object {absent[1]!r:.40}, which does not exist")
    try:
        order = list(graphlib.TopologicalSorter(inside).static_order())
    except graphlib.CycleError as error:
        raise FileError(f"the object {error.args[1][0][1]} contains itself") from None
    # Inner objects come first, so their totals are complete.
    for key in order:
        facets[key] += sum(facets[other] for other in inside[key])
    total = sum(facets[key] for key in built)
    if total > FACETS:
        raise beyond(NAME, counted(total, "facet"), FACETS, PACKAGE)


def _bodies(content: bytes, name: str) -> Iterator[tuple[str, Key, int, list[Key]]]:
    """Each object of a model with its facets and the objects in it; each item with its object."""
    key, facets, inner = (name, ""), 0, list[Key]()
    for event, item in ET.iterparse(io.BytesIO(content), events=("start", "end")):
        tag = item.tag.rpartition("}")[2]
        if event == "start":
            if tag == "object":
                key, facets, inner = (name, item.get("id", "")), 0, []
            continue
        if tag == "triangle":
            facets += 1
        elif item.tag == VERTEX:
            _check_numbers((item.get("x"), item.get("y"), item.get("z")), "a vertex")
        elif tag in ("component", "item"):
            if "transform" in item.attrib:
                numbers, what = item.get("transform", "").split(), f"the transform of a {tag}"
                _check_numbers(numbers, what)
                if len(numbers) != TRANSFORM:
                    raise FileError(
                        f"{what} has {counted(len(numbers), 'number')}, not {TRANSFORM}"
                    )
            path = posixpath.normpath(item.get(PATH, name)).removeprefix("/")
            inner.append((path, item.get("objectid", "")))
            if tag == "item":
                yield "item", key, 0, inner
                inner = []
        elif tag == "object":
            yield "object", key, facets, inner
            key, facets, inner = (name, ""), 0, []
        item.clear()


def _check_numbers(texts: Collection[str | None], what: str) -> None:
    for text in texts:
        if text is None or parse_number(text) is None:
            quoted = "nothing" if text is None else repr(text[:40])
            raise FileError(f"{what} has {quoted}, which is not a number of at most {COORDINATE:g}")


# -- model ----------------------------------------------------------------------------------------
# What the model of a 3MF package must hold, by the clauses of the 3MF core specification 1.3.
#
# The rules are those that strict readers like lib3mf apply to the core of a model; what extensions
# add to it is not read. Coordinates and transforms are looked at before, the mesh itself
# is compared elsewhere.


XML: Final = "{http://www.w3.org/XML/1998/namespace}"
LANGUAGE: Final = f"{XML}lang"
SPACE: Final = f"{XML}space"

READ_EXTENSIONS: Final = (PRODUCTION,)
"""Namespaces of the extensions that a model may require: they only spread it over several files."""

CORE_ATTRIBUTES: Final[Mapping[str, Collection[str]]] = {
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
"""Largest id or index."""


def fault(clause: str, what: str) -> FileError:
    """The error for what breaks a clause of the core specification."""
    return FileError(f"{what} (3MF core specification, {clause})")


def core(*tags: str) -> str:
    """The path of nested elements of the core specification."""
    return "/".join(f"{{{CORE}}}{tag}" for tag in tags)


def check_model(content: bytes, thumbnails: Collection[str]) -> None:
    """Raise FileError or SyntaxError with what is wrong unless a model is valid.

    `thumbnails` are the names of the parts to which it has a relationship as a picture.
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
    _check_elements(root)
    for prefix in root.get("requiredextensions", "").split():
        if prefixes.get(prefix) not in READ_EXTENSIONS:
            raise FileError(f"it requires the extension {prefix!r}, which is not read")
    for group in root.iter(core("metadatagroup")):
        _check_metadata(group, prefixes)
    _check_metadata(root, prefixes)
    order = [element.tag for element in root if element.tag in (core("resources"), core("build"))]
    if order != [core("resources"), core("build")]:
        raise fault("3.4", "it must have one element resources, followed by one element build")
    _check_items(root, _objects(root, thumbnails))


def _check_elements(root: ET.Element) -> None:
    """2.3.2: every element and attribute of the core namespace is known."""
    name = core("")
    for element in root.iter():
        if SPACE in element.attrib:
            raise fault("2.3.4", "it has the attribute xml:space")
        if not element.tag.startswith(name):
            continue
        tag = element.tag.removeprefix(name)
        if tag not in CORE_ATTRIBUTES:
            raise fault("2.3.2", f"the element {tag} is not expected")
        for attribute in element.attrib:
            if attribute not in CORE_ATTRIBUTES[tag] and not attribute.startswith("{"):
                raise fault("2.3.2", f"the attribute {attribute} of {tag} is not expected")


def _check_metadata(holder: ET.Element, prefixes: Mapping[str, str]) -> None:
    """3.4.1: a name of metadata is there once, and one of `METADATA`, or has a namespace that the
    model declares.
    """
    names: set[str] = set()
    for element in holder.findall(core("metadata")):
        name = element.get("name", "")
        prefix, colon, _ = name.partition(":")
        if name in names:
            raise fault("3.4.1", f"the metadata {name!r} appears twice")
        if prefix not in prefixes if colon else name not in METADATA:
            wanted = "neither defined by 3MF nor in a namespace that the model declares"
            raise fault("3.4.1", f"the metadata {name!r} is {wanted}")
        names.add(name)


def _objects(root: ET.Element, thumbnails: Collection[str]) -> dict[str, ET.Element]:
    """3.4.2: the objects by id. An id is unique among all resources, and what refers to a resource
    comes after it (3.4).
    """
    objects: dict[str, ET.Element] = {}
    groups: dict[str, int] = {}  # how many properties each has
    for resource in root.iterfind(core("resources") + "/*"):
        key, is_core = resource.get("id", ""), resource.tag.startswith(core(""))
        if not 1 <= _number(key) <= LARGEST:
            if is_core:
                raise fault("3.4.2", f"the resource id {key!r} is not valid")
            continue  # not a resource: an extension may have other elements here
        if key in objects or key in groups:
            raise fault("3.4.2", f"the resource id {key!r} appears twice")
        if resource.tag == core("object"):
            _check_object(resource, objects, groups, thumbnails)
            objects[key] = resource
        else:
            groups[key] = len(resource)
    for base in root.iterfind(core("resources", "basematerials", "base")):
        if not COLOUR.fullmatch(base.get("displaycolor", "")):
            raise fault("5.1.1", f"{base.get('displaycolor')!r} is not a colour #RRGGBB")
    return objects


def _check_object(
    element: ET.Element,
    objects: Mapping[str, ET.Element],
    groups: Mapping[str, int],
    thumbnails: Collection[str],
) -> None:
    """4: an object is a mesh or has components; it refers to objects and groups before it."""
    name = f"the object {element.get('id')}"
    if element.get("type", "model") not in TYPES:
        raise fault("4", f"{element.get('type')!r} is not a type of object")
    shapes = [*element.findall(core("mesh")), *element.findall(core("components"))]
    if len(shapes) != 1:
        raise fault("4", f"{name} has {len(shapes)} meshes or lists of components, not one")
    picture = element.get("thumbnail")
    if picture is not None and picture not in thumbnails:
        raise fault("4", f"the thumbnail {picture!r} of {name} is not a part that the model names")
    if "pindex" in element.attrib and "pid" not in element.attrib:
        raise fault("4", f"{name} has a pindex and no pid")
    _check_properties(element, element.get("pid"), ("pindex",), groups, "4", name)
    for component in element.iterfind(core("components", "component")):
        other = component.get("objectid", "")
        if PATH not in component.attrib and other not in objects:
            raise fault(
                "4.2.1", f"{name} has the component {other!r}, which is not an object before it"
            )
    count = len(element.findall(core("mesh", "vertices", "vertex")))
    for triangle in element.iterfind(core("mesh", "triangles", "triangle")):
        corners = [_number(triangle.get(corner)) for corner in ("v1", "v2", "v3")]
        if min(corners) < 0 or max(corners) >= count or len({*corners}) != len(corners):
            stated = ", ".join(str(triangle.get(corner)) for corner in ("v1", "v2", "v3"))
            wanted = f"not three different ones of its {counted(count, 'vertex', 'vertices')}"
            raise fault("4.1.4.1", f"a triangle of {name} has the corners {stated}, {wanted}")
        if len(triangle.attrib) > len(corners):
            pid = triangle.get("pid", element.get("pid"))
            _check_properties(triangle, pid, ("p1", "p2", "p3"), groups, "4.1.4.1", name)


def _check_properties(
    element: ET.Element,
    pid: str | None,
    indices: Sequence[str],
    groups: Mapping[str, int],
    clause: str,
    name: str,
) -> None:
    """Raise FileError unless the properties of an element are those of a known group."""
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
    digits = (text or "").strip()
    return int(digits) if digits.isascii() and digits.isdecimal() else -1


def _check_items(root: ET.Element, objects: Mapping[str, ET.Element]) -> None:
    """3.4.3: what is built, at least one object, and none of type "other", by itself or within
    another one.
    """
    items = root.findall(core("build", "item"))
    if not items:
        raise FileError("it builds nothing: its build has no item")
    others: set[str] = set()
    # Components come before what contains them, so their kind is known already.
    for key, element in objects.items():
        inner = [one.get("objectid") for one in element.iterfind(core("components", "component"))]
        if any(one in others for one in inner) or (not inner and element.get("type") == "other"):
            others.add(key)
    for item in items:
        key = item.get("objectid", "")
        if PATH in item.attrib:
            raise FileError("it builds an object of another part, which is not read")
        if key not in objects:
            raise fault("3.4.3.1", f"it builds the object {key!r}, which does not exist")
        if key in others:
            raise fault("3.4.3.1", f"it builds the object {key!r}, which is of type 'other'")


# -- package --------------------------------------------------------------------------------------
# Whether other programs can read a 3MF package: its parts, and how they refer to each other.
#
# The rules are those of the Open Packaging Conventions (ECMA-376, part 2) and of the 3MF core
# specification, as strict readers like lib3mf apply them; those of the model are above.


IDENTIFIER: Final = re.compile(r"[A-Za-z_][\w.-]*")

SCHEME: Final = re.compile(r"[A-Za-z][\w+.-]*:")
"""How an address outside the package begins."""

THUMBNAIL: Final = f"{RELATIONSHIPS}/metadata/thumbnail"
PRINT_TICKET: Final = "http://schemas.microsoft.com/3dmanufacturing/2013/01/printticket"
TEXTURE: Final = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dtexture"
"""Types of relationships."""

PICTURES: Final = (THUMBNAIL, TEXTURE)
"""Relationships that name the thumbnail of an object, the second one in older files."""

NEEDED: Final = (MODEL_RELATION, PRINT_TICKET, *PICTURES)
"""Relationships whose target must be in the package."""

ONCE: Final = {False: (MODEL_RELATION, THUMBNAIL), True: (PRINT_TICKET,)}
"""Relationships that a package (False) or a model (True) has at most once."""

TARGET_TYPES: Final[Mapping[str, Collection[str]]] = {
    MODEL_RELATION: (MODEL_TYPE,),
    THUMBNAIL: ("image/png", "image/jpeg"),
    PRINT_TICKET: ("application/vnd.ms-printing.printticket+xml",),
}
"""Content types of what relationships lead to (2.1.3 and appendix C)."""


def package_checks(parts: Mapping[str, bytes]) -> list[Check]:
    """The checks that the package of these `parts` is complete and valid."""
    try:
        path = model_path(parts)
        pictures = [f"/{target}" for kind, target in _relations(parts, path) if kind in PICTURES]
    except (SyntaxError, ValueError) as error:
        return [failed("package", str(error))]
    checks = [Check("package", "", path, ok=True)]
    try:
        check_model(parts[path], pictures)
    except (SyntaxError, ValueError) as error:
        return [*checks, failed("model", str(error))]
    return [*checks, Check("model", "", "valid", ok=True)]


def model_path(parts: Mapping[str, bytes]) -> str:
    """The part that holds the model; raises FileError unless the package leads to it, and all that
    it and the model refer to is there.
    """
    for name in (CONTENT_TYPES_PATH, RELATIONSHIPS_PATH):
        if name not in parts:
            raise FileError(f"it has no {name}, without which other programs do not read it")
    relations = _relations(parts, "")
    models = [target for kind, target in relations if kind == MODEL_RELATION]
    if len(models) != 1:
        raise FileError(f"{RELATIONSHIPS_PATH}: {len(models)} models are named, not one")
    types = _types(parts)
    for kind, target in (*relations, *_relations(parts, models[0])):
        _check_type(types, target, TARGET_TYPES.get(kind, ()))
    _check_type(types, RELATIONSHIPS_PATH, (RELATIONSHIP_TYPE,))
    return models[0]


Relation = tuple[str, str]
"""The type of a relationship, and the part that it leads to."""


def _relations(parts: Mapping[str, bytes], source: str) -> list[Relation]:
    """The relationships of a part, or of the package, whose name is empty.

    By OPC (ECMA-376-2, 9.3) each has an identifier of its own. By 2.1.1 of the core specification
    none leads out of the package, no two of a type lead to one part, and what must be there is; by
    2.1.2 to 2.1.4 there is one at most of the types in `ONCE`.
    """
    folder, name = posixpath.split(source)
    path = posixpath.join(folder, "_rels", f"{name}.rels")
    seen: set[str] = set()
    relations: dict[Relation, Relation] = {}  # by what there may be once
    for element in _children(parts, path, RELATIONSHIPS, "Relationships") if path in parts else ():
        key, kind, target = (element.get(word, "") for word in ("Id", "Type", "Target"))
        if not IDENTIFIER.fullmatch(key) or key in seen:
            raise FileError(f"{path}: the Id {key!r} is not valid, or appears twice")
        seen.add(key)
        if not target or element.get("TargetMode") == "External" or SCHEME.match(target):
            raise fault("2.1.1", f"{path}: the target {target!r} is not in the package")
        whole = target if kind == MODEL_RELATION else posixpath.join("/", folder, target)
        part = posixpath.normpath(whole).removeprefix("/")
        if kind in NEEDED and (whole[0] != "/" or part not in parts):
            raise fault("2.1.1", f"{path}: the target {target!r} is not in the package")
        once = (kind, "" if kind in ONCE[bool(source)] else part)
        if once in relations:
            raise fault("2.1", f"{path}: it has two relationships of the type {kind}")
        relations[once] = (kind, part)
    return list(relations.values())


def _children(parts: Mapping[str, bytes], path: str, namespace: str, root: str) -> list[ET.Element]:
    """The elements of a part, whose root must be `root` of the `namespace`."""
    try:
        element = ET.fromstring(parts[path])
    except SyntaxError as error:
        raise FileError(f"{path}: {error}") from None
    if element.tag != f"{{{namespace}}}{root}":
        raise FileError(f"{path}: its root is {element.tag}, not {root} of {namespace}")
    return list(element)


def _types(parts: Mapping[str, bytes]) -> dict[tuple[str, str], str]:
    """The content types that are stated, by extension or by part."""
    types: dict[tuple[str, str], str] = {}
    for element in _children(parts, CONTENT_TYPES_PATH, CONTENT_TYPES, "Types"):
        kind = element.tag.rpartition("}")[2]
        key = element.get(
            {"Default": "Extension", "Override": "PartName"}.get(kind, ""), ""
        ).lower()
        if not key or (kind, key) in types:
            raise FileError(
                f"{CONTENT_TYPES_PATH}: {kind} {key!r} is not expected, or appears twice"
            )
        types[kind, key] = element.get("ContentType", "")
    return types


def _check_type(types: Mapping[tuple[str, str], str], part: str, allowed: Collection[str]) -> None:
    """Raise FileError unless the content type of a part is `allowed`; if none is, any will do."""
    extension = posixpath.splitext(part.lower())[1].removeprefix(".")
    extension = extension or posixpath.basename(part).removeprefix(".")
    content_type = types.get(
        ("Override", f"/{part.lower()}"), types.get(("Default", extension), "")
    )
    if allowed and content_type not in allowed:
        what = f"the type of {part} is {content_type or 'not stated'}"
        raise FileError(f"{CONTENT_TYPES_PATH}: {what}, not {' or '.join(allowed)}")


# -- plate ----------------------------------------------------------------------------------------
# The bodies of a plate, each compared with what it should be.


def plate_checks(
    plate: Sequence[PlatePiece],
    parts: Mapping[str, bytes],
    model: bytes,
    scale: float,
    tolerance: float,
) -> list[Check]:
    """All checks of the bodies in a package, each as if it were the only one, and not moved.

    Parameters
    ----------
    plate : what the package should hold.
    parts : of the package.
    model : that which it leads to; `scale` [mm] is its unit.
    tolerance : [mm].
    """
    count = len(ET.fromstring(model).findall(f"{{{CORE}}}resources/{{{CORE}}}object"))
    if count != len(plate):
        note = f"the package has {counted(count, 'object')}, expected {len(plate)}"
        return [failed("bodies", note)]
    checks: list[Check] = []
    for number, piece in enumerate(plate):
        compare = partial(checks_of_body, piece.part, piece.reach, tolerance=tolerance)
        alone = packed({f"/{MODEL_PATH}": _alone(model, number), **parts})
        checks += [
            replace(check, of=f"{piece.name}: {check.of}" if check.of else piece.name)
            for check in _mesh_checks(alone, scale, compare)
        ]
    return checks


def _alone(model: bytes, number: int) -> bytes:
    """The model with one of its objects only, not transformed."""
    root = ET.fromstring(model)
    resources = root.find(f"{{{CORE}}}resources")
    build = root.find(f"{{{CORE}}}build")
    assert resources is not None  # it has objects
    selected = resources.findall(f"{{{CORE}}}object")[number]
    for element in resources.findall(f"{{{CORE}}}object"):
        if element is not selected:
            resources.remove(element)
    if build is not None:
        root.remove(build)
    build_element = ET.SubElement(root, f"{{{CORE}}}build")
    ET.SubElement(build_element, f"{{{CORE}}}item", {"objectid": selected.get("id", "")})
    data: bytes = ET.tostring(root, "UTF-8", xml_declaration=True)
    return data
