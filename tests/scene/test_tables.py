"""The tables [drawing], [print], [sweep] and [optimise] of a scene."""

from __future__ import annotations

from typing import Any

import pytest

from camgeo.errors import SceneError
from camgeo.part.compensation import Foot, PrintSpec, Shrinkage
from camgeo.scene.formats.drawing import DrawingSpec
from camgeo.scene.scene import Scene, load_scene, parse_scene, schema_of_all
from camgeo.studies.optimise.optimise import Effort, optimise, task_of
from camgeo.studies.sweep.family import Sample, family_of, question_names
from tests.contour.cams import SCENES
from tests.optimise.cams import PLAIN
from tests.scene.scenes import PLATE, refusal_of
from tests.sweep.families import FIXTURES, SETZHUB


def test_a_scene_without_the_table_has_the_defaults_and_its_old_identity() -> None:
    """A format's table with a default would be part of every scene's hash."""
    assert parse_scene(PLATE).drawing == DrawingSpec()
    top = schema_of_all({})["properties"]
    assert "default" not in top["drawing"]
    assert "default" not in top["output"]["properties"]["drawing"]


def test_its_values_are_taken() -> None:
    table = '[drawing]\nsheet = "A4"\nstep = 20\nflank_tolerance = 0.02\nbore_fit = "H7"\n'
    spec = parse_scene(PLATE + table).drawing
    assert (spec.sheet, spec.step, spec.flank_tolerance, spec.bore_fit) == ("A4", 20, 0.02, "H7")
    inches = parse_scene(PLATE.replace('length = "mm"', 'length = "inch"') + table).drawing
    assert inches.flank_tolerance == pytest.approx(0.508)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('scale = "1:3"', r'drawing\.scale = "1:3": must be a standard scale'),
        ('date = "1.3.2026"', "must be a date in quotes"),
        ('title = ""', "must be a text of 1 to 80 characters"),
        ('title = "100%"', "without %"),
        ('bore_fit = "tight"', "must be a tolerance class"),
        ("step = 7", r"drawing\.step = 7: must be 5, 10, 15"),
        ('sheet = "A5"', 'must be one of "A3", "A4"'),
        ('langauge = "de"', r"is not a known key \(did you mean language\?\)"),
    ],
)
def test_wrong_values_are_refused_with_their_key(line: str, message: str) -> None:
    with pytest.raises(SceneError, match=message):
        parse_scene(f"{PLATE}[drawing]\n{line}\n")


WHOLE = {
    "print.bore_clearance": 0.2,
    "print.elephant_foot": {"inset": 0.2, "height": 0.4, "steps": 2},
    "print.shrinkage": {"xy": 0.5},
}


@pytest.fixture(scope="module")
def plate() -> Scene:
    return load_scene(SCENES / "plate_translating.toml").with_values({"part.bore": 20})


def test_the_table_is_converted(plate: Scene) -> None:
    assert plate.printing is None
    found = plate.with_values(WHOLE).printing
    assert found == PrintSpec(0.2, None, Foot(0.2, 0.4, 2), Shrinkage(0.5, 0.0))
    inches = load_scene(SCENES / "inch.toml").with_values({**WHOLE, "print.bore_clearance": 0.01})
    assert inches.printing is not None
    assert inches.printing.bore_clearance == pytest.approx(0.254)
    assert inches.printing.elephant_foot == Foot(0.2 * 25.4, 0.4 * 25.4, 2)
    assert inches.printing.scale_xy == pytest.approx(1.0 / 0.995)


def test_a_foot_higher_than_a_thin_disc_on_a_hub(plate: Scene) -> None:
    """The hub lies on the bed, not the disc."""
    hub = {"diameter": 34, "height": 6, "side": "lower"}
    foot = {"inset": 0.2, "height": 4}
    values = {"part.thickness": 3, "part.hub": hub, "print.elephant_foot": foot}
    assert plate.with_values(values).printing == PrintSpec(elephant_foot=Foot(0.2, 4.0))


def test_it_decides_the_bytes_of_files(plate: Scene) -> None:
    assert len({plate.made, *(plate.with_values({k: v}).made for k, v in WHOLE.items())}) == 4


@pytest.mark.parametrize(
    ("values", "key", "message"),
    [
        (
            {"part.keyway": None, "print.key_clearance": 0.1},
            "print.key_clearance",
            "needs .part. keyway, or d_shaft",
        ),
        (
            {"part.bore": None, "part.keyway": None, "print.bore_clearance": 0.1},
            "print.bore_clearance",
            "needs .part. bore",
        ),
        (
            {"print.elephant_foot": {"inset": 0.1, "height": 50}},
            "print.elephant_foot.height",
            "must be less than the thickness",
        ),
        (
            {
                "part.hub": {"diameter": 34, "height": 3, "side": "lower"},
                "print.elephant_foot": {"inset": 0.1, "height": 4},
            },
            "print.elephant_foot.height",
            "must be less than the height of the lower hub, 3",
        ),
        ({"print.elephant_foot": {"inset": 0.1}}, "print.elephant_foot.height", "is missing"),
        ({"print.elephant_foot": 0.2}, "print.elephant_foot", "must be a table, e.g."),
        ({"print.bore_clearance": 0}, "print.bore_clearance", "must be a positive number"),
        ({"print.shrinkage": {"xy": 25}}, "print.shrinkage.xy", "must be a number from -10 to 20"),
        ({"part.print_clearance": 0.2}, "part.print_clearance", "is not a known key"),
        ({"print.clearance": 0.2}, "print.clearance", "did you mean"),
    ],
)
def test_refusals(plate: Scene, values: dict[str, Any], key: str, message: str) -> None:
    with pytest.raises(SceneError, match=message) as caught:
        plate.with_values(values)
    assert [fault.key for fault in caught.value.faults] == [key]


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
    assert question_names(scene) == ("transmission-angle", "peak:a")
    assert question_names(scene, ["mass,laws"]) == ("mass", "laws")
    assert family_of(scene, OPTIONS[:1]).count == 4


