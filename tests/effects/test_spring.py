from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any, Final

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camgeo.design.design import Design
from camgeo.dynamics.effects.spring.result import BetweenPoints, along_slider
from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.linkages import SliderCrank
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.units import TURN
from tests.effects.scenes import design
from tests.findings import finding
from tests.integrals import cells, integrals

LINEAR: Final = "stiffness = 5\npreload = 50\n"
TORSION: Final = 'kind = "torsion"\ntorsional_stiffness = 5\npreload_torque = 50\n'

ENDS: Final = "anchor = [30, -60]\nattachment = [60, 30]\n"

SPRINGS: Final = {
    "guide": ("plate_translating", LINEAR),
    "guide, outer flank": ("ring", LINEAR),
    "guide, lift from a table": ("measured", LINEAR),
    "slider that draws": ("setzhub", LINEAR),
    "slider that pushes": ("schnitt", LINEAR),
    "torsion": ("shuttle", TORSION),
    "torsion in a groove": ("groove", TORSION),
    "torsion with a linkage": ("setzhub", TORSION),
    "extension": ("shuttle", 'kind = "extension"\n' + LINEAR + ENDS),
    "compression": ("groove", LINEAR + ENDS),
    "compression with a linkage": ("schnitt", LINEAR + ENDS),
}

WOUND: Final = {"diameter": 3.0, "coil_diameter": 24.0, "active_coils": 6.0, "free_length": 60.0}
"""Its coils touch at 24 mm."""

ROUNDING: Final = 1e-13
"""Some hundred roundings of the numbers at hand."""


def spring_of(name: str) -> tuple[Design, Any]:
    scene, table = SPRINGS[name]
    made = design(scene, f"[effects.spring]\n{table}")
    return made, made.effect("spring")


def grid(made: Design) -> FloatArray:
    """Angles all round, with those where the formula changes."""
    found: FloatArray = np.concatenate((np.linspace(0.0, TURN, 361), made.drive.smooth_angles))
    return found


@pytest.mark.parametrize("name", SPRINGS)
def test_the_force_is_the_slope_of_the_potential(name: str) -> None:
    """c0 q' = -dV/dphi, integrated from place to place, so that no difference blurs it."""
    made, spring = spring_of(name)
    low, high = cells(made.cam.drive.motion.borders, 12)

    def power(phi: FloatArray) -> FloatArray:
        found: FloatArray = (
            spring.force.coefficients(phi, "right")[0] * made.cam.drive.motion.jet(phi)[1]
        )
        return found

    work = integrals(power, low, high)

    def potential(phi: FloatArray, side: Side) -> Any:
        x = spring.way(phi, side)[0]
        return (0.5 * spring.stiffness * x - spring.preload) * x

    loss = potential(low, "right") - potential(high, "left")
    scale = np.max(np.abs(potential(grid(made), "right")))
    # The rule of 24 points is exact to rounding on a twelfth of a law.
    assert np.max(np.abs(work - loss)) <= 1e-11 * scale
    phi = grid(made)
    peak = np.max(
        np.abs(spring.force.coefficients(phi, "right")[0] * made.cam.drive.motion.jet(phi)[1])
    )
    assert abs(np.sum(work)) <= 1e-12 * peak
    assert np.all(spring.force.coefficients(phi, "right")[1:] == 0.0)


@pytest.mark.parametrize("name", SPRINGS)
def test_the_force_is_linear_in_preload_and_stiffness(name: str) -> None:
    made, spring = spring_of(name)
    for side in ("right", "left"):
        phi = grid(made)
        parts = spring.preload * spring.per_preload(phi, side)
        parts += spring.stiffness * spring.per_stiffness(phi, side)
        found = spring.force.coefficients(phi, side)[0]
        assert parts == pytest.approx(found, abs=ROUNDING * float(np.max(np.abs(found))))


@pytest.mark.parametrize(
    "name", [name for name, (_, table) in SPRINGS.items() if ENDS not in table]
)
def test_it_presses_the_roller_to_its_flank(name: str) -> None:
    """The preload alone, whatever the motion: against the outward normal, or along it."""
    made, spring = spring_of(name)
    phi = grid(made)
    outwards = spring.per_preload(phi, "right") / made.cam.disc.pitch_curve.leverage(phi)
    assert np.all(outwards > 0.0 if made.cam.contact == "outer" else outwards < 0.0)
    assert "spring-opens-contact" not in {found.name for found in spring.findings}


