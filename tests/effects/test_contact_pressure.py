from __future__ import annotations

import math
import sys
import tomllib
from collections.abc import Callable
from dataclasses import dataclass, replace
from decimal import Decimal
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camgeo.design.design import Design
from camgeo.dynamics.effects.contact import INNER, OUTER
from camgeo.dynamics.effects.contact_pressure import (
    SHEAR_DEPTH,
    SHEAR_SHARE,
    ContactPressure,
    LineContact,
    compute,
    half_width,
    largest_pressure,
    needed_radius,
    roller_radii,
    spin,
)
from camgeo.dynamics.effects.effect import Request, Results
from camgeo.dynamics.effects.tables import PressureRequirements
from camgeo.dynamics.effects.tables import parse_contact_pressure as parse
from camgeo.errors import EffectError, GeometryError
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.quadrature import Integral, piecewise_integral
from camgeo.part.materials import Material, find_material
from camgeo.units import RPM, TURN
from tests.effects.bodies import Bodies
from tests.effects.scenes import design
from tests.findings import finding
from tests.reference import FOLDER

EPS = 2.0**-52

EXAMPLES = tomllib.loads((FOLDER / "hertz_examples.toml").read_text("utf-8"))

loads = st.floats(1e-3, 1e6)
radii = st.floats(1e-3, 1e5)


def body(modulus: float, poisson: float) -> Material:
    return replace(find_material("steel"), modulus=modulus, poisson=poisson)


def contact_modulus(first: Material, second: Material) -> float:
    return PressureRequirements(first, second, 1.0).modulus


bodies = st.builds(body, st.floats(1.0, 1e6), st.floats(0.0, 0.5))

FLANKS = [("plate_translating", INNER), ("ring", OUTER), ("groove", INNER), ("groove", OUTER)]

by_flank = pytest.mark.parametrize(("name", "sense"), FLANKS)


@dataclass(frozen=True)
class Given:
    """A contact force that is given instead of computed."""

    edges: FloatArray
    function: Callable[[FloatArray], FloatArray]

    def normal(self, phi: FloatArray, side: Side) -> FloatArray:
        return self.function(phi)


def steady(force: float) -> Given:
    return Given(np.array([0.0, TURN]), lambda phi: np.full(len(phi), force))


def pressed(
    subject: Design, force: Given, table: dict[str, Any] | None = None, tolerance: float = 1e-6
) -> Any:
    given = Results({"contact-force": force})
    return compute(Request(subject.effects.subject, parse(table or {}), given, tolerance))


def scene(name: str, *changes: tuple[str, str]) -> Design:
    return design(name, "", *changes)


def contact_of(subject: Design, force: float = 1.0) -> LineContact:
    return LineContact(subject.effects.subject, steady(force).normal, 1.0, 1.0)


def value(result: Any, name: str) -> float:
    return float(finding(result.findings, name).value)


def severities(result: Any) -> dict[str, str]:
    return {each.name: each.severity for each in result.findings}


def printed(digits: str) -> tuple[float, float]:
    """The printed value, and half a unit of its last digit."""
    exponent = Decimal(digits).as_tuple().exponent
    assert isinstance(exponent, int)
    return float(digits), 0.5 * 10.0**exponent


# -- Hertz's formulas ----------------------------------------------------------------------------


@pytest.mark.parametrize("example", EXAMPLES["example"], ids=lambda each: each["name"])
def test_published_examples(example: dict[str, Any]) -> None:
    load = float(example["force"]) / float(example["width"])
    radius = 1.0 / sum(float(each) for each in example["curvatures"])
    first, second = (
        body(float(modulus), float(poisson))
        for modulus, poisson in zip(example["moduli"], example["poisson"], strict=True)
    )
    modulus = contact_modulus(first, second)
    found = {
        "pressure": largest_pressure(load, modulus, radius),
        "half_width": half_width(load, modulus, radius),
        "half_width_square": half_width(load, modulus, radius) ** 2,
        "mean_pressure": 0.5 * load / half_width(load, modulus, radius),
    }
    results = found.keys() & example.keys()
    assert results
    for name in results:
        expected, half = printed(example[name])
        assert abs(found[name] - expected) <= half * (1.0 + 1e-9)


