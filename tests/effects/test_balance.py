"""Balance of the disc: closed forms, invariants, the solid of the writers, and added holes."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.design.design import Design
from camgeo.dynamics.effects.balance import PITCH, Balance, largest_removable, rows
from camgeo.dynamics.effects.tables import parse_balance as parse
from camgeo.errors import EffectError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.outline.path import Moments
from camgeo.part.part import Part
from camgeo.units import TURN
from tests.effects.scenes import course_of, design
from tests.findings import by_name, effect_findings, finding

STEEL = "density = 7850\n"
RHO = 7850e-12

DWELL = """
camgeo = 1
name = "disc"
[cam]
rotation = "ccw"
speed = 600
[follower]
kind = "translating-roller"
base_radius = 50
roller_radius = 10
[[motion]]
dwell = 360
[part]
thickness = 12
bore = 25
"""
"""A disc of the radius 40 mm."""

KEYWAY = "keyway = { width = 8, depth = 3.3, angle = 50 }\n"

MARK = "[part.mark]\nradius = 30\nwidth = 2\ndepth = 0.5\nangle = 90\n"


def disc(text: str = "", table: str = "") -> Design:
    """The disc without a stroke, with more about its part and the table of the effect."""
    from camgeo.scene.scene import parse_scene

    return Design(parse_scene(f"{DWELL}{text}\n[effects.balance]\n{STEEL}{table}", "disc.toml"))


def balance(scene: str, table: str = "", *changes: tuple[str, str]) -> Balance:
    """The balance of a fixture scene."""
    found = design(scene, f"[effects.balance]\n{STEEL}{table}", *changes).effect("balance")
    assert isinstance(found, Balance)
    return found


def test_a_disc_without_a_stroke_is_balanced() -> None:
    result = disc(table="counterweight_radius = 20\nhole_radius = 30\n").effect("balance")
    assert result.mass == pytest.approx(RHO * 12.0 * math.pi * (40.0**2 - 12.5**2), rel=1e-14)
    assert abs(result.unbalance) <= result.unbalance_error
    assert result.unbalance_error < 1e-13 * result.mass * 40.0
    assert result.holes is None
    found = by_name(result.findings)
    for name in ("centre-of-mass", "unbalance", "unbalance-force", "counterweight"):
        assert found[name].value == 0.0  # what is off the axis is rounding
    assert "no counterweight is needed" in found["counterweight"].sentence
    assert all(each.severity == "ok" for each in result.findings)


def slot_moments() -> tuple[float, float]:
    """Area [mm^2] and first moment [mm^3] of the keyway, by hand.

    It is the rectangle from x = 0 to bore radius + depth, less the part of the bore in its width:
    of that the area is the integral of sqrt(r^2 - y^2), the moment that of (r^2 - y^2) / 2.
    """
    r, half, bottom = 12.5, 4.0, 15.8
    in_bore = half * math.sqrt(r * r - half * half) + r * r * math.asin(half / r)
    moment = r * r * half - half**3 / 3.0
    return 2.0 * half * bottom - in_bore, half * bottom**2 - moment


def test_a_keyway_has_the_unbalance_of_what_it_takes_off() -> None:
    result = disc(KEYWAY, "counterweight_radius = 20\n").effect("balance")
    area, moment = slot_moments()
    full = math.pi * (40.0**2 - 12.5**2)
    assert result.mass == pytest.approx(RHO * 12.0 * (full - area), rel=1e-14)
    expected = -RHO * 12.0 * moment * cmath.rect(1.0, math.radians(50.0))
    assert abs(result.unbalance - expected) <= 1e-14 * result.mass * 40.0
    assert result.centre == result.unbalance / result.mass
    assert result.counterweight == pytest.approx(abs(expected) / 20.0, rel=1e-11)
    found = by_name(result.findings)
    assert found["unbalance"].value == pytest.approx(1e6 * abs(expected), rel=1e-11)
    assert "direction 230.0000 deg" in found["unbalance"].sentence
    assert "direction 50.0000 deg" in found["counterweight"].sentence
    omega = TURN * 10.0
    assert found["unbalance-force"].value == pytest.approx(abs(expected) * omega**2, rel=1e-11)
    assert found["unbalance-force"].cam_angle is None


@pytest.mark.parametrize("scene", ["plate_translating", "groove", "ring", "cut_lobe"])
def test_the_solid_of_the_writers_has_the_same_mass_and_centre(scene: str) -> None:
    """Vertices of the body are within t of the boundaries: volumes differ by t times their faces,
    first moments by that times the largest radius."""
    import trimesh

    from camgeo_export.solid.prism import body

    tolerance = 2e-3
    made = design(scene, f"[effects.balance]\n{STEEL}")
    result = made.effect("balance")
    part: Part = made.disc.drawn.part
    solid = body(part, tolerance, lambda x: x)
    mesh = trimesh.Trimesh(solid.vertices, solid.triangles, process=False)
    mass = 1e-3 * 7850e-9 * mesh.volume  # kg from mm^3, in t
    faces = part.thickness * sum(each.polyline(0.1).contour.length for each in part.boundaries)
    room = RHO * 1.1 * tolerance * faces
    largest = float(np.max(np.hypot(*solid.vertices.T[:2])))
    assert abs(mass - result.mass) <= room
    assert abs(mass * complex(*mesh.center_mass[:2]) - result.unbalance) <= room * largest


@settings(max_examples=30, deadline=None)
@given(
    needed=st.floats(1e-3, 2.0),
    direction=st.floats(-math.pi, math.pi),
    radius=st.floats(1.0, 300.0),
    share=st.floats(0.02, 1.0),
)
def test_each_row_of_holes_cancels_the_unbalance(
    needed: float, direction: float, radius: float, share: float
) -> None:
    """By the contours of the holes, whose moments are in closed form."""
    per_area, largest = RHO * 12.0, share * radius
    reached = largest_removable(per_area, radius, largest)
    unbalance = cmath.rect(needed * reached, direction)
    found = list(rows(unbalance, per_area, radius, largest))
    assert bool(found) == (needed <= 1.0) or abs(needed - 1.0) < 1e-12
    assert [row.count for row in found] == sorted({row.count for row in found})
    for row in found:
        assert 0.0 < row.diameter <= largest
        moments = Moments.total(
            Contour.circle(row.diameter / 2.0, centre).moments for centre in row.centres
        )
        assert abs(per_area * moments.first - unbalance) <= 1e-12 * abs(unbalance)
        assert abs(row.moment(per_area) - unbalance) <= 1e-12 * abs(unbalance)
        for one, other in zip(row.centres, row.centres[1:], strict=False):
            assert abs(other - one) == pytest.approx(PITCH * row.diameter, rel=1e-9)


def test_the_fewest_holes_are_taken() -> None:
    """One hole of the diameter 2 sqrt(U / (pi rho b R)) where that is allowed; else two."""
    unbalance, per_area, radius = cmath.rect(1e-4, 0.4), RHO * 12.0, 30.0
    single = 2.0 * math.sqrt(abs(unbalance) / (math.pi * per_area * radius))
    first = next(rows(unbalance, per_area, radius, single * (1.0 + 1e-12)))
    assert first.count == 1
    assert first.directions == pytest.approx((0.4,))
    assert first.diameter == pytest.approx(single, rel=1e-15)
    assert next(rows(unbalance, per_area, radius, single * (1.0 - 1e-12))).count == 2


def test_holes_that_fit_are_reported_with_the_remaining_unbalance() -> None:
    result = disc(KEYWAY, "hole_radius = 29\n").effect("balance")
    row = result.holes
    assert row is not None
    assert row.diameter <= 29.0 / 4.0
    rest = result.unbalance - row.moment(RHO * 12.0)
    assert abs(rest) <= 1e-14 * result.mass * 40.0
    told = finding(result.findings, "balancing-holes")
    assert told.value == row.diameter
    # the nearest boundary is the outline, 11 mm from the centres
    wall = 40.0 - 29.0 - row.diameter / 2.0
    reported = float(told.sentence.split("thinnest wall ")[1].split(" mm")[0])
    assert reported == pytest.approx(wall, abs=3.0 * 1e-4 * 29.0 / 4.0 + 1e-3)


@pytest.mark.parametrize(
    ("table", "reason"),
    [
        ("hole_radius = 39.99\n", "cuts into the outline"),
        ("hole_radius = 12.6\n", "cuts into the bore"),
        ("hole_radius = 45\n", "outside the material"),
        ("hole_radius = 29\nhole_diameter = 0.5\n", "they remove at most"),
    ],
)
def test_holes_that_do_not_fit_are_a_warning_with_its_reason(table: str, reason: str) -> None:
    result = disc(KEYWAY, table).effect("balance")
    assert result.holes is None
    told = finding(result.findings, "holes-do-not-fit")
    assert told.severity == "warning"
    assert reason in told.sentence


def test_smaller_holes_are_taken_where_few_large_ones_do_not_fit() -> None:
    wide = disc(KEYWAY, "hole_radius = 38.9\nhole_diameter = 9\n").effect("balance").holes
    middle = disc(KEYWAY, "hole_radius = 30\nhole_diameter = 9\n").effect("balance").holes
    assert middle.count == 1
    assert wide.count > 1
    assert wide.diameter / 2.0 < 40.0 - 38.9


def test_hub_and_mark_weigh_and_holes_stay_beside_the_hub() -> None:
    hub = "[part.hub]\ndiameter = 50\nheight = 9\nside = 'both'\n"
    plain = disc().effect("balance")
    made = disc(hub + MARK, "hole_radius = 29\n").effect("balance")
    tube = RHO * 2.0 * 9.0 * math.pi * (25.0**2 - 12.5**2)
    dot = RHO * 0.5 * math.pi
    assert made.mass == pytest.approx(plain.mass + tube - dot, rel=1e-13)
    assert abs(made.unbalance + 30.0j * dot) <= 1e-12 * made.mass * 40.0
    # Holes go through the disc, whose thickness is that without the hubs.
    assert abs(made.unbalance - made.holes.moment(RHO * 12.0)) <= 1e-12 * made.mass * 40.0
    within = disc(hub + MARK, "hole_radius = 20\n").effect("balance")
    assert within.holes is None
    assert "outside the material" in finding(within.findings, "holes-do-not-fit").sentence


def test_no_holes_in_a_groove() -> None:
    """The middle of the groove is not solid through the whole disc."""
    pitch = design("groove", "").cam.disc.pitch_curve.point(np.linspace(0.0, TURN, 3601))
    heavy = np.exp(1j * np.angle(balance("groove").unbalance))
    middle = float(np.abs(pitch[np.argmax((pitch / np.abs(pitch) * heavy.conj()).real)]))
    found = by_name(balance("groove", f"hole_radius = {middle}\nhole_diameter = 40\n").findings)
    assert "outside the material" in found["holes-do-not-fit"].sentence


def test_the_grade_is_held_against_mass_and_speed() -> None:
    """G 6.3 at 600 rev/min: U_per = 6.3 mm/s m / omega."""
    area, moment = slot_moments()
    mass = RHO * 12.0 * (math.pi * (40.0**2 - 12.5**2) - area)
    allowed = 1e6 * 6.3 * mass / (TURN * 10.0)
    value = 1e6 * RHO * 12.0 * moment
    told = finding(disc(KEYWAY, "grade = 6.3\n").effect("balance").findings, "unbalance")
    assert told.limit == pytest.approx(allowed, rel=1e-12)
    assert told.severity == ("broken" if value > allowed else "ok")
    just = value * TURN * 10.0 / (1e6 * mass)
    for factor, severity in ((1.0 + 1e-9, "ok"), (1.0 - 1e-9, "broken")):
        found = by_name(disc(KEYWAY, f"grade = {just * factor!r}\n").effect("balance").findings)
        assert found["unbalance"].severity == severity


def test_the_force_is_minus_mass_times_acceleration_at_any_speed_curve() -> None:
    made = design("points", f"[effects.balance]\n{STEEL}")
    result = made.effect("balance")
    course = course_of(made)
    phi = np.linspace(0.1, 6.0, 200)
    x, y = (column.values(phi, "right") for column in result.columns)
    omega, alpha = course.rates(phi)[:2]
    place = result.centre * np.exp(1j * made.cam.rotation * phi)
    acceleration = (
        1j * made.cam.rotation * place * alpha - place * omega**2
    )  # z'' from z and dz/dphi
    np.testing.assert_allclose(x + 1j * y, -result.mass * acceleration, rtol=1e-12)
    largest = finding(result.findings, "unbalance-force")
    dense = np.linspace(0.0, TURN, 20001)
    fx, fy = (column.values(dense, "right") for column in result.columns)
    assert largest.value >= np.max(np.hypot(fx, fy)) * (1.0 - 1e-12)
    assert largest.value == pytest.approx(np.max(np.hypot(fx, fy)), rel=1e-4)
    assert largest.cam_angle is not None


def test_a_disc_of_which_nothing_is_left_has_no_balance() -> None:
    made = design(
        "plate_translating",
        f"[effects.balance]\n{STEEL}",
        ("roller_radius = 10\n", "roller_radius = 49.9\n"),
        ("offset = 12\n", "offset = 0\n"),
        ("to = 20\n", "to = -5\n"),
    )
    with pytest.raises(EffectError, match="no disc to balance"):
        made.effect("balance")
    [told] = effect_findings(made)
    assert (told.name, told.severity) == ("balance", "broken")


def test_a_material_gives_its_density() -> None:
    steel = parse({})
    assert steel.density == pytest.approx(7.85e-9, rel=0.01)
    assert parse({"material": "steel"}) == steel
