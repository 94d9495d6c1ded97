"""Bad input through the command line: one clear message, exit 2, no file left behind."""

from __future__ import annotations

import errno
import os
import re
from pathlib import Path

import pytest

import camgeo
from camgeo.app.cli.main import main
from camgeo.design import writing
from camgeo.errors import SceneError
from tests.scene.scenes import FIXTURES, PLATE, ROCKER, spoilt

SCHNITT = (FIXTURES / "schnitt.toml").read_text(encoding="utf-8")

Capture = pytest.CaptureFixture[str]

BAD = {
    "empty": ("", "the scene is empty"),
    "not TOML": ("this is not TOML\n", "line 1: the scene is not valid TOML"),
    "misspelt key": (
        spoilt(PLATE, ("roller_radius", "roler_radius")),
        r"line 11: follower\.roler_radius = 10: is not a known key \(did you mean roller_radius",
    ),
    "text for a number": (
        spoilt(PLATE, ("base_radius = 50", 'base_radius = "fifty"')),
        r'line 10: follower\.base_radius = "fifty": must be a positive number',
    ),
    "negative radius": (
        spoilt(PLATE, ("roller_radius = 10", "roller_radius = -10")),
        r"line 11: follower\.roller_radius = -10: must be 0 \(a knife edge\), or",
    ),
    "spans of 359.999": (
        spoilt(PLATE, ("span = 100", "span = 99.999")),
        r"motion: the spans add up to 359\.999 degrees; they must add up to 360",
    ),
    "zero-length move": (
        spoilt(PLATE, ("span = 100", "span = 0"), ("dwell = 40", "dwell = 140")),
        r"line 17: motion\[2\]\.span = 0: must be a number from .* a move needs a span",
    ),
    # Hard case HC07: Table 5 with a stroke of 40 mm, of which 38.93 can be reached.
    "linkage that cannot close": (
        spoilt(SCHNITT, ("to = 5.5", "to = 40")),
        r"does not close between cam angles 43\.9976\d* and 54\.5017\d* degrees",
    ),
    "base radius too small": (
        spoilt(ROCKER, ("base_radius = 55", "base_radius = 35")),
        r"follower\.base_radius = 35: .* no triangle: .* between 40 and 200 mm",
    ),
    "offset above the base radius": (
        spoilt(PLATE, ("offset = 12", "offset = 50.1")),
        r"line 12: follower\.offset = 50\.1: .* must not exceed the base radius, 50 mm",
    ),
    "name with a path": (
        spoilt(PLATE, ('name = "plate"', 'name = "../plate"')),
        r'line 2: name = "\.\./plate": must be .* no path',
    ),
}


@pytest.mark.parametrize("command", ["check", "build", "table", "plot"])
@pytest.mark.parametrize("case", BAD)
def test_one_message_and_no_file(
    case: str, command: str, tmp_path: Path, capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    text, message = BAD[case]
    monkeypatch.chdir(tmp_path)
    scene = tmp_path / "scene.toml"
    scene.write_text(text, encoding="utf-8")
    output = {"build": ["-o", "out"], "table": ["-o", "t.csv"], "plot": ["-o", "p.png"]}
    assert main([command, "scene.toml", *output.get(command, [])]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    head, *faults = captured.err.splitlines()
    assert head == "camgeo: scene.toml: 1 fault"
    assert len(faults) == 1
    assert re.search(message, faults[0])
    assert list(tmp_path.iterdir()) == [scene]


def test_all_faults_at_once(tmp_path: Path, capsys: Capture) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(
        spoilt(PLATE, ("span = 100", "span = -1"), ("roller_radius = 10", "roller_radius = -1"))
    )
    assert main(["check", str(scene)]) == 2
    err = capsys.readouterr().err
    assert "2 faults" in err
    assert "motion[2].span" in err
    assert "follower.roller_radius" in err


@pytest.mark.parametrize(
    ("change", "word", "message"),
    [
        (("offset = 12", "offset = 50"), "self-locking", "transmission angle is 0 at cam angle 0"),
        (("offset = 12", "offset = -50"), "self-locking", "transmission angle is 0"),
        (("roller_radius = 10", "roller_radius = 60"), "roller-over-axis", "covers the cam axis"),
    ],
)
def test_mechanism_that_is_none(
    change: tuple[str, str], word: str, message: str, tmp_path: Path, capsys: Capture
) -> None:
    """Offset at the base radius, roller larger than the base circle: the checks report both."""
    scene = tmp_path / "scene.toml"
    scene.write_text(spoilt(PLATE, change))
    assert main(["check", str(scene)]) == 2
    (line,) = [line for line in capsys.readouterr().out.splitlines() if line.startswith("INVALID")]
    assert word in line
    assert message in line
    assert main(["build", str(scene), "-o", str(tmp_path / "out")]) == 2
    assert "nothing was written" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == [scene]


def test_undercut_is_reported_and_nothing_written(tmp_path: Path, capsys: Capture) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(spoilt(PLATE, ("roller_radius = 10", "roller_radius = 48")))
    assert main(["check", str(scene)]) == 1
    assert "NO DISC" in capsys.readouterr().out
    assert main(["build", str(scene), "-o", str(tmp_path / "out")]) == 1
    assert "nothing was written" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == [scene]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ([("bore = 20", "bore = 81")], r"part\.bore|the bore reaches"),
        (
            [("\ndiameter = 10", "\ndiameter = 20.5")],
            r"diameter = 20\.5: must be less than the bore",
        ),
        ([("tolerance = 0.001", "tolerance = 1e-13")], r"output\.tolerance = 1e-13: must be"),
    ],
)
def test_part_that_cannot_be_made(
    changes: list[tuple[str, str]], message: str, tmp_path: Path, capsys: Capture
) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(spoilt(PLATE, *changes))
    assert main(["build", str(scene), "-o", str(tmp_path / "out")]) == 2
    assert re.search(message, capsys.readouterr().err)
    assert list(tmp_path.iterdir()) == [scene]


