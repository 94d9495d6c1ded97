"""What verify reports on files, as tests compare it."""

from __future__ import annotations

from typing import Final

import numpy as np
import pytest
import trimesh

from camgeo.app.answers.verify import first_difference
from camgeo.design.product import Product
from camgeo.design.verify import Check, ReadingOptions, Verifier, failed
from camgeo.design.writing import Writer, Written, find_writer
from camgeo.part.mass import Solid
from camgeo.part.part import Part
from camgeo_export.verify.dxf import VERIFIER as DXF
from camgeo_export.verify.gcode import VERIFIER as GCODE
from camgeo_export.verify.step import VERIFIER as STEP
from camgeo_export.verify.stl import VERIFIER as STL
from camgeo_export.verify.svg import VERIFIER as SVG
from camgeo_export.verify.threemf import VERIFIER as THREEMF

TOLERANCE = 0.01
"""Of all these files [mm]."""

VERIFIERS: Final[dict[str, Verifier]] = {
    each.format: each for each in (DXF, GCODE, STEP, STL, SVG, THREEMF)
}

FILE: Final = ReadingOptions("file")
"""Of which nothing else is known."""

Checks = dict[tuple[str, str], Check]
"""By name, and by what the check is of."""


def checked(
    verifier: Verifier, product: Product, data: bytes, reading: ReadingOptions = FILE
) -> Checks:
    checks = verifier.checks(product, data, reading, TOLERANCE)
    return {(check.name, check.of): check for check in checks}


WRITTEN: dict[tuple[str, int, float], tuple[Product, bytes]] = {}
"""Files by format, identity of their product, which is kept lest another one gets that, and
tolerance.
"""


def written(name: str, product: Product, tolerance: float) -> bytes:
    """What camgeo writes of a product in a format."""
    key = name, id(product), tolerance
    if key not in WRITTEN:
        WRITTEN[key] = product, find_writer(name).write(product, tolerance).data
    return WRITTEN[key][1]


def faults(
    verifier: Verifier, product: Product, data: bytes, tolerance: float = TOLERANCE
) -> list[Check]:
    """The checks that fail on a file that should be one of ours, those of its origin included."""
    origin = verifier.origin(data)
    if origin.damage:
        return [failed("file", origin.damage)]
    checks = [
        Check("scene", value=origin.scene, ok=product.scene_hash.startswith(origin.scene or "-")),
        Check("tolerance", value=origin.tolerance, ok=origin.tolerance in (None, tolerance)),
        *verifier.checks(product, data, ReadingOptions("file"), tolerance),
    ]
    if origin.version == product.version:
        own = written(origin.format or verifier.format, product, tolerance)
        if difference := first_difference(verifier, data, own):
            checks.insert(0, failed("written again", difference.sentence))
    return [check for check in checks if check.ok is False]


def measured(writer: Writer, product: Product, data: bytes) -> float:
    """The deviation of a file that is measured [mm]."""
    deviation = writer.measure(product, data)
    assert deviation is not None
    return deviation


def read_back(
    writer: Writer, product: Product, tolerance: float = TOLERANCE, least: float = 0.5
) -> Written:
    """What is written: within the tolerance, of which it uses some, and without a fault."""
    found = writer.write(product, tolerance)
    assert least * tolerance <= measured(writer, product, found.data) <= tolerance
    assert faults(VERIFIERS[writer.format.name], product, found.data, tolerance) == []
    return found


def require_moments(mesh: trimesh.Trimesh, part: Part, room: float) -> None:
    """That a mesh is one piece of the part's volume, centre and inertia but for `room` [mm^3]."""
    exact = Solid.from_part(part)
    assert mesh.body_count == 1
    assert mesh.volume == pytest.approx(exact.volume, abs=room)
    size = float(np.max(np.abs(mesh.vertices)))
    centre = exact.centre - [0.0, 0.0, part.layers[0].z0]
    assert np.max(np.abs(mesh.center_mass - centre)) <= room * size / exact.volume
    assert np.max(np.abs(mesh.moment_inertia - exact.inertia)) <= 2.0 * room * size**2
