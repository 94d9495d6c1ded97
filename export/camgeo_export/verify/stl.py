"""Verification of STL files, ours and others, binary or text; a format without unit."""

from __future__ import annotations

import math
import re
from array import array
from collections.abc import Iterator
from typing import Final

import numpy as np

from camgeo.design.product import Product
from camgeo.design.verify import Check, Origin, ReadingOptions, equal, failed, reported
from camgeo.errors import FileError
from camgeo.numeric.arrays import FloatArray
from camgeo.reading import (
    COORDINATE,
    FACETS,
    Limits,
    beyond,
    check_size,
    check_text,
    parse_number,
    text_lines,
)
from camgeo.units import MM_PER, LengthUnit, counted
from camgeo_export.reading import text_tokens
from camgeo_export.verify.body import body_checks, heights, point_text

STL: Final = Limits("STL", 32_000_000, lines=1_500_000)
"""Limits of an STL; the lines are those of its text form, seven for each facet."""

HEADER_BYTES = 80

PREFIX = HEADER_BYTES + 4
"""Size in bytes of what precedes the facets: header and number of facets."""

FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])

OURS = re.compile(rb"camgeo (\S+) unit (\w+) scene ([0-9a-f]*)")

TURNED = 0.01
"""Largest error of a normal's direction [deg]; single floats cause 1e-5."""

UNIT = 1e-5
"""Largest error of the length 1 of our normals."""

SINGLE = 2.0**-23 * 4.0
"""Rounding of the corners and normals, as a fraction of their coordinates."""


class StlVerifier:
    """Verifies an STL."""

    format = "stl"
    slack = SINGLE

    def tokens(self, data: bytes) -> Iterator[tuple[str, str]]:
        """The words of the header, and all numbers of each facet."""
        yield from text_tokens(data[:HEADER_BYTES], "header")
        normals, corners = _binary_facets(data)
        numbers = np.hstack((normals, corners.reshape(-1, 9))).tolist()
        attributes = np.frombuffer(data, FACET, offset=PREFIX)["attribute"].tolist()
        for place, row in enumerate(zip(numbers, attributes, strict=True), 1):
            for value in (*row[0], row[1]):
                yield f"facet {place}", repr(value)

    def origin(self, data: bytes) -> Origin:
        """The origin that the header states; it holds only the first digits of the scene's hash."""
        match = OURS.match(data[:PREFIX])
        version, scene = (match[1].decode(), match[3].decode()) if match else ("", "")
        try:
            _check(data)
        except FileError as error:
            return Origin(damage=str(error))
        return Origin(version, scene, None, _damage(data))

    def checks(
        self, product: Product, data: bytes, reading: ReadingOptions, tolerance: float
    ) -> tuple[Check, ...]:
        """Unit, header, normals, and the body against the part."""
        ours = OURS.match(data[:PREFIX]) is not None
        unit, check = _unit(data, reading)
        checks = [check]
        if ours:  # it states no tolerance, so what cannot be written again is checked here
            checks += [_header(data, product), _attributes(data)]
        try:
            normals, corners = _read_facets(data)
        except FileError as error:
            return (*checks, failed("file", f"no mesh: {error}"))
        if not np.abs(corners).max(initial=0.0) <= COORDINATE:  # or NaN
            message = f"a coordinate of a facet is not finite or exceeds {COORDINATE:g}"
            return (*checks, failed("facets", message))
        checks.append(_normals(normals, corners, ours))
        vertices = corners.reshape(-1, 3) * MM_PER[unit]
        triangles = np.arange(len(vertices)).reshape(-1, 3)
        return (*checks, *body_checks(product, vertices, triangles, tolerance))


def _check(data: bytes) -> None:
    """Raise FileError if the file is beyond the limits."""
    if _is_binary(data):
        check_size(len(data), STL, "the file")
        count = (len(data) - PREFIX) // FACET.itemsize
    else:
        check_text(data, STL, "the file")
        count = data.count(b"vertex") // 3
    if count > FACETS:
        raise beyond("the file", counted(count, "facet"), FACETS, STL)


def _damage(data: bytes) -> str:
    """How the file is truncated, if it is: a text has a last word, a binary its facet count."""
    if _is_binary(data) and len(data) > PREFIX:
        return ""
    count = int.from_bytes(data[PREFIX - 4 : PREFIX], "little")
    expected = PREFIX + FACET.itemsize * count
    if data.lstrip().startswith(b"solid") and b"facet" in data[:1000]:
        end = data.rstrip().rsplit(b"\n", 1)[-1].strip()
        return "" if end.startswith(b"endsolid") else "not a complete text STL: endsolid missing"
    size, facets = counted(len(data), "byte"), counted(count, "facet")
    return f"not a complete binary STL: {size}, {expected} for its {facets}"


def _unit(data: bytes, reading: ReadingOptions) -> tuple[LengthUnit, Check]:
    """The unit and its check: our files are in mm and say so, others state none."""
    match = OURS.match(data[:PREFIX])
    if match:
        return "mm", equal("unit", match[2].decode(), "mm", note="camgeo's STL files are in mm")
    if reading.unit is not None:
        return reading.unit, reported("unit", reading.unit, note="by --unit")
    return "mm", reported("unit", "mm", note="assumed: STL has no unit; give another with --unit")


