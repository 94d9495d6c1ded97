"""The contact force, and where and at which speed it is lost."""

from __future__ import annotations

import math
from itertools import islice, pairwise
from typing import Any

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.dynamics.effects.contact import ranges_below, runs
from camgeo.dynamics.effects.lift_off.flight import flight_cells
from camgeo.errors import EffectError
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.extremes import piecewise_extremes
from camgeo.scene.scene import parse_scene
from camgeo.units import TURN
from tests.effects.scenes import course_of, design
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
    assert (found.severity, found.limit) == ("broken", 60.0)
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
    contact = design("straight_moves", effects, ('"trim"', '"refuse"')).effect("contact-force")
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


ROUNDING = 1e-12
"""A few thousand roundings of the largest force; see the tests of the contact force."""


def effects(
    speed_of_inertia: str = "mass = 1.2",
    stiffness: float = 0.8,
    preload: float = 15.0,
    margin: float = 0.0,
    more: str = "",
) -> str:
    return f"""
[effects.inertia]
{speed_of_inertia}
[effects.spring]
stiffness = {stiffness!r}
preload = {preload!r}
{more}
[effects.contact-force]
[effects.lift-off]
margin = {margin!r}
"""


def named(found: Any, name: str) -> list[Any]:
    return [each for each in found.findings if each.name == name]


def lowest(subject: Design, factor: float) -> float:
    """Smallest force on the flank, by the largest, at so many times the scene's speed."""
    contact, course = subject.effect("contact-force"), course_of(subject)
    sense = 1.0 if subject.cam.contact == "inner" else -1.0

    def force(phi: FloatArray, side: Side) -> FloatArray:
        omega, alpha = course.rates(phi)[:2]
        return np.asarray(
            sense
            * contact.normal_at_rates(
                phi, side, np.stack((factor * omega, factor * factor * alpha))
            )
        )

    found = piecewise_extremes(force, contact.edges)
    return found.lowest.value / found.magnitude


# -- where contact is lost -----------------------------------------------------------------------

FAST = ("speed = 60", "speed = 500")


def test_contact_is_lost_where_the_force_is_below_0() -> None:
    subject = design("plate_translating", effects(), FAST)
    contact = subject.effect("contact-force")
    found = subject.effect("lift-off")
    lost = named(found, "lift-off")
    assert lost
    phi = np.linspace(0.0, TURN, 20_001)[1:-1]
    phi = phi[np.min(np.abs(phi[:, np.newaxis] - contact.edges), axis=1) > 1e-9]
    inside = np.zeros(len(phi), dtype=bool)
    for each in lost:
        assert each.severity == "broken"
        start, end = each.cam_range
        inside |= (phi > start) & (phi < end)
        around = contact.normal(np.linspace(start, end, 2001)[1:-1], "right")
        assert each.value <= np.min(around) < 0.0
        assert np.min(around) == pytest.approx(each.value, rel=1e-5)
    assert np.array_equal(inside, contact.normal(phi, "right") < 0.0)


def test_with_a_margin_it_is_lost_earlier() -> None:
    subject = design("plate_translating", effects(margin=14.0), ("speed = 60", "speed = 250"))
    found = subject.effect("lift-off")
    assert found.lost
    assert 0.0 < found.lowest.value < 14.0
    for each in found.lost:
        sides = [
            subject.effect("contact-force").normal(np.array([each.start]), side)[0]
            for side in ("left", "right")
        ]
        # The force may fall short by a rounding of the largest one, 45 N, before it is reported.
        assert min(sides) <= 14.0 + 45.0 * ROUNDING
        assert max(sides) >= 14.0 - 90.0 * ROUNDING


