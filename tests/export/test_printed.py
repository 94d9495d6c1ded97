"""Bodies compensated for printing: written, measured and verified against what they should be."""

from __future__ import annotations

from functools import cache
from typing import Any

import lib3mf  # type: ignore[import-untyped]  # it has no types
import pytest

import camgeo
from camgeo.design.drawn import COMPENSATED
from camgeo.design.product import Product
from camgeo.design.verify import Reading
from camgeo.design.writing import Writer
from camgeo.errors import FileError
from camgeo.part.mass import solid
from camgeo_export.dxf.writer import WRITER as DXF
from camgeo_export.step.writer import WRITER as STEP
from camgeo_export.stl import WRITER as STL
from camgeo_export.threemf.writer import WRITER as THREEMF
from camgeo_export.verify.stl import VERIFIER as STL_VERIFIER
from camgeo_export.verify.threemf import VERIFIER as THREEMF_VERIFIER
from tests.contour.cams import SCENES
from tests.export.verified import TOLERANCE, checked, faults

VERIFIERS: dict[str, Any] = {"stl": STL_VERIFIER, "3mf": THREEMF_VERIFIER}

both = pytest.mark.parametrize("writer", [STL, THREEMF], ids=["stl", "3mf"])

PART = {
    "part.bore": 20,
    "part.keyway": {"width": 6, "depth": 2.8},
    "part.hub": {"diameter": 30, "height": 6, "side": "both"},
}

COMPENSATION: dict[str, Any] = {
    "print.bore_clearance": 0.2,
    "print.key_clearance": 0.1,
    "print.elephant_foot": {"inset": 0.2, "height": 0.4, "steps": 2},
    "print.shrinkage": {"xy": 0.5, "z": 0.3},
}


@cache
def _disc(*keys: str) -> Product:
    """The disc with some of the compensations."""
    design = camgeo.load(SCENES / "plate_translating.toml")
    scene = design.scene.with_values({**PART, **{key: COMPENSATION[key] for key in keys}})
    return camgeo.Design(scene).disc


WHOLE = tuple(COMPENSATION)


@both
def test_a_compensated_body_is_what_it_should_be(writer: Writer) -> None:
    """Of the volume of the exact compensated part, and verified as such."""
    disc = _disc(*WHOLE)
    written = writer.write(disc, TOLERANCE)
    deviation = writer.measure(disc, written.data)
    assert deviation is not None
    assert deviation <= TOLERANCE
    exact = solid(disc.drawn.printed.target).volume
    assert exact != pytest.approx(solid(disc.drawn.part).volume, rel=1e-3)
    assert written.facts["volume_mm3"] == pytest.approx(exact, rel=1e-3)
    assert written.facts["bore_clearance_mm"] == 0.2
    assert "switch off the slicer's own" in str(written.facts["compensation"])
    (finding,) = written.findings
    assert (finding.name, finding.severity) == (COMPENSATED, "warning")
    assert "switch off the slicer's own: elephant foot" in finding.sentence
    assert "bore 0.2 mm larger in diameter, 0.1 mm per side" in finding.sentence
    verifier = VERIFIERS[writer.format.name]
    assert faults(verifier, disc, written.data) == []
    checks = checked(verifier, disc, written.data, Reading("file"))
    assert checks["compensation", ""].value == disc.drawn.printed.text
    assert checks["volume", ""].expected == pytest.approx(exact, rel=1e-9)


@both
@pytest.mark.parametrize("lost", WHOLE)
def test_a_body_without_one_of_them_is_another(writer: Writer, lost: str) -> None:
    """Each compensation is far above the tolerance: without it, the file is not the one."""
    data = writer.write(_disc(*(key for key in WHOLE if key != lost)), TOLERANCE).data
    disc = _disc(*WHOLE)
    if lost == "print.elephant_foot":  # there are fewer flat faces
        with pytest.raises(FileError, match="flat faces at"):
            writer.measure(disc, data)
    else:
        deviation = writer.measure(disc, data)
        assert deviation is not None
        assert deviation > 3.0 * TOLERANCE
    checks = VERIFIERS[writer.format.name].checks(disc, data, Reading("file"), TOLERANCE)
    assert any(each.ok is False for each in checks)


@both
def test_without_compensation_nothing_is_said(writer: Writer) -> None:
    disc = _disc()
    written = writer.write(disc, TOLERANCE)
    assert list(written.facts) == ["triangles", "volume_mm3"]
    assert written.findings == ()
    assert disc.drawn.printed.target is disc.drawn.part
    checks = checked(VERIFIERS[writer.format.name], disc, written.data, Reading("file"))
    assert ("compensation", "") not in checks


def test_other_files_show_the_part_itself() -> None:
    for writer in (DXF, STEP):
        plain, own = _disc(), _disc(*WHOLE)
        assert writer.measure(plain, writer.write(own, TOLERANCE).data) <= TOLERANCE


def test_lib3mf_reads_it_strictly() -> None:
    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromBuffer(THREEMF.write(_disc(*WHOLE), TOLERANCE).data)
    assert reader.GetWarningCount() == 0
    meshes = model.GetMeshObjects()
    assert meshes.MoveNext()
    assert meshes.GetCurrentMeshObject().IsManifoldAndOriented()
    said = model.GetMetaDataGroup().GetMetaDataByKey("", "Description").GetValue()
    assert said.startswith("Compensated for printing: bore 0.2 mm larger in diameter")


def test_a_part_without_room_is_refused_with_the_key() -> None:
    design = camgeo.load(SCENES / "plate_translating.toml")
    for key, value in (("bore_clearance", 60.0), ("elephant_foot", {"inset": 60, "height": 0.2})):
        scene = design.scene.with_values({"part.bore": 20, f"print.{key}": value})
        with pytest.raises(camgeo.GeometryError) as caught:
            camgeo.Design(scene).disc.drawn.printed.target  # noqa: B018  # it is computed now
        assert caught.value.key.startswith(f"print.{key}")
