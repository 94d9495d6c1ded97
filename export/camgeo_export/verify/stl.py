"""Verification of STL files, ours and others, binary or text; a format without unit."""

from __future__ import annotations

import re

from camgeo.product.product import Product
from camgeo.units import MM_PER, LengthUnit
from camgeo.verifying.verification import Check, Origin, Reading, equal, reported
from camgeo.wording import counted
from camgeo_export.stl.writer import FACET, PREFIX
from camgeo_export.verify.body import mesh_checks

OURS = re.compile(rb"camgeo \S+ unit (\w+) scene ([0-9a-f]*)")


class StlVerifier:
    """Verifies an STL."""

    format = "stl"

    def origin(self, data: bytes) -> Origin:
        """From the header, which has room only for the first digits of the scene's hash."""
        found = OURS.match(data[:PREFIX])
        scene = found.group(2).decode() if found else ""
        return Origin(found is not None, scene, None, _damage(data))

    def checks(
        self, product: Product, data: bytes, reading: Reading, tolerance: float
    ) -> tuple[Check, ...]:
        """Unit, and the body against the part."""
        unit, check = _unit(data, reading)
        return (check, *mesh_checks(product, data, "stl", MM_PER[unit], tolerance))


def _damage(data: bytes) -> str:
    """How the file is truncated: a text has a last word, a binary states its number of facets."""
    count = int.from_bytes(data[PREFIX - 4 : PREFIX], "little")
    expected = PREFIX + FACET.itemsize * count
    if len(data) == expected and len(data) > PREFIX:
        return ""
    if data.lstrip().startswith(b"solid") and b"facet" in data[:1000]:
        end = data.rstrip().rsplit(b"\n", 1)[-1].strip()
        return "" if end.startswith(b"endsolid") else "not a complete text STL: endsolid missing"
    size, facets = counted(len(data), "byte"), counted(count, "facet")
    return f"not a complete binary STL: {size}, {expected} for its {facets}"


def _unit(data: bytes, reading: Reading) -> tuple[LengthUnit, Check]:
    """Ours are in mm and say so; others state no unit."""
    if reading.ours:
        found = OURS.match(data[:PREFIX])
        stated = found.group(1).decode() if found else ""
        return "mm", equal("unit", stated, "mm", note="our STL files are in mm")
    if reading.unit is not None:
        return reading.unit, reported("unit", reading.unit, note="by --unit")
    return "mm", reported("unit", "mm", note="assumed: STL has no unit; give another with --unit")


VERIFIER = StlVerifier()
