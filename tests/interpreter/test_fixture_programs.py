"""Programs of the fixture scenes for every profile: nothing is found in them, and they verify.

Six scenes, of which one is verified; all of them in the long form.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from camgeo.toolpath.machine import load, names
from camgeo.verifying.verification import Reading
from camgeo_export.gcode.measure import bench_of
from camgeo_export.interpreter.run import run_bytes
from camgeo_export.verify.gcode import VERIFIER
from tests.judges.programs import SIX, milled_scenes, programs, workshop
from tests.long_form import LONG


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return workshop(tmp_path_factory.mktemp("workshop"))


@pytest.mark.parametrize("machine", names())
@pytest.mark.parametrize("scene", milled_scenes() if LONG else SIX)
def test_programs_are_clean_and_verify(scene: str, machine: str, folder: Path) -> None:
    profile = load(machine)
    for product, data in programs(folder, scene, machine):
        found = run_bytes(data, profile, bench_of(product, profile))
        assert found.findings == ()
        if not (LONG or scene == SIX[0]):  # to measure the path takes half a second
            continue
        origin = VERIFIER.origin(data)
        assert origin.tolerance is not None
        checks = VERIFIER.checks(product, data, Reading("a.nc", ours=True), origin.tolerance)
        assert [check for check in checks if check.ok is False] == []
