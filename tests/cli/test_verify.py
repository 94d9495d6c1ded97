"""`camgeo verify` as a command: where it finds scenes, what it writes, how it exits."""

from __future__ import annotations

import errno
import hashlib
import json
import re
import shutil
from pathlib import Path

import pytest

import camgeo
from camgeo.app.answers.verify import verify
from camgeo.reading import VERIFIED
from camgeo_export.verify.dxf import VERIFIER
from tests.cli.calling import SCENES, Called, called

SCENE = SCENES / "vorschub.toml"


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A drawing, a table, a body and their certificate; without a scene in their folder."""
    folder = tmp_path_factory.mktemp("source")
    words = ("-o", folder, "--only", "dxf,csv,stl", "--tolerance", "0.05")
    assert called("build", SCENE, *words).code == 0
    return folder


@pytest.fixture
def folder(source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Drawing, table and certificate, which a test may change; the present folder is above."""
    monkeypatch.chdir(tmp_path)
    found = Path(shutil.copytree(source, tmp_path / "parts"))
    (found / "vorschub.stl").unlink()
    certificate = json.loads((found / "certificate.json").read_text())
    certificate["files"] = [each for each in certificate["files"] if "stl" not in each["file"]]
    (found / "certificate.json").write_text(json.dumps(certificate))
    return found


@pytest.fixture
def bare(source: Path, tmp_path: Path) -> Path:
    """Drawing and body, without their certificate."""
    found = Path(shutil.copytree(source, tmp_path / "bare"))
    for name in ("certificate.json", "vorschub.csv"):
        (found / name).unlink()
    return found


def with_scene(folder: Path, *words: object) -> Called:
    return called("verify", folder, "--scene", SCENE, *words)


def verdicts(folder: Path) -> tuple[int, dict[str, str]]:
    """The exit code, and the failed checks of each file."""
    found = with_scene(folder, "--tolerance", "0.05", "--json")
    return found.code, {
        each["file"]: "; ".join(c.get("note", "") for c in each["checks"] if c["ok"] is False)
        for each in found.document["files"]
    }


def test_a_folder_that_cannot_be_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Root can read every folder."""

    def refused(_: Path) -> None:
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(Path, "iterdir", refused)
    found = called("verify", tmp_path)
    assert found.code == 2
    assert f"DIR = {tmp_path}: cannot be read: Permission denied" in found.err


def test_verdict_and_certificate(folder: Path) -> None:
    found = with_scene(folder)
    assert found.code == 0
    assert found.err.endswith("verification.json: the results\n")

    before = (folder / "verification.json").read_bytes()
    document = json.loads(before)
    assert document["passed"] is True
    drawing = document["files"][1]
    data = (folder / "vorschub.dxf").read_bytes()
    assert drawing["sha256"] == hashlib.sha256(data).hexdigest()
    assert drawing["bytes"] == len(data)
    sha256 = camgeo.load(SCENE).scene.made
    assert drawing["scene"] == {"name": "vorschub", "sha256": sha256}
    assert (drawing["tolerance_mm"], drawing["tolerance_from"]) == (0.05, "the file")
    assert drawing["deviation_mm"] <= 0.05
    assert with_scene(folder).code == 0
    assert (folder / "verification.json").read_bytes() == before


@pytest.mark.parametrize("place", ["folder", "parent", "here"])
def test_scene_is_found_by_its_hash(
    place: str, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the file's folder, the one above, or the current one; its name does not matter."""
    here = tmp_path / "elsewhere"
    here.mkdir()
    monkeypatch.chdir(here)
    drawing = folder / "vorschub.dxf"
    found = called("verify", drawing)
    assert found.code == 2
    assert re.search("no scene with SHA-256 .* name it with --scene", found.err)
    assert not (folder / "verification.json").exists()
    target = {"folder": folder, "parent": tmp_path, "here": here}[place]
    shutil.copy(SCENES / "setzhub.toml", target / "another.toml")
    assert called("verify", drawing).code == 2
    shutil.copy(SCENE, target / "renamed.toml")
    assert called("verify", drawing).code == 0


