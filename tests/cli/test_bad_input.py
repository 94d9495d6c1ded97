"""Bad input through the command line: one clear message, exit 2, no file left behind."""

from __future__ import annotations

import errno
import os
import re
from pathlib import Path

import pytest

from camgeo.design import writing
from tests.cli.calling import called
from tests.scene.scenes import FIXTURES, PLATE, ROCKER, spoilt

SCHNITT = (FIXTURES / "schnitt.toml").read_text(encoding="utf-8")

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

OUTPUT = {"build": ["-o", "out"], "table": ["-o", "t.csv"], "plot": ["-o", "p.png"], "check": []}


@pytest.fixture
def scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A scene, alone in the present folder."""
    monkeypatch.chdir(tmp_path)
    path = Path("scene.toml")
    path.write_text(PLATE, encoding="utf-8")
    return path


def alone(scene: Path) -> bool:
    """Whether nothing else has been written."""
    return list(Path().iterdir()) == [scene]


@pytest.mark.parametrize("command", OUTPUT)
@pytest.mark.parametrize("case", BAD)
def test_one_message_and_no_file(case: str, command: str, scene: Path) -> None:
    text, message = BAD[case]
    scene.write_text(text, encoding="utf-8")
    found = called(command, scene, *OUTPUT[command])
    assert (found.code, found.out) == (2, "")
    head, fault = found.err.splitlines()
    assert head == "camgeo: scene.toml: 1 fault"
    assert re.search(message, fault)
    assert alone(scene)


@pytest.mark.parametrize(
    ("change", "code", "said"),
    [
        (("offset = 12", "offset = 50"), 2,
         r"^INVALID +self-locking .*transmission angle is 0 at cam angle 0"),
        (("offset = 12", "offset = -50"), 2, r"^INVALID +self-locking .*transmission angle is 0"),
        (("roller_radius = 10", "roller_radius = 60"), 2,
         r"^INVALID +roller-over-axis.*covers the cam axis"),
        (("roller_radius = 10", "roller_radius = 48"), 1, "^NO DISC "),
    ],
)  # fmt: skip
def test_a_mechanism_or_disc_that_is_none(
    change: tuple[str, str], code: int, said: str, scene: Path
) -> None:
    """Offset at the base radius, roller larger than the base circle: the checks report both."""
    scene.write_text(spoilt(PLATE, change))
    checked = called("check", scene)
    assert (checked.code, checked.out.count("INVALID")) == (code, code - 1)
    assert re.search(said, checked.out, re.MULTILINE)
    built = called("build", scene, "-o", "out")
    assert built.code == code
    assert "nothing was written" in built.err
    assert alone(scene)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("bore = 20", "bore = 81"), r"part\.bore|the bore reaches"),
        (("\ndiameter = 10", "\ndiameter = 20.5"), r"diameter = 20\.5: must be less than the bore"),
        (("tolerance = 0.001", "tolerance = 1e-13"), r"output\.tolerance = 1e-13: must be"),
    ],
)
def test_part_that_cannot_be_made(change: tuple[str, str], message: str, scene: Path) -> None:
    scene.write_text(spoilt(PLATE, change))
    found = called("build", scene, "-o", "out")
    assert found.code == 2
    assert re.search(message, found.err)
    assert alone(scene)


@pytest.mark.parametrize("command", ["build", "table", "plot", "new", "size", "verify"])
def test_names_that_are_too_long(command: str, scene: Path) -> None:
    name = "a" * 256
    words: dict[str, list[object]] = {
        "new": ["-o", name],
        "plot": [scene, "motion", "-o", f"{name}.svg"],
        "size": [scene, "--scene", name],
        "verify": [name],
    }
    found = called(command, *words.get(command, [scene, "-o", name]))
    assert found.code == 2
    assert os.strerror(errno.ENAMETOOLONG) in found.err or "there is no such file" in found.err
    assert alone(scene)


def test_full_disk(scene: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    original = writing._write_durably

    def full(path: Path, data: bytes) -> None:
        if path.suffix == ".dxf":
            path.write_bytes(data[:100])  # some fits
            raise OSError(errno.ENOSPC, "No space left on device", str(path))
        original(path, data)

    monkeypatch.setattr(writing, "_write_durably", full)
    found = called("build", scene, "-o", "out", "--only", "csv,dxf")
    assert found.code == 2
    assert "plate.dxf: No space left on device; nothing was written" in found.err
    assert alone(scene)
