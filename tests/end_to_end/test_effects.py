"""Scenes with effects, by the commands of a user; the tables are read back and measured."""

from __future__ import annotations

import contextlib
import csv
import io
from pathlib import Path

import numpy as np
import pytest

from camgeo import load
from camgeo.app.cli.main import main
from camgeo.design.design import Design
from camgeo.dynamics.effects.registry import EFFECTS
from camgeo.kinematics.time_course import in_time
from tests.effects.scenes import SCENES
from tests.long_form import LONG

FOLDER = SCENES.parent / "effects"

EFFECT_SCENES = sorted(FOLDER.glob("*.toml"))


CHEAP = ("camshaft_windup", "four_bar", "groove_lever", "valve_spring")
"""Found speeds, linkages, two flanks, columns of a spring; those of the others are in
`tests/effects/test_recorded.py`."""

MEASURED = [each for each in EFFECT_SCENES if LONG or each.stem in CHEAP]


@pytest.fixture(scope="module", params=MEASURED, ids=lambda path: path.stem)
def scene(request: pytest.FixtureRequest) -> Path:
    path: Path = request.param
    return path


@pytest.fixture(scope="module")
def subject(scene: Path) -> Design:
    return load(scene)


@pytest.fixture(scope="module")
def table(scene: Path) -> str:
    """What `camgeo table` prints."""
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        assert main(["table", str(scene), "--step", "5"]) == 0
    return printed.getvalue()


def rows(text: str) -> tuple[list[str], np.ndarray[tuple[int, int], np.dtype[np.float64]]]:
    """Headings and numbers of a CSV file."""
    head, *body = csv.reader(io.StringIO(text))
    return head, np.array([[float(cell) for cell in row] for row in body])


def column(text: str, name: str) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    head, values = rows(text)
    (place,) = [k for k, each in enumerate(head) if each.rpartition(" [")[0] == name]
    found: np.ndarray[tuple[int], np.dtype[np.float64]] = values[:, place]
    return found


def test_all_effects_are_in_some_scene() -> None:
    named = {name for path in EFFECT_SCENES for name in load(path).scene.effects}
    assert named == set(EFFECTS)


def test_table_has_the_columns_and_finite_numbers(subject: Design, table: str) -> None:
    head, values = rows(table)
    names = [each.rpartition(" [")[0] or each for each in head]
    for each in subject.disc.columns():
        assert each.name in names
    assert len(set(head)) == len(head)
    finite = [k for k, each in enumerate(head) if not each.startswith("r_K")]
    assert np.all(np.isfinite(values[:, finite]))


def test_force_and_torque_of_the_table_keep_the_power_balance(subject: Design, table: str) -> None:
    """Without friction the torque is the normal force times its way a radian (virtual work)."""
    if "friction" in subject.scene.effects:
        pytest.skip("the balance with friction is held in tests/effects")
    if not {"contact-force", "drive-torque"} <= set(subject.scene.effects):
        pytest.skip("the scene does not ask for both")
    phi = np.radians(column(table, "phi"))
    force, torque = column(table, "contact force"), column(table, "drive torque")
    way = subject.cam.disc.pitch_curve.leverage(phi) * subject.cam.drive.motion.jet(phi)[1]
    scale = float(np.max(np.abs(force * way)))
    # Both columns are rounded to a double once, and so are way and product.
    assert np.allclose(torque * 1e3, force * way, rtol=0.0, atol=8.0 * np.spacing(scale))


@pytest.mark.parametrize(
    "path",
    [each for each in EFFECT_SCENES if LONG or each.stem == "groove_lever"],
    ids=lambda path: path.stem,
)
def test_picture(path: Path, tmp_path: Path) -> None:
    target = tmp_path / "effects.png"
    assert main(["plot", str(path), "effects", "-o", str(target)]) == 0
    assert target.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("path", MEASURED[1:], ids=lambda path: path.stem)
def test_files_are_written_and_verified(path: Path, tmp_path: Path) -> None:
    code = main(["build", str(path), "-o", str(tmp_path), "--tolerance", "0.01"])
    assert code == (1 if any(f.severity == "broken" for f in load(path).findings) else 0)
    assert main(["verify", str(tmp_path), "--scene", str(path)]) == 0


def test_velocity_of_the_table_is_that_of_the_motion(subject: Design, table: str) -> None:
    if "kinematics" not in subject.scene.effects:
        pytest.skip("the scene does not ask for it")
    phi = np.radians(column(table, "phi"))
    course = subject.effects.course("kinematics")  # the found speed, where one is found
    assert course is not None
    velocity = in_time(subject.drive.plan.jet(phi), course, phi)[1]
    assert np.array_equal(column(table, "velocity"), velocity)
