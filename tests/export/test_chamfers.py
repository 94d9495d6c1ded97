"""Chamfers in the files of solids: written, read back, verified; what lacks one is refused."""

from __future__ import annotations

import io
import math

import numpy as np
import pytest
import trimesh

from camgeo.errors import GeometryError
from camgeo.numeric.arrays import FloatArray, IntArray
from camgeo.part.bands import Bevel
from camgeo.part.boundary import Boundary
from camgeo.part.mass import solid
from camgeo.part.part import Layer, Part
from camgeo.writing.writer import Writer
from camgeo_export.errors import FileError
from camgeo_export.solid.measure import measure
from camgeo_export.solid.prism import body
from camgeo_export.stl.writer import WRITER as STL
from camgeo_export.threemf.writer import WRITER as THREEMF
from camgeo_export.verify.body import body_checks
from tests.export.test_solids import PartProduct
from tests.part.test_mass import circle

OUTLINE = circle("outline", 30.0, complex(0.0, -5.0))
BORE = circle("bore", 8.0, hole=True)
TOLERANCE = 0.01


def bevel(boundary: Boundary, width: float, z: float, *, upper: bool) -> Bevel:
    edge = boundary.inset(width, f"chamfer of the {boundary.name}")
    return Bevel(boundary, edge, width, width, z, upper)


PART = Part(
    (Layer(-8.0, 0.0, (OUTLINE, BORE)),),
    (
        bevel(OUTLINE, 0.5, 0.0, upper=True),
        bevel(OUTLINE, 0.5, -8.0, upper=False),
        bevel(BORE, 1.0, 0.0, upper=True),
    ),
)
PRODUCT = PartProduct(given=PART)


def _cone(one: float, other: float) -> float:
    """Volume of a frustum of 45 degrees."""
    return math.pi * abs(other**3 - one**3) / 3.0


WALLS = 7.0 * math.pi * (30.0**2 - 8.0**2)
VOLUME = 2.0 * _cone(29.5, 30.0) + WALLS - _cone(8.0, 9.0)


def mesh() -> tuple[FloatArray, IntArray]:
    made = body(PART, TOLERANCE, lambda values: values)
    return made.vertices.copy(), made.triangles


@pytest.mark.parametrize("writer", [STL, THREEMF], ids=["stl", "3mf"])
@pytest.mark.parametrize("tolerance", [0.05, 1e-3])
def test_read_back_is_within_the_tolerance(writer: Writer, tolerance: float) -> None:
    written = writer.write(PRODUCT, tolerance)
    measured = writer.measure(PRODUCT, written.data)
    assert measured is not None
    assert 0.5 * tolerance < measured <= tolerance
    assert written.facts["volume_mm3"] == pytest.approx(VOLUME, rel=0.2 * tolerance)
    found = trimesh.load_mesh(io.BytesIO(written.data), file_type=writer.format.suffix[1:])
    assert found.is_volume
    assert found.bounds[:, 2].tolist() == [0.0, 8.0]


def test_mass_and_mesh_agree_with_cones() -> None:
    assert solid(PART).volume == pytest.approx(VOLUME, rel=1e-13)


def test_a_chamfer_takes_no_more_facets_than_a_wall() -> None:
    """Each wall has two facets for each of its chords, and so has each chamfer beside it."""
    sharp, edged = (len(body(part, TOLERANCE, lambda values: values).triangles)
                    for part in (PART.sharp, PART))  # fmt: skip
    assert edged <= 1.1 * 2.0 * sharp


def test_verification_has_nothing_to_say() -> None:
    vertices, triangles = mesh()
    checks = body_checks(PRODUCT, vertices, triangles, TOLERANCE)
    assert [check for check in checks if not check.ok] == []
    where = {check.of for check in checks if check.name == "deviation"}
    assert len([each for each in where if "half way up" in each]) == 3


def test_a_solid_with_sharp_edges_is_refused() -> None:
    made = body(PART.sharp, TOLERANCE, lambda values: values)
    with pytest.raises(FileError, match="there is no chamfer"):
        measure(PART, made.vertices, made.triangles)
    for check in body_checks(PRODUCT, made.vertices, made.triangles, TOLERANCE):
        if check.name == "deviation" and "chamfer" in check.of:
            assert not check.ok


def test_a_chamfer_of_another_width_is_measured() -> None:
    wide = bevel(BORE, 1.25, 0.0, upper=True)
    other = Part(PART.layers, (*PART.bevels[:2], wide))
    vertices, triangles = mesh()
    with pytest.raises(FileError, match="neither flat nor upright"):
        measure(other, vertices, triangles)
    steep = vertices.copy()
    radius = np.hypot(steep[:, 0], steep[:, 1])
    steep[(steep[:, 2] == 8.0) & (radius < 10.0), :2] *= 9.25 / 9.0
    assert measure(PART, steep, triangles) == pytest.approx(0.25, abs=0.02)
    broken = [check for check in body_checks(PRODUCT, steep, triangles, TOLERANCE) if not check.ok]
    assert {check.name for check in broken} >= {"deviation", "area"}


def test_a_twisted_chamfer_sags_half_way_up() -> None:
    """Its edges are where they belong, but facets join places that do not lie over each other."""
    vertices, triangles = mesh()
    places = vertices[:, 0] + 1j * vertices[:, 1]
    top = (vertices[:, 2] == 8.0) & (np.abs(places) < 10.0)
    count = int(np.count_nonzero(top))
    order = np.flatnonzero(top)
    after = np.arange(len(vertices))
    after[order] = np.roll(order, count // 8)
    measured = measure(PART, vertices[after], triangles)
    # Half way up, chords of an eighth of a turn lie inside the circle of 8.5 mm.
    assert measured > 8.5 * (1.0 - math.cos(math.pi / 8.0)) - 0.1


def test_chamfers_that_the_tolerance_may_hide_are_refused() -> None:
    with pytest.raises(GeometryError, match=r"at least 4 tolerances wide, 0\.8 mm") as caught:
        STL.write(PRODUCT, 0.2)
    assert caught.value.key == "part.chamfers"
