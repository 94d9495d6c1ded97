"""`camgeo verify`: what camgeo builds passes, and each kind of damage is caught, with reasons."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from camgeo.app.answers.verify import FileVerdict, Reference, Wanted, verify_files
from camgeo.app.cli.main import main
from camgeo.design.design import Design
from camgeo.scene.scene import load_scene
from camgeo_export.verify.stl import FACET, PREFIX
from tests.answers.documents import validator
from tests.end_to_end.built import SCENES, Built
from tests.export.test_verify import places

FOLDER = SCENES[0].parent

FORMATS = ("dxf", "gcode", "stl", "3mf", "step")

TOLERANCE = 1e-3
"""At which the files are built [mm]."""

# Damage, as by a slip, an editor or a converter ---------------------------------------------------

Damage = Callable[[bytes], bytes]


def replaced(old: bytes, new: bytes, count: int = 1) -> Damage:
    """The first `count` occurrences replaced, all of them for -1."""
    return lambda data: data.replace(old, new, count)


def cut_short(data: bytes) -> bytes:
    return data[: len(data) * 7 // 10]


def scaled(factor: float, *codes: str) -> Damage:
    """All values of some groups of a drawing multiplied."""

    def change(data: bytes) -> bytes:
        lines = data.decode().split("\n")
        for place in places(lines, codes):
            lines[place] = repr(factor * float(lines[place]))
        return "\n".join(lines).encode()

    return change


def shifted(by: float) -> Damage:
    """A vertex of the outline moved, the first polyline of a drawing [mm]."""

    def change(data: bytes) -> bytes:
        lines = data.decode().split("\n")
        place = places(lines, ("20",))[8]
        lines[place] = repr(float(lines[place]) + by)
        return "\n".join(lines).encode()

    return change


def without_outline(data: bytes) -> bytes:
    begin = b"\n  0\nLWPOLYLINE\n"
    head, _, *others = data.split(begin)
    return begin.join((head, *others))


def with_word(letter: str, by: float) -> Damage:
    """A word of an arc of the outline's program changed."""

    def change(data: bytes) -> bytes:
        head, mark, tail = data.decode().partition("(operation outline)")
        arcs = tail.split("\nG2 ")
        arcs[5] = re.sub(
            rf"{letter}(-?[\d.]+)", lambda word: f"{letter}{float(word[1]) + by:.4f}", arcs[5]
        )
        return "".join((head, mark, "\nG2 ".join(arcs))).encode()

    return change


def leave_out_line(start: str) -> Damage:
    """The last line that begins so is left out."""

    def leave_out(data: bytes) -> bytes:
        lines = data.decode().splitlines(keepends=True)
        del lines[max(k for k, line in enumerate(lines) if line.startswith(start))]
        return "".join(lines).encode()

    return leave_out


