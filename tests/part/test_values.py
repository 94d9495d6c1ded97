"""What a scene states of a part is checked under its own key, and what it leaves out points along
the x axis."""

from __future__ import annotations

from typing import Any

import pytest

from camgeo.part.spec import (
    Chamfer,
    Counterbore,
    DShaft,
    Engraving,
    Holes,
    Hub,
    Keyway,
    Mark,
    Pair,
    SetScrew,
)
from tests.part.parts import refused

VALUES: dict[str, tuple[type, dict[str, float]]] = {
    "part.keyway": (Keyway, {"width": 6.0, "depth": 2.8}),
    "part.d_shaft": (DShaft, {"across": 17.0}),
    "part.hub": (Hub, {"diameter": 40.0, "height": 6.0}),
    "part.set_screw": (SetScrew, {"diameter": 4.0, "height": 3.0}),
    "part.mark": (Mark, {"radius": 25.0, "width": 2.0, "depth": 1.0}),
    "part.bolt_circle.counterbore": (Counterbore, {"diameter": 6.0, "depth": 3.0}),
    "part.holes": (Holes, {"count": 3, "circle": 40.0, "hole": 5.0}),
    "part.pair": (Pair, {"gap": 7.0, "spacer": 36.0}),
    "part.chamfers": (Chamfer, {"width": 1.0}),
    "part.engraving": (Engraving, {"height": 4.0, "depth": 0.5, "radius": 20.0}),
}


@pytest.mark.parametrize("table", VALUES)
def test_each_value_is_checked_under_its_key(table: str) -> None:
    kind, values = VALUES[table]
    given: dict[str, Any] = {"text": "a", **values} if kind is Engraving else values
    made = kind(**given)
    assert getattr(made, "angle", 0.0) == 0.0
    for name in values:
        with refused(f"{table}.{name}"):
            kind(**{**given, name: -1})
    if hasattr(made, "angle"):
        with refused(f"{table}.angle"):
            kind(**{**given, "angle": 6.3})
