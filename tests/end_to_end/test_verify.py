"""`camgeo verify`: what camgeo builds passes, and each kind of damage is caught, with reasons."""

from __future__ import annotations

import json
import shutil
from functools import cache
from pathlib import Path

import pytest

from camgeo.app.answers.verify import Against, Verdict, Wanted, verify_files
from camgeo.app.cli.main import main
from camgeo.design.design import Design
from camgeo.scene.scene import load_scene
from tests.answers.documents import validator
from tests.end_to_end import damage as d
from tests.end_to_end.built import SCENES, Built

FOLDER = SCENES[0].parent

FORMATS = ("dxf", "gcode", "stl", "3mf", "step")

DAMAGES: dict[str, tuple[str, d.Damage, set[str]]] = {
    "dxf: a moved vertex": (".dxf", d.move_dxf_vertex, {"deviation"}),
    "dxf: a bulge of the wrong sign": (".dxf", d.turn_bulge, {"deviation"}),
    "dxf: a vertex left out": (".dxf", d.leave_out_vertex, {"deviation"}),
    "dxf: a boundary left out": (".dxf", d.leave_out_polyline, {"contours"}),
    "dxf: another unit": (".dxf", d.change_insunits, {"deviation"}),
    "dxf: mirrored": (".dxf", d.times(-1.0, 10, 42), {"deviation"}),
    "dxf: scaled": (".dxf", d.times(1.001, 10, 20), {"deviation", "area"}),
    "dxf: an open polyline": (".dxf", d.open_polyline, {"closure"}),
    "dxf: a digit of a coordinate": (".dxf", d.change_dxf_digit, {"deviation"}),
    "dxf: cut short": (".dxf", d.cut_short, {"file"}),
    "gcode: a moved end": (".ngc", d.move_gcode_end, {"deviation"}),
    "gcode: an arc reversed": (".ngc", d.reverse_arc, {"deviation"}),
    "gcode: a lead left out": (".ngc", d.leave_out_line("G3"), set()),
    "gcode: a lead reversed": (".ngc", d.reverse_lead, set()),
    "gcode: a lead into the part": (".ngc", d.lead_into_the_part, {"simulation"}),
    "gcode: an I changed": (".ngc", d.change_word("I", 0.1), {"arc ends", "deviation"}),
    "gcode: a J changed": (".ngc", d.change_word("J", 0.1), {"arc ends", "arcs", "deviation"}),
    "gcode: a block left out": (".ngc", d.leave_out_block, {"arc ends", "deviation"}),
    "gcode: another unit": (".ngc", d.replaced(b"G21", b"G20", -1), {"deviation"}),
    "gcode: a plunge left out": (".ngc", d.leave_out_line("G1 Z"), {"passes"}),
    "gcode: the spindle stands still": (".ngc", d.leave_out_line("S"), {"safety"}),
    "gcode: path blending": (".ngc", d.replaced(b"G61", b"G64", -1), {"path blending"}),
    "gcode: a word unknown": (".ngc", d.replaced(b"G61", b"G68"), {"program"}),
    "gcode: compensated": (".ngc", d.replaced(b"G61", b"G41"), {"compensation"}),
    "gcode: cut short": (".ngc", d.cut_between_lines, {"passes", "frame"}),
    "gcode: a feed": (".ngc", d.replaced(b"F100", b"F101"), set()),
    "gcode: a speed": (".ngc", d.replaced(b"S3000", b"S3001"), set()),
    "gcode: a tool length": (".ngc", d.replaced(b"H1", b"H2"), set()),
    "gcode: a work offset": (".ngc", d.replaced(b"G0 ", b"G55 G0 "), set()),
    "gcode: a comment": (".ngc", d.replaced(b"diameter 10", b"diameter 12"), set()),
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
    "3mf: another unit": (".3mf", d.change_3mf_unit, {"deviation", "volume"}),
    "3mf: cut short": (".3mf", d.cut_short, {"file"}),
    "step: a sense swapped": (".step", d.swap_sense("ADVANCED_FACE"), {"walls"}),
    "step: an edge turned": (".step", d.swap_sense("EDGE_CURVE"), {"uncertainty"}),
    "step: an edge of a loop turned": (".step", d.swap_sense("ORIENTED_EDGE"), {"closed"}),
    "step: a moved vertex": (".step", d.move_step_vertex, {"uncertainty", "deviation"}),
    "step: a face dropped": (".step", d.drop_step_face, {"closed"}),
    "step: another radius": (".step", d.change_radius, {"uncertainty"}),
    "step: another unit": (".step", d.replaced(b".MILLI.", b".CENTI."), {"deviation"}),
    "step: no such entity": (".step", d.replaced(b"_LOOP('',(#", b"_LOOP('',(#9"), {"file"}),
    "step: another name": (".step", d.replaced(b"'outline'", b"'rim'"), set()),
    "step: cut short": (".step", d.cut_short, {"file"}),
    "spline: a moved control point": (".dxf", d.move_control, {"deviation"}),
    "spline: a knot changed": (".dxf", d.change_knot, {"deviation"}),
    "spline: a spline left out": (".dxf", d.leave_out_spline, {"closure"}),
    "spline: another unit": (".dxf", d.change_insunits, {"deviation"}),
}  # fmt: skip
"""Kinds of damage: ending, what is done, and the checks that measure it. That the file is not what
camgeo writes is told of all that can be read.
"""

