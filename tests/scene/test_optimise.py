"""`[optimise]`: what a scene seeks, the same as the options of `camgeo optimise`."""

from __future__ import annotations

import pytest

from camgeo.errors import SceneError
from camgeo.scene.scene import Scene, parse_scene
from camgeo.studies.optimise.optimise import optimise
from camgeo.studies.optimise.task import Effort, task_of
from camgeo.studies.sweep.family import family_of
from tests.optimise.cams import PLAIN
from tests.sweep.families import FIXTURES, SETZHUB

TEXT = (FIXTURES / "scenes" / "setzhub.toml").read_text()

SOUGHT = """
[optimise]
least = ["diameter", "peak:a"]
largest = ["transmission-angle"]
keep = ["mass<=0.5", "transmission-angle>=42"]
ignore = ["smallest-wall"]
evaluations = 6
seconds = 60
seed = 3

[[optimise.vary]]
key = "follower.base_radius"
from = 40
to = 60

[[optimise.vary]]
key = "motion.2.law"
values = ["modified-sine", "polynomial-345"]
"""

VARY = ("follower.base_radius=40:60", "motion.2.law=modified-sine,polynomial-345")


def stated(sought: str = SOUGHT) -> Scene:
    return parse_scene(TEXT + sought)


def test_a_file_states_what_options_state() -> None:
    scene = stated()
    of_file = task_of(scene)
    of_options = task_of(
        SETZHUB,
        VARY,
        least=["diameter", "peak:a"],
        largest=["transmission-angle"],
        keep=["mass<=0.5", "transmission-angle>=42"],
        ignore=["smallest-wall"],
    )
    assert of_file.family.scene == of_options.family.scene == SETZHUB
    assert of_file.family.variables == of_options.family.variables
    for name in ("goals", "limits", "ignored"):
        assert getattr(of_file, name) == getattr(of_options, name)
    assert of_file.effort == Effort(3, 6, 60.0)
    assert of_options.effort == Effort(0, 2000, None)


def test_an_option_replaces_what_the_file_states() -> None:
    """Either of --least and --largest stands in the place of all objectives of the file."""
    found = task_of(stated(), VARY[:1], largest=["diameter"], keep=["peak:a<=9"], ignore=["limits"])
    assert [(each.asked.word, each.sense) for each in found.goals] == [("diameter", "largest")]
    assert [str(each) for each in found.limits] == ["peak:a <= 9"]
    assert found.ignored == {"limits"}
    assert found.family.keys == ("follower.base_radius",)


def test_what_varies_is_that_of_a_sweep_if_nothing_else_is_stated() -> None:
    sweep = '\n[[sweep.vary]]\nkey = "follower.base_radius"\nvalues = [50, 55]\n'
    both = stated(SOUGHT + sweep)
    assert task_of(both).family.keys == ("follower.base_radius", "motion[2].law")
    assert family_of(both).count == 2
    assert family_of(both).scene == SETZHUB
    alone = parse_scene(TEXT + sweep + '\n[optimise]\nleast = ["diameter"]\n')
    assert task_of(alone).family.variables == family_of(alone).variables


def test_the_search_takes_as_long_as_the_file_says() -> None:
    table = {"evaluations": 3, "seed": 5}
    task = task_of(PLAIN.with_values({"optimise": table}), VARY[:1], least=["diameter"])
    found = optimise(task)
    assert (found.seed, found.most, found.ended) == (5, 3, "3 designs were allowed")
    assert optimise(task, seed=0, evaluations=1).most == 1


def test_what_is_sought_changes_no_file_but_tells_scenes_apart() -> None:
    scene = stated()
    assert scene.made == SETZHUB.made
    assert scene.identity != SETZHUB.identity
    assert parse_scene(scene.to_toml()) == scene


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"follower.base_radius"', '"follower.base_radis"', "did you mean follower.base_radius?"),
        ('"motion.2.law"', '"optimise.seed"', "is no key of a design"),
        ("to = 60", "to = 40", "optimise.vary[1].to = 40: is an empty range"),
        ("to = 60", "to = 60\ncount = 1", "one number for two ends"),
        ("seconds = 60", "seconds = 0", "optimise.seconds = 0"),
        ("seed = 3", "seeds = 3", "did you mean seed?"),
        ('["smallest-wall"]', "[1]", 'must be a name, e.g. "smallest-wall"'),
    ],
)
def test_what_is_wrong_is_told_with_its_line(old: str, new: str, message: str) -> None:
    assert old in SOUGHT
    with pytest.raises(SceneError) as error:
        stated(SOUGHT.replace(old, new))
    assert message in str(error.value)
    assert all(fault.line is not None for fault in error.value.faults)