def test_the_published_cam_at_three_widths() -> None:
    """Force, curvature and modulus are not given; the other widths follow from one of them."""
    cam = EXAMPLES["cam"]
    (first, *widths), (known, *pressures) = cam["widths"], cam["pressures"]
    pressure, half = printed(known)
    radius = needed_radius(1.0 / float(first), 1.0, pressure)
    for width, digits in zip(widths, pressures, strict=True):
        expected, own = printed(digits)
        assert abs(largest_pressure(1.0 / float(width), 1.0, radius) - expected) <= half + own


@given(load=loads, radius=radii, first=bodies, second=bodies)
def test_pressure_and_half_width_in_fifty_digits(
    load: float, radius: float, first: Material, second: Material
) -> None:
    """1 - nu^2 loses no digit below nu = 1/2; some ten roundings in all."""
    with mpmath.workdps(50):
        compliance = sum(
            (1 - mpmath.mpf(each.poisson) ** 2) / mpmath.mpf(each.modulus)
            for each in (first, second)
        )
        pressure = mpmath.sqrt(mpmath.mpf(load) / (mpmath.pi * radius * compliance))
        width = mpmath.sqrt(4 * mpmath.mpf(load) * radius * compliance / mpmath.pi)
    modulus = contact_modulus(first, second)
    assert abs(largest_pressure(load, modulus, radius) - pressure) <= 10.0 * EPS * pressure
    assert abs(half_width(load, modulus, radius) - width) <= 10.0 * EPS * width


def test_the_shear_below_the_surface_is_that_of_the_half_ellipse_of_pressure() -> None:
    """Stresses on the axis from Flamant's line loads, integrated over the contact (b = p = 1), and
    their shear maximised, without the formulas of the module."""

    def shear(z: Any) -> Any:
        def line(s: Any) -> Any:  # sigma_x - sigma_z of a line load at s, over -2/pi
            return mpmath.sqrt(1 - s * s) * (z * s * s - z**3) / (s * s + z * z) ** 2

        return -2 / mpmath.pi * mpmath.quad(line, [0, 1])

    with mpmath.workdps(20):
        depth = mpmath.findroot(lambda z: mpmath.diff(shear, z), (0.7, 0.85), solver="anderson")
        assert abs(shear(depth) - SHEAR_SHARE) <= 1e-12
        assert abs(depth - SHEAR_DEPTH) <= 1e-7  # flat: the square root of the error above
    assert pytest.approx(0.30028, abs=0.5e-5) == SHEAR_SHARE
    assert pytest.approx(0.78615, abs=0.5e-5) == SHEAR_DEPTH


@given(needed=st.floats(1e-3, 1e3), curvature=st.floats(-1.0, 1.0))
def test_roller_radii_give_the_radius_that_is_needed(needed: float, curvature: float) -> None:
    found = roller_radii(needed, curvature)
    if found is None:
        assert needed * curvature > 0.25
        best = 0.5 / curvature
        assert best * (1.0 - best * curvature) < needed
        return
    for radius in found:
        if math.isinf(radius):
            assert curvature < 1.0 / sys.float_info.max  # beyond what a double holds
            continue
        # R is r times a difference whose parts are rounded
        rounding = 20.0 * EPS * radius * (1.0 + radius * abs(curvature))
        assert abs(radius * (1.0 - radius * curvature) - needed) <= rounding
    assert 0.0 < found[0] <= found[1]


# -- the contact over the cam angle --------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "sense"), [*FLANKS, ("groove_clearance", INNER), ("groove_clearance", OUTER)]
)
def test_the_relative_curvature_is_that_of_roller_and_flank(name: str, sense: int) -> None:
    """1/R = 1/r_R + that of the working curve, the outer one mirrored; (1 + d kappa) and its
    inverse round a few times each."""
    subject = scene(name)
    flank = subject.cam.disc.inner_curve if sense == INNER else subject.cam.disc.outer_curve
    phi = np.linspace(0.0, TURN, 400, endpoint=False)
    _, radius = contact_of(subject, float(sense)).load_and_radius(phi, "right")
    roller = subject.cam.follower.roller_radius
    expected = 1.0 / roller + sense * flank.curvature(phi)
    margin = flank.regularity(phi)
    limit = 40.0 * EPS * (1.0 + np.abs(1.0 / margin)) / (roller * np.abs(margin))
    assert np.all(np.abs(1.0 / radius - expected) <= limit)