def test_a_lift_of_more_than_the_deflection_by_the_preload_makes_it_slack() -> None:
    """F = P - k s on the ring, whose lift is 12.5 mm, and 10 mm are those of the preload."""
    made, spring = spring_of("guide, outer flank")
    slack = finding(spring.findings, "slack-spring")
    assert (slack.severity, slack.value) == ("warning", pytest.approx(-12.5))
    ends = made.cam.drive.motion.jet(np.array(slack.cam_range))
    assert ends[0] == pytest.approx([10.0, 10.0], abs=1e-12)
    assert ends[1][0] > 0.0 > ends[1][1]


@pytest.mark.parametrize(
    ("name", "sense", "unit"),
    [
        ("guide", -1.0, 1.0),  # outwards, of an inner flank
        ("guide, outer flank", 1.0, 1.0),
        ("torsion in a groove", 1.0, 1e3),  # inwards: the spring relaxes
        ("slider that draws", 1.0, 1.0),  # inwards, of an inner flank
        ("slider that pushes", -1.0, 1.0),
    ],
)
def test_along_one_way_it_does_the_work_of_its_end(name: str, sense: float, unit: float) -> None:
    """Q q' = F ds/dphi in the sense in which it closes: virtual work, without the linkage."""
    made, spring = spring_of(name)
    phi = grid(made)
    stroke, speed = made.cam.drive.plan.jet(phi)[:2]
    force = 50.0 - 5.0 * sense * stroke
    work = spring.force.coefficients(phi, "right")[0] * made.cam.drive.motion.jet(phi)[1]
    wanted = sense * unit * force * speed
    assert work == pytest.approx(wanted, abs=1e-11 * float(np.max(np.abs(wanted))))
    (column,) = spring.columns
    assert column.unit == ("N" if unit == 1.0 else "N m")
    assert column.values(phi, "right") == pytest.approx(force)


@pytest.mark.parametrize(
    ("name", "pivot", "sense"),
    [("extension", 110.0, -1.0), ("compression", -96.0 - 72.0j, 1.0)],
)
def test_between_two_points(name: str, pivot: complex, sense: float) -> None:
    """The moment of the spring's force about the pivot, from where its end is in the drawing."""
    made, spring = spring_of(name)
    phi = grid(made)
    lift = made.cam.drive.motion.jet(phi)[0]
    turn = np.exp(1j * made.cam.follower.reach / abs(made.cam.follower.reach) * lift)
    anchor, first = 30.0 - 60.0j, 60.0 + 30.0j
    end = pivot + (first - pivot) * turn
    longer = np.abs(end - anchor) - abs(first - anchor)
    force = (50.0 - sense * 5.0 * longer) * sense * (end - anchor) / np.abs(end - anchor)
    moment = np.imag(np.conj(end - pivot) * force)
    wanted = moment * made.cam.follower.reach / abs(made.cam.follower.reach)
    found = spring.force.coefficients(phi, "right")[0]
    assert found == pytest.approx(wanted, abs=1e-12 * float(np.max(np.abs(wanted))))


def test_pulling_instead_of_pushing_opens_the_contact() -> None:
    """One of the two must: both act along the same line."""
    opened = {}
    for kind in ("extension", "compression"):
        made = design("shuttle", f'[effects.spring]\nkind = "{kind}"\n{LINEAR}{ENDS}')
        found = made.effect("spring").findings
        opened[kind] = [each for each in found if each.name == "spring-opens-contact"]
    assert not opened["compression"]
    (told,) = opened["extension"]
    assert (told.severity, told.cam_range) == ("warning", (0.0, TURN))


coordinates = st.complex_numbers(min_magnitude=1.0, max_magnitude=1e3, allow_nan=False)


@settings(max_examples=60, deadline=None)
@given(anchor=coordinates, attachment=coordinates, swing=st.floats(1e-3, 1.5))
def test_a_tiny_elongation_keeps_its_digits(
    anchor: complex, attachment: complex, swing: float
) -> None:
    """Against 40 digits, from swings of 1e-12 to 1.5 rad."""
    for size in (1e-9, -1e-3, 1.0):
        angle = swing * size
        if abs(attachment - anchor) < 1.0 or abs(attachment * np.exp(1j * angle) - anchor) < 1.0:
            continue
        motion: Any = SimpleNamespace(jet=lambda *_, q=angle: np.array([[q], [0.0]]))
        way = BetweenPoints(motion, 0.0, 1, attachment, anchor, 1.0)
        found = way(np.zeros(1), "right")[0][0]
        with mpmath.workdps(40):
            r, a = mpmath.mpc(attachment), mpmath.mpc(anchor)
            wanted = abs(r * mpmath.expj(mpmath.mpf(angle)) - a) - abs(r - a)
            # Im(conj(a) r) and sin(half) are rounded each, no difference of lengths is.
            slack = 16.0 * 2.0**-52 * abs(angle) * abs(a) * abs(r) / abs(r - a)
            assert abs(found - wanted) <= slack + 16.0 * 2.0**-52 * abs(wanted)


