"""Processes that compute for the designer: too slow, too large, dead, or orphaned."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from camgeo.designing.children import Children, Refused
from camgeo.designing.job import Job
from camgeo.scene.new import template

SCENE = template("translating-roller")
SECONDS = 60.0


@pytest.fixture(scope="module")
def children() -> Iterator[Children]:
    with Children() as found:
        yield found


def test_a_job_has_its_result(children: Children) -> None:
    found = children.submit(Job("curves", SCENE), SECONDS)
    assert found.data["faults"] == []
    assert found.data["animation"] is not None


def test_an_unknown_job_is_refused_and_the_next_one_served(children: Children) -> None:
    with pytest.raises(Refused, match=r"^nonsense: there is no job 'nonsense'"):
        children.submit(Job("nonsense", SCENE), SECONDS)
    assert children.submit(Job("curves", SCENE), SECONDS).data["faults"] == []


def test_a_job_that_is_too_slow_is_killed_and_the_next_one_served(children: Children) -> None:
    with pytest.raises(Refused, match=r"^curves: took longer than 0.0001 s$"):
        children.submit(Job("curves", SCENE), 0.0001)
    assert children.submit(Job("curves", SCENE), SECONDS).data["faults"] == []