def test_a_narrow_dip_is_found_by_its_lowest_place() -> None:
    def quantity(phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray((phi - 1.0) ** 2 - 1e-10)

    edges = np.array([0.0, TURN])
    (found,) = ranges_below(quantity, edges, 0.0, piecewise_extremes(quantity, edges).lowest)
    # The roots are known to half the digits of the square, 1e-16 / 2e-5.
    assert found.start == pytest.approx(1.0 - 1e-5, abs=1e-10)
    assert found.end == pytest.approx(1.0 + 1e-5, abs=1e-10)


def test_a_range_past_cam_angle_0_is_one() -> None:
    def quantity(phi: FloatArray, side: Side) -> FloatArray:
        return np.asarray(0.5 - np.cos(phi))

    edges = np.linspace(0.0, TURN, 9)
    (found,) = ranges_below(quantity, edges, 0.0, piecewise_extremes(quantity, edges).lowest)
    assert (found.start, found.end) == pytest.approx((TURN * 5.0 / 6.0, TURN / 6.0))
    assert found.lowest.value == pytest.approx(-0.5)


@pytest.mark.parametrize(
    ("inside", "expected"),
    [
        ([0, 0, 0], []),
        ([1, 1, 1], [[0, 1, 2]]),
        ([1, 0, 1], [[2, 0]]),
        ([1, 0, 1, 1, 0, 1], [[2, 3], [5, 0]]),
    ],
)
def test_runs(inside: list[int], expected: list[list[int]]) -> None:
    assert runs(np.array(inside, dtype=bool)) == expected


def test_a_velocity_that_jumps_away_lifts_off_at_any_speed() -> None:
    found = design("straight_moves", effects(preload=1e6), ('"trim"', '"refuse"')).effect(
        "lift-off"
    )
    lost = named(found, "lift-off")
    assert [round(math.degrees(each.cam_angle)) for each in lost] == [140, 200]
    assert finding(found.findings, "lift-off-speed").value == 0.0
    assert finding(found.findings, "least-preload").value is None


# -- the speed -----------------------------------------------------------------------------------

LOADED_ROCKER = """
[effects.inertia]
moment_of_inertia = 0.01
[effects.load]
constant = 3
[effects.contact-force]
[effects.lift-off]
"""

SPRUNG_ROCKER = f"""
[effects.spring]
kind = "torsion"
torsional_stiffness = 40
preload_torque = 30
[effects.friction]
pivot_viscous = 0.4
{LOADED_ROCKER}
margin = 20
"""


OUTER = (
    ("offset = 12", "offset = 0"),
    ('direction = "outward"', 'direction = "inward"'),
    ('contact = "inner"', 'contact = "outer"'),
    ("bore = 25", "rim = 160"),
    ("keyway = { width = 8, depth = 3.3, angle = 90 }\n", ""),
)
"""A ring around the roller, which a positive lift moves inwards."""

SCENES: list[tuple[str, str, tuple[tuple[str, str], ...]]] = [
    ("plate_translating", effects(), ()),
    ("plate_translating", effects(), OUTER),
    ("plate_translating", effects(margin=5.0), OUTER),
    ("plate_translating", effects(more="[effects.gravity]\nangle = 80"), ()),
    ("plate_translating", effects(more="[effects.friction]\nguide_viscous = 0.05"), ()),
    ("feed", effects(stiffness=0.2), ()),
    ("shuttle", LOADED_ROCKER, ()),
    ("shuttle", SPRUNG_ROCKER, ()),
    ("points", effects(), ()),
    ("setzhub", effects(preload=60.0), ()),
    (
        "tappet",
        effects(
            "mass = 0.9",
            12.0,
            150.0,
            15.0,
            "[effects.friction]\nface = 0.11\nguide = 0.13\nguide_length = 42\nguide_overhang = 17",
        ),
        (),
    ),
]


@pytest.mark.parametrize(("scene", "tables", "changes"), SCENES)
def test_the_speed_is_that_at_which_the_force_first_touches_its_margin(
    scene: str, tables: str, changes: tuple[tuple[str, str], ...]
) -> None:
    subject = design(scene, tables, *changes)
    found = subject.effect("lift-off")
    factor = found.speed.value
    contact = subject.effect("contact-force")
    margin = subject.effects.tables["lift-off"].get("margin", 0.0)
    here = np.array([found.speed.place])
    omega, alpha = course_of(subject).rates(here)[:2]
    forces = [
        contact.normal_at_rates(here, side, np.stack((factor * omega, factor * factor * alpha)))[0]
        for side in ("left", "right")
    ]
    scale = abs(contact.normal_at_rates(here, "right", np.stack((0.0 * omega, alpha)))[0]) + margin
    assert min(abs(abs(force) - margin) for force in forces) <= ROUNDING * scale
    if margin == 0.0:
        assert abs(lowest(subject, factor)) <= ROUNDING
        assert lowest(subject, factor * (1.0 - 1e-9)) > 0.0
        assert lowest(subject, factor * (1.0 + 1e-9)) < 0.0
        assert lowest(subject, 0.4 * factor) > 0.0


def test_a_scene_without_speed_has_no_speed_of_lift_off() -> None:
    tables = "[effects.load]\nconstant = -5\n[effects.contact-force]\n[effects.lift-off]\n"
    found = design("ring", tables).effect("lift-off")
    assert found.speed is None
    assert not named(found, "lift-off-speed")


# -- the spring ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("scene", "changes", "margin"),
    [
        ("plate_translating", (FAST,), 12.5),
        ("plate_translating", (FAST, *OUTER), 12.5),
        ("feed", (("speed = 45", "speed = 300"),), 0.0),
        ("setzhub", (("speed = 90", "speed = 200"),), 3.0),
    ],
)
def test_the_least_spring_just_keeps_contact(
    scene: str, changes: tuple[tuple[str, str], ...], margin: float
) -> None:
    found = design(scene, effects("mass = 1.2", 0.5, 20.0, margin), *changes).effect("lift-off")

    def short(stiffness: float, preload: float) -> float:
        """Shortfall of the margin, relative to the largest force."""
        subject = design(scene, effects("mass = 1.2", stiffness, preload, margin), *changes)
        force = subject.effect("contact-force").extremes
        outer = subject.cam.contact == "outer"
        least = -force.highest.value if outer else force.lowest.value
        return float((least - margin) / force.magnitude)

    assert abs(short(0.5, found.preload.value)) <= ROUNDING
    assert short(0.5, found.preload.value * (1.0 - 1e-6)) < -ROUNDING
    if math.isinf(found.stiffness.value):
        # The stroke leads the roller inwards, and the spring relaxes: stiffness takes force away.
        assert scene == "setzhub"
        assert short(1e6, 20.0) < 0.0
        return
    assert abs(short(found.stiffness.value, 20.0)) <= ROUNDING
    assert short(found.stiffness.value * (1.0 - 1e-6), 20.0) < -ROUNDING


