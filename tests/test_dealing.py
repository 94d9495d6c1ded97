"""How tests are dealt out with `-n`: every group to one process, the longest first."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from tests.dealing import SCENES, SHARING, Dealing, group_of, longest_first
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


class Process:
    """A process that keeps the numbers of the tests that it is given."""

    def __init__(self, name: str) -> None:
        self.gateway = SimpleNamespace(id=name)
        self.shutting_down = False
        self.given: list[int] = []

    def send_runtest_some(self, numbers: list[int]) -> None:
        self.given += numbers

    def shutdown(self) -> None:
        self.shutting_down = True


def test_each_group_goes_to_one_process() -> None:
    modules = ["a.py", "b.py", *SHARING]
    tests = [f"tests/{module}::test_a[{number}]" for module in modules for number in range(5)]
    values: dict[str, Any] = {"tx": ["popen", "popen"]}
    option = SimpleNamespace(loadscopereorder=False, debug=False)
    dealing = Dealing(SimpleNamespace(getvalue=values.get, option=option))
    processes = [Process("one"), Process("other")]
    for process in processes:
        dealing.add_node(process)
        dealing.add_node_collection(process, tests)
    dealing.schedule()
    done = {process.gateway.id: 0 for process in processes}
    while any(done[process.gateway.id] < len(process.given) for process in processes):
        for process in processes:
            if done[process.gateway.id] < len(process.given):
                dealing.mark_test_complete(process, process.given[done[process.gateway.id]])
                done[process.gateway.id] += 1
    assert sorted(processes[0].given + processes[1].given) == list(range(len(tests)))
    groups = [{group_of(tests[number]) for number in process.given} for process in processes]
    assert not groups[0] & groups[1]
    assert all(groups)
    assert all(process.shutting_down for process in processes)
