"""What running small programs says: findings, moves, events, by line and controller."""

from __future__ import annotations

import pytest

from tests.interpreter.programs import GOOD
from tests.interpreter.results import document
from tests.kept import compare_documents


@pytest.mark.parametrize("machine", GOOD)
def test_all_that_is_said_of_a_program_is_as_kept(machine: str) -> None:
    """Each block left out, some twice, and others put in, right and wrong ones."""
    found = document(machine)
    compare_documents(f"interpreter/{machine}", found)
    assert found[""]["findings"] == []
    told = [each for each in found.values() if isinstance(each, str) or each.get("findings")]
    assert len(told) > 0.4 * len(found)