@by_flank
def test_the_largest_pressure_is_the_largest(name: str, sense: int) -> None:
    subject = scene(name)

    def force(phi: FloatArray) -> FloatArray:
        return np.asarray(sense * (300.0 + 100.0 * np.sin(3.0 * phi) + 50.0 * np.cos(7.0 * phi)))

    result = pressed(subject, Given(np.array([0.0, TURN]), force))
    pressure = result.contact.pressure
    grid = np.linspace(0.0, TURN, 20001)
    assert np.max(pressure(grid, "right")) <= result.largest.value * (1.0 + 1e-12)
    near = result.largest.place + np.array([-1e-12, 0.0, 1e-12])
    sides = np.concatenate((pressure(near, "right"), pressure(near, "left")))
    assert np.max(sides) == pytest.approx(result.largest.value, rel=1e-9)


def test_a_roller_that_is_lifted_off_is_pressed_on_nothing() -> None:
    subject = scene("plate_translating")
    edges = np.array([0.0, 0.5, 1.5, 2.0]) * math.pi
    result = pressed(subject, Given(edges, lambda phi: 100.0 * np.cos(phi)))
    phi = np.linspace(0.0, TURN, 721)
    lifted = np.cos(phi) < 0.0
    values = result.contact.pressure(phi, "right")
    assert np.all(values[lifted] == 0.0)
    assert np.all(values[~lifted & (np.cos(phi) > 0.0)] > 0.0)
    nothing = pressed(subject, steady(-100.0), {"rating": 5000.0})
    assert nothing.largest.value == 0.0
    assert nothing.life.seconds is None
    assert set(severities(nothing).values()) == {"ok"}
    assert all(np.all(each.values(phi, "left") == 0.0) for each in nothing.columns)


def test_in_a_groove_the_flank_follows_the_force() -> None:
    subject = scene("groove")
    edges = np.array([0.0, 0.5, 1.5, 2.0]) * math.pi
    result = pressed(subject, Given(edges, lambda phi: 100.0 * np.cos(phi)))
    phi = np.linspace(0.01, TURN, 500)
    for sense in (INNER, OUTER):
        carries = sense * np.cos(phi) > 0.0
        own = contact_of(subject, float(sense)).load_and_radius(phi, "right")[1]
        assert np.array_equal(
            result.contact.load_and_radius(phi, "right")[1][carries], own[carries]
        )
    assert np.all(result.contact.pressure(phi, "right") > 0.0)


def bend(subject: Design) -> tuple[float, float]:
    """The largest curvature of the pitch curve [1/mm], and its cam angle, by the checks' search."""
    bends = subject.cam.disc.bends
    place = int(np.argmax(bends.values))
    return float(bends.values[place]), float(bends.phi[place])


@pytest.mark.parametrize("share", [1.0, 1.2])
def test_a_cusp_or_undercut_under_force_has_no_pressure(share: float) -> None:
    kappa, angle = bend(scene("plate_translating"))
    radius = share / kappa
    subject = scene("plate_translating", ("roller_radius = 10", f"roller_radius = {radius!r}"))
    with pytest.raises(EffectError, match="infinite") as caught:
        pressed(subject, steady(100.0))
    assert caught.value.finding == "infinite-contact-pressure"
    assert caught.value.cam_angle == pytest.approx(angle, abs=1e-6)
    assert caught.value.value == pytest.approx(1.0 - share, abs=1e-9)


def test_undercut_without_force_does_not_matter() -> None:
    """The roller is pressed on its flank in the rest alone, and there is undercut after it."""
    kappa, _ = bend(scene("plate_translating"))
    subject = scene("plate_translating", ("roller_radius = 10", f"roller_radius = {1.1 / kappa!r}"))
    edges = np.array([0.0, 0.5, TURN])
    force = Given(edges, lambda phi: np.where(phi < 0.5, 50.0, 0.0))
    grid = np.linspace(0.0, TURN, 1000)
    assert np.min(subject.cam.disc.inner_curve.regularity(grid)) < 0.0  # else the test says nothing
    result = pressed(subject, force)
    assert 0.0 < result.largest.value < math.inf
    assert np.all(result.contact.pressure(grid[grid > 0.5], "right") == 0.0)


