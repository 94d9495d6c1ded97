"""`camgeo verify`: what camgeo builds passes, and each kind of damage is caught, with reasons."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from camgeo.app.cli.main import main
from tests.answers.documents import validator
from tests.end_to_end import damage as d
from tests.end_to_end.built import SCENES, Built
from tests.long_form import LONG

FOLDER = SCENES[0].parent

FORMATS = ("dxf", "gcode", "stl", "3mf", "step")

DAMAGES: dict[str, tuple[str, d.Damage, set[str]]] = {
    "dxf: a moved vertex": (".dxf", d.move_dxf_vertex, {"deviation"}),
    "dxf: a bulge of the wrong sign": (".dxf", d.turn_bulge, {"deviation"}),
    "dxf: a vertex left out": (".dxf", d.leave_out_vertex, {"deviation"}),
    "dxf: a boundary left out": (".dxf", d.leave_out_polyline, {"contours"}),
    "dxf: another unit": (".dxf", d.change_insunits, {"unit", "deviation"}),
    "dxf: mirrored": (".dxf", d.mirror_dxf, {"deviation"}),
    "dxf: scaled": (".dxf", d.scale_dxf, {"deviation", "area"}),
    "dxf: an open polyline": (".dxf", d.open_polyline, {"closure"}),
    "dxf: a digit of a coordinate": (".dxf", d.change_dxf_digit, {"deviation"}),
    "dxf: cut short": (".dxf", d.cut_short, {"file"}),
    "gcode: a moved end": (".ngc", d.move_gcode_end, {"deviation"}),
    "gcode: an arc reversed": (".ngc", d.reverse_arc, {"deviation"}),
    "gcode: a lead left out": (".ngc", d.leave_out_line("G3"), {"leads"}),
    "gcode: a lead reversed": (".ngc", d.reverse_lead, {"kink"}),
    "gcode: a lead into the part": (".ngc", d.lead_into_the_part, {"gouge"}),
    "gcode: an I changed": (".ngc", d.change_word("I", 0.1), {"arc ends", "deviation"}),
    "gcode: a J changed": (".ngc", d.change_word("J", 0.1), {"arc ends", "arcs", "deviation"}),
    "gcode: a block left out": (".ngc", d.leave_out_block, {"arc ends", "deviation"}),
    "gcode: another unit": (".ngc", d.replaced(b"G21", b"G20", -1), {"unit", "deviation"}),
    "gcode: a plunge left out": (".ngc", d.leave_out_line("G1 Z"), {"passes"}),
    "gcode: the spindle stands still": (".ngc", d.leave_out_line("S"), {"safety"}),
    "gcode: path blending": (".ngc", d.replaced(b"G61", b"G64", -1), {"path blending"}),
    "gcode: a word unknown": (".ngc", d.replaced(b"G61", b"G68"), {"program"}),
    "gcode: compensated": (".ngc", d.replaced(b"G61", b"G41"), {"compensation"}),
    "gcode: cut short": (".ngc", d.cut_between_lines, {"passes", "frame"}),
    "stl: a missing facet": (".stl", d.drop_facet, {"closed"}),
    "stl: a flipped facet": (".stl", d.flip_facet, {"oriented"}),
    "stl: a moved edge": (".stl", d.move_stl_vertex, {"deviation"}),
    "stl: a moved corner": (".stl", d.tear_stl, {"closed"}),
    "stl: scaled": (".stl", d.scale_stl, {"deviation", "area", "volume", "height"}),
    "stl: thicker": (".stl", d.thicken_stl, {"height"}),
    "stl: mirrored": (".stl", d.mirror_stl, {"deviation"}),
    "stl: cut short": (".stl", d.cut_short, {"file"}),
    "3mf: a missing facet": (".3mf", d.drop_triangle, {"closed"}),
    "3mf: a flipped facet": (".3mf", d.flip_triangle, {"oriented"}),
    "3mf: a moved edge": (".3mf", d.move_3mf_vertex, {"deviation"}),
    "3mf: scaled": (".3mf", d.scale_3mf, {"deviation", "area", "volume", "height"}),
    "3mf: another unit": (".3mf", d.change_3mf_unit, {"unit", "deviation", "volume"}),
    "3mf: cut short": (".3mf", d.cut_short, {"file"}),
    "step: a sense swapped": (".step", d.swap_sense("ADVANCED_FACE"), {"walls"}),
    "step: an edge turned": (".step", d.swap_sense("EDGE_CURVE"), {"uncertainty"}),
    "step: an edge of a loop turned": (".step", d.swap_sense("ORIENTED_EDGE"), {"closed"}),
    "step: a moved vertex": (".step", d.move_step_vertex, {"uncertainty", "deviation"}),
    "step: a face dropped": (".step", d.drop_step_face, {"closed", "contents"}),
    "step: another radius": (".step", d.change_radius, {"uncertainty"}),
    "step: another unit": (".step", d.replaced(b".MILLI.", b".CENTI."), {"unit", "deviation"}),
    "step: no such entity": (".step", d.replaced(b"_LOOP('',(#", b"_LOOP('',(#9"), {"file"}),
    "step: cut short": (".step", d.cut_short, {"file"}),
}  # fmt: skip
"""Kinds of damage: ending, what is done, and the checks that fail even without a certificate."""

SPLINES: dict[str, tuple[d.Damage, set[str]]] = {
    "a moved control point": (d.move_control, {"deviation"}),
    "a knot changed": (d.change_knot, {"deviation"}),
    "a spline left out": (d.leave_out_spline, {"closure"}),
    "another unit": (d.change_insunits, {"unit", "deviation"}),
    "cut short": (d.cut_short, {"file"}),
}
"""Kinds of damage to a drawing of splines, and the checks that fail."""

LAST_DIGITS: dict[str, tuple[str, d.Damage]] = {
    "dxf": (".dxf", d.change_dxf_last_digit),
    "dxf that names a looser tolerance": (".dxf", d.replaced(b"\n0.001\n", b"\n0.01\n")),
    "gcode": (".ngc", d.change_gcode_last_digit),
}


def _with_and_without(kinds: Iterable[str]) -> list[Any]:
    """Each kind of damage without a certificate, and one for each format with it.

    With a certificate the same checks are made, and the hash of the file besides, which does not
    ask what was changed. The long form makes all of them.
    """
    found = []
    certified = set()
    for kind in kinds:
        name, colon, _ = kind.partition(":")
        file = name if colon else "dxf"
        found.append(pytest.param(kind, False, id=f"{kind}-alone"))
        if LONG or file not in certified:
            found.append(pytest.param(kind, True, id=f"{kind}-certified"))
        certified.add(file)
    return found


def _build(stem: str, folder: Path) -> Path:
    """The scene's files, with the scene in their folder."""
    scene = shutil.copy(FOLDER / f"{stem}.toml", folder)
    words = ["build", str(scene), "-o", str(folder), "--only", ",".join(FORMATS)]
    assert main([*words, "--tolerance", repr(d.TOLERANCE)]) == 0
    return folder


