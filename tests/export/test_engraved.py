"""Engraved discs in files: each is read back and judged as any other, and by trimesh."""

from __future__ import annotations

import io

import pytest
import trimesh
from ezdxf.filemanagement import read

from camgeo.cam.cam import Contact
from camgeo.design.verify import Verifier
from camgeo.design.writing import Writer
from camgeo.part.mass import solid
from camgeo.part.part import Part
from camgeo.part.spec import Engraving, PartSpec, text_of
from camgeo.scene.formats.dxf import ENTITIES, DxfSpec, Entity
from camgeo.scene.formats.step import StepSpec
from camgeo_export.dxf.writer import WRITER as DXF
from camgeo_export.part21.solid import Extrusion, Model, solid_of
from camgeo_export.part21.text import exchange_of
from camgeo_export.step.writer import WRITER as STEP
from camgeo_export.stl import WRITER as STL
from camgeo_export.svg import WRITER as SVG
from camgeo_export.threemf.writer import WRITER as THREEMF
from camgeo_export.verify.dxf import VERIFIER as OF_DXF
from camgeo_export.verify.step import VERIFIER as OF_STEP
from camgeo_export.verify.stl import VERIFIER as OF_STL
from camgeo_export.verify.svg import VERIFIER as OF_SVG
from camgeo_export.verify.threemf import VERIFIER as OF_THREEMF
from tests.export.test_solids import PartProduct
from tests.export.verified import TOLERANCE, faults
from tests.part.parts import made

DEPTH = 0.3

TEXTS = (Engraving("Ø8", 5.0, DEPTH, 22.0), Engraving("0", 4.0, 0.5, 20.0, 3.0))

WRITERS = {
    "dxf": (DXF, OF_DXF), "svg": (SVG, OF_SVG), "stl": (STL, OF_STL),
    "3mf": (THREEMF, OF_THREEMF), "step": (STEP, OF_STEP),
}  # fmt: skip


@pytest.fixture(scope="module")
def part() -> Part:
    return made(Contact.INNER, PartSpec(thickness=8.0, bore=20.0, engraving=TEXTS))


@pytest.mark.parametrize(("writer", "verifier"), WRITERS.values(), ids=WRITERS)
def test_files_are_read_back(part: Part, writer: Writer, verifier: Verifier) -> None:
    product = PartProduct(given=part, unit="inch")
    written = writer.write(product, TOLERANCE)
    measured = writer.measure(product, written.data)
    assert measured is not None
    assert 0.5 * TOLERANCE < measured <= TOLERANCE
    assert faults(verifier, product, written.data) == []
    assert writer.write(product, TOLERANCE).data == written.data


def test_a_solid_is_closed_and_lacks_the_letters(part: Part) -> None:
    data = STL.write(PartProduct(given=part), 1e-3).data
    mesh = trimesh.load_mesh(io.BytesIO(data), file_type="stl")
    assert mesh.is_volume
    assert mesh.body_count == 1
    length = sum(each.polyline(0.01).contour.length for each in part.boundaries)
    assert mesh.volume == pytest.approx(solid(part).volume, abs=1e-3 * 8.0 * length)


@pytest.mark.parametrize("entity", ENTITIES)
def test_letters_are_on_layers_of_their_depth(part: Part, entity: Entity) -> None:
    """A laser would cut through what is on layer CUT."""
    product = PartProduct(given=part, dxf=DxfSpec(entity))
    data = DXF.write(product, TOLERANCE).data
    assert faults(OF_DXF, product, data) == []
    space = read(io.StringIO(data.decode("utf-8"))).modelspace()
    assert {"CUT", "BLIND_0.3", "BLIND_0.5"} <= {each.dxf.layer for each in space}
    if entity in ("arcs", "polyline"):
        letters = [each for each in part.boundaries if text_of(each.name)]
        blind = [each for each in space if each.dxf.layer.startswith("BLIND")]
        assert len(blind) == len(letters)


def test_walls_of_letters_are_splines_where_step_files_have_splines(part: Part) -> None:
    product = PartProduct(given=part, step=StepSpec("spline"))
    data = STEP.write(product, TOLERANCE).data
    assert faults(OF_STEP, product, data) == []
    curved = sum(
        len(each.spline(TOLERANCE).contour.splines)
        for each in part.boundaries
        if text_of(each.name)
    )
    found = solid_of(Model.of(exchange_of(data)))
    assert sum(isinstance(each.surface, Extrusion) for each in found.faces) >= curved
