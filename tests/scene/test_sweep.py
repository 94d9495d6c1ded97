"""`[sweep]`: a family that a scene states, the same as the options of `camgeo sweep`."""

from __future__ import annotations

import pytest

from camgeo.errors import SceneError
from camgeo.scene.scene import Scene, parse_scene
from camgeo.studies.sweep.family import Sample, family_of, questions_of
from tests.scene.scenes import refusal_of
from tests.sweep.families import FIXTURES, SETZHUB

TEXT = (FIXTURES / "scenes" / "setzhub.toml").read_text()

FAMILY = """
[sweep]
ask = ["transmission-angle", "peak:a"]

[[sweep.vary]]
key = "follower.base_radius"
from = 45
to = 60
count = 4

[[sweep.vary]]
key = "motion.2.law"
values = ["modified-sine", "polynomial-345"]

[[sweep.vary]]
keys = ["motion[1].dwell", "motion[5].dwell"]
values = [[110, 60], [100.5, 69.5]]
"""

OPTIONS = (
    "follower.base_radius=45:60:4",
    "motion.2.law=modified-sine,polynomial-345",
    "motion[1].dwell,motion[5].dwell=110/60,100.5/69.5",
)


def stated(family: str = FAMILY) -> Scene:
    return parse_scene(TEXT + family)


def test_a_file_states_what_options_state() -> None:
    scene = stated()
    of_file, of_options = family_of(scene), family_of(SETZHUB, OPTIONS)
    assert of_file.variables == of_options.variables
    assert list(of_file.points()) == list(of_options.points())
    assert of_file.scene == of_options.scene == SETZHUB
    assert questions_of(scene) == ("transmission-angle", "peak:a")
    assert questions_of(scene, ["mass,laws"]) == ("mass", "laws")
    assert family_of(scene, OPTIONS[:1]).count == 4


def test_samples_are_stated_too() -> None:
    scene = stated(FAMILY.replace("count = 4", "").replace("ask =", "samples = 8\nseed = 3\nask ="))
    assert family_of(scene).sample == Sample(8, "sobol", 3)
    assert family_of(scene, OPTIONS).sample is None
    assert family_of(scene).count == 8


def test_a_family_changes_no_file_but_tells_scenes_apart() -> None:
    scene = stated()
    assert scene.made == SETZHUB.made
    assert scene.identity != SETZHUB.identity
    assert parse_scene(scene.to_toml()) == scene
    assert Scene(scene.values) == scene


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"follower.base_radius"', '"follower.base_radis"', "did you mean follower.base_radius?"),
        ('"motion.2.law"', '"motion.9.law"', "its positions are 1 to 5"),
        ('"motion.2.law"', '"sweep.seed"', "is no key of a design"),
        ('"motion.2.law"', '"follower.base_radius"', "varies twice"),
        ('key = "motion.2.law"\n', "", 'must have either "key" or "keys"'),
        ('key = "motion.2.law"\n', 'key = "a"\nkeys = ["b"]\n', 'either "key" or "keys"'),
        ("from = 45\nto = 60\ncount = 4", "", 'either "values", or "from" and "to"'),
        ("to = 60\n", "", 'must have both "from" and "to"'),
        ("to = 60\n", "to = 45\n", "is an empty range"),
        ("count = 4", "count = 1", "one number for two ends"),
        ("count = 4", "", 'needs "count", unless [sweep] has "samples"'),
        ("count = 4", "count = 0", "sweep.vary[1].count = 0"),
        ("[[110, 60], [100.5, 69.5]]", "[[110, 60], [1]]", "must have a value for each of 2 keys"),
        ('"modified-sine", "polynomial-345"', '"scca", "scca"', "is listed twice"),
        ('"modified-sine", "polynomial-345"', "1, 1.0", "is listed twice"),
        ('"modified-sine", "polynomial-345"', "{}", "must be a number, a text, true or false"),
        ("ask =", 'method = "halton"\nask =', 'must be one of "sobol", "random"'),
        ("ask =", "sample = 3\nask =", "did you mean samples?"),
    ],
)
def test_what_is_wrong_is_told_with_its_line(old: str, new: str, message: str) -> None:
    assert old in FAMILY
    with pytest.raises(SceneError) as error:
        stated(FAMILY.replace(old, new))
    assert message in str(error.value)
    assert all(fault.line is not None for fault in error.value.faults)


def test_all_faults_are_told_at_once() -> None:
    wrong = FAMILY.replace("to = 60", "to = 45").replace("motion.2.law", "motion.2.lew")
    text = (TEXT + wrong).replace("roller_radius = 7.0", "roller_radius = -7.0")
    assert len(refusal_of(text).faults) == 3