def test_samples_are_stated_too() -> None:
    scene = stated(FAMILY.replace("count = 4", "").replace("ask =", "samples = 8\nseed = 3\nask ="))
    assert family_of(scene).sample == Sample(8, "sobol", 3)
    assert family_of(scene, OPTIONS).sample is None
    assert family_of(scene).count == 8


def test_all_faults_are_told_at_once() -> None:
    wrong = FAMILY.replace("to = 60", "to = 45").replace("motion.2.law", "motion.2.lew")
    text = (TEXT + wrong).replace("roller_radius = 7.0", "roller_radius = -7.0")
    assert len(refusal_of(text).faults) == 3


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


def searching(sought: str = SOUGHT) -> Scene:
    return parse_scene(TEXT + sought)


def test_a_file_states_what_options_of_a_search_state() -> None:
    scene = searching()
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
    found = task_of(
        searching(), VARY[:1], largest=["diameter"], keep=["peak:a<=9"], ignore=["limits"]
    )
    assert [(each.question.word, each.sense) for each in found.goals] == [("diameter", "largest")]
    assert [str(each) for each in found.limits] == ["peak:a <= 9"]
    assert found.ignored == {"limits"}
    assert found.family.keys == ("follower.base_radius",)


def test_what_varies_is_that_of_a_sweep_if_nothing_else_is_searching() -> None:
    sweep = '\n[[sweep.vary]]\nkey = "follower.base_radius"\nvalues = [50, 55]\n'
    both = searching(SOUGHT + sweep)
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


@pytest.mark.parametrize("tables", [FAMILY, SOUGHT])
def test_they_change_no_file_but_tell_scenes_apart(tables: str) -> None:
    scene = parse_scene(TEXT + tables)
    assert scene.made == SETZHUB.made
    assert scene.identity != SETZHUB.identity
    assert parse_scene(scene.to_toml()) == Scene(scene.values) == scene


@pytest.mark.parametrize(
    ("tables", "old", "new", "message"),
    [
        (
            FAMILY,
            '"follower.base_radius"',
            '"follower.base_radis"',
            "did you mean follower.base_radius?",
        ),
        (FAMILY, '"motion.2.law"', '"motion.9.law"', "its positions are 1 to 5"),
        (FAMILY, '"motion.2.law"', '"sweep.seed"', "is not a key of a design"),
        (FAMILY, '"motion.2.law"', '"follower.base_radius"', "varies twice"),
        (FAMILY, 'key = "motion.2.law"\n', "", 'must have either "key" or "keys"'),
        (FAMILY, 'key = "motion.2.law"\n', 'key = "a"\nkeys = ["b"]\n', 'either "key" or "keys"'),
        (FAMILY, "from = 45\nto = 60\ncount = 4", "", 'either "values", or "from" and "to"'),
        (FAMILY, "to = 60\n", "", 'must have both "from" and "to"'),
        (FAMILY, "to = 60\n", "to = 45\n", "is an empty range"),
        (FAMILY, "count = 4", "count = 1", "one number for two ends"),
        (FAMILY, "count = 4", "", 'needs "count", unless [sweep] has "samples"'),
        (FAMILY, "count = 4", "count = 0", "sweep.vary[1].count = 0"),
        (
            FAMILY,
            "[[110, 60], [100.5, 69.5]]",
            "[[110, 60], [1]]",
            "must have a value for each of 2 keys",
        ),
        (FAMILY, '"modified-sine", "polynomial-345"', '"scca", "scca"', "is listed twice"),
        (FAMILY, '"modified-sine", "polynomial-345"', "1, 1.0", "is listed twice"),
        (
            FAMILY,
            '"modified-sine", "polynomial-345"',
            "{}",
            "must be a number, a text, true or false",
        ),
        (FAMILY, "ask =", 'method = "halton"\nask =', 'must be one of "sobol", "random"'),
        (FAMILY, "ask =", "sample = 3\nask =", "did you mean samples?"),
        (
            SOUGHT,
            '"follower.base_radius"',
            '"follower.base_radis"',
            "did you mean follower.base_radius?",
        ),
        (SOUGHT, '"motion.2.law"', '"optimise.seed"', "is not a key of a design"),
        (SOUGHT, "to = 60", "to = 40", "optimise.vary[1].to = 40: is an empty range"),
        (SOUGHT, "to = 60", "to = 60\ncount = 1", "one number for two ends"),
        (SOUGHT, "seconds = 60", "seconds = 0", "optimise.seconds = 0"),
        (SOUGHT, "seed = 3", "seeds = 3", "did you mean seed?"),
        (SOUGHT, '["smallest-wall"]', "[1]", 'must be a name, e.g. "smallest-wall"'),
    ],
)
def test_what_is_wrong_is_told_with_its_line(tables: str, old: str, new: str, message: str) -> None:
    assert old in tables
    error = refusal_of(TEXT + tables.replace(old, new))
    assert message in str(error)
    assert all(fault.line is not None for fault in error.faults)