@pytest.fixture(scope="module")
def setzhub(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return _build("setzhub", tmp_path_factory.mktemp("setzhub"))


@pytest.fixture(scope="module")
def vorschub(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return _build("vorschub", tmp_path_factory.mktemp("vorschub"))


@pytest.fixture(scope="module")
def splined(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A drawing of splines."""
    folder = tmp_path_factory.mktemp("splined")
    scene = folder / "setzhub.toml"
    text = (FOLDER / "setzhub.toml").read_text()
    scene.write_text(text + '\n[output.dxf]\nentity = "spline"\n')
    words = ["build", str(scene), "-o", str(folder), "--only", "dxf"]
    assert main([*words, "--tolerance", repr(d.TOLERANCE)]) == 0
    assert main(["verify", str(folder)]) == 0
    return folder


def _verify(capsys: pytest.CaptureFixture[str], *words: object) -> tuple[int, dict[str, Any]]:
    """Exit code, and the report on the first file."""
    capsys.readouterr()
    code = main(["verify", *(str(word) for word in words), "--json"])
    document = json.loads(capsys.readouterr().out)
    validator("camgeo.app.answers.verify").validate(document)
    assert document["passed"] == (code == 0)
    return code, document["files"][0]


def _failed(record: dict[str, Any]) -> set[str]:
    return {check["name"] for check in record["checks"] if check["ok"] is False}


def _damaged(source: Path, suffix: str, change: d.Damage, to: Path, *, certified: bool) -> Path:
    """A copy of one file, damaged, with the scene and perhaps the certificate next to it."""
    (path,) = source.glob(f"*{suffix}")
    before = path.read_bytes()
    after = change(before)
    assert after != before
    target = to / path.name
    target.write_bytes(after)
    (scene,) = source.glob("*.toml")
    shutil.copy(scene, to)
    if certified:
        shutil.copy(source / "certificate.json", to)
    return target


def test_what_is_built_passes(
    built: Built, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Every fixture scene in every format: plate, groove and ring, trimmed ones, mm and inch."""
    for path in built.folder.iterdir():
        shutil.copy(path, tmp_path)
    capsys.readouterr()
    scene = FOLDER / f"{built.design.name}.toml"
    assert main(["verify", str(tmp_path), "--scene", str(scene), "--json"]) == 0
    reported = json.loads(capsys.readouterr().out)
    validator("camgeo.app.answers.verify").validate(reported)
    kept = json.loads((tmp_path / "verification.json").read_text())
    assert [kept[key] for key in ("camgeo", "passed", "files")] == [
        reported[key] for key in ("camgeo", "passed", "files")
    ]
    records = {record["file"]: record for record in reported["files"]}
    assert set(records) == {path.name for path in built.folder.iterdir()} - {"certificate.json"}
    for suffix in (".dxf", ".ngc", ".stl", ".3mf", ".step"):
        record = records[built.file(suffix).name]
        # The readers are others, and the sense in which a contour is run may be too.
        certain = built.deviation(suffix)
        assert record["deviation_mm"] == pytest.approx(certain, rel=0.02, abs=1e-9)
        assert record["scene"]["sha256"] == built.design.disc.scene_hash
    volumes = [c for c in records[built.file(".stl").name]["checks"] if c["name"] == "volume"]
    slack = built.tolerance * built.length * built.height
    assert volumes[0]["expected"] == pytest.approx(built.volume, abs=slack)


@pytest.mark.parametrize(("kind", "certified"), _with_and_without(DAMAGES))
def test_damage_is_caught(
    kind: str,
    certified: bool,
    setzhub: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    suffix, change, expected = DAMAGES[kind]
    path = _damaged(setzhub, suffix, change, tmp_path, certified=certified)
    code, record = _verify(capsys, path)
    assert code == 1
    assert expected <= _failed(record)
    assert ("sha256" in _failed(record)) == certified
    for check in record["checks"]:
        assert check["ok"] is not False or check.get("note") or "value" in check


@pytest.mark.parametrize(("kind", "certified"), _with_and_without(SPLINES))
def test_damage_to_splines_is_caught(
    kind: str,
    certified: bool,
    splined: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    change, expected = SPLINES[kind]
    path = _damaged(splined, ".dxf", change, tmp_path, certified=certified)
    code, record = _verify(capsys, path)
    assert code == 1
    assert expected <= _failed(record)
    assert ("sha256" in _failed(record)) == certified


@pytest.mark.parametrize("kind", LAST_DIGITS)
def test_any_digit_is_caught_with_its_certificate(
    kind: str, setzhub: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The last digit moves nothing that can be measured, but the file's hash shows the change."""
    suffix, change = LAST_DIGITS[kind]
    path = _damaged(setzhub, suffix, change, tmp_path, certified=True)
    code, record = _verify(capsys, path)
    assert code == 1
    assert _failed(record) == {"sha256"} | ({"tolerance"} if "tolerance" in kind else set())
    assert record["deviation_mm"] <= d.TOLERANCE
    (tmp_path / "certificate.json").unlink()
    code, record = _verify(capsys, path)
    assert code == 0
    assert "only its geometry is checked" in record["checks"][0]["note"]


@pytest.mark.parametrize("suffix", [".dxf", ".ngc", ".stl", ".3mf", ".step"])
@pytest.mark.parametrize("certified", [True, False], ids=["certified", "alone"])
def test_another_scene_is_reported(
    suffix: str,
    certified: bool,
    setzhub: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Against a scene that the file was not made from; then against another version of its own
    scene."""
    (path,) = setzhub.glob(f"*{suffix}")
    shutil.copy(path, tmp_path)
    if certified:
        shutil.copy(setzhub / "certificate.json", tmp_path)
    path = tmp_path / path.name
    code, record = _verify(capsys, path, "--scene", FOLDER / "vorschub.toml")
    assert code == 1
    assert {"scene", "deviation"} <= _failed(record)
    other = tmp_path / "other.toml"
    text = (setzhub / "setzhub.toml").read_text()
    assert "radius_ratio = 0.7\n" in text
    other.write_text(text.replace("radius_ratio = 0.7\n", "radius_ratio = 0.71\n"))
    code, record = _verify(capsys, path, "--scene", other)
    assert code == 1
    assert _failed(record) == {"scene"}


def test_files_of_another_scene_under_this_name(
    setzhub: Path, vorschub: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The certificate stays, the drawing is that of another cam."""
    shutil.copy(vorschub / "vorschub.dxf", tmp_path / "setzhub.dxf")
    shutil.copy(setzhub / "certificate.json", tmp_path)
    shutil.copy(vorschub / "vorschub.toml", tmp_path)
    code, record = _verify(capsys, tmp_path / "setzhub.dxf")
    assert code == 1
    assert _failed(record) == {"sha256", "scene"}
    assert record["deviation_mm"] <= d.TOLERANCE
