"""The exact flat faces against rigid bodies: the contact lies on the face, and it runs along it."""

from __future__ import annotations

from typing import Any

import pytest
from mpmath import mp, mpf

from camgeo.kinematics.mechanism.oscillating_flat import OscillatingFlat
from camgeo.kinematics.mechanism.translating_flat import TranslatingFlat
from tests.stability import faces
from tests.stability.cam_case import CamSpec
from tests.stability.exact_face import FaceJet, face_jet

DIGITS = 60

CLOSE = mpf(10) ** -40
"""As a share: what 60 digits are left with behind a pivot a thousandfold away, and more."""

SMALL = mpf(10) ** -15
"""Of central differences over 1e-12 of a span, as a share."""


def face_line(cam: CamSpec, lift: Any) -> tuple[Any, Any]:
    """A point of the face and its direction in the fixed frame: at lift 0 it touches the base
    circle, then the follower is shifted, or turned about its pivot.
    """
    follower = cam.follower
    if isinstance(follower, TranslatingFlat):
        out = mp.expj(mpf(follower.guide_angle))
        return out * (mpf(follower.base_radius) + follower.direction * lift), -1j * out
    assert isinstance(follower, OscillatingFlat)
    pivot = mp.mpc(follower.pivot)
    slope = mp.asin((mpf(follower.base_radius) - mpf(follower.face_offset)) / abs(pivot))
    along = mp.expj(mp.arg(-pivot) + follower.arm_side * slope)
    foot = 1j * follower.arm_side * along * mpf(follower.face_offset)
    turned = mp.expj(follower.swing_sense * lift)
    return pivot + foot * turned, along * turned


def jets(cam: CamSpec, share: str) -> tuple[Any, list[FaceJet], list[Any]]:
    """The step, the jets before, at and behind a place, and its cam angles."""
    parameters = [mpf(value) for value in cam.parameters(back=False)]
    start, end = parameters[:2]
    phi, step = start + (end - start) * mpf(share), (end - start) * mpf(10) ** -12
    angles = [phi - step, phi, phi + step]
    return step, [face_jet(cam.stage, angle, parameters) for angle in angles], angles


@pytest.mark.parametrize("cam", faces.specs(), ids=lambda cam: cam.name)
def test_the_contact_lies_on_the_face_and_runs_along_it(cam: CamSpec) -> None:
    with mp.workdps(DIGITS):
        _, (_, jet, _), (_, phi, _) = jets(cam, "0.37")
        point, along = face_line(cam, jet.lift.terms[0])
        turn = mp.expj(-cam.rotation * phi)
        contact = jet.contact
        size = abs(contact.terms[0]) + abs(point)
        seen = (contact.terms[0] - point * turn) / (along * turn)
        assert abs(mp.im(seen)) <= CLOSE * size
        place = mp.re(seen)
        assert abs(jet.place.terms[0] - place) <= CLOSE * size
        assert abs(mp.im(contact.terms[1] / (along * turn))) <= CLOSE * abs(contact.terms[1])


@pytest.mark.parametrize("cam", faces.specs(), ids=lambda cam: cam.name)
def test_what_are_derivatives_are_and_rho_is_the_curve_s(cam: CamSpec) -> None:
    with mp.workdps(DIGITS):
        step, (before, here, after), _ = jets(cam, "0.37")
        for name in ("contact", "place", "turn", "pace"):
            was, now, then = (getattr(each, name).terms for each in (before, here, after))
            rate = (then[0] - was[0]) / (2 * step)
            assert abs(rate - now[1]) <= SMALL * (abs(now[0]) + abs(now[1])), name
        z1, z2 = (here.contact.derivative(order) for order in (1, 2))
        kappa = -cam.rotation * mp.im(mp.conj(z1) * z2) / abs(z1) ** 3
        pace = here.pace.terms[0]
        forward = 1 if pace > 0 else -1
        assert abs(kappa * pace / here.turn.terms[0] * forward - 1) <= CLOSE


def test_a_tappet_s_radius_is_its_distance_and_acceleration() -> None:
    """rho = h + h'', and the contact h' off the foot."""
    cam = faces.specs()[0]
    with mp.workdps(DIGITS):
        _, (_, jet, _), _ = jets(cam, "0.6")
        s = [jet.lift.derivative(order) for order in range(4)]
        assert abs(jet.pace.terms[0] / jet.turn.terms[0] - (50 + s[0] + s[2])) <= CLOSE * 50
        assert abs(jet.place.terms[0] - cam.rotation * s[1]) <= CLOSE * 50
