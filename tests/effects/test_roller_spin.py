"""Effect `roller-spin` against the roller as a free body of its own."""

from __future__ import annotations

import itertools
import math
from typing import Any, Final

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from camgeo.design.design import Design
from camgeo.dynamics.effects.roller_spin.result import Rolling, Skid
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.scene import load_scene
from camgeo.units import RPM, TURN
from tests.effects.bodies import (
    DIFFERENCE,
    PLATE,
    ROLLER,
    Bodies,
    cross,
    friction,
    inside,
    omega,
    slope,
    speed_of,
)
from tests.effects.scenes import SCENES, design
from tests.long_form import examples

INERTIA: Final = 3e-2
"""[t mm^2]"""


def rolling(scene: str, rev: float, traction: float = 0.05, *changes: tuple[str, str]) -> Design:
    table = f"\n[effects.roller-spin]\nmoment_of_inertia = {1e-3 * INERTIA!r}\n"
    forces = "[effects.load]\nconstant = 40\n[effects.inertia]\nmoment_of_inertia = 0.01\n"
    forces = PLATE if scene == "plate_translating" else forces
    text = f"{forces}{friction(ROLLER)}{table}traction = {traction!r}"
    return design(scene, text, speed_of(scene, rev), *changes)


def groove(inertia: float, traction: float = 0.06) -> Design:
    path = SCENES.parent / "effects" / "groove_lever.toml"
    table = {"moment_of_inertia": inertia, "traction": traction}
    return Design(load_scene(path).with_values({"effects.roller-spin": table}))


@pytest.mark.parametrize("scene", ["plate_translating", "shuttle"])
def test_it_rolls_on_its_flank(scene: str) -> None:
    """No slip at the contact, by velocities in the fixed frame."""
    made = rolling(scene, 90.0)
    phi = inside(made)
    bodies = Bodies(made.cam, phi, made.effect("contact-force").normal(phi, "right"))
    wanted = (bodies.roller, bodies.roller - bodies.turning)
    found = made.effect("roller-spin").rolling.spin(phi, "right")
    for own, other in zip(found, wanted, strict=False):
        assert np.max(np.abs(own / omega(made) - other)) <= DIFFERENCE * np.max(np.abs(other))
    (column,) = (each for each in made.effect("roller-spin").columns if each.name == "roller spin")
    assert column.values(phi, "right") == pytest.approx(found[1] / RPM)


@pytest.mark.parametrize("way", ["ccw", "cw"])
def test_its_angular_momentum_changes_by_friction_and_traction(way: str) -> None:
    """The force of the cam acts at the contact, along the tangent there."""
    turned = [('"ccw"', '"cw"')] if way == "cw" else []
    made = rolling("plate_translating", 200.0, 0.05, *turned)
    phi, roller = inside(made), made.effect("roller-spin").rolling
    at = Bodies(made.cam, phi, made.effect("contact-force").normal(phi, "right"))
    ahead = -made.cam.rotation * 1j * at.outward  # as the contact moves along the flank
    moment = cross(at.arm, roller.traction(phi, "right") * ahead) + sum(at.moments(ROLLER))
    gain = omega(made) * slope(lambda x: roller.spin(x, "right")[0], phi)
    assert np.max(np.abs(INERTIA * gain - moment)) <= 1e3 * DIFFERENCE * np.max(np.abs(moment))


def test_it_skids_where_the_traction_does_not_suffice() -> None:
    loose = rolling("plate_translating", 200.0, 1.0)
    roller, contact = loose.effect("roller-spin").rolling, loose.effect("contact-force")
    phi = np.linspace(0.0, contact.edges[-1], 20001)
    share = np.abs(roller.traction(phi, "right") / contact.normal(phi, "right"))
    needed = float(np.max(share))

    def told(traction: float) -> Any:
        found = rolling("plate_translating", 200.0, traction).effect("roller-spin").findings
        return next(each for each in found if each.name == "traction-reserve")

    assert told(1.01 * needed).severity == "ok"
    assert told(1.01 * needed).value > 0.0
    skids = told(0.99 * needed)
    assert skids.severity == "warning"
    assert "too little" in skids.sentence
    assert skids.value < 0.0


