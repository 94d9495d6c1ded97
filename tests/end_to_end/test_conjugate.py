"""The files of both discs of a conjugate pair: read back, held together, verified, certified."""

from __future__ import annotations

import json
import math
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ezdxf.filemanagement import readfile

from camgeo import load
from camgeo.app.cli.main import main
from camgeo.design.design import Design
from camgeo.errors import UndercutError
from camgeo.kinematics.mechanism.rollers import OscillatingRoller, TranslatingRoller
from camgeo.numeric.arrays import ComplexArray
from tests.end_to_end.built import SCENES
from tests.measuring import DensePath, Outline
from tests.pairs import Carriage, Lever, carriage_of, lever_of

Capture = pytest.CaptureFixture[str]

FOLDER = SCENES[0].parent

NAMES = ("conjugate_lever", "conjugate_carriage")

FORMATS = "dxf,gcode,stl,3mf,csv"

DENSE = 60_001


def body_of(design: Design) -> Lever | Carriage:
    """The rigid follower by the dimensions in the scene file."""
    if isinstance(design.cam.follower, OscillatingRoller):
        return lever_of(design.cam.follower, math.radians(84.0), 70.0)
    assert isinstance(design.cam.follower, TranslatingRoller)
    return carriage_of(design.cam.follower, 135.0, -5.0)


@pytest.fixture(scope="module", params=NAMES)
def built(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The scene and the files of both discs."""
    folder = tmp_path_factory.mktemp(request.param)
    scene = shutil.copy(FOLDER / f"{request.param}.toml", folder)
    assert main(["build", str(scene), "-o", str(folder), "--only", FORMATS]) == 0
    return folder / f"{request.param}.toml"


def drawn(file: Path) -> Outline:
    """The largest closed polyline on layer CUT."""
    found = []
    for entity in readfile(file).modelspace().query('LWPOLYLINE[layer=="CUT"]'):
        rows = np.array(list(entity.get_points("xyb")))  # type: ignore[attr-defined]  # the entity is a polyline
        starts = rows[:, 0] + 1j * rows[:, 1]
        found.append(Outline.through(starts, 4.0 * np.arctan(rows[:, 2])))
    return max(found, key=lambda outline: abs(outline.area))


def centres(design: Design) -> tuple[ComplexArray, ComplexArray]:
    """Dense roller centres of main and return roller in the cam, by the rigid follower."""
    phi = np.linspace(0.0, 2.0 * math.pi, DENSE)
    both = body_of(design).rollers(design.drive.motion.jet(phi)[0])
    turn = np.exp(-1j * design.cam.rotation * phi)
    return both[0] * turn, both[1] * turn


def test_both_drawings_touch_the_rollers_of_the_rigid_follower(built: Path) -> None:
    """All points of either drawing are the roller's radius from its centres' path.

    Chords of the dense path are 90 mm / 60,000 * 2 pi = 0.01 mm long, h^2/8 kappa = 4e-7 mm off.
    """
    design = load(built)
    tolerance = design.scene.output.tolerance
    for disc, path in zip(design.discs, centres(design), strict=True):
        outline = drawn(built.with_name(f"{disc.name}.dxf"))
        points = outline.dense(4000)
        off = np.abs(DensePath(path).distances(points) - disc.cam.follower.roller_radius)
        assert np.max(off) <= tolerance + 5e-7
        # And at every cam angle the roller reaches the drawing, and no farther.
        reached = np.abs(outline.distances(path[::50]) - disc.cam.follower.roller_radius)
        assert np.max(reached) <= tolerance + 1e-9


def test_the_written_contours_close_within_what_the_check_says(
    built: Path, capsys: Capture
) -> None:
    """The bound is met to half at least: the tolerance is used up by either contour."""
    files = [str(built.with_name(f"{built.stem}{end}.dxf")) for end in ("-return", "")]
    capsys.readouterr()
    assert main(["replay", str(built), *files, "--json"]) == 0
    reported: dict[str, Any] = json.loads(capsys.readouterr().out)
    contours = [each["contour"] for each in reported["discs"]]
    assert contours == [f"{built.stem}.dxf", f"{built.stem}-return.dxf"]
    closing = next(f for f in load(built).findings if f.name == "closing-error")
    assert closing.value is not None
    play, squeeze = (
        reported["closing"][f"{which}_play"]["travel_mm"] for which in ("largest", "smallest")
    )
    assert squeeze < 0.0 < play
    # The roller touches an inexact disc a little off its place, where the leverage differs.
    bound = 1.001 * closing.value
    assert 0.5 * bound < max(play, -squeeze) <= bound


@pytest.mark.parametrize("end", [".dxf", ".ngc", ".stl", ".3mf"])
def test_a_main_disc_in_place_of_the_return_disc_fails(
    built: Path, end: str, tmp_path: Path, capsys: Capture
) -> None:
    shutil.copy(built, tmp_path)
    shutil.copy(built.with_name(f"{built.stem}{end}"), tmp_path / f"{built.stem}-return{end}")
    capsys.readouterr()
    assert main(["verify", str(tmp_path), "--json", "--scene", str(built)]) == 1
    (record,) = json.loads(capsys.readouterr().out)["files"]
    assert "deviation" in {each["name"] for each in record["checks"] if each["ok"] is False}


def test_a_return_disc_that_undercuts_is_refused_with_the_main_disc(tmp_path: Path) -> None:
    """Nothing is written of either; the picture still shows the main disc as the body it is."""
    scene = tmp_path / "undercut.toml"
    text = (FOLDER / "conjugate_lever.toml").read_text()
    scene.write_text(text.replace("roller_radius = 12", "roller_radius = 46"))
    design = load(scene)
    assert main(["build", str(scene), "-o", str(tmp_path / "out"), "--only", "dxf"]) == 1
    with pytest.raises(UndercutError, match=r"^return disc: inner flank"):
        design.write(tmp_path / "out", ["dxf"])
    assert not (tmp_path / "out").exists()
    assert main(["plot", str(scene), "cam", "-o", str(tmp_path / "cam.svg")]) == 0
    picture = (tmp_path / "cam.svg").read_text()
    assert "edges of the main disc" in picture
    assert "no outline" not in picture


def test_a_trimmed_return_disc_leaves_play(tmp_path: Path, capsys: Capture) -> None:
    """What the roller loses on a disc that is cut off is play, and the main disc loses nothing."""
    scene = tmp_path / "trimmed.toml"
    text = (FOLDER / "conjugate_lever.toml").read_text()
    text = text.replace("roller_radius = 12", "roller_radius = 46")
    scene.write_text(text.replace("[part]", '[limits]\nundercut = "trim"\n\n[part]'))
    assert main(["replay", str(scene), "--json"]) == 0
    reported = json.loads(capsys.readouterr().out)
    first, second = (each["lost_stroke"]["value"] for each in reported["discs"])
    assert first == 0.0
    lost = math.radians(second)
    assert lost > 0.0
    # As way of the main roller, 75 mm from the pivot.
    assert reported["closing"]["largest_play"]["travel_mm"] == pytest.approx(75.0 * lost, rel=1e-9)
    # Rounding of 100 mm at the ends of what is cut off.
    assert reported["closing"]["smallest_play"]["travel_mm"] == pytest.approx(0.0, abs=1e-12)
    assert main(["replay", str(scene)]) == 0
    assert "squeezed" not in capsys.readouterr().out
