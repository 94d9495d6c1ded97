"""What `-m quick` runs: something from every folder, and otherwise no expensive module."""

from __future__ import annotations

import pytest

from tests.end_to_end.built import SCENES
from tests.quick import BUILDS, BUILT, EXPENSIVE, LONGEST, QUICK, TESTS, chosen

FOLDERS = sorted({path.parent.relative_to(TESTS).parts[0] for path in TESTS.glob("*/**/test_*.py")})


@pytest.mark.parametrize("folder", FOLDERS)
def test_each_folder_has_quick_tests(folder: str) -> None:
    modules = {path.relative_to(TESTS).as_posix() for path in (TESTS / folder).rglob("test_*.py")}
    least = min(EXPENSIVE.get(module, 0.0) for module in modules)
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
    assert marked == ("test_quick.py" in QUICK)