def test_in_a_groove_it_reverses_at_each_change_of_flanks() -> None:
    made = groove(4e-9)
    found = {each.name: each for each in made.effect("roller-spin").findings}
    changes = [each for each in made.effects.findings("lift-off") if each.name == "flank-change"]
    assert found["roller-reversal"].value == len(changes) == 4
    assert found["roller-reversal"].cam_angle == pytest.approx(changes[0].cam_angle)
    assert found["largest-roller-spin"].value > 0.0 > found["smallest-roller-spin"].value


# Skidding -----------------------------------------------------------------------------------------
# How far a roller skids, against its equation of motion solved by others' means.


SOLVED: Final = 1e-9
"""Of solvers whose steps are good to 1e-12: some hundreds of them, and their events."""

FINDINGS: Final = ("largest-slip", "slip-distance", "slip-work")


def skid_of(made: Design) -> Skid:
    found = made.effect("roller-spin").skid
    assert isinstance(found, Skid)
    return found


def values(made: Design) -> dict[str, float]:
    return {each.name: each.value for each in made.effect("roller-spin").findings}


def turned(skid: Skid, phi: FloatArray, side: Any) -> FloatArray:
    """w [rad/s]."""
    return np.asarray(skid.spin(phi, side)[0] + skid.cells.rolling.rubbed(phi, side)[0][0])


# Against a solver ---------------------------------------------------------------------------------


class Solved:
    """A roller that rolls at cam angle 0, over a turn: w, path and work of its slip."""

    def __init__(self, made: Design, friction: dict[str, float], traction: float) -> None:
        self.rolling: Rolling = made.effect("roller-spin").rolling
        self.radius = made.cam.follower.roller_radius
        self.flank = traction * self.radius
        self.pin = 0.5 * friction.get("roller_pin", 0.0) * friction.get("roller_pin_diameter", 0.0)
        self.of_rolling = friction.get("rolling", 0.0)
        self.slips: list[tuple[float, float]] = []
        self.distance = self.work = 0.0
        held, w = True, 0.0
        for low, high in itertools.pairwise(self.rolling.contact.edges.tolist()):
            held, w = self.over(low, high, w, held=held and self.follows(low))
        assert held

    def at(self, phi: float, w: float | None = None) -> tuple[float, ...]:
        """omega_R, its rate, |N| and omega, and the moment of friction per |N|, at w or rolling."""
        here = np.array([phi])
        v, rates = (each[:, 0] for each in self.rolling.rubbed(here, "right"))
        size = abs(float(self.rolling.contact.normal(here, "right")[0]))
        w = v[0] if w is None else w
        rest = -self.pin * np.sign(w - v[1]) - self.of_rolling * np.sign(w - v[2])
        return v[0], rates[0], size, self.rolling.course.rates(here)[0, 0], rest

    def follows(self, phi: float) -> bool:
        """Whether omega_R does not jump."""
        here = np.array([phi])
        before, after = (self.rolling.rubbed(here, side)[0][0, 0] for side in ("left", "right"))
        return bool(abs(after - before) <= 1e-9 * abs(before))

    def lacking(self, phi: float) -> float:
        """The moment that the flank lacks [N mm]."""
        _, rate, size, _, rest = self.at(phi)
        inertia = self.rolling.data.moment_of_inertia
        return abs(inertia * rate - size * rest) - self.flank * size

    def over(self, low: float, high: float, w: float, *, held: bool) -> tuple[bool, float]:
        """The cell from `low` to `high`, free of its ends by rounding."""
        inset = 1e-12 * (high - low)
        low, high = low + inset, high - inset
        while low < high:
            if held:
                grid = np.linspace(low, high, 64)
                lacks = np.array([self.lacking(each) for each in grid])
                out = np.flatnonzero(lacks > 0.0)
                if not len(out):
                    return True, self.at(high)[0]
                if out[0] > 0:
                    low = brentq(self.lacking, grid[out[0] - 1], grid[out[0]], xtol=1e-15)
                w, rate, size, _, rest = self.at(low)
                sense = np.sign(size * rest - self.rolling.data.moment_of_inertia * rate)
            else:
                sense = np.sign(w - self.at(low)[0])
            start = low
            low, w = self.slip(low, high, w, float(sense))
            self.slips.append((start, low))
            held = low < high and self.lacking(low) <= 0.0
        return held, w

    def slip(self, low: float, high: float, w: float, sense: float) -> tuple[float, float]:
        def rate(phi: float, y: FloatArray) -> list[float]:
            rolls, _, size, omega, rest = self.at(phi, float(y[0]))
            pull = size * (rest - sense * self.flank) / self.rolling.data.moment_of_inertia
            path = self.radius * abs(y[0] - rolls)
            return [pull / omega, path / omega, self.flank / self.radius * size * path / omega]

        def gap(phi: float, y: FloatArray) -> float:
            return float(sense * (y[0] - self.at(phi)[0])) if phi > low else 1.0

        gap.terminal, gap.direction = True, -1.0  # type: ignore[attr-defined]  # scipy's way
        done = solve_ivp(
            rate, (low, high), [w, self.distance, self.work],
            method="DOP853", rtol=1e-12, atol=1e-12, events=gap,
        )  # fmt: skip
        w, self.distance, self.work = done.y[:, -1]
        return float(done.t[-1]), float(w)


