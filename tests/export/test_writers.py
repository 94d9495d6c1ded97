"""Every writer is a `Writer`, and its file stands for itself."""

from __future__ import annotations

import pytest

from camgeo.design.writing import Writer
from camgeo_export.dxf.writer import WRITER as DXF
from camgeo_export.gcode.writer import WRITER as GCODE
from camgeo_export.picture import PNG, SVG
from camgeo_export.step.writer import WRITER as STEP
from camgeo_export.stl import WRITER as STL
from camgeo_export.table import WRITER as CSV
from camgeo_export.threemf.writer import WRITER as THREEMF
from tests.export.stub_product import StubProduct

WRITERS: dict[str, Writer] = {
    ".dxf": DXF,
    ".ngc": GCODE,
    ".stl": STL,
    ".3mf": THREEMF,
    ".step": STEP,
    ".csv": CSV,
    ".svg": SVG,
    ".png": PNG,
}


@pytest.mark.parametrize("suffix", WRITERS)
def test_suffix_and_content(suffix: str) -> None:
    writer = WRITERS[suffix]
    written = writer.write(StubProduct(), 0.01)
    assert writer.format.suffix == suffix
    assert written.data
    assert all(isinstance(value, int | float | str) for value in written.facts.values())


@pytest.mark.parametrize("suffix", [".dxf", ".ngc", ".stl", ".3mf", ".step", ".csv"])
def test_another_design_s_file_is_measured_as_wrong(suffix: str) -> None:
    writer = WRITERS[suffix]
    data = writer.write(StubProduct(scale=1.01), 0.01).data
    measured = writer.measure(StubProduct(), data)
    assert measured is not None
    assert measured > 0.05
