"""What would not be read back is not written: a file beyond the limits is refused as it is made."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from camgeo import reading
from camgeo.app.cli.main import main
from camgeo.errors import FileError
from camgeo.milling import plan
from camgeo.milling.strategies import walk
from camgeo_export.dxf import writer as dxf_writer
from camgeo_export.gcode import writer
from camgeo_export.solid import prism
from camgeo_export.step import writer as step_writer
from tests.export.stub_product import StubProduct

SCENE = Path(__file__).parents[2] / "fixtures" / "scenes" / "setzhub.toml"


@pytest.mark.parametrize(
    ("name", "module", "limit", "message"),
    [
        ("stl", prism, "FACETS", "stl: the body would have at least "),
        ("3mf", prism, "FACETS", "3mf: the body would have at least "),
        ("step", step_writer, "INSTANCES", "step: the solid would have walls of "),
        ("dxf", dxf_writer, "DRAWING_LINES", "dxf: the drawing would have "),
        ("gcode", plan, "PROGRAM_LINES", "gcode: the program would have more than 200,000 lines"),
        ("gcode", walk, "PROGRAM_LINES", "gcode: the program would have more than 200,000 lines"),
        (
            "gcode",
            writer,
            "PROGRAM_LINES",
            "gcode: the program would have more than 200,000 lines",
        ),
    ],
)
def test_a_file_that_would_not_be_read_is_refused_before_anything_is_written(
    name: str,
    module: object,
    limit: str,
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(module, limit, 1 if module is writer else 20)
    assert main(["build", str(SCENE), "-o", str(tmp_path / "out"), "--only", name]) == 2
    said = capsys.readouterr().err
    assert message in said
    assert "a larger tolerance" in said
    assert not (tmp_path / "out").exists()


def test_walls_within_the_limit_may_have_faces_beyond_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(prism, "FACETS", 100)
    mesh = prism._Mesh()
    mesh.points = [np.zeros((3, 3))]
    mesh.faces = [np.zeros((101, 3), dtype=np.intp)]
    with pytest.raises(FileError, match="would have 101 facets; at most 100"):
        mesh.close()


def test_the_largest_body_is_within_all_other_limits() -> None:
    """A closed surface has half as many vertices as facets, and two more for each of its parts."""
    vertices, digits = reading.FACETS // 2 + 100, 24
    elements = reading.FACETS + vertices + 100
    assert elements <= reading.ELEMENTS
    assert 3 * elements <= reading.ATTRIBUTES
    vertex = len('<vertex x="" y="" z="" />') + 3 * digits
    facet = len('<triangle v1="" v2="" v3="" />') + 3 * len(str(vertices))
    model = vertices * vertex + reading.FACETS * facet
    assert model <= reading.UNPACKED
    assert reading.STL.size >= 84 + 50 * reading.FACETS


def test_the_largest_solid_is_within_all_other_limits() -> None:
    """Of a cam with thousands of pieces, an entity takes 52 bytes, and 5 commas and brackets."""
    data = step_writer.WRITER.write(StubProduct(), 0.01).data
    entities = data.count(b"\n#")
    assert reading.STEP.size >= 1.2 * len(data) / entities * reading.INSTANCES
    marks = data.count(b",") + data.count(b"(")
    assert 1.05 * marks / entities * reading.INSTANCES <= reading.PARAMETERS
