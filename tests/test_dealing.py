"""How tests are dealt out with `-n`: every group to one process, the longest first."""

from __future__ import annotations

import pytest

from tests.dealing import SCENES, SHARING, group_of, longest_first
from tests.quick import EXPENSIVE, TESTS


def test_tests_go_with_their_module(request: pytest.FixtureRequest) -> None:
    assert group_of(request.node.nodeid) == "test_dealing.py"
    assert group_of("tests/part/test_part.py::test_a[setzhub]") == "part/test_part.py"
    assert group_of("tests/part/test_part.py::test_a[x::y@z]") == "part/test_part.py"


def test_tests_of_a_scene_that_is_built_go_together() -> None:
    assert "setzhub" in SCENES
    for test in ("test_dxf.py::test_document[setzhub]", "test_targets.py::test_a[setzhub-arcs]",
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
    long = max(EXPENSIVE, key=lambda module: EXPENSIVE[module])
    tests = [f"tests/{module}::test_{name}" for name in "ab" for module in ("new.py", long)]
    assert [tests[number] for number in longest_first(tests)] == [
        f"tests/{long}::test_a", f"tests/{long}::test_b",
        "tests/new.py::test_a", "tests/new.py::test_b",
    ]  # fmt: skip