# -- what is found -------------------------------------------------------------------------------


@pytest.mark.parametrize("safety", [1.0, 2.5])
def test_the_needed_width_gives_the_safety_that_is_asked_for(safety: float) -> None:
    table = {"limit": 1200.0, "safety": safety, "width": 3.0}
    subject, force = scene("plate_translating"), steady(500.0)
    first = pressed(subject, force, table)
    needed = value(first, "needed-width")
    again = pressed(subject, force, {**table, "width": needed})
    assert value(again, "pressure-safety") == pytest.approx(safety, rel=20.0 * EPS)
    share = value(first, "largest-contact-pressure") * safety / 1200.0
    assert needed == pytest.approx(3.0 * share**2, rel=20.0 * EPS)


@pytest.mark.parametrize(
    ("name", "limit", "larger", "changes", "radius"),
    [
        ("plate_translating", 1600.0, True, (), "roller_radius = 10"),
        ("plate_translating", 4000.0, False, (), "roller_radius = 10"),
        (
            "groove_clearance",
            1600.0,
            True,
            (
                ("side_clearance = 0.08", "side_clearance = 3"),
                ("\ndiameter = 12", "\ndiameter = 6"),
            ),
            "roller_radius = 8",
        ),
    ],
)
def test_the_needed_roller_radius_gives_the_safety_that_is_asked_for(
    name: str, limit: float, larger: bool, changes: tuple[tuple[str, str], ...], radius: str
) -> None:
    """At the place where it was worst, for elsewhere the flank bends otherwise. Where the pressure
    is too large it is a larger one, else the smallest that would do; the play of a groove stays."""
    table = {"limit": limit, "safety": 2.0, "width": 3.0}
    first = pressed(scene(name, *changes), steady(500.0), table)
    needed, now = value(first, "needed-roller-radius"), float(radius.split()[-1])
    assert (needed > now) is larger
    again = scene(name, *changes, (radius, f"roller_radius = {needed!r}"))
    contact = pressed(again, steady(500.0), table).contact
    phi = np.array([first.largest.place])
    there = max(float(contact.pressure(phi, side)[0]) for side in ("right", "left"))
    assert there == pytest.approx(0.5 * limit, rel=1e-12)


def test_a_knife_edge_has_no_pressure() -> None:
    with pytest.raises(GeometryError, match="knife edge") as caught:
        pressed(scene("knife_edge"), steady(500.0), {"width": 3.0})
    assert caught.value.key == "follower.roller_radius"


def test_a_roller_that_is_too_large_is_reported_with_the_largest_one() -> None:
    kappa, _ = bend(scene("plate_translating"))
    radius = 0.98 / kappa
    change = ("roller_radius = 10", f"roller_radius = {radius!r}")
    result = pressed(scene("plate_translating", change), steady(500.0), {"limit": 500.0})
    assert 0.5 / kappa < value(result, "needed-roller-radius") < radius


def test_no_roller_is_large_enough() -> None:
    result = pressed(scene("plate_translating"), steady(500.0), {"limit": 50.0})
    found = finding(result.findings, "needed-roller-radius")
    assert (found.severity, found.value) == ("warning", None)
    assert "no roller radius is sufficient" in found.sentence


@pytest.mark.parametrize(
    ("limit", "safety", "expected"),
    [(1e4, 1.0, ("ok", "ok")), (400.0, 1.0, ("broken", "broken")), (1e4, 50.0, ("ok", "broken"))],
)
def test_what_is_held_against_the_limit(
    limit: float, safety: float, expected: tuple[str, str]
) -> None:
    table = {"limit": limit, "safety": safety}
    result = pressed(scene("plate_translating"), steady(600.0), table)
    found = severities(result)
    assert (found["largest-contact-pressure"], found["pressure-safety"]) == expected
    assert value(result, "pressure-safety") == limit / value(result, "largest-contact-pressure")


