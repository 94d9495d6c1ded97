"""Form closure and closing error, compared with dense values and with inexact discs."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings

import camgeo
from camgeo.app.answers.replay import closing_error
from camgeo.check.machine import check_pair, leverage_slope
from camgeo.design.design import Design
from camgeo.geometry.contour.arcs import fit_arcs
from camgeo.geometry.outline.path import whole
from camgeo.geometry.outline.replay import replay_contour
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.geometry.working_curve import WorkingCurve
from camgeo.kinematics.mechanism.conjugate import return_on_lever
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.numeric.arrays import FloatArray
from camgeo.units import TURN
from tests.findings import known
from tests.integrals import cells, integrals
from tests.pairs import Pair, pairs
from tests.strategies import attack

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"
PAIRS = ("conjugate_lever", "conjugate_carriage")

TOLERANCE = 1e-3

DENSE = np.linspace(0.0, TURN, 20_001)


@settings(attack, max_examples=20)
@given(pairs())
def test_the_slope_of_the_leverage_is_its_derivative(pair: Pair) -> None:
    """Its integral over cells of every smooth piece is the difference of the leverage."""
    for curve in (pair.main, pair.other):
        low, high = cells(curve.borders, 8)

        def slope(phi: FloatArray, curve: PitchCurve = curve) -> FloatArray:
            return leverage_slope(curve, phi, "right")

        grown = curve.leverage(high, "left") - curve.leverage(low)
        # The leverage is known to some ten roundings, Gauss's rule to no more than as many.
        slack = 1e-12 * abs(curve.follower.reach)
        assert integrals(slope, low, high) == pytest.approx(grown, abs=slack)


@settings(attack, max_examples=30)
@given(pairs())
def test_the_extremes_are_those_of_dense_values(pair: Pair) -> None:
    closed, closing = check_pair(pair.main, pair.other, TOLERANCE, 1.0)
    assert (closed.name, closed.severity) == ("form-closure", "ok")
    assert (closing.name, closing.severity) == ("closing-error", "ok")
    one, two = (curve.leverage(DENSE) for curve in (pair.main, pair.other))
    product = one * two / abs(pair.main.follower.reach * pair.other.follower.reach)
    play = TOLERANCE * abs(pair.main.follower.reach) * (1.0 / np.abs(one) + 1.0 / np.abs(two))
    # Between two of the dense places lies no more than their next difference.
    for found, dense in ((closed, product), (closing, play)):
        slack = float(np.max(np.abs(np.diff(dense, 2))))
        assert np.max(dense) - 1e-12 <= known(found.value) <= np.max(dense) + slack + 1e-12


def test_two_discs_on_one_side_of_the_lever_do_not_close() -> None:
    design = camgeo.load(SCENES / "conjugate_lever.toml")
    main = design.cam.follower
    assert isinstance(main, OscillatingRoller)
    other = return_on_lever(main, math.radians(-20.0))
    curve = PitchCurve(design.cam.drive.motion, other, design.cam.rotation)
    (closed,) = check_pair(design.cam.disc.pitch_curve, curve, TOLERANCE, 1.0)
    assert (closed.name, closed.severity) == ("form-closure", "broken")
    assert known(closed.value) > 0.0
    assert closed.cam_angle is not None
    assert "do not hold the follower" in closed.sentence


def test_a_lever_that_swings_through_the_line_of_centres_does_not_close() -> None:
    """The return arm 5 degrees off the line, swinging 14 over it: closed at cam angle 0 only."""
    design = camgeo.load(SCENES / "conjugate_lever.toml")
    main = design.cam.follower
    assert isinstance(main, OscillatingRoller)
    chi = main.start_angle + math.radians(5.0)
    curve = PitchCurve(design.cam.drive.motion, return_on_lever(main, chi), design.cam.rotation)
    start = np.zeros(1)
    assert design.cam.disc.pitch_curve.leverage(start) * curve.leverage(start) < 0.0
    (closed,) = check_pair(design.cam.disc.pitch_curve, curve, TOLERANCE, 1.0)
    assert closed.severity == "broken"
    assert 40.0 < math.degrees(known(closed.cam_angle)) < 300.0


@pytest.mark.parametrize("scene", PAIRS)
def test_the_limit_is_the_scenes(scene: str) -> None:
    spec = camgeo.load(SCENES / f"{scene}.toml").scene
    for limit, severity in ((0.001, "broken"), (0.02, "ok")):
        findings = Design(spec.with_values({"limits.closing_error": limit})).findings
        (closing,) = [each for each in findings if each.name == "closing-error"]
        assert (closing.severity, closing.limit) == (severity, limit)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("scene", PAIRS)
def test_discs_that_are_off_by_the_tolerance_leave_that_play(scene: str, sign: float) -> None:
    """Both discs made larger or smaller by the tolerance all round, and replayed.

    The discs are fitted to a thousandth of it, and the way along the flank that the roller makes
    with it, the tolerance over 40 mm, changes the leverage by a part in 1e4 at most.
    """
    design = camgeo.load(SCENES / f"{scene}.toml")
    assert len(design.discs) == 2
    closing = next(each for each in design.findings if each.name == "closing-error")
    tolerance = design.scene.output.tolerance
    replays = []
    for disc in design.discs:
        flank = WorkingCurve(
            disc.cam.disc.pitch_curve, sign * tolerance - disc.cam.follower.roller_radius
        )
        contour = fit_arcs(whole(flank), 1e-3 * tolerance).contour
        replays.append(replay_contour(disc.cam.disc.pitch_curve, contour))
    found = closing_error(replays[0], replays[1])
    reach = abs(design.cam.follower.reach)
    worst = found.lowest if sign > 0.0 else found.highest
    assert -sign * reach * worst.value == pytest.approx(known(closing.value), rel=1.2e-3)
