"""Cases: what is drawn, how it is kept, and how it is made smaller."""

from __future__ import annotations

import tomllib
from collections import Counter
from pathlib import Path
from random import Random

import pytest

from camgeo.errors import SceneError
from camgeo.scene.scene import load_scene
from tests.fuzz.__main__ import call
from tests.fuzz.case import SCENE, SCENE_STEPS, Case, restore, store, toml
from tests.fuzz.cases import KINDS, draw
from tests.fuzz.lines import ENDING, line
from tests.fuzz.minimise import minimised
from tests.fuzz.runner import Report
from tests.fuzz.scenes import fixtures, scene_case, values_of
from tests.hostile.mutations import mutated
from tests.seeds import FIXED, FRESH


@pytest.mark.parametrize("path", fixtures(), ids=lambda path: path.stem)
def test_toml_is_read_back(path: Path) -> None:
    values = values_of(path)
    assert tomllib.loads(toml(values)) == values


@pytest.mark.parametrize("kind", KINDS)
def test_a_number_of_a_run_is_always_the_same_case(kind: str) -> None:
    assert draw(1, 2, kind) == draw(1, 2, kind)
    assert draw(1, 2, kind) != draw(1, 3, kind)


def test_most_scenes_pass_the_door(tmp_path: Path) -> None:
    passed = 0
    for number in range(20):
        case = scene_case(Random(number))
        for name, data in case.files.items():
            (tmp_path / name).write_bytes(data)
        try:
            load_scene(tmp_path / SCENE)
            passed += 1
        except SceneError:
            pass
    assert 12 <= passed < 20  # those that the door refuses are cases too


def test_all_commands_that_end_are_called() -> None:
    rng = Random(1)
    called = Counter(line(rng)[0] for _ in range(600))
    assert set(ENDING) <= set(called)


@pytest.mark.parametrize("seed", range(20))
def test_files_of_no_length_can_be_damaged(seed: int) -> None:
    assert isinstance(mutated(b"", Random(seed)), bytes)


@pytest.mark.parametrize(
    "case",
    [
        Case({SCENE: b"camgeo = 1\n"}, SCENE_STEPS, "a scene"),
        Case({SCENE: b"camgeo = 1\n"}, SCENE_STEPS, "a scene, in one form", both=False),
        Case({SCENE: b"camgeo = 1\n", "a.csv": b"\xff\x00"}, (("check", SCENE),), "files"),
    ],
)
def test_what_is_kept_is_read_back(case: Case, tmp_path: Path) -> None:
    path = store(case, tmp_path / "case")
    found = restore(path)
    assert found.steps == case.steps
    assert found.source == case.source
    assert found.both == case.both
    for name, data in case.files.items():  # a scene has the reason above it
        assert found.files[name].endswith(data)


def test_the_smallest_case_has_only_what_fails() -> None:
    segments = [{"dwell": 30.0}, {"law": "auto", "span": 230.0, "to": 7.0}, {"dwell": 100.0}]
    values = {"name": "a", "cam": {"rotation": "cw"}, "motion": segments, "part": {"bore": 1.2345}}
    steps = (("check", SCENE), ("build", SCENE))
    case = Case({SCENE: toml(values).encode(), "a.csv": b"1\n2\n3\n"}, steps)

    def fails(smaller: Case) -> bool:
        found = smaller.values or {}
        builds = any(step[:1] == ("build",) for step in smaller.steps)
        return builds and any("law" in each for each in found.get("motion", ()))

    smallest = minimised(case, fails)
    assert smallest.steps == (("build",),)
    assert smallest.values == {"motion": [{"law": "auto"}]}
    assert set(smallest.files) == {SCENE}


def test_a_case_is_made_smaller_in_so_many_runs_and_no_more() -> None:
    data = b"".join(b"%d\n" % k for k in range(100))
    runs = []

    def fails(smaller: Case) -> bool:
        runs.append(smaller)
        return b"57" in smaller.files.get("a.dxf", b"")

    found = minimised(Case({"a.dxf": data}, (("verify", "a.dxf"),)), fails, 5)
    assert len(runs) == 5
    assert b"57" in found.files["a.dxf"]
    assert len(found.files["a.dxf"]) < len(data)


def test_lines_that_do_not_matter_are_left_out() -> None:
    data = b"".join(b"%d\n" % k for k in range(100))
    case = Case({"a.dxf": data}, (("verify", "a.dxf"),))
    smallest = minimised(case, lambda each: b"57" in each.files.get("a.dxf", b""))
    assert smallest.files == {"a.dxf": b"57\n"} or smallest.files == {"a.dxf": b"57"}


def test_a_seed_is_fixed_unless_a_fresh_one_is_asked_for() -> None:
    assert call([]).seed == call([]).seed == FIXED
    assert call(["--seed", "7"]).seed == 7
    assert len({call(["--seed", FRESH]).seed for _ in range(4)}) > 1


@pytest.mark.parametrize("kind", [None, *KINDS])
def test_the_command_that_repeats_a_case_draws_it_again(kind: str | None) -> None:
    for number in (3, 4, 7):
        words = Report(11, kind).repeated(number).split()
        assert words[:3] == ["python", "-m", "tests.fuzz"]
        given = call(words[3:])
        assert draw(given.seed, given.case, given.kind) == draw(11, number, kind)