def assert_solved(made: Design, friction: dict[str, float], traction: float) -> None:
    skid, solved = skid_of(made), Solved(made, friction, traction)
    found = values(made)
    assert found["slip-distance"] == pytest.approx(solved.distance, rel=SOLVED)
    assert found["slip-work"] == pytest.approx(1e-3 * solved.work, rel=SOLVED)
    (start, end), *_ = skid.ranges
    assert start == pytest.approx(solved.slips[0][0], abs=SOLVED)
    assert any(abs(end - each[1]) <= SOLVED for each in solved.slips)


def test_a_plate_cam_that_spins_its_roller_too_fast() -> None:
    assert_solved(rolling("plate_translating", 200.0, 0.02), ROLLER, 0.02)


def test_a_groove_that_reverses_its_roller() -> None:
    assert_solved(groove(4e-8), {}, 0.06)


# Against steps of its own, whatever holds it ------------------------------------------------------


def stepped(skid: Skid, count: int) -> tuple[FloatArray, FloatArray, float]:
    """Angles, w there, and the largest step, by Euler's implicit method from the same start.

    The moments fall as w rises, so each step has one answer: the sum over the sorted v_i.
    """
    roller = skid.cells.rolling
    phi = np.union1d(np.linspace(0.0, TURN, count), roller.contact.edges)
    middle = 0.5 * (phi[1:] + phi[:-1])
    v, levers = roller.rubbed(phi[1:], "left")[0].T, roller.levers
    pressing = roller.pressing(middle, "right") / roller.course.rates(middle)[0]
    pulls = pressing * np.diff(phi) / roller.data.moment_of_inertia
    w = [float(turned(skid, phi[:1], "right")[0])]
    for pull, row in zip(pulls.tolist(), v.tolist(), strict=True):
        best = w[-1] + pull * float(np.sum(levers))
        for lever, each in sorted(zip(levers.tolist(), row, strict=False), key=lambda x: x[1]):
            if best <= each:
                break
            best = max(best - 2.0 * pull * lever, each)
            if best == each:
                break
        w.append(best)
    rise = np.abs(np.diff(roller.rubbed(phi, "right")[0][:, :-1], axis=1))
    smooth = np.quantile(rise, 0.99)  # the others are the jumps where flanks change
    return phi, np.array(w), float(smooth + np.max(pulls) * np.sum(levers))


EVENTS: Final = 24
"""More than changes of what holds the roller in a turn; each is found late by up to a step."""


