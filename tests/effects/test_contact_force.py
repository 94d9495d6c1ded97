from __future__ import annotations

import math
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.dynamics.effects.contact_force import EFFECT
from camgeo.dynamics.effects.contact_force.result import compute
from camgeo.dynamics.effects.effect import Request, Results
from camgeo.dynamics.effects.forces import Force
from camgeo.dynamics.effects.results import ContactForce
from camgeo.errors import EffectError, SceneError
from camgeo.kinematics.time_course import in_time
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.quadrature import piecewise_integral
from camgeo.scene.scene import parse_scene
from camgeo.units import TURN
from tests.effects.scenes import design
from tests.findings import effect_findings

PHI = np.linspace(0.0, TURN, 721)[:-1]

ROUNDING = 1e-12
"""A few thousand roundings: forces, normals and arms go through a dozen operations each, and the
place of the roller is known to 1e-16 of lengths ten times those of the lift."""

TRANSLATING = """
[effects.inertia]
mass = 0.8
[effects.gravity]
angle = -60
[effects.load]
constant = 12
[effects.spring]
stiffness = 1.5
preload = 30
[effects.contact-force]
"""

ROCKING = """
[effects.inertia]
moment_of_inertia = 0.012
roller_mass = 0.15
[effects.load]
constant = 2.5
[effects.contact-force]
"""


@dataclass
class Stuck:
    """Friction that takes a constant share of the normal force against the motion."""

    design: Design
    share: float
    force: Force = field(default_factory=lambda: Force("friction", lambda phi, side: zero(phi)))
    rubbing: None = None

    def per_normal(self, phi: FloatArray, side: Side, sense: int) -> FloatArray:
        velocity = self.design.cam.drive.motion.jet(phi, side)[1]
        return np.stack((-self.share * np.sign(velocity), np.zeros(len(phi))))


def timed(subject: Design) -> FloatArray:
    assert subject.drive.time_course is not None
    return in_time(subject.cam.drive.motion.jet(PHI), subject.drive.time_course, PHI)


def zero(phi: FloatArray) -> FloatArray:
    return np.zeros((4, len(phi)))


def constant(value: float) -> Any:
    """An effect whose force on the follower is `value`, always."""

    def coefficients(phi: FloatArray, side: Side) -> FloatArray:
        out = zero(phi)
        out[0] = value
        return out

    return SimpleNamespace(force=Force("load", coefficients))


def computed(subject: Design, results: dict[str, Any], limit: float | None = None) -> ContactForce:
    table = {} if limit is None else {"limit": limit}
    return compute(Request(subject.effects.subject, EFFECT.parse(table), Results(results), 1e-6))


def turned(subject: Design, phi: FloatArray) -> Any:
    """From cam coordinates to those of the frame, (n,) complex."""
    return np.exp(1j * subject.cam.rotation * phi)


def outward(subject: Design, phi: FloatArray) -> Any:
    """(n,) complex unit normals in the cam, from the point of contact to the roller's centre."""
    between = subject.cam.disc.pitch_curve.point(phi) - subject.cam.disc.inner_curve.point(phi)
    return between / subject.cam.follower.roller_radius


def finding(found: Any, name: str) -> Any:
    (one,) = [each for each in found if each.name == name]
    return one


# -- Newton and virtual work ---------------------------------------------------------------------


def test_newton_along_the_guide() -> None:
    """Free body of a translating follower in the frame: m a = N n + weight + spring + load."""
    subject = design("plate_translating", TRANSLATING)
    found = subject.effect("contact-force").normal(PHI, "right")
    follower: Any = subject.cam.follower
    guide = np.exp(1j * follower.guide_angle)
    lift, _, acceleration, _ = timed(subject)
    mass = 0.8e-3
    weight = mass * 9806.65 * np.exp(1j * math.radians(-60.0))
    pushed = weight - (30.0 + 1.5 * lift + 12.0) * guide
    n = outward(subject, PHI) * turned(subject, PHI)
    along = (n * np.conj(guide)).real
    expected = (mass * acceleration - (pushed * np.conj(guide)).real) / along
    assert np.max(np.abs(found - expected)) <= ROUNDING * np.max(np.abs(expected))