def _is_binary(data: bytes) -> bool:
    count = int.from_bytes(data[PREFIX - 4 : PREFIX], "little")
    return len(data) == PREFIX + FACET.itemsize * count


def _header(data: bytes, product: Product) -> Check:
    """The check of the part that the header names, as far as there is room for its name."""
    match = OURS.match(data[:PREFIX])
    assert match is not None  # it is one of ours
    named = data[match.end() : HEADER_BYTES].decode("ascii", "replace").strip()
    room = HEADER_BYTES - match.end() - 1
    name = product.name.encode("ascii", "replace").decode()[: max(room, 0)].strip()
    return equal("part", named, name, note="the header names a different part")


def _attributes(data: bytes) -> Check:
    """The check that the attributes of facets, which some programs take for colours, are 0."""
    attributes = np.frombuffer(data, FACET, offset=PREFIX)["attribute"]
    marked = np.flatnonzero(attributes)
    if len(marked):
        return failed(
            "attributes", f"facet {marked[0] + 1} has the attribute {attributes[marked[0]]}"
        )
    return Check("attributes", "", "none", ok=True)


def _read_facets(data: bytes) -> tuple[FloatArray, FloatArray]:
    """(m, 3) normals and (m, 3, 3) corners, as in the file; raises FileError."""
    if _is_binary(data):
        return _binary_facets(data)
    normals, corners = array("d"), array("d")
    for number, line in enumerate(text_lines(data), start=1):
        row = line.split(maxsplit=5)
        if row[:1] == ["vertex"]:
            corners.extend(_triple(row[1:], number))
        elif row[:2] == ["facet", "normal"]:
            normals.extend(_triple(row[2:], number))
    if len(corners) != 3 * len(normals):
        stated = counted(len(normals) // 3, "facet")
        raise FileError(f"{stated} with {counted(len(corners) // 3, 'corner')}, not 3 for each")
    return (
        np.array(normals, dtype=np.float64).reshape(-1, 3),
        np.array(corners, dtype=np.float64).reshape(-1, 3, 3),
    )


def _binary_facets(data: bytes) -> tuple[FloatArray, FloatArray]:
    """(m, 3) normals and (m, 3, 3) corners of a binary file."""
    facets = np.frombuffer(data, FACET, offset=PREFIX)
    with np.errstate(invalid="ignore"):  # a signalling NaN becomes a quiet one
        return facets["normal"].astype(np.float64), facets["corners"].astype(np.float64)


def _triple(words: list[str], line: int) -> tuple[float, float, float]:
    """The three numbers in a line of a text; NaN where a word is none."""
    if len(words) != 3:
        raise FileError(f"line {line}: {counted(len(words), 'number')} where 3 are expected")
    x, y, z = (parse_number(word) for word in words)
    lost = math.nan
    return (lost if x is None else x, lost if y is None else y, lost if z is None else z)


def _normals(normals: FloatArray, corners: FloatArray, ours: bool) -> Check:
    """The check that normals follow the right-hand rule for the corners of their facets.

    Programs may leave them 0, to be computed by the reader; ours are never 0. Others may have
    rounded the corners afterwards, which turns the normal of a narrow facet.
    """
    lost = np.flatnonzero(~(np.abs(normals).max(axis=1, initial=0.0) <= COORDINATE))  # or NaN
    if len(lost):
        many = counted(len(lost), "facet")
        return failed(
            "normals", f"the normal of facet {lost[0] + 1} is not finite; {many} affected"
        )
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    aside = np.linalg.norm(np.cross(normals, across), axis=1)
    # Of the cross and the dot product of each row, which is accurate for small angles.
    turned = np.degrees(np.arctan2(aside, np.einsum("ij,ij->i", normals, across)))
    limits = np.full(len(normals), TURNED)
    if not ours:
        with np.errstate(divide="ignore", invalid="ignore"):
            share = SINGLE * np.abs(corners).max(axis=(1, 2), initial=0.0) / heights(corners)
        limits += np.degrees(np.arctan(share))
    solid = np.linalg.norm(across, axis=1) > 0.0
    empty = solid & (lengths == 0.0)
    faults = (
        ("is 0", empty & ours),
        ("is not of length 1", solid & ~(np.abs(lengths - 1.0) <= UNIT) & ours),
        ("is turned away from its facet", solid & ~empty & ~(turned <= limits)),
    )
    for what, which in faults:
        if np.any(which):
            first = int(np.argmax(which))
            place = point_text(corners[first].mean(axis=0))
            many = counted(int(np.count_nonzero(which)), "facet")
            return failed(
                "normals", f"the normal of facet {first + 1}, near {place}, {what}; {many} affected"
            )
    zeros = counted(int(np.count_nonzero(empty)), "facet")
    note = f"0 at {zeros}, to be computed by the reading program" if empty.any() else ""
    return Check("normals", "", float(len(normals)), ok=True, note=note)


VERIFIER = StlVerifier()
