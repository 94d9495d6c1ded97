"""The result of `camgeo inspect`, rendered as text, JSON, table and picture."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from camgeo.app.answers.answer import figure, table, text
from camgeo.app.answers.inspect import Inspection, MeasuredPoints, inspect, inspect_points
from camgeo.app.answers.probe import flank_table, probe
from camgeo.design.design import Design
from camgeo.geometry.outline.exact_flank import ExactFlank
from camgeo.geometry.outline.path import Flank
from camgeo.numeric.arrays import FloatArray
from camgeo.pictures.model import Line
from camgeo.scene.scene import load_scene
from camgeo.studies.inspection import Align
from tests.answers.documents import FIXTURES, document
from tests.inspection.flanks import bump, disc_of, every, flank_of, measured

FOLDER = FIXTURES / "scenes"


def found_on(
    name: str,
    side: Flank = Flank.INNER,
    *,
    away: FloatArray | float = 0.0,
    count: int = 180,
    **options: object,
) -> Inspection:
    """Points that are `away` [mm] from a flank."""
    points = MeasuredPoints(measured(every(flank_of(name, side), count), away))
    return inspect_points(disc_of(name), side, points, "points.csv", **options)  # type: ignore[arg-type]  # of one test each


def test_a_profile_out_of_tolerance_breaks_a_limit() -> None:
    away = 0.001 * np.sin(np.arange(180.0))
    assert found_on("plate_translating", away=away, tolerance=0.00201).exit_code == 0
    found = found_on("plate_translating", away=away, tolerance=0.0019)
    assert found.exit_code == 1
    assert "BROKEN  profile" in text(found)
    assert document(found)["findings"][0]["name"] == "profile"


def test_radial_normals_are_told() -> None:
    places = every(flank_of("setzhub", Flank.INNER), 90)
    points = MeasuredPoints(places.points, places.points)
    found = inspect_points(disc_of("setzhub"), Flank.INNER, points, "radial.csv")
    (told,) = (each for each in found.findings if each.name == "radial-normals")
    assert told.severity == "warning"
    assert "along the radius" in text(found)
    wrong = MeasuredPoints(places.points, -places.normals * np.exp(0.1j))
    found = inspect_points(disc_of("setzhub"), Flank.INNER, wrong, "wrong.csv")
    names = {each.name: each.severity for each in found.findings}
    assert names["normals"] == names["normals-inward"] == "warning"


def test_a_round_cam_is_told() -> None:
    scene = load_scene(FOLDER / "plate_translating.toml")
    rng = np.random.default_rng(3)

    def turned(*motion: Mapping[str, object]) -> Inspection:
        design = Design(scene.with_values({"motion": motion}))
        flank = ExactFlank(design.cam.disc.outline("inner").path, Flank.INNER)
        points = MeasuredPoints(measured(every(flank, 60), rng.normal(0.0, 1e-3, 60)))
        return inspect_points(design.disc, Flank.INNER, points, "p.csv", align=Align.ROTATION)

    found = turned({"dwell": 360})
    assert "too nearly circular" in text(found)
    assert "turn                  +0 deg ± unknown; the motion comes 0 deg early" in text(found)
    assert document(found)["turn_uncertainty_deg"] is None
    small = ({"law": "polynomial-345", "span": 180, "to": to} for to in (0.05, 0))
    assert "shows the rotation of the part only to within" in text(turned(*small))


def test_errors_of_form_are_told_to_sway_a_fit() -> None:
    places = every(flank_of("plate_translating", Flank.INNER), 180)
    found = found_on("plate_translating", away=bump(places.phi), align=Align.FREE)
    (told,) = (each for each in found.findings if each.name == "form")
    assert told.severity == "warning"
    assert "--robust" in told.sentence
    robust = found_on("plate_translating", away=bump(places.phi), align=Align.FREE, robust=True)
    assert "form" not in {each.name for each in robust.findings}
    assert "shifted and turned to fit, disregarding local errors" in text(robust)
    assert document(robust)["robust"] is True
    assert document(found)["robust"] is False
    assert "form" not in {each.name for each in found_on("plate_translating").findings}


@pytest.mark.parametrize("name", ["plate_translating", "groove"])
def test_a_turned_part_moves_the_follower_late_or_early(name: str) -> None:
    """A place of the flank meets the follower when the cam has turned by as much less."""
    flank, disc = flank_of(name, Flank.INNER), disc_of(name)
    points = MeasuredPoints(measured(every(flank, 360), 0.0, 0j, 0.001))
    found = inspect_points(disc, Flank.INNER, points, "p.csv", align=Align.ROTATION)
    assert found.delay is not None
    assert document(found)["delay_deg"] == pytest.approx(np.degrees(found.delay))
    assert abs(found.delay) == pytest.approx(0.001)
    assert ("late" if found.delay > 0.0 else "early") in text(found)
    by_datum = inspect_points(disc, Flank.INNER, points, "p.csv").lift
    assert by_datum is not None
    motion = disc.cam.drive.motion
    phi = by_datum.errors.phi
    expected = motion.jet(phi - found.delay)[0] - motion.jet(phi)[0]
    # Between points the deviation is linear, not the flank's own.
    assert by_datum.errors.errors == pytest.approx(expected, abs=5e-3 * np.max(np.abs(expected)))


@pytest.mark.parametrize("mirrored", [False, True])
def test_points_in_other_axes_are_told(mirrored: bool) -> None:
    places = every(flank_of("plate_translating", Flank.INNER), 90)
    points = measured(places, 0.0, 20.0 + 5.0j, 0.7)
    seen = MeasuredPoints(points.conj() if mirrored else points)
    found = inspect_points(disc_of("plate_translating"), Flank.INNER, seen, "p.csv")
    (told,) = (each for each in found.findings if each.name == "axes")
    assert "shifted by 20 mm and 5 mm and turned by 40.11 deg" in told.sentence
    assert ("other side of the disc" in told.sentence) == mirrored


def test_a_gap_leaves_the_follower_unknown() -> None:
    flank = flank_of("plate_translating", Flank.INNER)
    points = MeasuredPoints(flank.places(np.radians(np.arange(0.0, 200.0, 2.0))).points)
    found = inspect_points(disc_of("plate_translating"), Flank.INNER, points, "part.csv")
    assert found.lift is None
    assert "no points from cam angle 198 to 0 deg" in text(found)
    assert "lift error" not in text(found)
    assert "lift error" not in " ".join(table(found).names)
    # No line is drawn over what was not measured; the range here passes cam angle 0.
    lines = [mark for mark in figure(found).panels[0].marks if isinstance(mark, Line)]
    assert not np.any(np.isnan(lines[0].points))
    points = MeasuredPoints(
        flank.places(np.radians([*range(0, 90, 2), *range(120, 360, 2)])).points
    )
    found = inspect_points(disc_of("plate_translating"), Flank.INNER, points, "part.csv")
    lines = [mark for mark in figure(found).panels[0].marks if isinstance(mark, Line)]
    assert np.count_nonzero(np.isnan(lines[0].points[:, 1])) == 1
    json.dumps(figure(found).to_data(), allow_nan=False)


def test_the_name_of_a_file_tells_flank_and_disc(tmp_path: Path) -> None:
    for name, endings in (("groove", ("-inner", "-outer")), ("conjugate_lever", ("", "-return"))):
        design = Design(load_scene(FOLDER / f"{name}.toml"))
        points = probe(design)
        for flank, ending in zip(points.flanks, endings, strict=True):
            path = tmp_path / f"points{ending}.csv"
            path.write_text(flank_table(points, flank).csv())
            found = inspect(design, path)
            assert (found.disc.name, found.flank) == (flank.disc.name, flank.flank)
            assert found.deviations.profile < 1e-12
