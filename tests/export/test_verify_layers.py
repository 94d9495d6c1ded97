"""Verification of drawings whose edges are on layers by depth, and of those of before."""

from __future__ import annotations

import pytest

import camgeo
from camgeo.design.product import Product
from camgeo.design.verify import Reading
from camgeo_export.dxf import writer
from camgeo_export.dxf.writer import WRITER
from camgeo_export.reading import CUT
from camgeo_export.verify.dxf import VERIFIER
from tests.effects.scenes import SCENES
from tests.export.verified import TOLERANCE, checked, faults


def disc(entity: str) -> Product:
    """Drawn fast, and without auxiliary curves."""
    edits = {"fit": "fast", "dxf.auxiliary": False, "dxf.entity": entity}
    return camgeo.load(SCENES / "groove.toml").with_output(edits).disc


@pytest.fixture(scope="module")
def groove() -> Product:
    return disc("arcs")


@pytest.fixture(scope="module")
def data(groove: Product) -> bytes:
    return WRITER.write(groove, TOLERANCE).data


def test_each_boundary_is_sought_on_its_layer(groove: Product, data: bytes) -> None:
    assert faults(VERIFIER, groove, data) == []
    checks = checked(VERIFIER, groove, data, Reading("groove.dxf", ours=True))
    assert {of for name, of in checks if name == "contours"} == {"layer CUT", "layer BLIND_10"}
    assert ("layers", "") not in checks


def test_a_drawing_of_before_is_verified_and_told(
    groove: Product, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All edges on layer CUT, as camgeo drew them."""
    boundaries = groove.drawn.part.boundaries
    monkeypatch.setattr(writer, "layered", lambda _: {CUT: boundaries})
    before = WRITER.write(groove, TOLERANCE).data
    assert faults(VERIFIER, groove, before) == []
    checks = checked(VERIFIER, groove, before, Reading("groove.dxf", ours=True))
    assert "earlier version" in checks["layers", ""].note
    assert checks["contours", ""].value == 4.0


def test_flanks_that_have_come_to_be_cut_through_are_found(groove: Product, data: bytes) -> None:
    """One of them, so that the layer of the other is still there."""
    text = data.decode().replace("\r\n", "\n")
    moved = text.replace("  8\nBLIND_10\n", "  8\nCUT\n", 1)
    assert moved != text
    found = {(each.name, each.of) for each in faults(VERIFIER, groove, moved.encode())}
    assert {("contours", "layer CUT"), ("contours", "layer BLIND_10")} <= found


@pytest.mark.parametrize("entity", ["arcs", "lines-and-arcs"])
def test_a_foreign_drawing_is_read_from_all_layers_of_the_part(entity: str) -> None:
    """As a CAD program saves one of ours, whose origin it does not keep."""
    product = disc(entity)
    data = WRITER.write(product, TOLERANCE).data
    checks = checked(VERIFIER, product, data, Reading("groove.dxf", ours=False))
    assert all(each.ok is not False for each in checks.values())
    assert checks["contours", ""].value == 4.0
