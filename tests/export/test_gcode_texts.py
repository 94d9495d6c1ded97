"""The words of programs for all controllers, and of jobs of all kinds, as they were before."""

from __future__ import annotations

import pytest

from camgeo_export.gcode.writer import WRITER
from tests.export.texts import JOBS, STUBS, TOLERANCE, product, said
from tests.kept import compare_documents


@pytest.mark.parametrize("name", [*STUBS, *JOBS])
def test_the_words_of_a_program_are_as_kept(name: str) -> None:
    """Its lines, the sums of its cuts, what is told of it, and how exact it is."""
    found = said(product(name))
    compare_documents(f"export/programs/{name}", {name: found})
    assert all(0.0 <= deviation <= TOLERANCE for _, _, deviation in found)
    assert len(found) == len(list(WRITER.pieces(product(name))))