@pytest.mark.parametrize("scene", ["shuttle", "groove"])
def test_euler_about_the_pivot(scene: str) -> None:
    """Free body of a rocker in the frame: J chi'' = arm x N n + torque, counter-clockwise."""
    subject = design(scene, ROCKING)
    found = subject.effect("contact-force").normal(PHI, "right")
    follower: Any = subject.cam.follower
    sense = follower.swing_sense
    _, _, acceleration, _ = timed(subject)
    moment = 0.012e3 + 0.15e-3 * follower.arm**2
    arm = subject.cam.disc.pitch_curve.point(PHI) * turned(subject, PHI) - follower.pivot
    n = outward(subject, PHI) * turned(subject, PHI)
    crossed = (np.conj(arm) * n).imag
    expected = (moment * sense * acceleration + sense * 2.5e3) / crossed
    assert np.max(np.abs(found - expected)) <= ROUNDING * np.max(np.abs(expected))


@pytest.mark.parametrize(
    ("scene", "effects"),
    [("plate_translating", TRANSLATING), ("shuttle", ROCKING), ("groove", ROCKING)],
)
def test_torque_is_the_moment_of_the_force_about_the_cam_axis(scene: str, effects: str) -> None:
    subject = design(scene, effects)
    normal = subject.effect("contact-force").normal(PHI, "right")
    work = (
        normal * subject.cam.disc.pitch_curve.leverage(PHI) * subject.cam.drive.motion.jet(PHI)[1]
    )
    at, n = subject.cam.disc.inner_curve.point(PHI), outward(subject, PHI)
    moment = subject.cam.rotation * normal * (np.conj(at) * n).imag
    # The arm is a difference of lengths of the size of the cam.
    scale = np.max(np.abs(normal)) * np.max(np.abs(at))
    assert np.max(np.abs(work - moment)) <= ROUNDING * scale


def test_conservative_torque_does_no_work_over_a_turn() -> None:
    subject = design("plate_translating", TRANSLATING)
    contact = subject.effect("contact-force")

    def torque(phi: FloatArray) -> FloatArray:
        lever = subject.cam.disc.pitch_curve.leverage(phi) * subject.cam.drive.motion.jet(phi)[1]
        return np.asarray(contact.normal(phi, "right") * lever)

    work = piecewise_integral(torque, contact.edges, 1e-13)
    assert abs(work.value) <= 1e-12 * np.max(np.abs(torque(PHI)))


def test_a_force_at_every_speed_is_the_force_of_the_scene_at_that_speed() -> None:
    slow = design("plate_translating", TRANSLATING)
    fast = design("plate_translating", TRANSLATING, ("speed = 60", "speed = 300"))
    omega = np.full(len(PHI), 10.0 * math.pi)
    found = slow.effect("contact-force").normal_at(PHI, "right", np.stack((omega, 0.0 * omega)))
    expected = fast.effect("contact-force").normal(PHI, "right")
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-12 * np.max(expected))


# -- examples ------------------------------------------------------------------------------------

CYCLOIDAL = """
camgeo = 1
name = "cycloidal"
[cam]
rotation = "ccw"
speed = 1000
[follower]
kind = "translating-roller"
base_radius = 30
roller_radius = 8
[[motion]]
law = "inclined-sine"
span = 120
to = 10
[[motion]]
dwell = 60
[[motion]]
law = "inclined-sine"
span = 120
to = 0
[[motion]]
dwell = 60
"""