def test_files_that_name_the_hash_of_the_text(folder: Path) -> None:
    """Those were written before a scene was known by its values; an edit of the text counts."""
    scene = camgeo.load(SCENE).scene
    for path in folder.glob("vorschub.*"):
        data = path.read_bytes()
        for digits in (64, 16):
            data = data.replace(scene.made[:digits].encode(), scene.text_hash[:digits].encode())
        path.write_bytes(data)
    certificate = json.loads((folder / "certificate.json").read_text())
    certificate["scene"]["sha256"] = scene.text_hash
    for record in certificate["files"]:
        record["sha256"] = hashlib.sha256((folder / record["file"]).read_bytes()).hexdigest()
    (folder / "certificate.json").write_text(json.dumps(certificate))
    for name in ("with", "without"):
        assert with_scene(folder).code == 0
        (folder / "certificate.json").unlink(missing_ok=name == "without")
    text = SCENE.read_text("utf-8")
    assert called("verify", folder / "vorschub.dxf").code == 2
    for content, code in ((f"# another state\n{text}", 2), (f"{text}\n[effects.kinematics]\n", 0)):
        (folder / "scene.toml").write_text(content, "utf-8")
        assert called("verify", folder / "vorschub.dxf").code == code


def test_scene_is_found_whatever_effects_it_names(folder: Path) -> None:
    """Files stay those of the scene when a table of an effect is added to it."""
    text = SCENE.read_text("utf-8")
    other = text.replace("roller_radius = ", "roller_radius = 1", 1)
    for content, code in ((other, 2), (text, 0)):
        (folder / "scene.toml").write_text(f"{content}\n[effects.kinematics]\n", "utf-8")
        assert called("verify", folder / "vorschub.dxf").code == code


def test_tolerance_of_the_person_counts(folder: Path) -> None:
    found = with_scene(folder / "vorschub.dxf", "--json", "--tolerance", "0.001")
    (record,) = found.document["files"]
    assert found.code == 1
    assert (record["tolerance_mm"], record["tolerance_from"]) == (0.001, "--tolerance")
    failed = [check for check in record["checks"] if check["ok"] is False]
    assert {check["name"] for check in failed} == {"deviation"}
    assert failed[0]["note"].startswith("at least 0.0")


@pytest.mark.parametrize("text", ["", "{", "[]", '{"scene": 1}', '{"scene": {"sha256": ""}}'])
def test_certificate_that_is_none(text: str, folder: Path) -> None:
    (folder / "certificate.json").write_text(text)
    found = with_scene(folder)
    assert found.code == 1
    assert "certificate.json is not a certificate of camgeo" in found.out


def test_files_are_compared_with_their_certificate(folder: Path) -> None:
    """Also one that is not measured, and one that is not there."""
    table = folder / "vorschub.csv"
    table.write_bytes(table.read_bytes().replace(b"7", b"8", 1))
    found = with_scene(folder)
    assert found.code == 1
    assert "it was changed" in found.out
    table.unlink()
    found = with_scene(folder)
    assert found.code == 1
    assert "certificate.json names it, but it is not there" in found.out


def test_changed_data_file_of_the_scene(tmp_path: Path) -> None:
    """The scene is found, though the lift table that it reads is another one now."""
    for name in ("measured.toml", "measured.csv"):
        shutil.copy(SCENES / name, tmp_path)
    out, table = tmp_path / "out", tmp_path / "measured.csv"
    assert called("build", tmp_path / "measured.toml", "-o", out, "--only", "dxf").code == 0
    assert called("verify", out).code == 0
    table.write_text(table.read_text() + "\n")
    found = called("verify", out)
    assert found.code == 1
    assert "a file that the scene reads is not the one that certificate.json names" in found.out


def test_a_new_set_takes_away_the_verification_of_the_old_one(folder: Path) -> None:
    target = folder / "verification.json"
    build = ("build", SCENE, "-o", folder, "--force", "--only", "dxf")
    assert with_scene(folder).code == 0
    assert called(*build, "--tolerance", "0.02").code == 0
    assert not target.exists()
    assert with_scene(folder).code == 0
    assert called(*build, "--tolerance", "0.02").code == 0
    assert target.exists()  # the files are the same
    target.write_text('{"kind": "a diary"}')
    assert called(*build).code == 0
    assert target.read_text() == '{"kind": "a diary"}'