def test_shear_depth_and_half_width_belong_to_the_largest_pressure() -> None:
    result = pressed(scene("plate_translating"), steady(600.0))
    pressure = value(result, "largest-contact-pressure")
    assert value(result, "largest-subsurface-shear") == SHEAR_SHARE * pressure
    width = value(result, "contact-half-width")
    assert value(result, "subsurface-shear-depth") == SHEAR_DEPTH * width
    assert 0.5 * math.pi * pressure * width == pytest.approx(600.0 / 15.0, rel=1e-12)


# -- life of the roller's bearing ----------------------------------------------------------------


@by_flank
def test_roller_and_cam_have_one_velocity_where_they_touch(name: str, sense: int) -> None:
    """Turns on its pin as those of the roller as a body of its own."""
    cam, phi = scene(name).cam, np.linspace(0.02, 6.2, 97)
    nu = spin(contact_of(scene(name)), phi, "right", np.full(len(phi), float(sense)))
    at = Bodies(cam, phi, np.full(len(phi), float(sense)))
    wanted = -sense * cam.rotation * (at.roller - at.turning)
    assert np.max(np.abs(nu - wanted)) <= 1e-12 * np.max(np.abs(wanted))


@pytest.mark.parametrize(("speed", "bearing"), [(60, {}), (300, {"bearing": "ball"})])
def test_the_life_under_a_steady_force(speed: int, bearing: dict[str, Any]) -> None:
    """P is that force, and the life in turns of the roller (C/P)^p millions."""
    subject = scene("plate_translating", ("speed = 60", f"speed = {speed}"))
    result = pressed(subject, steady(700.0), {"rating": 9000.0, "life": 3600.0} | bearing, 1e-9)
    life = result.life
    assert life.load == pytest.approx(700.0, rel=1e-9)
    turns = life.seconds * life.speed / TURN
    assert turns == pytest.approx(
        1e6 * (9000.0 / 700.0) ** (3.0 if bearing else 10.0 / 3.0), rel=2e-9
    )
    flank = subject.cam.disc.inner_curve
    length = piecewise_integral(
        lambda phi: flank.traced(phi)[2], subject.drive.smooth_angles, 1e-12
    ).value
    expected = length / (TURN * 10.0) * speed
    assert value(result, "roller-speed") == pytest.approx(expected, rel=1e-9)
    assert value(result, "roller-life") == pytest.approx(life.seconds / 3600.0, rel=EPS)
    assert life.speed == pytest.approx(expected * RPM, rel=1e-9)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-10])
def test_the_error_of_the_life_is_stated(tolerance: float) -> None:
    """A force that touches zero, F^(10/3) with it; against a tolerance of 1e-13, whose own
    rounding is some hundred roundings."""
    subject = scene("groove")
    edges = np.array([0.0, 0.5, 1.5, 2.0]) * math.pi
    force = Given(edges, lambda phi: 400.0 * np.cos(phi))
    table = {"rating": 9000.0}
    best, found = (pressed(subject, force, table, each) for each in (1e-13, tolerance))
    assert found.error == pytest.approx(found.life.error, rel=1e-14)
    assert found.life.error <= tolerance
    for exact, own in (
        (best.life.seconds, found.life.seconds),
        (best.life.load, found.life.load),
        (best.life.speed, found.life.speed),
    ):
        assert abs(own / exact - 1.0) <= found.error + 100.0 * EPS + 1e-13


def test_a_tolerance_that_cannot_be_reached_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    module = "camgeo.dynamics.effects.contact_pressure.piecewise_integral"
    monkeypatch.setattr(module, lambda *_: Integral(1.0, 1e-3, 1.0))
    with pytest.raises(EffectError, match="the tolerance is") as caught:
        pressed(scene("groove"), steady(400.0), {"rating": 9000.0}, 1e-6)
    assert (caught.value.value, caught.value.limit) == (1e-3, 1e-6)


@pytest.mark.parametrize(("hours", "severity"), [(0.5, "ok"), (2.0, "broken")])
def test_the_life_is_held_against_the_one_asked_for(hours: float, severity: str) -> None:
    subject, force = scene("plate_translating"), steady(700.0)
    free = pressed(subject, force, {"rating": 9000.0}).life
    table = {"rating": 9000.0, "life": hours * free.seconds}
    assert severities(pressed(subject, force, table))["roller-life"] == severity


