"""Plates in 3MF packages: written, read by lib3mf, measured, verified, and mutated."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import lib3mf  # type: ignore[import-untyped]  # it has no types
import pytest

import camgeo
from camgeo.design.plate import plate_of
from camgeo.design.product import Product
from camgeo.design.verify import Reading
from camgeo.design.writing import make_files
from camgeo.errors import FileError
from camgeo.part.mass import solid
from camgeo_export.threemf.writer import WRITER
from camgeo_export.verify.threemf import VERIFIER
from tests.contour.cams import SCENES
from tests.export.verified import TOLERANCE, checked, faults
from tests.packages import repacked

BODIES = ["cam", "return-cam", "roller", "test-ring"]

VALUES: dict[str, Any] = {
    "output.3mf.plate": BODIES,
    "output.3mf.roller_bore": 6,
    "drawing.title": "Nockenhebel für Ø8",
    "print.bore_clearance": 0.2,
    "print.elephant_foot": {"inset": 0.2, "height": 0.4},
}


@cache
def _discs() -> tuple[Product, ...]:
    scene = camgeo.load(SCENES / "conjugate_carriage.toml").scene
    return camgeo.Design(scene.with_values(VALUES)).discs


@cache
def _written() -> bytes:
    return WRITER.write(_discs()[0], TOLERANCE).data


def test_one_file_has_all() -> None:
    discs = _discs()
    files, (report,) = make_files(discs, ("3mf",), TOLERANCE)
    assert sorted(files) == ["certificate.json", "conjugate_carriage.3mf"]
    assert report.facts["bodies"] == "cam, return-cam, roller, test-ring"
    plate = plate_of(discs[0])
    whole = sum(solid(each.part).volume for each in plate)
    assert report.facts["volume_mm3"] == pytest.approx(whole, rel=1e-3)
    assert report.deviation is not None
    assert 0.5 * TOLERANCE < report.deviation <= TOLERANCE
    assert files["conjugate_carriage.3mf"] == _written()  # the same bytes again


def test_lib3mf_reads_it_strictly() -> None:
    """Names, colours and places are those of the plate, volumes those of the exact bodies."""
    plate = plate_of(_discs()[0])
    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromBuffer(_written())
    assert reader.GetWarningCount() == 0
    items = model.GetBuildItems()
    for piece in plate:
        assert items.MoveNext()
        item = items.GetCurrent()
        shift = item.GetObjectTransform().Fields[3]
        assert list(shift) == pytest.approx([piece.x, piece.y, 0.0], rel=1e-6)
        mesh = model.GetMeshObjectByID(item.GetObjectResource().GetResourceID())
        assert mesh.GetName() == piece.name
        assert mesh.IsManifoldAndOriented()
        group, number, coloured = mesh.GetObjectLevelProperty()
        assert coloured
        bases = model.GetBaseMaterialGroupByID(group)
        colour = bases.GetDisplayColor(number)
        assert f"#{colour.Red:02X}{colour.Green:02X}{colour.Blue:02X}" == piece.colour
        assert bases.GetName(number) == piece.name
        box = mesh.GetOutbox()
        low, high = list(box.MinCoordinate), list(box.MaxCoordinate)
        assert max(map(abs, (*low[:2], *high[:2]))) <= piece.reach + TOLERANCE
        assert high[2] - low[2] == pytest.approx(piece.part.thickness, rel=1e-6)
    assert not items.MoveNext()
    assert plate[0].name == "Nockenhebel für Ø8"


def test_it_is_verified() -> None:
    disc = _discs()[0]
    assert faults(VERIFIER, disc, _written()) == []
    checks = checked(VERIFIER, disc, _written(), Reading("file"))
    for piece in plate_of(disc):
        volume = checks["volume", piece.name]
        assert volume.expected == pytest.approx(solid(piece.part).volume, rel=1e-9)


def _swapped(text: str, one: str, other: str) -> str:
    return text.replace(one, "\0").replace(other, one).replace("\0", other)


MUTATIONS: dict[str, Callable[[str], str]] = {
    "a name": lambda text: text.replace('name="roller" pid', 'name="router" pid'),
    "a colour": lambda text: text.replace("#E0A030", "#E0A031"),
    "the colours of two": lambda text: _swapped(text, 'pindex="0"', 'pindex="1"'),
    "a place": lambda text: text.replace("0 0 0 1 ", "0 0 0 1 1", 1),
    "a scale": lambda text: text.replace('transform="1 ', 'transform="1.001 ', 1),
    "the bodies of two": lambda text: _swapped(text, 'objectid="2"', 'objectid="3"'),
    "a body lost": lambda text: text[: text.rindex("<item")] + "</build></model>",
    "a vertex": lambda text: text.replace('vertex x="', 'vertex x="1', 1),
    "a body twice": lambda text: text.replace('objectid="5"', 'objectid="4"'),
}


@pytest.mark.parametrize("kind", MUTATIONS)
def test_what_is_changed_is_found(kind: str) -> None:
    disc = _discs()[0]
    change = MUTATIONS[kind]
    data = repacked(_written(), lambda path, text: change(text) if "model" in path else text)
    assert data != _written()
    assert faults(VERIFIER, disc, data)
    if "colour" not in kind:
        try:
            deviation = WRITER.measure(disc, data)
        except FileError:
            return
        assert deviation is not None
        assert deviation > TOLERANCE


def test_another_plate_is_another_file() -> None:
    scene = _discs()[0].scene.with_values({"output.3mf.plate": BODIES[:3]})
    disc = camgeo.Design(scene).disc
    with pytest.raises(FileError, match="other objects"):
        WRITER.measure(disc, _written())
    assert faults(VERIFIER, disc, _written())
    scene = _discs()[0].scene.with_values(
        {"output.3mf.plate": None, "output.3mf.roller_bore": None}
    )
    alone = camgeo.Design(scene).disc
    with pytest.raises(FileError, match="other objects"):
        WRITER.measure(alone, _written())


def test_a_pair_in_one_piece_has_one_plate() -> None:
    scene = camgeo.load(SCENES / "conjugate_carriage.toml").scene
    values = {"part.pair": {"gap": 8, "spacer": 40}, "output.3mf.plate": ["cam", "roller"]}
    discs = camgeo.Design(scene.with_values(values)).discs
    files, (report,) = make_files(discs, ("3mf",), 0.1)
    assert report.name == "conjugate_carriage-pair.3mf"
    assert discs[0].pair is not None
    data = files[report.name]
    checks = VERIFIER.checks(discs[0].pair, data, Reading(report.name), 0.1)
    assert [each for each in checks if each.ok is False] == []


def test_without_a_plate_each_disc_has_a_file_of_its_own() -> None:
    design = camgeo.load(SCENES / "conjugate_carriage.toml")
    pieces = [WRITER.pieces(each) for each in design.discs]
    assert pieces == [(each,) for each in design.discs]
    assert [WRITER.pieces(each) for each in _discs()] == [(_discs()[0],), ()]
