"""`camgeo verify` as a command: where it finds scenes, what it writes, how it exits."""

from __future__ import annotations

import errno
import hashlib
import json
import shutil
from pathlib import Path

import pytest

import camgeo
from camgeo.app.answers.verify import verify
from camgeo.app.cli.main import main
from camgeo.reading import VERIFIED

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

SCENE = SCENES / "vorschub.toml"


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A drawing, a table and their certificate; without a scene in their folder."""
    folder = tmp_path_factory.mktemp("source")
    words = ["build", str(SCENE), "-o", str(folder), "--only", "dxf,csv", "--tolerance", "0.01"]
    assert main(words) == 0
    return folder


@pytest.fixture
def folder(source: Path, tmp_path: Path) -> Path:
    """A copy of it that a test may change."""
    return Path(shutil.copytree(source, tmp_path / "parts"))


def test_a_folder_that_cannot_be_read(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Root can read every folder."""

    def refused(_: Path) -> None:
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(Path, "iterdir", refused)
    assert main(["verify", str(tmp_path)]) == 2
    assert f"DIR = {tmp_path}: cannot be read: Permission denied" in capsys.readouterr().err


def test_verdict_and_certificate(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["verify", str(folder), "--scene", str(SCENE)]) == 0
    out, err = capsys.readouterr()
    lines = out.splitlines()
    assert lines[0] == f"{folder / 'vorschub.csv'}: pass, bytes only"
    assert lines[2].startswith(f"{folder / 'vorschub.dxf'}: pass, at most 0.00")
    assert lines[2].endswith("mm off (tolerance 0.01 mm, by the file)")
    names = [line.split("  ")[1] for line in lines[3:]]
    for name in ("unit", "closure", "deviation outline", "kink outline", "area outline"):
        assert name in names
    assert all(line.rpartition("ok")[1] for line in lines[3:])
    assert err.endswith("verification.json: the results\n")

    document = json.loads((folder / "verification.json").read_text())
    assert document["passed"] is True
    drawing = document["files"][1]
    data = (folder / "vorschub.dxf").read_bytes()
    assert drawing["sha256"] == hashlib.sha256(data).hexdigest()
    assert drawing["bytes"] == len(data)
    sha256 = camgeo.load(SCENE).scene.made
    assert drawing["scene"] == {"name": "vorschub", "sha256": sha256}
    assert drawing["tolerance_mm"] == 0.01
    assert drawing["tolerance_from"] == "the file"
    assert drawing["deviation_mm"] <= 0.01
    before = (folder / "verification.json").read_bytes()
    assert main(["verify", str(folder), "--scene", str(SCENE)]) == 0
    assert (folder / "verification.json").read_bytes() == before