def drawn(scene: str, inertia: float, traction: float, rev: float) -> Design:
    if scene == "groove_lever":
        return groove(inertia, traction)
    made = rolling(scene, rev, traction)
    table = {"moment_of_inertia": inertia, "traction": traction}
    return Design(made.scene.with_values({"effects.roller-spin": table}))


@settings(max_examples=examples(6, long=100), deadline=None)
@given(
    st.sampled_from(["groove_lever", "plate_translating", "shuttle"]),
    st.floats(-7.0, -1.0),
    st.floats(-4.0, -0.7),
    st.floats(60.0, 900.0),
)
def test_whatever_holds_it_it_moves_as_in_small_steps(
    name: str, inertia: float, traction: float, rev: float
) -> None:
    made = drawn(name, 10.0**inertia, 10.0**traction, rev)
    skid = made.effect("roller-spin").skid
    if skid is None:
        assert [values(made)[each] for each in FINDINGS] == [0.0, 0.0, 0.0]
        return
    phi, w, step = stepped(skid, examples(2001, long=20001))
    assert np.max(np.abs(turned(skid, phi[1:], "left") - w[1:])) <= EVENTS * step
    # the end of the turn is its start, and what nobody jumps over is continuous
    after, before = (turned(skid, skid.edges[:-1], side) for side in ("right", "left"))
    assert np.max(np.abs(after - before)) <= 1e-12 * skid.cells.fastest


# Balances -----------------------------------------------------------------------------------------


def test_a_roller_that_its_pin_holds_slips_all_round_the_cam() -> None:
    """By the length of the outline, that of the pitch curve less the roller's circumference."""
    made = rolling("plate_translating", 60.0, 1e-4)
    found = values(made)
    points = made.cam.disc.pitch_curve.point(np.linspace(0.0, TURN, 20001))
    outline = float(np.sum(np.abs(np.diff(points)))) - TURN * made.cam.follower.roller_radius
    assert found["largest-roller-spin"] == found["smallest-roller-spin"] == 0.0
    assert found["slip-distance"] == pytest.approx(outline, rel=1e-7)
    share = 0.5 * ROLLER["roller_pin"] * ROLLER["roller_pin_diameter"] + ROLLER["rolling"]
    assert found["roller-drag"] == pytest.approx(share / made.cam.follower.roller_radius)


def test_without_inertia_it_does_not_slip() -> None:
    """|N| rises from 0 where the flanks change, so the slip goes with the root of the inertia."""
    coarse, fine = (values(groove(each))["slip-distance"] for each in (1e-12, 1e-14))
    assert coarse / fine == pytest.approx(10.0, rel=1e-3)
    assert [values(groove(0.0))[each] for each in FINDINGS] == [0.0, 0.0, 0.0]


def test_where_nothing_presses_it_keeps_its_spin() -> None:
    made = rolling("plate_translating", 900.0)
    skid = skid_of(made)
    for lost in made.effect("contact-force").lost_contact.ranges:
        w = turned(skid, np.linspace(lost.start, lost.end, 21), "right")
        assert np.ptp(w) <= 1e-12 * skid.cells.fastest
    assert {each.severity for each in made.effects.findings("roller-spin")} == {"broken", "warning"}


def test_what_nothing_turns_has_no_slip_that_is_known() -> None:
    made = groove(1e-6, 0.0)
    found = {each.name for each in made.effect("roller-spin").findings}
    assert "roller-undriven" in found
    assert not found & set(FINDINGS)


def test_a_roller_that_rolls_is_not_followed() -> None:
    made = rolling("plate_translating", 60.0, 0.2)
    found = {each.name: each for each in made.effect("roller-spin").findings}
    assert made.effect("roller-spin").skid is None
    assert [found[each].value for each in FINDINGS] == [0.0, 0.0, 0.0]
    columns = {each.name: each for each in made.effect("roller-spin").columns}
    assert not np.any(columns["roller slip"].values(np.linspace(0.0, math.pi, 5), "right"))
