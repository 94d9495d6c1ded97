"""What `-m quick` runs: of each stage something, of dear modules nothing else."""

from __future__ import annotations

import pytest

from tests.end_to_end.built import SCENES
from tests.quick import BUILDS, BUILT, QUICK, TESTS, chosen

FOLDERS = sorted(path.parent.name for path in TESTS.glob("*/__init__.py"))


@pytest.mark.parametrize("folder", FOLDERS)
def test_each_folder_has_quick_tests(folder: str) -> None:
    assert any(module.startswith(f"{folder}/") for module in QUICK)


def test_the_scene_that_is_built_is_there() -> None:
    assert BUILT in {scene.stem for scene in SCENES}
    assert (TESTS / BUILDS).is_dir()


def test_dear_modules_are_left_out_unless_a_folder_has_no_others() -> None:
    modules = ["a/new", "a/dear", "a/dearer", "b/dear", "b/dearer", "top"]
    dear = {"a/dear": 2.0, "a/dearer": 3.0, "b/dear": 2.0, "b/dearer": 3.0, "gone": 9.0}
    assert chosen(modules, dear) == {"a/new", "b/dear", "top"}


def test_quick_tests_are_marked(request: pytest.FixtureRequest) -> None:
    """This module is quick, and so is each of its tests."""
    marked = request.node.get_closest_marker("quick") is not None
    assert marked == ("test_quick.py" in QUICK)