@pytest.mark.parametrize("place", ["folder", "parent", "here"])
def test_scene_is_found_by_its_hash(
    place: str, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the file's folder, the one above, or the current one; its name does not matter."""
    here = tmp_path / "elsewhere"
    here.mkdir()
    monkeypatch.chdir(here)
    assert main(["verify", str(folder / "vorschub.dxf")]) == 2
    target = {"folder": folder, "parent": tmp_path, "here": here}[place]
    shutil.copy(SCENES / "setzhub.toml", target / "another.toml")
    assert main(["verify", str(folder / "vorschub.dxf")]) == 2
    shutil.copy(SCENE, target / "renamed.toml")
    assert main(["verify", str(folder / "vorschub.dxf")]) == 0


def test_files_that_name_the_hash_of_the_text(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those were written before a scene was known by its values; an edit of the text counts."""
    scene = camgeo.load(SCENE).scene
    for path in folder.glob("vorschub.*"):
        data = path.read_bytes()
        for digits in (64, 16):
            data = data.replace(scene.made[:digits].encode(), scene.made_before[:digits].encode())
        path.write_bytes(data)
    certificate = json.loads((folder / "certificate.json").read_text())
    certificate["scene"]["sha256"] = scene.made_before
    for record in certificate["files"]:
        record["sha256"] = hashlib.sha256((folder / record["file"]).read_bytes()).hexdigest()
    (folder / "certificate.json").write_text(json.dumps(certificate))
    monkeypatch.chdir(tmp_path)
    for name in ("with", "without"):
        assert main(["verify", str(folder), "--scene", str(SCENE)]) == 0
        (folder / "certificate.json").unlink(missing_ok=name == "without")
    assert main(["verify", str(folder / "vorschub.dxf")]) == 2
    text = SCENE.read_text("utf-8")
    (folder / "scene.toml").write_text(f"# another state\n{text}", "utf-8")
    assert main(["verify", str(folder / "vorschub.dxf")]) == 2
    (folder / "scene.toml").write_text(f"{text}\n[effects.kinematics]\n", "utf-8")
    assert main(["verify", str(folder / "vorschub.dxf")]) == 0


def test_scene_is_found_whatever_effects_it_names(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Files stay those of the scene when a table of an effect is added to it."""
    monkeypatch.chdir(tmp_path)
    text = SCENE.read_text("utf-8")
    other = text.replace("roller_radius = ", "roller_radius = 1", 1)
    (folder / "scene.toml").write_text(f"{other}\n[effects.kinematics]\n", "utf-8")
    assert main(["verify", str(folder / "vorschub.dxf")]) == 2
    (folder / "scene.toml").write_text(f"{text}\n[effects.kinematics]\n", "utf-8")
    assert main(["verify", str(folder / "vorschub.dxf")]) == 0


def test_scene_that_is_not_found_is_reported(
    folder: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["verify", str(folder)]) == 2
    assert "no scene with SHA-256" in (err := capsys.readouterr().err)
    assert "name it with --scene" in err
    assert not (folder / "verification.json").exists()


def test_tolerance_of_the_person_counts(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["verify", str(folder / "vorschub.dxf"), "--scene", str(SCENE), "--json"]
    assert main([*words, "--tolerance", "0.001"]) == 1
    (record,) = json.loads(capsys.readouterr().out)["files"]
    assert (record["tolerance_mm"], record["tolerance_from"]) == (0.001, "--tolerance")
    failed = [check for check in record["checks"] if check["ok"] is False]
    assert {check["name"] for check in failed} == {"deviation"}
    assert failed[0]["note"].startswith("at least 0.00")


def test_changed_bytes_of_a_table(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A file that is not measured is still compared with its certificate."""
    table = folder / "vorschub.csv"
    table.write_bytes(table.read_bytes().replace(b"7", b"8", 1))
    assert main(["verify", str(folder), "--scene", str(SCENE)]) == 1
    assert "it was changed" in capsys.readouterr().out


def test_missing_file_is_reported(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "vorschub.csv").unlink()
    assert main(["verify", str(folder), "--scene", str(SCENE)]) == 1
    assert "certificate.json names it, but it is not there" in capsys.readouterr().out


@pytest.mark.parametrize("text", ["", "{", "[]", '{"scene": 1}', '{"scene": {"sha256": ""}}'])
def test_certificate_that_is_none(
    text: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "certificate.json").write_text(text)
    assert main(["verify", str(folder), "--scene", str(SCENE)]) == 1
    assert "certificate.json is not a certificate of camgeo" in capsys.readouterr().out


def test_changed_data_file_of_the_scene(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The scene is found, though the lift table that it reads is another one now."""
    for name in ("measured.toml", "measured.csv"):
        shutil.copy(SCENES / name, tmp_path)
    words = [str(tmp_path / "measured.toml"), "-o", str(tmp_path / "out")]
    assert main(["build", *words, "--only", "dxf"]) == 0
    assert main(["verify", str(tmp_path / "out")]) == 0
    table = tmp_path / "measured.csv"
    table.write_text(table.read_text() + "\n")
    capsys.readouterr()
    assert main(["verify", str(tmp_path / "out")]) == 1
    out = capsys.readouterr().out
    assert "a file that the scene reads is not the one that certificate.json names" in out


def test_a_new_set_takes_away_the_verification_of_the_old_one(folder: Path) -> None:
    target = folder / "verification.json"
    build = ["build", str(SCENE), "-o", str(folder), "--force", "--only", "dxf"]
    assert main(["verify", str(folder), "--scene", str(SCENE)]) == 0
    assert main([*build, "--tolerance", "0.02"]) == 0
    assert not target.exists()
    assert main(["verify", str(folder), "--scene", str(SCENE)]) == 0
    assert main([*build, "--tolerance", "0.02"]) == 0
    assert target.exists()  # the files are the same
    target.write_text('{"kind": "a diary"}')
    assert main(build) == 0
    assert target.read_text() == '{"kind": "a diary"}'


def test_only_verifications_are_replaced(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["verify", str(folder), "--scene", str(SCENE)]
    target = folder / "verification.json"
    target.write_text('{"kind": "a diary"}')
    assert main(words) == 2
    assert "verification.json would be overwritten" in capsys.readouterr().err
    assert target.read_text() == '{"kind": "a diary"}'
    assert main([*words, "--force"]) == 0
    assert main([*words, "--tolerance", "0.02"]) == 0
    assert json.loads(target.read_text())["files"][1]["tolerance_mm"] == 0.02
    other = folder / "notes.txt"
    other.write_text("mine")
    assert main([*words, "-o", str(other)]) == 2
    assert other.read_text() == "mine"


def test_nothing_is_written_if_nothing_was_measured(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    drawing = folder / "vorschub.dxf"
    drawing.write_bytes(drawing.read_bytes()[:5000])
    assert main(["verify", str(drawing)]) == 1
    out, err = capsys.readouterr()
    assert "FAIL, not measured" in out
    assert "not a complete DXF file" in out
    assert "nothing was written" in err
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
def test_wrong_calls(
    words: list[str],
    message: str,
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(folder.parent)
    Path("notes.txt").write_text("")
    Path("empty").mkdir()
    assert main(["verify", *words]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize("tolerance", ["0", "-1", "nan", "inf", "wide"])
def test_no_tolerance(tolerance: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main(["verify", str(folder), "--tolerance", tolerance])
    assert stop.value.code == 2
    assert "--tolerance" in capsys.readouterr().err


def test_files_of_several_folders(
    folder: Path, source: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["verify", str(folder), str(source / "vorschub.dxf"), "--scene", str(SCENE)]
    with pytest.raises(SystemExit) as stop:
        main(words)
    assert stop.value.code == 2
    assert "-o" in capsys.readouterr().err
    target = tmp_path / "all.json"
    assert main([*words, "-o", str(target)]) == 0
    assert len(json.loads(target.read_text())["files"]) == 3


def test_format_of_a_file_too_large_to_be_read(tmp_path: Path) -> None:
    program = tmp_path / "long.ngc"
    with program.open("wb") as stream:
        stream.truncate(VERIFIED.size + 1)
    (verdict,) = verify((program,), scene=SCENE).verdicts
    assert verdict.format == "gcode"
    assert not verdict.passed
