"""Programs of parts with a hub, a timing mark and holes are measured and verified."""

from __future__ import annotations

import pytest

import camgeo
from camgeo_export.gcode.writer import WRITER
from camgeo_export.verify.gcode import VERIFIER
from tests.export.verified import TOLERANCE, faults
from tests.toolpath.test_features import ROUND_BLANK, SCENE, STATED


@pytest.mark.parametrize("text", [SCENE, SCENE + ROUND_BLANK.replace("top = 1", "") + STATED])
def test_programs_are_measured_and_verified(text: str) -> None:
    product = camgeo.loads(text).disc
    data = WRITER.write(product, TOLERANCE).data
    assert WRITER.measure(product, data) <= TOLERANCE
    assert faults(VERIFIER, product, data) == []


def test_a_mark_that_is_missing_in_a_program_is_found() -> None:
    product = camgeo.loads(SCENE).disc
    data = WRITER.write(product, TOLERANCE).data.decode()
    start = data.index("(operation engrave mark)")
    end = data.index("(operation drill", start)
    cut = "\n".join(line for line in data[start:end].split("\n") if " Z-6.5" not in line)
    damaged = (data[:start] + cut + data[end:]).encode()
    assert damaged != data.encode()
    assert faults(VERIFIER, product, damaged)