def test_only_verifications_are_replaced(folder: Path) -> None:
    target, other = folder / "verification.json", folder / "notes.txt"
    target.write_text('{"kind": "a diary"}')
    found = with_scene(folder)
    assert found.code == 2
    assert "verification.json would be overwritten" in found.err
    assert target.read_text() == '{"kind": "a diary"}'
    assert with_scene(folder, "--force").code == 0
    assert with_scene(folder, "--tolerance", "0.06").code == 0
    assert json.loads(target.read_text())["files"][1]["tolerance_mm"] == 0.06
    other.write_text("mine")
    assert with_scene(folder, "-o", other).code == 2
    assert other.read_text() == "mine"


def test_nothing_is_written_if_nothing_was_measured(folder: Path) -> None:
    drawing = folder / "vorschub.dxf"
    drawing.write_bytes(drawing.read_bytes()[:5000])
    found = called("verify", drawing)
    assert found.code == 1
    assert "FAIL, not measured" in found.out
    assert "not a complete DXF file" in found.out
    assert "nothing was written" in found.err
    assert not (folder / "verification.json").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["absent.dxf"], "cannot be read"),
        (["absent"], "there is no such file or folder"),
        (["notes.txt"], "must end in one of .3mf, .cnc, .cut.svg, .dxf, .gcode"),
        (["empty"], "the folder holds no file that ends in"),
        (["parts", "--scene", "absent.toml"], "there is no such file"),
    ],
)
def test_wrong_calls(words: list[str], message: str, folder: Path) -> None:
    Path("notes.txt").write_text("")
    Path("empty").mkdir()
    found = called("verify", *words)
    assert found.code == 2
    assert message in found.err


def test_files_of_several_folders(folder: Path, source: Path) -> None:
    words = ("verify", folder, source / "vorschub.dxf", "--scene", SCENE)
    found = called(*words)
    assert found.code == 2
    assert "-o" in found.err
    assert called(*words, "-o", "all.json").code == 0
    assert len(json.loads(Path("all.json").read_text())["files"]) == 3


def test_format_of_a_file_too_large_to_be_read(tmp_path: Path) -> None:
    program = tmp_path / "long.ngc"
    with program.open("wb") as stream:
        stream.truncate(VERIFIED.size + 1)
    (verdict,) = verify((program,), scene=SCENE).verdicts
    assert verdict.format == "gcode"
    assert not verdict.passed


# Some files that cannot be read: the others keep their verdicts -----------------------------------


@pytest.mark.parametrize(
    ("name", "data", "reason"),
    [
        ("a.3mf", b"PK\x03\x04", "not a complete 3MF package: cannot be unpacked"),
        ("a.ngc", b"G1 X" + b"9" * 310, "cut|more than 60 digits|move before unit"),
        ("a.stl", b"0\n" * 20_000_000,
         "has 40,000,000 bytes; at most 32,000,000 are allowed in a STL"),
        ("a.stl", b"solid\nfacet normal 0 0 nan\n", "endsolid missing"),
    ],
)  # fmt: skip
def test_a_damaged_file_takes_away_no_verdict(
    name: str, data: bytes, reason: str, bare: Path
) -> None:
    (bare / name).write_bytes(data)
    code, found = verdicts(bare)
    assert code == 1
    assert any(each in found[name] for each in reason.split("|"))
    assert found["vorschub.dxf"] == found["vorschub.stl"] == ""


def test_a_file_that_names_an_unknown_scene_takes_away_no_verdict(bare: Path) -> None:
    shutil.copy(SCENE, bare)
    text = (bare / "vorschub.dxf").read_text()
    place = text.index("scene\n") + len("scene\n")
    (bare / "other.dxf").write_text(text[:place] + text[place:].replace("1\n", "1\n0000", 1))
    found = called("verify", bare)
    assert found.code == 1
    assert f"{bare / 'vorschub.dxf'}: pass" in found.out
    assert f"{bare / 'other.dxf'}: FAIL" in found.out


def test_an_error_of_ours_takes_away_no_verdict(
    bare: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise ZeroDivisionError("by zero")

    monkeypatch.setattr(type(VERIFIER), "checks", fail)
    code, found = verdicts(bare)
    assert code == 70
    assert "internal error (ZeroDivisionError: by zero); please report" in found["vorschub.dxf"]
    assert found["vorschub.stl"] == ""