def test_a_textbook_exercise() -> None:
    """A plate cam drives a radial follower with cycloidal motion, 10 mm in 120 deg, at 1000 rpm;
    1.8 kg, spring 15 N/mm compressed by 2.5 mm: radial force and torque at 100 deg. The exercise is
    one of many courses on cam dynamics; its answer is worked out here by the textbook formulas.
    With z = 5/6 and beta = 2.0944: s = 10 (z - sin(2 pi z) / (2 pi)) = 9.7117 mm, s' = (10 / beta)
    (1 - cos(2 pi z)) = 2.3873 mm/rad, s'' omega^2 = -136.04 m/s^2; F = 37.5 + 145.67 - 244.86 N.
    The radius of the cam is not given and is of no account.
    """
    effects = (
        "[effects.inertia]\nmass = 1.8\n[effects.spring]\nstiffness = 15\npreload = 37.5\n"
        "[effects.contact-force]\n"
    )
    subject = Design(parse_scene(CYCLOIDAL + effects, "cycloidal.toml"))
    phi = np.array([math.radians(100.0)])
    radial = subject.effect("contact-force").required(phi, "right")
    omega = 1000.0 * TURN / 60.0
    force = float(radial[0, 0] + radial[2, 0] * omega**2)
    assert force == pytest.approx(-61.69, abs=0.005)
    assert force * subject.cam.drive.motion.jet(phi)[1][0] == pytest.approx(
        -61.69 * 2.3873, rel=2e-4
    )
    normal = subject.effect("contact-force").normal(phi, "right")
    angle = math.atan2(2.3873, 30.0 + 9.7117)
    assert normal[0] * math.cos(angle) == pytest.approx(force, rel=1e-6)


# -- friction and jamming ------------------------------------------------------------------------


def test_friction_keeps_the_balance_on_both_flanks() -> None:
    subject = design("groove", "", ("speed = 30\n", "speed = 300\n"))
    friction = Stuck(subject, 0.2 * 80.0)
    loads = {"load": constant(-2000.0), "spring": swaying(), "friction": friction}
    found = computed(subject, loads)
    normal = found.normal(PHI, "right")
    assert np.min(normal) < 0.0 < np.max(normal)
    sense = np.where(normal >= 0.0, 1, -1)
    lever = subject.cam.disc.pitch_curve.leverage(PHI)
    taken = friction.per_normal(PHI, "right", 1)[0]
    needed = found.required(PHI, "right")[0]
    balance = np.abs(normal) * (sense * lever + taken) - needed
    assert np.max(np.abs(balance)) <= ROUNDING * np.max(np.abs(needed))


def swaying() -> Any:
    def coefficients(phi: FloatArray, side: Side) -> FloatArray:
        out = zero(phi)
        out[0] = 4000.0 * np.sin(phi)
        return out

    return SimpleNamespace(force=Force("spring", coefficients))


def test_jamming_is_where_friction_takes_all() -> None:
    """sin mu - c is what is left of the force on a rise: it jams where mu <= asin c."""
    subject = design("plate_translating", "")
    rise = np.linspace(math.radians(30.0), math.radians(130.0), 20001)[1:-1]
    least = float(np.min(subject.cam.disc.pitch_curve.transmission_angle(rise)))
    share = math.sin(least + 0.05)
    friction = Stuck(subject, share)
    with pytest.raises(EffectError, match="jams from cam angle") as caught:
        computed(subject, {"load": constant(-5.0), "friction": friction})
    error = caught.value
    assert error.finding == "jamming"
    assert error.unit == "deg"
    assert error.value == pytest.approx(math.degrees(least), rel=1e-7)
    assert error.cam_range is not None
    first, last = error.cam_range
    assert first == pytest.approx(math.radians(30.0), rel=1e-15)  # where the rise begins
    mu = subject.cam.disc.pitch_curve.transmission_angle(np.array([last]))
    assert mu[0] == pytest.approx(math.asin(share), abs=1e-9)
    assert error.limit == pytest.approx(math.degrees(math.asin(share)), abs=1e-7)
    # Just below, it moves everywhere.
    computed(subject, {"load": constant(-5.0), "friction": Stuck(subject, math.sin(least) - 1e-6)})


@pytest.mark.parametrize("load", [-5.0, 5.0])
def test_jamming_at_transmission_angle_0(load: float) -> None:
    """The roller centre on a level with the cam axis: no force along the guide from the cam."""
    subject = design("plate_translating", "", ("offset = 12", "offset = 50"))
    with pytest.raises(EffectError, match="transmission angle is 0") as caught:
        computed(subject, {"load": constant(load)})
    assert caught.value.finding == "jamming"
    assert caught.value.value == pytest.approx(0.0, abs=1e-9)


def test_no_force_is_no_jamming() -> None:
    subject = design("plate_translating", "", ("offset = 12", "offset = 50"))
    found = computed(subject, {"load": constant(0.0)})
    assert not np.any(found.normal(PHI, "right"))


# -- findings ------------------------------------------------------------------------------------


