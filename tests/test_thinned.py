"""Which tests run: the quick ones, some cases of what takes long, and how they are dealt out."""

from __future__ import annotations

import itertools

import pytest

from tests.dealing import SCENES as DEALT
from tests.dealing import SHARING, group_of, longest_first
from tests.end_to_end.built import SCENES
from tests.quick import BUILDS, BUILT, LONGEST, QUICK, TESTS, chosen
from tests.quick import EXPENSIVE as MODULES
from tests.thinned import EXPENSIVE, MOST, function_of, kept

CASES = [f"a.py::test_many[{number}]" for number in range(12)]


def test_what_is_cheap_runs_whole() -> None:
    assert kept([*CASES, "a.py::test_one"], {"a.py::test_other": 100.0}) == [True] * 13


def test_one_of_so_many_runs_that_they_take_about_the_most() -> None:
    runs = kept(CASES, {"a.py::test_many": 4 * MOST})
    found = [number for number, each in enumerate(runs) if each]
    assert len(found) == 3
    assert {after - before for before, after in itertools.pairwise(found)} == {4}


def test_one_runs_at_least() -> None:
    assert sum(kept(CASES, {"a.py::test_many": 1000 * MOST})) == 1
    assert kept(CASES[:1], {"a.py::test_many": 1000 * MOST}) == [True]


def test_the_expensive_ones_have_several_cases_and_are_long() -> None:
    assert EXPENSIVE
    assert all(name == function_of(name) for name in EXPENSIVE)
    assert max(EXPENSIVE.values()) > MOST


FOLDERS = sorted({path.parent.relative_to(TESTS).parts[0] for path in TESTS.glob("*/**/test_*.py")})


@pytest.mark.parametrize("folder", FOLDERS)
def test_each_folder_has_quick_tests(folder: str) -> None:
    modules = {path.relative_to(TESTS).as_posix() for path in (TESTS / folder).rglob("test_*.py")}
    least = min(MODULES.get(module, 0.0) for module in modules)
    assert (not modules.isdisjoint(QUICK)) == (least <= LONGEST)


def test_the_scene_that_is_built_is_there() -> None:
    assert BUILT in {scene.stem for scene in SCENES}
    assert (TESTS / BUILDS).is_dir()


def test_expensive_modules_are_left_out_unless_a_folder_has_no_others() -> None:
    modules = ["a/new", "a/slow", "a/slower", "b/slow", "b/slower", "top"]
    expensive = {"a/slow": 2.0, "a/slower": 3.0, "b/slow": 2.0, "b/slower": 3.0, "gone": 9.0}
    assert chosen(modules, expensive) == {"a/new", "b/slow", "top"}
    assert chosen(["c/slow"], {"c/slow": LONGEST + 1.0}) == frozenset()


def test_quick_tests_are_marked(request: pytest.FixtureRequest) -> None:
    """This module is quick, so all of its tests are."""
    marked = request.node.get_closest_marker("quick") is not None
    assert marked == ("test_thinned.py" in QUICK)


def test_tests_go_with_their_module(request: pytest.FixtureRequest) -> None:
    assert group_of(request.node.nodeid) == "test_thinned.py"
    assert group_of("tests/part/test_part.py::test_a[setzhub]") == "part/test_part.py"
    assert group_of("tests/part/test_part.py::test_a[x::y@z]") == "part/test_part.py"


def test_tests_of_a_scene_that_is_built_go_together() -> None:
    assert "setzhub" in DEALT
    for test in ("test_dxf.py::test_cut_layer[setzhub]", "test_solids.py::test_a[setzhub-stl]",
                 "test_conjugate.py::test_a[csv-setzhub]"):  # fmt: skip
        assert group_of(f"tests/end_to_end/{test}") == "scene setzhub"
    assert group_of("tests/end_to_end/test_verify.py::test_a[alone-dxf: scaled]") == (
        "end_to_end/test_verify.py"
    )


@pytest.mark.parametrize("module", SHARING)
def test_modules_that_share_a_result_are_there(module: str) -> None:
    assert (TESTS / module).is_file()
    assert group_of(f"tests/{module}::test_a") == SHARING[module]


def test_groups_follow_each_other_the_longest_first() -> None:
    long = max(MODULES, key=lambda module: MODULES[module])
    tests = [f"tests/{module}::test_{name}" for name in "ab" for module in ("new.py", long)]
    assert [tests[number] for number in longest_first(tests)] == [
        f"tests/{long}::test_a", f"tests/{long}::test_b",
        "tests/new.py::test_a", "tests/new.py::test_b",
    ]  # fmt: skip