def test_an_arm_over_the_line_of_centres_cannot_close_by_the_slider() -> None:
    made = design("schnitt", f"[effects.spring]\n{LINEAR}")
    linkage = made.cam.drive.linkage
    assert isinstance(linkage, SliderCrank)
    follower: Any = SimpleNamespace(
        reach=1.0, ahead=0,
        relative_jet=lambda jet, *_: SimpleNamespace(u=jet[0] - 0.5 * np.max(jet[0])),
    )  # fmt: skip
    plan = made.cam.drive.plan
    state = SimpleNamespace(output=plan, motion=plan, smooth_angles=made.drive.smooth_angles)
    subject: Any = SimpleNamespace(cam=SimpleNamespace(rotation=1, follower=follower), state=state)
    with pytest.raises(GeometryError, match="line of centres") as error:
        along_slider(subject, linkage)
    assert error.value.key == "effects.spring"


def helical(**changed: float | str) -> tuple[Any, dict[str, Any]]:
    """The spring `WOUND` along a guide with a lift of 20 mm, and its findings."""
    keys = "\n".join(f"{key} = {value!r}" for key, value in (WOUND | changed).items())
    table = f"[effects.spring]\npreload = 50\n[effects.spring.wire]\n{keys}\n"
    spring = design("plate_translating", table).effect("spring")
    return spring, {each.name: each for each in spring.findings}


def test_a_helical_spring_acts_as_one_of_its_stiffness() -> None:
    """And its stress is what its force does, all round."""
    spring, found = helical()
    stated = design(
        "plate_translating", f"[effects.spring]\npreload = 50\nstiffness = {spring.stiffness!r}\n"
    )
    phi = grid(stated)
    plain = stated.effect("spring")
    for side in ("right", "left"):
        same = plain.force.coefficients(phi, side)
        assert np.array_equal(spring.force.coefficients(phi, side), same)
    assert spring.findings[:3] == plain.findings
    force, stress = (column.values(phi, "right") for column in spring.columns)
    # C = 8, so K = 31/28 + 0.615/8.
    per_force = (31.0 / 28.0 + 0.615 / 8.0) * 8.0 * 24.0 / (math.pi * 27.0)
    assert stress == pytest.approx(per_force * force, rel=ROUNDING)
    assert found["largest-spring-stress"].value == pytest.approx(float(np.max(stress)))
    assert {each.severity for each in spring.findings} == {"ok"}


def test_what_a_helical_spring_cannot_bear_is_said() -> None:
    """Limits on either side of the values found."""
    _, found = helical()
    largest, solid = found["largest-spring-stress"].value, found["solid-spring-stress"].value
    assert solid > largest
    for strength, judged in (
        (0.999 * largest, ("broken", "warning")),
        (0.999 * solid, ("ok", "warning")),
        (1.001 * solid, ("ok", "ok")),
    ):
        _, told = helical(strength=strength)
        names = ("largest-spring-stress", "solid-spring-stress")
        assert tuple(told[name].severity for name in names) == judged
    force = found["largest-spring-force"].value
    for deflections, severity in ((0.99, "broken"), (1.14, "warning"), (1.16, "ok")):
        length = 24.0 + deflections * force / helical()[0].stiffness
        assert helical(free_length=length)[1]["spring-closure"].severity == severity
    # 2.63 times 24 mm, divided by the effective length of each pair of seats.
    for seats, alpha in (
        ("flat", 0.5),
        ("flat-hinged", 0.707),
        ("hinged", 1.0),
        ("flat-free", 2.0),
    ):
        for share, severity in ((0.999, "ok"), (1.001, "warning")):
            length = share * 2.63 * 24.0 / alpha
            told = helical(free_length=length, seats=seats)[1]
            assert told["spring-buckling"].severity == severity
    assert helical(coil_diameter=37.0)[1]["spring-index"].severity == "warning"
