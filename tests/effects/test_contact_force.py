from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.errors import EffectError
from camgeo.scene.scene import parse_scene
from camgeo.units import TURN
from tests.effects.scenes import design
from tests.findings import effect_findings, finding

PHI = np.linspace(0.0, TURN, 721)[:-1]


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


def loaded(scene: str, load: float, table: str = "", *changes: tuple[str, str]) -> Any:
    """Under a constant force against the motion [N], with more tables and keys of the effect."""
    tables = f"[effects.load]\nconstant = {load!r}\n[effects.contact-force]\n{table}"
    return design(scene, tables, *changes).effect("contact-force")


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


def test_jamming_is_where_friction_takes_all() -> None:
    """A guide takes c cos mu of the sin mu that moves it on a rise: it jams where tan mu <= c."""
    curve = design("plate_translating", "").cam.disc.pitch_curve
    rise = np.linspace(math.radians(30.0), math.radians(130.0), 20001)[1:-1]
    least = float(np.min(curve.transmission_angle(rise)))
    with pytest.raises(EffectError, match="jams from cam angle") as caught:
        loaded("plate_translating", 5.0, f"[effects.friction]\nguide = {math.tan(least + 0.05)!r}")
    error = caught.value
    assert (error.finding, error.unit) == ("jamming", "deg")
    assert error.value == pytest.approx(math.degrees(least), rel=1e-7)
    assert error.limit == pytest.approx(math.degrees(least + 0.05), abs=1e-7)
    assert error.cam_range is not None
    first, last = error.cam_range
    assert first == pytest.approx(math.radians(30.0), rel=1e-15)  # where the rise begins
    assert curve.transmission_angle(np.array([last]))[0] == pytest.approx(least + 0.05, abs=1e-9)
    # Just below, it moves everywhere.
    loaded("plate_translating", 5.0, f"[effects.friction]\nguide = {math.tan(least) - 1e-6!r}")


def test_no_force_is_no_jamming() -> None:
    found = loaded("plate_translating", 0.0, "", ("offset = 12", "offset = 50"))
    assert not np.any(found.normal(PHI, "right"))


# -- findings ------------------------------------------------------------------------------------


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
    found = loaded("ring", -5.0, "limit = 6")
    normal = found.normal(PHI, "right")
    mu = design("ring", "").cam.disc.pitch_curve.transmission_angle(PHI)
    assert normal == pytest.approx(-5.0 / np.sin(mu), rel=1e-13)
    least = finding(found.findings, "smallest-contact-force")
    assert least.value == pytest.approx(5.0, rel=1e-15)
    assert "outer flank" in least.sentence
    assert found.columns[0].limit == -6.0


def test_a_force_that_pulls_is_reported() -> None:
    found = loaded("plate_translating", -5.0)
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


def test_the_force_keeps_its_sign_between_its_edges() -> None:
    subject = design("groove", ROCKING, ("speed = 30\n", "speed = 400\n"))
    contact = subject.effect("contact-force")
    share = np.linspace(0.0, 1.0, 41)[1:-1, np.newaxis]
    inside = contact.edges[:-1] + share * np.diff(contact.edges)
    sign = np.sign(contact.normal(inside.ravel(), "right")).reshape(inside.shape)
    assert np.all(sign == sign[:1])
