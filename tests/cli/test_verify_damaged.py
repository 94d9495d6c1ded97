"""`camgeo verify` with some files that cannot be read: the others keep their verdicts."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from camgeo.app.cli.main import main
from camgeo_export.stl import FACET, PREFIX
from camgeo_export.verify.dxf import VERIFIER

SCENE = Path(__file__).parents[2] / "fixtures" / "scenes" / "vorschub.toml"


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A drawing and a body of the scene, without their certificate."""
    folder = tmp_path_factory.mktemp("source")
    words = ["build", str(SCENE), "-o", str(folder), "--only", "dxf,stl", "--tolerance", "0.05"]
    assert main(words) == 0
    (folder / "certificate.json").unlink()
    return folder


@pytest.fixture
def folder(source: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(source, tmp_path / "parts"))


def verdicts(folder: Path, capsys: pytest.CaptureFixture[str]) -> tuple[int, dict[str, str]]:
    """The exit code, and the failed checks of each file."""
    capsys.readouterr()
    words = ["verify", str(folder), "--scene", str(SCENE), "--tolerance", "0.05", "--json"]
    code = main(words)
    files = json.loads(capsys.readouterr().out)["files"]
    return code, {
        each["file"]: "; ".join(c.get("note", "") for c in each["checks"] if c["ok"] is False)
        for each in files
    }


@pytest.mark.parametrize(
    ("name", "data", "reason"),
    [
        ("a.3mf", b"PK\x03\x04", "not a complete 3MF package: cannot be unpacked"),
        ("a.ngc", b"G1 X" + b"9" * 310, "cut|more than 60 digits|move before unit"),
        (
            "a.stl",
            b"0\n" * 20_000_000,
            "has 40,000,000 bytes; at most 32,000,000 are allowed in a STL",
        ),
        ("a.stl", b"solid\nfacet normal 0 0 nan\n", "endsolid missing"),
    ],
)
def test_a_damaged_file_takes_away_no_verdict(
    name: str, data: bytes, reason: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / name).write_bytes(data)
    code, found = verdicts(folder, capsys)
    assert code == 1
    assert any(each in found[name] for each in reason.split("|"))
    assert found["vorschub.dxf"] == found["vorschub.stl"] == ""


def test_a_file_that_names_an_unknown_scene_takes_away_no_verdict(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copy(SCENE, folder)
    text = (folder / "vorschub.dxf").read_text()
    place = text.index("scene\n") + len("scene\n")
    (folder / "other.dxf").write_text(text[:place] + text[place:].replace("1\n", "1\n0000", 1))
    code = main(["verify", str(folder)])
    out = capsys.readouterr().out
    assert code == 1
    assert f"{folder / 'vorschub.dxf'}: pass" in out
    assert f"{folder / 'other.dxf'}: FAIL" in out


def test_an_error_of_ours_takes_away_no_verdict(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise ZeroDivisionError("by zero")

    monkeypatch.setattr(type(VERIFIER), "checks", fail)
    code, found = verdicts(folder, capsys)
    assert code == 70
    assert "internal error (ZeroDivisionError: by zero); please report" in found["vorschub.dxf"]
    assert found["vorschub.stl"] == ""


@pytest.mark.parametrize("value", [np.nan, np.inf, -1.0])
@pytest.mark.parametrize("whose", ["ours", "foreign"])
def test_wrong_normals_fail_without_a_certificate(
    value: float, whose: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = folder / "vorschub.stl"
    data = path.read_bytes()
    facets = np.frombuffer(data, FACET, offset=PREFIX).copy()
    facets["normal"][7] *= value if value == -1.0 else 1.0
    if value != -1.0:
        facets["normal"][7] = value
    head = data[:PREFIX] if whose == "ours" else b"cad".ljust(80) + data[80:PREFIX]
    path.write_bytes(head + facets.tobytes())
    code, found = verdicts(folder, capsys)
    assert code == 1
    assert "that of facet 8" in found["vorschub.stl"]
    assert found["vorschub.dxf"] == ""
