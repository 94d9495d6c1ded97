"""The diagrams over the cam angle: the limits that they show are those of the findings."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import camgeo
from camgeo.pictures.model import Line, Rule
from camgeo.pictures.motion import RATIO, RATIO_STYLE, curvature
from camgeo.units import MM_PER

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"


@pytest.mark.parametrize(
    ("name", "sides"),
    [("setzhub", {1.0}), ("groove_clearance", {1.0, -1.0}), ("inch", {1.0}), ("tappet", set())],
)
def test_the_limit_of_the_ratio_of_radii_is_in_the_picture(name: str, sides: set[float]) -> None:
    """The curve crosses a line just where its flank's finding breaks the limit.

    The value of a finding is r_R kappa of the worst place, and the line lies at limit/r_R.
    """
    product = camgeo.load(SCENES / f"{name}.toml").disc
    (panel,) = curvature(product).panels
    rules = {
        float(np.sign(mark.at)): mark.at
        for mark in panel.marks
        if isinstance(mark, Rule) and mark.style == RATIO_STYLE
    }
    assert set(rules) == sides
    (curve,) = [mark for mark in panel.marks if isinstance(mark, Line)]
    low, high = panel.y.limits
    roller = product.cam.follower.roller_radius / MM_PER[product.unit]
    findings = {item.name: item for item in product.findings}
    for flank, sign in RATIO.items():
        if sign not in rules:
            continue
        item, at = findings[f"radius-ratio-{flank}"], rules[sign]
        assert item.limit is not None
        assert item.value is not None
        assert low < at < high
        assert abs(at) * roller == pytest.approx(item.limit)
        worst = np.nanmax(sign * curve.points[:, 1])
        # Of the drawn points, a quarter of a degree apart, the worst one is near the exact place.
        assert max(worst, 0.0) * roller == pytest.approx(item.value, rel=1e-3, abs=1e-12)
