"""The parts of a 3MF package, unpacked within limits, and a check of what its bodies consist of.

Verification gets the parts of a package from here: a damaged package, one that unpacks to more than
allowed, and XML that refers to anything outside itself are refused before they are parsed.
"""

from __future__ import annotations

import graphlib
import io
import posixpath
import re
import struct
import zipfile
import zlib
from collections.abc import Collection, Iterator, Mapping
from itertools import chain
from typing import Final
from xml.etree import ElementTree as ET

from camgeo.errors import FileError
from camgeo.reading import (
    ATTRIBUTES,
    COORDINATE,
    ELEMENTS,
    FACETS,
    MEMBERS,
    OBJECTS,
    PACKAGE,
    RATIO,
    TAG,
    UNPACKED,
    beyond,
    check_size,
    number_of,
)
from camgeo.units import counted
from camgeo_export.threemf.writer import CORE

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

XML: Final = (".model", ".rels", ".xml")
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
"""Those of extensions, as of slices, have other coordinates."""

TRANSFORM: Final = 12
"""Numbers of a transform (3.3 of the 3MF core specification)."""

Key = tuple[str, str]
"""Part and id of an object."""


def parts_of(data: bytes) -> dict[str, bytes]:
    """The parts of a package by name; raises FileError if it is damaged or beyond the limits."""
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
    _check_xml({name: part for name, part in parts.items() if name.lower().endswith(XML)})
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
        found = ENCODING.match(content)
        if (found is not None and found[1].lower() not in UTF8) or b"\0" in content:
            raise FileError(f"{name}: is not encoded as UTF-8")
        if b"<!DOCTYPE" in content or b"<!ENTITY" in content:
            raise FileError(f"{name}: has a document type declaration, which 3MF forbids")
        if LONG.search(content) is not None:
            raise FileError(f"{name}: has a tag of more than {TAG:,} characters")
    for what, mark, most in (("tag", b"<", 2 * ELEMENTS), ("attribute", b"=", ATTRIBUTES)):
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
    """Check what is to be built, before anything is.

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
        for kind, own, number, inner in _objects(content, name):
            if kind == "item":
                built += inner
                continue
            if len(facets) >= OBJECTS:
                raise beyond(NAME, f"more than {OBJECTS:,} objects", OBJECTS, PACKAGE)
            facets[own] = facets.get(own, 0) + number
            inside.setdefault(own, []).extend(inner)
    absent = next((key for key in (*built, *chain(*inside.values())) if key not in facets), None)
    if absent is not None:
        raise FileError(f"it builds the object {absent[1]!r:.40}, which does not exist")
    try:
        order = list(graphlib.TopologicalSorter(inside).static_order())
    except graphlib.CycleError as error:
        raise FileError(f"the object {error.args[1][0][1]} contains itself") from None
    for key in order:
        facets[key] += sum(facets[other] for other in inside[key])
    total = sum(facets[key] for key in built)
    if total > FACETS:
        raise beyond(NAME, counted(total, "facet"), FACETS, PACKAGE)


def _objects(content: bytes, name: str) -> Iterator[tuple[str, Key, int, list[Key]]]:
    """Each object of a model with its facets and the objects in it; each item with its object."""
    own, facets, inner = (name, ""), 0, list[Key]()
    for event, item in ET.iterparse(io.BytesIO(content), events=("start", "end")):
        tag = item.tag.rpartition("}")[2]
        if event == "start":
            if tag == "object":
                own, facets, inner = (name, item.get("id", "")), 0, []
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
                yield "item", own, 0, inner
                inner = []
        elif tag == "object":
            yield "object", own, facets, inner
            own, facets, inner = (name, ""), 0, []
        item.clear()


def _check_numbers(texts: Collection[str | None], what: str) -> None:
    for text in texts:
        if text is None or number_of(text) is None:
            found = "nothing" if text is None else repr(text[:40])
            raise FileError(f"{what} has {found}, which is not a number of at most {COORDINATE:g}")