def test_the_extremes_are_those_of_the_turn() -> None:
    subject = design("plate_translating", TRANSLATING)
    contact = subject.effect("contact-force")
    fine = contact.normal(np.linspace(0.0, TURN, 200_001), "right")
    most = finding(contact.findings, "largest-contact-force")
    least = finding(contact.findings, "smallest-contact-force")
    # A step of 3e-5 rad misses a smooth extreme by the square of it times a curvature of 10.
    assert np.max(fine) <= most.value * (1.0 + 1e-15) <= np.max(fine) * (1.0 + 1e-7)
    assert np.min(fine) >= least.value * (1.0 - 1e-15) >= np.min(fine) * (1.0 - 1e-7)
    for each in (most, least):
        sides = [contact.normal(np.array([each.cam_angle]), side)[0] for side in ("left", "right")]
        assert any(value == pytest.approx(each.value, rel=1e-13) for value in sides)


def test_a_limit_is_broken() -> None:
    subject = design("plate_translating", TRANSLATING + "limit = 60\n")
    found = finding(effect_findings(subject), "largest-contact-force")
    assert found.severity == "broken"
    assert found.limit == 60.0
    assert "above 60 N" in found.sentence
    (column,) = subject.effect("contact-force").columns
    assert column.limit == 60.0


def test_the_outer_flank_carries_a_ring() -> None:
    """With F along the guide N = F / sin mu: least where mu is 90 degrees."""
    subject = design("ring", "")
    found = computed(subject, {"load": constant(5.0)}, limit=6.0)
    normal = found.normal(PHI, "right")
    mu = subject.cam.disc.pitch_curve.transmission_angle(PHI)
    assert normal == pytest.approx(-5.0 / np.sin(mu), rel=1e-13)
    least = finding(found.findings, "smallest-contact-force")
    assert least.value == pytest.approx(5.0, rel=1e-15)
    assert "outer flank" in least.sentence
    assert found.columns[0].limit == -6.0


def test_a_force_that_pulls_is_reported() -> None:
    subject = design("plate_translating", "")
    found = computed(subject, {"load": constant(5.0)})
    assert finding(found.findings, "smallest-contact-force").severity == "warning"


def test_each_flank_of_a_groove_is_reported() -> None:
    subject = design("groove", ROCKING, ("speed = 30\n", "speed = 400\n"))
    contact = subject.effect("contact-force")
    inner = finding(contact.findings, "largest-contact-force-inner")
    outer = finding(contact.findings, "largest-contact-force-outer")
    normal = contact.normal(PHI, "right")
    assert inner.value >= np.max(normal) > 0.0
    assert outer.value >= np.max(-normal) > 0.0
    most = finding(contact.findings, "largest-contact-force")
    assert most.value == max(inner.value, outer.value)


def test_a_shock_is_reported_and_the_rest_stays_finite() -> None:
    effects = "[effects.inertia]\nmass = 1\n[effects.load]\nconstant = 3\n[effects.contact-force]\n"
    subject = design("straight_moves", effects, ('"trim"', '"refuse"'))
    contact = subject.effect("contact-force")
    shocks = [each for each in contact.findings if each.name == "shock"]
    assert [round(math.degrees(each.cam_angle)) for each in shocks] == [50, 140, 200, 320]
    assert np.all(np.isfinite(contact.normal(PHI, "right")))
    massless = computed(subject, {"load": constant(-3.0)})
    assert [each.name for each in massless.findings] == [
        "largest-contact-force",
        "smallest-contact-force",
    ]


def test_the_force_keeps_its_sign_between_its_edges() -> None:
    subject = design("groove", ROCKING, ("speed = 30\n", "speed = 400\n"))
    contact = subject.effect("contact-force")
    share = np.linspace(0.0, 1.0, 41)[1:-1, np.newaxis]
    inside = contact.edges[:-1] + share * np.diff(contact.edges)
    sign = np.sign(contact.normal(inside.ravel(), "right")).reshape(inside.shape)
    assert np.all(sign == sign[:1])


def test_a_force_is_needed() -> None:
    with pytest.raises(SceneError, match=r"effects\.inertia"):
        design("plate_translating", "[effects.contact-force]\n")
