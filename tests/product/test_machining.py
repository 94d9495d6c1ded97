"""Milling programs: whoever asks for them has the same plan."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from camgeo.design.design import Design
from camgeo.design.machining import machining_of, machining_time
from camgeo.milling import plan
from camgeo.scene.scene import load_scene

SETZHUB = Path(__file__).parents[2] / "fixtures" / "scenes" / "setzhub.toml"


def test_time_and_findings_come_from_one_plan(monkeypatch: pytest.MonkeyPatch) -> None:
    planned, make = [], plan.plan_toolpath

    def counted(*given: Any) -> Any:
        planned.append(given)
        return make(*given)

    monkeypatch.setattr(plan, "plan_toolpath", counted)
    design = Design(load_scene(SETZHUB))
    seconds = machining_time(design.discs)
    assert machining_of(design.discs).seconds == seconds
    assert len(planned) == 1
    milled, tolerance = design.disc.milled, design.scene.output.tolerance
    assert milled.toolpath(0.5 * tolerance) != milled.toolpath(tolerance)  # each has its own
    assert len(planned) == 3
