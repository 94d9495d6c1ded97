"""Families: which designs there are, known before anything is computed."""

from __future__ import annotations

import math

import pytest

from camgeo.errors import CamgeoError, GeometryError, SceneError
from camgeo.studies.sweep.family import METHODS, Family, Sample, family_of
from tests.speed import spending
from tests.sweep.families import FIXTURES, SETZHUB, family


def test_all_combinations_the_last_variable_fastest() -> None:
    found = family("follower.base_radius=40,50", "motion.2.law=modified-sine,polynomial-345")
    assert found.keys == ("follower.base_radius", "motion[2].law")
    assert found.count == 4
    assert list(found.points()) == [
        (40, "modified-sine"),
        (40, "polynomial-345"),
        (50, "modified-sine"),
        (50, "polynomial-345"),
    ]
    scene = found.design_scene((50, "modified-sine"))
    assert scene == SETZHUB.with_values(
        {"follower.base_radius": 50, "motion[2].law": "modified-sine"}
    )


def test_tied_keys_change_together() -> None:
    found = family("motion.1.dwell,motion.5.dwell=110/60,100/70,90/80")
    assert [found.edits(point) for point in found.points()] == [
        {"motion[1].dwell": 110, "motion[5].dwell": 60},
        {"motion[1].dwell": 100, "motion[5].dwell": 70},
        {"motion[1].dwell": 90, "motion[5].dwell": 80},
    ]
    assert all(found.design_scene(point).plan for point in found.points())


@pytest.mark.parametrize("method", METHODS)
def test_the_same_seed_draws_the_same_designs(method: str) -> None:
    vary = ("follower.base_radius=40:60", "follower.roller_radius=5:9", "cam.rotation=cw,ccw")
    drawn = [
        list(family_of(SETZHUB, vary, Sample(50, method, seed)).points())  # type: ignore[arg-type]  # one of METHODS
        for seed in (3, 3, 4)
    ]
    assert drawn[0] == drawn[1] != drawn[2]
    assert len(drawn[0]) == 50
    for radius, roller, rotation in drawn[0]:
        assert isinstance(radius, int | float)
        assert isinstance(roller, int | float)
        assert 40 <= radius <= 60
        assert 5 <= roller <= 9
        assert rotation in ("cw", "ccw")


def test_sobol_fills_the_range_evenly() -> None:
    """Each sixteenth of the range has one of the first 16 points, whatever the seed."""
    found = family_of(SETZHUB, ["follower.base_radius=0:16"], Sample(16, "sobol", 7))
    places = [point[0] for point in found.points()]
    assert sorted(math.floor(place) for place in places if isinstance(place, float)) == [*range(16)]
    assert [
        *family_of(SETZHUB, ["follower.base_radius=0:16"], Sample(10, "sobol", 7)).points()
    ] == [*found.points()][:10]


def test_a_design_that_is_drawn_again_is_not_repeated() -> None:
    found = family_of(SETZHUB, ["cam.rotation=cw,ccw"], Sample(16))
    assert sorted(found.points()) == [("ccw",), ("cw",)]


def test_too_many_designs_are_refused_with_their_number_at_once() -> None:
    with (
        spending() as spent,
        pytest.raises(GeometryError, match=r"1,000,000,000 designs are more than 1,000,000"),
    ):
        family("follower.base_radius=30:60:100000", "follower.roller_radius=5:6:10000")
    assert spent.seconds < 1.0


@pytest.mark.parametrize(
    ("vary", "message"),
    [
        ("follower.base_radis=1,2", "did you mean follower.base_radius?"),
        ("motion.2.lw=x,y", "did you mean motion[2].law?"),
        ("motion.9.law=x,y", "motion is a list: its positions are 1 to 5"),
        ("motion[2]=1,2", "is a table: name one of its keys"),
        ("follower.base_radius=30:60", "needs a COUNT"),
        ("follower.base_radius,follower.base_radius=1,2", "varies twice"),
    ],
)
def test_what_cannot_vary(vary: str, message: str) -> None:
    with pytest.raises(CamgeoError) as error:
        family(vary)
    assert message in str(error.value)


def test_nothing_varies() -> None:
    with pytest.raises(GeometryError, match="nothing varies"):
        Family(SETZHUB, ())


@pytest.mark.parametrize("sample", [(0, "sobol", 0), (5, "halton", 0), (5, "random", -1)])
def test_samples_that_there_are_not(sample: tuple[int, str, int]) -> None:
    with pytest.raises(GeometryError):
        Sample(*sample)  # type: ignore[arg-type]  # the test is of those


def test_files_that_designs_name_are_read_once() -> None:
    from camgeo.scene.scene import load_scene

    scene = load_scene(FIXTURES / "scenes" / "measured.toml")
    index = next(k for k, each in enumerate(scene.values["motion"], 1) if "file" in each)
    own = scene.values["motion"][index - 1]["file"]
    found = family(f"motion.{index}.file={own},points_speed.csv,none.csv", scene=scene)
    assert {own} <= set(found.contents()) <= {own, "points_speed.csv"}
    with pytest.raises(SceneError):
        found.design_scene(("none.csv",))
