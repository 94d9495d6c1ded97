"""The words of programs for all controllers, and of jobs of all kinds, as they were before."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

import pytest

from camgeo_export.gcode.writer import WRITER
from tests.export.texts import FILE, JOBS, STUBS, TOLERANCE, product, said
from tests.toolpath.programs import rounded
from tests.toolpath.test_programs import same


@cache
def kept() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(FILE.read_text("utf-8"))
    return found


@pytest.mark.parametrize("name", [*STUBS, *JOBS])
def test_the_words_of_a_program(name: str) -> None:
    """Its lines, the sums of its cuts, what is told of it, and how exact it is."""
    found = rounded(said(product(name)))
    assert not list(same(found, kept()[name][""], name))
    assert all(0.0 <= deviation <= TOLERANCE for _, _, deviation in found)
    assert kept().keys() == {*STUBS, *JOBS}
    assert len(found) == len(list(WRITER.pieces(product(name))))