@pytest.mark.parametrize("command", ["check", "build", "table", "plot"])
def test_no_such_scene(
    command: str, tmp_path: Path, capsys: Capture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main([command, "none.toml"]) == 2
    assert "none.toml: 1 fault\n  there is no such file" in capsys.readouterr().err
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize("value", ["0", "-1", "1e-8", "2", "1e300"])
def test_no_such_tolerance(value: str, tmp_path: Path, capsys: Capture) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(PLATE)
    call = ["build", str(scene), "-o", str(tmp_path / "out"), "--tolerance", value]
    assert main([*call, "--only", "dxf"]) == 2
    assert "tolerance" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == [scene]


@pytest.mark.parametrize("value", ["nan", "inf", "-inf", "1" * 400, "-1e999"])
@pytest.mark.parametrize(
    "call",
    [
        ("build", "scene.toml", "--tolerance"),
        ("size", "scene.toml", "--transmission-angle"),
        ("laws", "polynomial-345", "--v0"),
    ],
    ids=lambda call: call[0],
)
def test_an_option_takes_finite_numbers_alone(
    call: tuple[str, ...], value: str, capsys: Capture
) -> None:
    *words, option = call
    with pytest.raises(SystemExit) as caught:
        main([*words, f"{option}={value}"])
    assert caught.value.code == 2
    said = capsys.readouterr().err
    assert f"argument {option}: '{value}' is " in said
    assert "finite number" in said or "too large for a number" in said


def test_unknown_format(tmp_path: Path, capsys: Capture) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(PLATE)
    assert main(["build", str(scene), "-o", str(tmp_path / "out"), "--only", "csv,dfx"]) == 2
    assert 'did you mean "dxf"?' in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == [scene]


@pytest.mark.parametrize("formats", ["", ",", " , "])
def test_no_format(formats: str, tmp_path: Path, capsys: Capture) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(PLATE)
    assert main(["build", str(scene), "-o", str(tmp_path / "out"), "--only", formats]) == 2
    assert "format: no format is named; there are 3mf, " in capsys.readouterr().err
    with pytest.raises(SceneError, match="no format is named"):
        camgeo.load(scene).write(tmp_path / "out", [])
    assert list(tmp_path.iterdir()) == [scene]


@pytest.mark.parametrize("command", ["build", "table", "plot", "new", "size", "verify"])
def test_names_that_are_too_long(command: str, tmp_path: Path, capsys: Capture) -> None:
    scene, name = tmp_path / "scene.toml", str(tmp_path / ("a" * 256))
    scene.write_text(PLATE)
    call = {
        "new": ["-o", name],
        "plot": [str(scene), "motion", "-o", f"{name}.svg"],
        "size": [str(scene), "--scene", name],
        "verify": [name],
    }
    assert main([command, *call.get(command, [str(scene), "-o", name])]) == 2
    err = capsys.readouterr().err
    assert os.strerror(errno.ENAMETOOLONG) in err or "there is no such file" in err
    assert list(tmp_path.iterdir()) == [scene]


def test_unwritable_folder(tmp_path: Path, capsys: Capture) -> None:
    """Even for root: below a file, and in /proc."""
    scene = tmp_path / "scene.toml"
    scene.write_text(PLATE)
    places = [scene / "out", scene]
    if Path("/proc/self").is_dir():
        places += [Path("/proc"), Path("/proc/camgeo-test")]
    for place in places:
        assert main(["build", str(scene), "-o", str(place), "--only", "csv"]) == 2
        assert "nothing was written" in capsys.readouterr().err
        assert main(["table", str(scene), "-o", str(place / "t.csv")]) == 2
        assert "nothing was written" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == [scene]
    assert scene.read_text() == PLATE


def test_full_disk(tmp_path: Path, capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(PLATE)
    original = writing._write_durably

    def full(path: Path, data: bytes) -> None:
        if path.suffix == ".dxf":
            path.write_bytes(data[:100])  # some fits
            raise OSError(errno.ENOSPC, "No space left on device", str(path))
        original(path, data)

    monkeypatch.setattr(writing, "_write_durably", full)
    assert main(["build", str(scene), "-o", str(tmp_path / "out"), "--only", "csv,dxf"]) == 2
    err = capsys.readouterr().err
    assert "plate.dxf: No space left on device; nothing was written" in err
    assert list(tmp_path.iterdir()) == [scene]
