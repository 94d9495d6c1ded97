"""What running small programs says: findings, moves, events, by line and controller."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

import pytest

from tests.interpreter.programs import GOOD
from tests.interpreter.results import FILE, document
from tests.toolpath.programs import rounded
from tests.toolpath.test_programs import same


@cache
def kept() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(FILE.read_text("utf-8"))
    return found


@pytest.mark.parametrize("machine", GOOD)
def test_all_that_is_said_of_a_program(machine: str) -> None:
    """Each block left out, some twice, and others put in, right and wrong ones."""
    found = rounded(document(machine))
    assert found.keys() == kept()[machine].keys()
    assert not list(same(found, kept()[machine], machine))
    assert found[""]["findings"] == []
    told = [each for each in found.values() if isinstance(each, str) or each.get("findings")]
    assert len(told) > 0.4 * len(found)
