"""The smallest concave radius of a wall, and the largest cutter that fits."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camgeo.cam.cam import Contact
from camgeo.errors import GeometryError, UndercutError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.outline.path import whole
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.plan import MotionPlan
from camgeo.milling.bench import largest_diameter
from camgeo.milling.cut import tightest
from camgeo.milling.planned import core
from camgeo.part.boundaries import CurveBoundary, ExactBoundary
from tests.contour.cams import dwell, move
from tests.toolpath.milled import sequence, tool

ROLLER = 8.0

HOLLOW = PitchCurve(
    MotionPlan((dwell(180), move(60, 30.0), dwell(40), move(80, 0.0))),
    TranslatingRoller(40.0, ROLLER),
    1,
)


@pytest.mark.parametrize("hole", [False, True])
def test_of_a_flank_it_is_where_the_sampled_radius_is_smallest(hole: bool) -> None:
    sign = 1.0 if hole else -1.0
    flank = CurveBoundary("flank", hole=hole, path=whole(WorkingCurve(HOLLOW, sign * ROLLER)))
    place = tightest(flank)
    assert place is not None
    phi = np.linspace(0.0, 2.0 * math.pi, 100_001)
    # The flank's own radius of curvature, positive where it is hollow seen from the cutter.
    kappa = WorkingCurve(HOLLOW, sign * ROLLER).curvature(phi) * sign
    assert 1.0 / np.max(kappa) == pytest.approx(place.radius, rel=1e-6)
    assert place.radius <= 1.0 / np.max(kappa) * (1.0 + 1e-12)
    assert place.cam_angle == pytest.approx(phi[np.argmax(kappa)], abs=1e-4)


def test_the_path_of_a_cutter_is_regular_up_to_it() -> None:
    flank = CurveBoundary("outline", hole=False, path=whole(WorkingCurve(HOLLOW, -ROLLER)))
    place = tightest(flank)
    assert place is not None
    flank.offset(0.999 * place.radius).arcs(0.01, "fast")
    with pytest.raises((GeometryError, UndercutError)):
        flank.offset(1.001 * place.radius).arcs(0.01, "fast")
    proposed = largest_diameter(place)
    assert 0.0 <= 2.0 * place.radius - proposed < 0.01 * (1.0 + 1e-9)


def test_of_circles() -> None:
    circle = Contour.circle(12.5)
    bore = tightest(ExactBoundary("bore", hole=True, exact=circle))
    assert bore is not None
    assert bore.radius == 12.5
    assert tightest(ExactBoundary("rim", hole=False, exact=circle)) is None


def test_a_cutter_that_is_too_large_is_refused_with_the_largest_that_fits() -> None:
    """On the hub of a cam that rises steeply the hollow of the outline is the limit."""
    with pytest.raises(GeometryError, match="the largest that fits has ") as caught:
        sequence(Contact.OUTER, tool(140.0))
    largest = float(caught.value.message.rpartition("has ")[2].split()[0])
    sequence(Contact.OUTER, tool(largest))


def test_cores() -> None:
    assert core(25.0, 12.0) == 1.0
    assert core(25.0, 12.5) == 0.0
    assert core(25.0, 20.0) == 0.0
