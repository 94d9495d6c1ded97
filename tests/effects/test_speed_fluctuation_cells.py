"""The cells of a steady turn: never more than the limit, which bounds memory."""

from __future__ import annotations

from typing import Any

import pytest

from camgeo.dynamics.effects.speed_fluctuation import result as steady_module
from camgeo.errors import EffectError
from tests.effects.scenes import design
from tests.effects.test_speed_fluctuation import driven, steady


def test_a_mesh_has_no_more_cells_than_allowed(monkeypatch: pytest.MonkeyPatch) -> None:
    plate = design("plate_translating", "")
    torque = driven(plate)
    sizes: list[int] = []
    newton_step = steady_module.newton_step

    def noted(shaft: Any, mesh: Any, state: Any) -> Any:
        sizes.append(len(mesh.low))
        return newton_step(shaft, mesh, state)

    monkeypatch.setattr(steady_module, "newton_step", noted)
    steady(plate, torque, 9.0, 6000.0, 1e-9)
    most = (max(sizes) - 1) // 2  # the finer mesh has twice as many
    assert most > min(sizes)
    sizes.clear()
    monkeypatch.setattr(steady_module, "MOST_CELLS", most)
    with pytest.raises(EffectError):
        steady(plate, torque, 9.0, 6000.0, 1e-9)
    assert max(sizes) <= 2 * most
