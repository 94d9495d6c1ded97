"""Effect `spring-surge`: harmonics of the travel against closed forms and an integral over time."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.dynamics.effects.spring_surge import CLEAR, FARTHEST
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.scene import parse_scene
from camgeo.units import RPM, TURN
from tests.effects.scenes import course_of, design
from tests.integrals import cells, integrals

LIFT: Final = 20.0

WIRE: Final = (
    "[effects.spring]\npreload = 50\n[effects.spring.wire]\ndiameter = 3\ncoil_diameter = 24\n"
    "active_coils = 6\nfree_length = 90\n"
)

SCENE: Final = """
camgeo = 1
name = "surge"
[cam]
rotation = "cw"
speed = {speed!r}
[follower]
kind = "translating-roller"
base_radius = 60
roller_radius = 10
[[motion]]
law = "{law}"
span = 180
to = {lift!r}
[[motion]]
law = "{law}"
span = 180
to = 0
[effects.spring-surge]
tolerance = 1e-9
"""

FREQUENCY: Final = math.sqrt(79300.0 / (2.0 * 7.85e-9)) * 3.0 / (24.0**2 * 6.0)
"""2 pi f_1 [rad/s] of that spring: d/(2 pi D^2 n) sqrt(G/(2 rho)) is f_1."""


def surge(law: str, speed: float) -> tuple[Any, dict[str, Any]]:
    """At `speed` [rev/min], up and down over half a turn each, and its findings."""
    text = SCENE.format(law=law, speed=speed, lift=LIFT) + WIRE
    result = Design(parse_scene(text, "surge.toml")).effect("spring-surge")
    return result, {each.name: each for each in result.findings}


@pytest.mark.parametrize("order", [1, 2, 7, 16, 101])
def test_harmonics_in_closed_form(order: int) -> None:
    """Of a cosine only the first one; of parabolas the odd ones fall with the cube.

    The acceleration per angle is A = 4 h/pi^2 up and down, a square wave with harmonics 4 A/(pi n),
    and n^2 times less is the travel's.
    """
    speed = 1.004 * FREQUENCY / order / RPM
    for law, wanted in (
        ("simple-sine", 0.5 * LIFT if order == 1 else 0.0),
        ("quadratic-parabola", 16.0 * LIFT / (math.pi * order) ** 3 * (order % 2)),
    ):
        result, found = surge(law, speed)
        assert result.harmonic.order == order
        bound = result.errors["surge-harmonic"]
        assert bound.scale == pytest.approx(0.5 * LIFT)
        assert bound.error <= 1e-9 * bound.scale
        assert abs(found["surge-harmonic"].value - wanted) <= bound.error + 1e-15 * LIFT


def test_the_frequency_and_what_is_too_near_it() -> None:
    for times in (0.3, 0.999 * CLEAR, 1.001 * CLEAR, 0.999 * FARTHEST, 1.001 * FARTHEST):
        result, found = surge("simple-sine", FREQUENCY / times / RPM)
        frequency = found["surge-frequency"]
        assert frequency.value == pytest.approx(FREQUENCY / TURN, rel=1e-12)
        assert frequency.severity == ("ok" if times > CLEAR else "warning")
        assert frequency.limit == pytest.approx(CLEAR / times * frequency.value)
        if times > FARTHEST:
            assert result.harmonic is None
        else:
            assert result.harmonic.order == max(1, round(times))


def test_a_cam_that_turns_unevenly() -> None:
    """Against the integral of the travel over time, not by parts, for a low harmonic."""
    made = design(
        "points", "[effects.spring-surge]\ntolerance = 1e-10\n" + WIRE + "density = 1e6\n"
    )
    course = course_of(made)
    result = made.effect("spring-surge")
    order, way = result.harmonic.order, made.effect("spring").way
    duration = TURN / result.speed

    def wave(phi: FloatArray) -> Any:
        phase = np.exp(-1j * order * TURN * course.time(phi) / duration)
        return way(phi, "right")[0] * phase / course.rates(phi)[0]

    borders = np.unique(np.concatenate((made.drive.motion.borders, course.borders)))
    total = np.sum(integrals(wave, *cells(borders, order)))
    wanted = 2.0 / duration * abs(total)
    assert result.harmonic.amplitude == pytest.approx(wanted, abs=1e-9 * result.harmonic.travel)
