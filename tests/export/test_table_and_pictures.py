"""CSV reads back to the bit; pictures are the same every time and leave no global state."""

from __future__ import annotations

import math
from collections.abc import Sequence

import matplotlib as mpl
import pytest

from camgeo.cam.cam import Cam, Drive
from camgeo.design.product import Product
from camgeo.design.value_table import Table
from camgeo.errors import FileError, UnknownNameError
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.pictures.model import Figure
from camgeo.pictures.plots import OWN, find, stacked
from camgeo.units import LengthUnit
from camgeo_export import picture as pictures
from camgeo_export.picture import PNG, SVG, PictureWriter
from camgeo_export.plots import render
from camgeo_export.table import WRITER as CSV
from tests.export.stub_product import StubProduct, there_and_back

ROCKER = StubProduct(
    name="rocker",
    cam=Cam(
        Drive(there_and_back(math.radians(10.0)), unit="rad"),
        OscillatingRoller(70.0 + 20.0j, 60.0, 35.0, 8.0),
    ),
)


@pytest.mark.parametrize("unit", ["mm", "inch"])
def test_the_table_reads_back_to_the_bit(unit: LengthUnit) -> None:
    product = StubProduct(unit=unit)
    data = CSV.write(product, 0.001).data
    assert data.startswith(f"phi [deg],s [{unit}],inner x [{unit}],inner y [{unit}]\n".encode())
    assert b"\r" not in data
    assert data.endswith(b"\n")
    assert data.count(b"\n") == 74
    assert CSV.measure(product, data) == 0.0


def test_a_changed_length_is_measured_in_mm() -> None:
    class Changed(StubProduct):
        def table(self) -> Table:
            table = super().table()
            values = table.values.copy()
            values[3, 2] += 0.5
            return Table(table.names, values)

    data = CSV.write(Changed(unit="inch"), 0.001).data
    assert CSV.measure(StubProduct(unit="inch"), data) == pytest.approx(12.7)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"\n5.0,", b"\n5.1,", "angles, ratios or radii differ"),
        (b"phi [deg]", b"phi [rad]", "does not have this scene's columns"),
        (b"\n5.0,", b"\nfive,", "not a number"),
    ],
)
def test_a_changed_table_is_refused(old: bytes, new: bytes, message: str) -> None:
    data = CSV.write(StubProduct(), 0.001).data
    assert old in data
    with pytest.raises(FileError, match=message):
        CSV.measure(StubProduct(), data.replace(old, new))


def test_an_empty_table_is_refused() -> None:
    with pytest.raises(FileError, match="does not have this scene's columns and rows"):
        CSV.measure(StubProduct(), b"")


@pytest.mark.parametrize("writer", [SVG, PNG], ids=["svg", "png"])
def test_pictures_are_the_same_each_time(writer: PictureWriter) -> None:
    product = StubProduct(groove=True)
    data = writer.write(product, 0.001).data
    assert data == writer.write(product, 0.001).data
    writer.measure(product, data)


def test_both_pictures_are_of_one_page(monkeypatch: pytest.MonkeyPatch) -> None:
    """Drawn once, and saved as if it were the only one, whichever is first."""
    alone = {each: each.write(StubProduct(groove=True), 0.001).data for each in (SVG, PNG)}
    made: list[Sequence[str]] = []

    def counted(product: Product, wanted: Sequence[str]) -> Figure:
        made.append(wanted)
        return stacked(product, wanted)

    monkeypatch.setattr(pictures, "stacked", counted)
    for order in ((SVG, PNG), (PNG, SVG)):
        product = StubProduct(groove=True)
        assert all(each.write(product, 0.001).data == alone[each] for each in order)
    assert made == [["cam"], ["cam"]]


@pytest.mark.parametrize("name", OWN)
def test_every_plot_draws(name: str) -> None:
    assert render(stacked(ROCKER, [name]), ".svg").startswith(b"<?xml")


def test_a_pivot_is_drawn() -> None:
    assert ROCKER.pictured.follower_sketch.kind == "pivot"
    rocker, guided = (
        render(stacked(product, ["cam"]), ".svg") for product in (ROCKER, StubProduct())
    )
    assert rocker != guided


def test_plots_stack_and_leave_no_state() -> None:
    before = dict(mpl.rcParams)
    data = render(stacked(StubProduct(), ["motion", "transmission-angle"]), ".pdf")
    assert data.startswith(b"%PDF")
    assert data == render(stacked(StubProduct(), ["motion", "transmission-angle"]), ".pdf")
    assert dict(mpl.rcParams) == before


def test_unknown_plots_and_kinds() -> None:
    with pytest.raises(UnknownNameError, match='did you mean "motion"'):
        find("motoin")
    with pytest.raises(ValueError, match=r"\.svg, \.png and \.pdf"):
        render(stacked(StubProduct(), ["cam"]), ".bmp")
