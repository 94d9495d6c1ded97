"""Outlines that are circles: one arc in every form.

Under a flat face square to its guide s = e (1 - cos phi) makes an eccentric disc: the face at the
distance r + e - e cos phi is the tangent of a circle of radius r + e about a point e behind."""

from __future__ import annotations

from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

from camgeo import load
from camgeo.geometry.contour import proof
from camgeo.geometry.contour.arcs import fewest_arcs, fit_arcs
from camgeo.geometry.contour.cubics import fewest_cubics
from camgeo.geometry.contour.spline import Arc
from camgeo.geometry.outline.outline import real_outline
from camgeo.geometry.outline.path import Path as Outline
from camgeo.geometry.outline.path import whole
from camgeo.geometry.pitch_curve import PitchCurve, WorkingCurve
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.mechanism.flat import TranslatingFlat
from camgeo.kinematics.mechanism.rollers import TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from tests.contour.cams import dwell, translating

FOUND = Path(__file__).parents[2] / "fixtures" / "found"


ROUNDING = 2.0**-52 * 100.0
"""Rounding of points and centres, as a fraction of the size: sums of a few dozen products."""


def eccentric(
    base: float, stroke: float, span: str = "180", *, direction: int = 1, rotation: int = 1
) -> Outline:
    """An outline: up by a simple sine over `span` degrees, and back by another one."""
    law, back = make_law("simple-sine", "R-R"), Decimal(360) - Decimal(span)
    plan = MotionPlan((Move(Decimal(span), stroke, law), Move(back, 0.0, law)))
    pitch = PitchCurve(plan, TranslatingFlat(base, direction=direction), rotation)
    return whole(WorkingCurve(pitch, 0.0))


def test_the_reported_disc_is_one_circle() -> None:
    (outline,) = load(FOUND / "eccentric_flat.toml").disc.drawn.part.boundaries
    fit = outline.arcs(0.01)
    assert len(fit.contour) == 1
    assert fit.contour.radii[0] == pytest.approx(13.5, rel=ROUNDING)
    assert abs(fit.contour.centres[0] + 1.5j) <= 13.5 * ROUNDING
    assert fit.deviation <= 2.0 * proof.ROUNDING * (1.5 + 13.5 + 12.0)


@pytest.mark.parametrize("rotation", [1, -1])
@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("tolerance", [0.1, 1e-7])
def test_every_form_of_it_is_one_circle(tolerance: float, direction: int, rotation: int) -> None:
    path = eccentric(1000.0, 300.0, direction=direction, rotation=rotation)
    centre, radius = -150.0j * direction, 1000.0 + 150.0 * direction
    (arc,) = fewest_cubics(path, tolerance).contour.strands
    assert isinstance(arc, Arc)
    assert abs(arc.centre - centre) + abs(abs(arc.start - centre) - radius) <= radius * ROUNDING
    for fit in (fit_arcs(path, tolerance), fewest_arcs(path, tolerance)):
        assert len(fit.contour) == 1
        assert abs(fit.contour.centres[0] - centre) <= radius * ROUNDING
        charged = 2.0 * proof.ROUNDING * (abs(centre) + radius + 1000.0)
        assert fit.deviation <= charged
        assert proof.deviation(path, fit.contour.reversed()) <= charged


def test_a_cam_that_rests_all_turn_is_one_circle() -> None:
    path = whole(WorkingCurve(translating(dwell(360)).pitch, -8.0))
    for fit in (fit_arcs(path, 1e-9), fewest_arcs(path, 1e-9), fewest_cubics(path, 1e-9)):
        assert len(fit.contour) == 1
        assert fit.contour.area == pytest.approx(np.pi * 32.0**2, rel=1e-15)
        assert fit.deviation < 1e-11


def test_a_quarter_of_a_law_is_one_arc() -> None:
    """Its first quarter turn is a circle, the rest is not; it begins beside a rest."""
    law = make_law("simple-sine", "R-R", inflection=0.4)
    moves = (Move(Decimal(225), 6.0, law), Move(Decimal(90), 0.0, make_law("cycloidal", "R-R")))
    plan = MotionPlan((Dwell(Decimal(45)), *moves))
    pitch = PitchCurve(plan, TranslatingFlat(40.0), 1)
    fit = fewest_arcs(whole(WorkingCurve(pitch, 0.0)), 1e-3)
    # f = A (1 - cos(pi z / 0.8)) up to z = 0.4, where the velocity of both parts is the same and
    # the lift has reached 0.4 of the stroke.
    own = np.abs(fit.contour.radii - (40.0 + 0.4 * 6.0)) <= 40.0 * ROUNDING
    assert np.count_nonzero(own) == 1
    assert abs(fit.contour.sweeps[own][0]) == pytest.approx(0.5 * np.pi, rel=ROUNDING)
    assert np.count_nonzero(np.abs(fit.contour.radii - 40.0) <= 40.0 * ROUNDING) == 1


@pytest.mark.parametrize("left", [1e-3, 1e-6, 1e-9])
def test_a_rest_on_a_tiny_circle_has_an_outline(left: float) -> None:
    """No cell of it comes nearer to a cusp than any other: its pace is one number."""
    plan = MotionPlan((Dwell(Decimal(360)),))
    pitch = PitchCurve(plan, TranslatingRoller(10.0, 10.0 - left), 1)
    path = real_outline(WorkingCurve(pitch, left - 10.0)).path
    (radius,) = fewest_arcs(path, 0.1 * left).contour.radii
    assert radius == pytest.approx(left, abs=10.0 * ROUNDING)