CERTIFIED = (
    "dxf: a moved vertex",
    "gcode: a feed",
    "stl: thicker",
    "3mf: scaled",
    "step: cut short",
)

LAST_DIGITS: dict[str, tuple[str, d.Damage, set[str]]] = {
    "dxf": (".dxf", d.change_dxf_last_digit, set()),
    "dxf that names a looser tolerance": (
        ".dxf", d.replaced(b"\n0.001\n", b"\n0.01\n"), {"written again", "tolerance"},
    ),
    "gcode": (".ngc", d.change_word("X", 1e-4), {"written again"}),
}  # fmt: skip
"""Changes that are within the tolerance, and the checks that fail besides the file's hash."""


@pytest.fixture(scope="session")
def sources(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Folders with scenes and their files: two, and the first one drawn with splines."""
    folders = {}
    text = (FOLDER / "setzhub.toml").read_text()
    for name, scene, formats in (
        ("setzhub", text, FORMATS),
        ("vorschub", (FOLDER / "vorschub.toml").read_text(), ("dxf",)),
        ("spline", f'{text}\n[output.dxf]\nentity = "spline"\n', ("dxf",)),
    ):
        folders[name] = tmp_path_factory.mktemp(name)
        path = folders[name] / "scene.toml"
        path.write_text(scene)
        words = ["build", str(path), "-o", str(path.parent), "--only", ",".join(formats)]
        assert main([*words, "--tolerance", repr(d.TOLERANCE)]) == 0
    return folders


@cache
def _against(scene: Path) -> Against:
    design = Design(load_scene(scene))
    return Against(design.discs, design.scene.output.tolerance)


def _verdict(path: Path, scene: Path) -> Verdict:
    (verdict,) = verify_files((path,), lambda *_: _against(scene), Wanted())
    return verdict


def _failed(verdict: Verdict) -> set[str]:
    return {check.name for check in verdict.checks if check.ok is False}


def _damaged(source: Path, suffix: str, change: d.Damage, to: Path, *, certified: bool) -> Path:
    """A copy of one file, damaged, perhaps with the certificate next to it."""
    (path,) = source.glob(f"*{suffix}")
    after = change(path.read_bytes())
    assert after != path.read_bytes()
    target = to / path.name
    target.write_bytes(after)
    if certified:
        shutil.copy(source / "certificate.json", to)
    return target


def test_what_is_built_passes(
    built: Built, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Every fixture scene in every format: plate, groove and ring, trimmed ones, mm and inch."""
    shutil.copytree(built.folder, tmp_path, dirs_exist_ok=True)
    capsys.readouterr()
    scene = FOLDER / f"{built.design.name}.toml"
    assert main(["verify", str(tmp_path), "--scene", str(scene), "--json"]) == 0
    reported = json.loads(capsys.readouterr().out)
    validator("camgeo.app.answers.verify").validate(reported)
    records = {record["file"]: record for record in reported["files"]}
    assert set(records) == {path.name for path in built.folder.iterdir()} - {"certificate.json"}
    for suffix in (".dxf", ".ngc", ".stl", ".3mf", ".step"):
        record = records[built.file(suffix).name]
        (again,) = (each for each in record["checks"] if each["name"] == "written again")
        assert (again["value"], again["ok"]) == ("the same", True)
        # The readers are others, and the sense in which a contour is run may be too.
        certain = built.deviation(suffix)
        assert record["deviation_mm"] == pytest.approx(certain, rel=0.02, abs=1e-9)
        assert record["scene"]["sha256"] == built.design.disc.scene_hash
    volumes = [c for c in records[built.file(".stl").name]["checks"] if c["name"] == "volume"]
    slack = built.tolerance * built.length * built.height
    assert volumes[0]["expected"] == pytest.approx(built.volume, abs=slack)


@pytest.mark.parametrize("kind", DAMAGES)
def test_damage_is_caught(kind: str, sources: dict[str, Path], tmp_path: Path) -> None:
    """By measures with reasons, and as what camgeo does not write: of a mesh that does not state
    its tolerance this is only said.
    """
    suffix, change, expected = DAMAGES[kind]
    source = sources.get(kind.partition(":")[0], sources["setzhub"])
    path = _damaged(source, suffix, change, tmp_path, certified=False)
    verdict = _verdict(path, source / "scene.toml")
    assert not verdict.passed
    assert expected <= _failed(verdict)
    unread = kind.endswith("cut short") and suffix != ".ngc"
    again = [check.ok for check in verdict.checks if check.name == "written again"]
    assert again == ([] if unread else [None] if suffix == ".stl" else [False])
    for check in verdict.checks:
        assert check.ok is not False or check.note or check.value is not None


@pytest.mark.parametrize("kind", CERTIFIED)
def test_a_certificate_shows_any_damage(
    kind: str, sources: dict[str, Path], tmp_path: Path
) -> None:
    suffix, change, expected = DAMAGES[kind]
    source = sources["setzhub"]
    path = _damaged(source, suffix, change, tmp_path, certified=True)
    again = {"written again"} if "file" not in expected else set()
    assert {"sha256", *expected, *again} <= _failed(_verdict(path, source / "scene.toml"))


@pytest.mark.parametrize("kind", LAST_DIGITS)
def test_digits_within_the_tolerance(kind: str, sources: dict[str, Path], tmp_path: Path) -> None:
    """What is rounded otherwise is no difference, but the file's hash shows it."""
    suffix, change, expected = LAST_DIGITS[kind]
    source = sources["setzhub"]
    path = _damaged(source, suffix, change, tmp_path, certified=True)
    verdict = _verdict(path, source / "scene.toml")
    assert _failed(verdict) == {"sha256", *expected}
    assert verdict.deviation is not None
    assert verdict.deviation <= d.TOLERANCE
    (tmp_path / "certificate.json").unlink()
    verdict = _verdict(path, source / "scene.toml")
    assert _failed(verdict) == expected - {"tolerance"}
    assert "only its geometry is checked" in verdict.checks[0].note


@pytest.mark.parametrize("suffix", [".dxf", ".ngc", ".stl", ".3mf", ".step"])
def test_another_scene_is_reported(suffix: str, sources: dict[str, Path], tmp_path: Path) -> None:
    """Against a scene that the file was not made from; then against another version of its own
    scene."""
    (path,) = sources["setzhub"].glob(f"*{suffix}")
    assert {"scene", "deviation"} <= _failed(_verdict(path, sources["vorschub"] / "scene.toml"))
    other = tmp_path / "other.toml"
    text = (sources["setzhub"] / "scene.toml").read_text()
    assert "radius_ratio = 0.7\n" in text
    other.write_text(text.replace("radius_ratio = 0.7\n", "radius_ratio = 0.71\n"))
    assert _failed(_verdict(path, other)) == {"scene"}


def test_files_of_another_scene_under_this_name(sources: dict[str, Path], tmp_path: Path) -> None:
    """The certificate stays, the drawing is that of another cam."""
    shutil.copy(sources["vorschub"] / "vorschub.dxf", tmp_path / "setzhub.dxf")
    shutil.copy(sources["setzhub"] / "certificate.json", tmp_path)
    verdict = _verdict(tmp_path / "setzhub.dxf", sources["vorschub"] / "scene.toml")
    assert _failed(verdict) == {"sha256", "scene"}
    assert verdict.deviation is not None
    assert verdict.deviation <= d.TOLERANCE