def test_no_spring_is_needed() -> None:
    tables = effects(more="[effects.load]\nconstant = 50")
    found = design("plate_translating", tables).effect("lift-off")
    assert finding(found.findings, "least-preload").value == 0.0
    assert finding(found.findings, "least-stiffness").value == 0.0
    assert finding(found.findings, "least-stiffness").severity == "ok"


def test_no_stiffness_helps_in_the_rest() -> None:
    """In the rest at lift 0 a spring has its preload, whatever its stiffness."""
    tables = effects(preload=4.0, more="[effects.load]\nconstant = -6")
    found = design("plate_translating", tables).effect("lift-off")
    stiffness = finding(found.findings, "least-stiffness")
    assert (stiffness.value, stiffness.severity) == (None, "warning")
    assert finding(found.findings, "least-preload").value > 4.0


# -- grooves -------------------------------------------------------------------------------------


def groove(backlash: float, more: str = "", speed: float = 30.0) -> Design:
    clearance = f"backlash = {backlash!r}\n" if backlash else ""
    tables = (
        "[effects.inertia]\nmoment_of_inertia = 0.01\nroller_mass = 0.1\n"
        f"{more}\n[effects.contact-force]\n[effects.lift-off]\n{clearance}"
    )
    return design("groove", tables, ("\nspeed = 30\n", f"\nspeed = {speed!r}\n"))


def test_the_flanks_change_where_the_acceleration_does() -> None:
    """Inertia alone: where the law's acceleration passes 0, and not in the rests."""
    found = groove(0.0).effect("lift-off")
    assert [round(math.degrees(each.leaving), 9) for each in found.changes] == [80.0, 230.0]
    assert [each.sense for each in found.changes] == [-1, 1]  # inward, so the outer one pushes
    assert all(each.leaving == each.carrying for each in found.changes)


def test_rests_without_force_lie_between() -> None:
    """From the end of the return to the start of the rise there is no force on either flank, and
    the outer flank carries before and after: no change."""
    subject = groove(0.0)
    normal = subject.effect("contact-force").normal(np.radians([10.0, 150.0, 330.0]), "right")
    assert not np.any(normal)


def test_without_a_mass_no_impact_is_reported() -> None:
    tables = (
        "[effects.load]\nsegments = [1, -1, 1, -1, 1]\n[effects.contact-force]\n"
        "[effects.lift-off]\nbacklash = 0.1\n"
    )
    found = design("groove", tables).effect("lift-off")
    assert len(found.changes) == 4
    assert "effects.inertia" in finding(found.findings, "impact-speed").sentence
    massless = design("groove", f"[effects.inertia]\nmoment_of_inertia = 0\n{tables}")
    assert "no mass" in finding(massless.effect("lift-off").findings, "impact-speed").sentence


# -- contradictions ------------------------------------------------------------------------------


def with_play(backlash: str = "") -> Design:
    tables = "[effects.inertia]\nmass = 1\n[effects.contact-force]\n[effects.lift-off]\n"
    return design("groove_clearance", tables + backlash)


def test_the_side_clearance_of_the_groove_is_the_backlash() -> None:
    stated = finding(with_play().effect("lift-off").findings, "largest-impact-speed")
    assert "0.08 mm" in stated.sentence
    same = finding(
        with_play("backlash = 0.08\n").effect("lift-off").findings, "largest-impact-speed"
    )
    assert same == stated
    tight = design(
        "groove_clearance",
        "[effects.inertia]\nmass = 1\n[effects.contact-force]\n"
        "[effects.lift-off]\nbacklash = 0.08\n",
        ("side_clearance = 0.08\n", ""),
    )
    # Impacts are those of the pitch curve, to first order in the clearance.
    assert finding(tight.effect("lift-off").findings, "largest-impact-speed").value == stated.value


def test_cells_between_edges_that_nearly_coincide_come_to_an_end() -> None:
    """A first cell shorter than the spacing of doubles would stay where it is."""
    close = 3.0 + 20.0 * np.spacing(3.0)
    found = list(islice(flight_cells(0.5, np.array([0.0, 3.0, close, TURN]), 2.0**-6), 100_000))
    assert len(found) < 100_000
    assert found[-1][1] == 0.5 + TURN
    assert all(before == after for (_, before), (after, _) in pairwise(found))
    assert all(low < high for low, high in found)