@pytest.mark.parametrize(("rating", "severity"), [(1401.0, "ok"), (1399.0, "warning")])
def test_a_load_above_half_of_the_rating_is_reported(rating: float, severity: str) -> None:
    result = pressed(scene("plate_translating"), steady(700.0), {"rating": rating})
    assert severities(result)["equivalent-roller-load"] == severity


# -- the table -----------------------------------------------------------------------------------


def test_an_empty_table_is_hardened_steel_on_hardened_steel() -> None:
    steel = find_material("steel-hardened")
    assert steel.pressure is not None
    assert parse({}) == PressureRequirements(cam=steel, mate=steel, limit=steel.pressure)
    assert parse({}).modulus == pytest.approx(210e3 / (2.0 * 0.91), rel=4.0 * EPS)


def test_the_limit_is_that_of_the_weaker_material_or_of_the_table() -> None:
    weak = {"cam_material": "cast-iron", "roller_material": "steel-100cr6"}
    assert parse(weak).limit == find_material("cast-iron").pressure
    assert parse({**weak, "limit": 500.0}).limit == 500.0
    assert parse({"roller_material": "pom", "limit": 40.0}).mate.modulus == 2.8e3
    own = parse({"cam_modulus": 1.0, "roller_poisson": 0.1})
    assert (own.cam.modulus, own.cam.poisson) == (1.0, 0.3)
    assert (own.mate.modulus, own.mate.poisson) == (210e3, 0.1)
    assert parse({"limit": 900.0, "safety": 1.5}).allowed == 600.0


@pytest.mark.parametrize(
    ("name", "table", "changes", "width"),
    [
        ("plate_translating", {}, (), 15.0),
        ("plate_translating", {"width": 12.0}, (), 12.0),
        ("plate_translating", {"width": 15.5}, (), None),
        ("groove", {}, (), 10.0),
        ("groove", {"width": 11.0}, (), None),
        (
            "plate_translating",
            {},
            (("thickness = 15\n", ""), ('"dxf", "gcode", "stl", "3mf", "csv"', '"dxf", "csv"')),
            None,
        ),
    ],
)
def test_the_width_is_that_of_the_flank_at_most(
    name: str, table: dict[str, Any], changes: tuple[tuple[str, str], ...], width: float | None
) -> None:
    subject = scene(name, *changes)
    sign = -1.0 if subject.cam.contact == "outer" else 1.0
    if width is None:
        with pytest.raises(GeometryError) as caught:
            pressed(subject, steady(sign), table)
        assert caught.value.key == "effects.contact-pressure.width"
    else:
        assert pressed(subject, steady(sign), table).contact.width == width


# -- end to end ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "tables"),
    [
        ("plate_translating", "[effects.inertia]\nmass = 3\n[effects.load]\nconstant = -200\n"),
        ("groove", "[effects.inertia]\nmoment_of_inertia = 0.2\n"),
    ],
)
def test_from_a_scene(name: str, tables: str) -> None:
    subject = design(name, f"{tables}[effects.contact-pressure]\nrating = 9000\nsafety = 1.5\n")
    result: ContactPressure = subject.effect("contact-pressure")
    force = subject.effect("contact-force")
    phi = np.linspace(0.0, TURN, 2000)
    load, radius = result.contact.load_and_radius(phi, "right")
    normal = force.normal(phi, "right")
    carried = np.abs(normal) if name == "groove" else np.maximum(normal, 0.0)
    assert np.array_equal(load, carried)
    pressure = np.sqrt(carried * (210e3 / 1.82) / (math.pi * result.contact.width * radius))
    assert np.allclose(result.columns[0].values(phi, "right"), pressure, rtol=1e-12)
    assert np.max(pressure) <= result.largest.value * (1.0 + 1e-12)
    shear = result.columns[1].values(phi, "right")
    assert np.array_equal(shear, SHEAR_SHARE * result.columns[0].values(phi, "right"))
    assert result.error is not None
    assert result.error <= 1e-6
