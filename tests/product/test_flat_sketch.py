"""The sketch of a flat face: its position at cam angle 0."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import camgeo
from tests.findings import known

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"


@pytest.mark.parametrize("name", ["tappet", "flat_rocker"])
def test_the_contact_lies_on_the_face_that_is_drawn(name: str) -> None:
    design = camgeo.load(SCENES / f"{name}.toml")
    sketch = design.disc.pictured.follower_sketch
    start, end = known(sketch.face)
    contact = complex(*design.disc.pictured.curve("pitch", np.zeros(1))[0])
    share = (contact - start) / (end - start)
    assert abs(share.imag) <= 1e-14
    assert 0.0 < share.real < 1.0
    # As long as the scene says, that of a rocker on to the foot of its pivot.
    assert abs(end - start) == pytest.approx({"tappet": 20.0, "flat_rocker": 100.0}[name])
    foot = start if sketch.kind == "pivot" else contact
    assert abs(((sketch.end - foot) / (end - start)).real) <= 1e-14