def cut_between_lines(data: bytes) -> bytes:
    """Cut short at the end of a line, so that every word is whole."""
    return data[: data.rindex(b"\n", 0, len(data) * 7 // 10) + 1]


def swapped(kind: str) -> Damage:
    """The last entity of a kind of a STEP file that ends in a truth value has the other one."""

    def change(data: bytes) -> bytes:
        *_, last = re.finditer(rf"={kind}\(.*\.([TF])\.\);".encode(), data)
        other = b"F" if last.group(1) == b"T" else b"T"
        return data[: last.start(1)] + other + data[last.end(1) :]

    return change


def thicker(data: bytes) -> bytes:
    """An STL whose upper face is higher."""
    facets = np.frombuffer(data[PREFIX:], dtype=FACET).copy()
    facets["corners"][:, :, 2] *= np.float32(1.001)
    return data[:PREFIX] + facets.tobytes()


DAMAGES: dict[str, tuple[str, Damage, set[str]]] = {
    "dxf: a moved vertex": (".dxf", shifted(20.0 * TOLERANCE), {"deviation"}),
    "dxf: a boundary left out": (".dxf", without_outline, {"contours"}),
    "dxf: another unit": (".dxf", replaced(b"UNITS\n 70\n4", b"UNITS\n 70\n1"), {"deviation"}),
    "dxf: mirrored": (".dxf", scaled(-1.0, "10", "42"), {"deviation"}),
    "dxf: scaled": (".dxf", scaled(1.001, "10", "20"), {"deviation", "area"}),
    "dxf: an open polyline": (".dxf", replaced(b" 70\n1\n 10\n", b" 70\n0\n 10\n"), {"closure"}),
    "dxf: cut short": (".dxf", cut_short, {"file"}),
    "gcode: a lead left out": (".ngc", leave_out_line("G3"), set()),
    "gcode: an I changed": (".ngc", with_word("I", 0.1), {"arc ends", "deviation"}),
    "gcode: another unit": (".ngc", replaced(b"G21", b"G20", -1), {"deviation"}),
    "gcode: a plunge left out": (".ngc", leave_out_line("G1 Z"), {"passes"}),
    "gcode: the spindle stands still": (".ngc", leave_out_line("S"), {"safety"}),
    "gcode: path blending": (".ngc", replaced(b"G61", b"G64", -1), {"path blending"}),
    "gcode: a word unknown": (".ngc", replaced(b"G61", b"G68"), {"program"}),
    "gcode: compensated": (".ngc", replaced(b"G61", b"G41"), {"compensation"}),
    "gcode: cut short": (".ngc", cut_between_lines, {"passes", "frame"}),
    "gcode: a feed": (".ngc", replaced(b"F100", b"F101"), set()),
    "gcode: a speed": (".ngc", replaced(b"S3000", b"S3001"), set()),
    "gcode: a tool length": (".ngc", replaced(b"H1", b"H2"), set()),
    "gcode: a work offset": (".ngc", replaced(b"G0 ", b"G55 G0 "), set()),
    "gcode: a comment": (".ngc", replaced(b"diameter 10", b"diameter 12"), set()),
    "stl: thicker": (".stl", thicker, {"height"}),
    "stl: cut short": (".stl", cut_short, {"file"}),
    "3mf: cut short": (".3mf", cut_short, {"file"}),
    "step: a sense swapped": (".step", swapped("ADVANCED_FACE"), {"walls"}),
    "step: an edge turned": (".step", swapped("EDGE_CURVE"), {"uncertainty"}),
    "step: an edge of a loop turned": (".step", swapped("ORIENTED_EDGE"), {"closed"}),
    "step: another unit": (".step", replaced(b".MILLI.", b".CENTI."), {"deviation"}),
    "step: no such entity": (".step", replaced(b"_LOOP('',(#", b"_LOOP('',(#9"), {"file"}),
    "step: another name": (".step", replaced(b"'outline'", b"'rim'"), set()),
    "step: cut short": (".step", cut_short, {"file"}),
}  # fmt: skip
"""Kinds of damage: ending, what is done, and the checks that measure it. That the file is not what
camgeo writes is told of all that can be read. Each field of a mesh and of a STEP file is changed in
`tests/export/test_verify_mutations.py` and `tests/export/test_step.py`.
"""

CERTIFIED = (
    "dxf: a moved vertex",
    "gcode: a feed",
    "stl: thicker",
    "3mf: cut short",
    "step: cut short",
)

LAST_DIGITS: dict[str, tuple[str, Damage, set[str]]] = {
    "dxf": (".dxf", shifted(1e-10), set()),
    "dxf that names a looser tolerance": (
        ".dxf", replaced(b"\n0.001\n", b"\n0.01\n"), {"written again", "tolerance"},
    ),
    "gcode": (".ngc", with_word("X", 1e-4), {"written again"}),
}  # fmt: skip
"""Changes that are within the tolerance, and the checks that fail besides the file's hash."""


@pytest.fixture(scope="session")
def sources(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Folders with a scene and its files."""
    folders = {}
    for name, formats in (("setzhub", FORMATS), ("vorschub", ("dxf",))):
        folders[name] = tmp_path_factory.mktemp(name)
        path = folders[name] / "scene.toml"
        shutil.copy(FOLDER / f"{name}.toml", path)
        words = ["build", str(path), "-o", str(path.parent), "--only", ",".join(formats)]
        assert main([*words, "--tolerance", repr(TOLERANCE)]) == 0
    return folders


@cache
def _against(scene: Path) -> Reference:
    design = Design(load_scene(scene))
    return Reference(design.discs, design.scene.output.tolerance)


def _verdict(path: Path, scene: Path) -> FileVerdict:
    (verdict,) = verify_files((path,), lambda *_: _against(scene), Wanted())
    return verdict


def _failed(verdict: FileVerdict) -> set[str]:
    return {check.name for check in verdict.checks if check.ok is False}


def _damaged(source: Path, suffix: str, change: Damage, to: Path, *, certified: bool) -> Path:
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
    source = sources["setzhub"]
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
    assert verdict.deviation <= TOLERANCE
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
    assert verdict.deviation <= TOLERANCE
