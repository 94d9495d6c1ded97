"""The motion of the written contour, against one that knows nothing but the piece that is touched.

The oracle solves in mpmath for the lift at which the roller touches a line, an arc or a vertex, and
differentiates it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any, Final

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from camgeo.design.design import Design
from camgeo.dynamics.effects.results import CONTACT_FORCE
from camgeo.dynamics.state.written import Written
from camgeo.geometry.contour.contour import Contour, Form
from camgeo.numeric.arrays import SIDES, FloatArray
from camgeo.part.part import written_contour
from camgeo.scene.scene import load_scene
from tests.effects.scenes import course_of, design
from tests.effects.test_trimmed_cams import derivatives, on_rocker, place_of


@cache
def asked(
    scene: str, form: Form = "arcs", tolerance: float = 1e-3, effects: str = "", flank: str = ""
) -> Design:
    """The fixture scene with the motion of its written contour, on a side of it if it has two."""
    edits: dict[str, Any] = {"state.motion": "written", "state.contour": form}
    edits |= {"output.tolerance": tolerance} | ({"state.flank": flank} if flank else {})
    return Design(design(scene, effects).scene.with_values(edits))


def state_of(made: Design) -> Written:
    state = made.effects.subject.state
    assert isinstance(state, Written)
    return state


def side_of(made: Design, flank: str = "") -> tuple[Contour, Any]:
    """The contour of a side, and the cam whose roller runs on it."""
    disc = made.discs[1 if flank == "return" else 0]
    name = f"{flank} flank" if flank in ("inner", "outer") else "outline"
    (boundary,) = (each for each in disc.drawn.part.boundaries if each.name == name)
    contours: Any = made.effects.subject.contours
    writing = contours.writing
    found = written_contour(boundary, writing.form, writing.effort, writing.tolerance).contour
    assert isinstance(found, Contour)
    return found, disc.drawn.cam


def gap_on(contour: Contour, element: int, cam: Any, sense: int = 1) -> Callable[[Any, Any], Any]:
    """Of lift and cam angle: 0 where the roller touches that element, numbered as in `Replay`, of
    an inner flank, or of an outer one if `sense` is -1.
    """
    place, radius = place_of(cam.follower), sense * mpmath.mpf(cam.follower.roller_radius)
    number = element if element >= 0 else -1 - element
    start, end = (
        mpmath.mpmathify(complex(each[number])) for each in (contour.vertices, contour.ends)
    )
    sweep = float(contour.sweeps[number]) if element >= 0 else 0.0
    centre = mpmath.mpmathify(complex(contour.centres[number])) if sweep else start

    def gap(lift: Any, phi: Any) -> Any:
        point = place(lift) * mpmath.expj(-cam.rotation * phi)
        if element >= 0 and not sweep:
            return mpmath.im(mpmath.conj(end - start) * (start - point)) / abs(end - start) - radius
        reach = radius + (mpmath.sign(sweep) * abs(start - centre) if sweep else 0)
        return abs(point - centre) - abs(reach)

    return gap


def touched(state: Written, count: int) -> Iterator[tuple[float, int, FloatArray]]:
    """Angles in the middle of pieces of the motion, what is touched there, and the motion."""
    lift: Any = state.motion.lift
    middles = 0.5 * (lift.borders + np.append(lift.borders[1:], lift.borders[0] + 2.0 * math.pi))
    places = middles[np.linspace(0, len(middles) - 1, count).astype(int)]
    elements, _ = lift.held_by(lift.number(places))
    yield from zip(places.tolist(), elements.tolist(), state.motion.jet(places).T, strict=True)


def assert_lift(jet: FloatArray, gap: Callable[[Any, Any], Any], phi: float) -> None:
    wanted = derivatives(gap, phi, float(jet[0]))
    assert jet == pytest.approx(wanted, abs=1e-8 * (max(map(abs, wanted)) + 1.0))


SIDED: Final = [
    ("groove", "inner"), ("groove", "outer"), ("groove_clearance", "outer"),
    ("conjugate_lever", "return"),
]  # fmt: skip
"""Followers that are held both ways, on one of their sides."""

ONE_SIDED: Final = [("plate_translating", ""), ("swallow_tail", ""), ("querhub", "")]


@pytest.mark.parametrize("form", ["arcs", "polyline"])
@pytest.mark.parametrize(("scene", "flank"), [*ONE_SIDED, *SIDED])
def test_the_lift_is_that_of_a_roller_that_touches_its_piece(
    scene: str, flank: str, form: Form
) -> None:
    made = asked(scene, form, flank=flank)
    state, (contour, cam) = state_of(made), side_of(made, flank)
    for phi, element, jet in touched(state, 8):
        assert_lift(jet, gap_on(contour, element, cam, -1 if flank == "outer" else 1), phi)


def face_gap_on(contour: Contour, element: int, cam: Any) -> Callable[[Any, Any], Any]:
    """Of lift and cam angle: 0 where the face touches that arc or vertex from outside."""
    follower, number = cam.follower, element if element >= 0 else -1 - element
    start, centre = (
        mpmath.mpmathify(complex(each[number])) for each in (contour.vertices, contour.centres)
    )
    radius = abs(start - centre) if element >= 0 else mpmath.mpf(0)
    centre = centre if element >= 0 else start

    def gap(lift: Any, phi: Any) -> Any:
        point = centre * mpmath.expj(cam.rotation * phi)
        if follower.lift_unit == "mm":
            normal, height = mpmath.expj(mpmath.mpf(follower.guide_angle)), follower.base_radius
            return mpmath.re(mpmath.conj(normal) * point) + radius - (height + lift)
        pivot = mpmath.mpmathify(complex(follower.pivot))
        side = follower.arm_side
        start_angle = mpmath.asin(
            (mpmath.mpf(follower.base_radius) - follower.face_offset) / abs(pivot)
        )
        along = -pivot / abs(pivot) * mpmath.expj(side * (start_angle + lift))
        away = mpmath.re(mpmath.conj(1j * side * along) * (point - pivot))
        return away + radius - follower.face_offset

    return gap


@pytest.mark.parametrize("form", ["arcs", "polyline"])
@pytest.mark.parametrize("scene", ["tappet", "flat_rocker"])
def test_the_lift_is_that_of_a_face_that_touches_its_piece(scene: str, form: Form) -> None:
    """The lift has three derivatives there, and no part of the contour lies beyond the face."""
    made = asked(scene, form, 1e-2)
    state, (contour, cam) = state_of(made), side_of(made)
    for phi, element, jet in touched(state, 9):
        assert (element >= 0) == (form == "arcs")
        assert_lift(jet, face_gap_on(contour, element, cam), phi)
        for number in range(0, len(contour), max(1, len(contour) // 12)):
            beyond = face_gap_on(contour, -1 - number, cam)(float(jet[0]), phi)
            assert beyond <= 1e-9


@pytest.mark.parametrize("form", ["arcs", "polyline"])
@pytest.mark.parametrize("scene", ["tappet", "flat_rocker"])
def test_a_face_is_pushed_along_its_normal(scene: str, form: Form) -> None:
    """On vertices too, where the contact stands still: m q'' omega^2 over 1, or over its lever."""
    sliding = scene == "tappet"
    own = "mass = 2" if sliding else "moment_of_inertia = 0.01"
    text = f"[effects.inertia]\n{own}\n[effects.contact-force]\n"
    sense = 'rotation = "cw"'
    changes = () if sliding else ((sense, f"{sense}\nspeed = 100"),)
    edits = {"state.motion": "written", "state.contour": form, "output.tolerance": 1e-2}
    made = Design(design(scene, text, *changes).scene.with_values(edits))
    state, course = state_of(made), course_of(made)
    cam: Any = made.cam
    phi = np.linspace(0.01, 6.27, 200)
    jet, omega = state.motion.jet(phi), course.rates(phi)[0]
    if sliding:
        wanted = 2e-3 * jet[2] * omega**2  # N, of t, mm and s
    else:
        lift: Any = state.motion.lift
        which = lift.number(phi)
        seen = lift.circles.centres[which] * np.exp(1j * cam.rotation * phi)
        away = np.abs(seen - complex(cam.follower.pivot))
        over = cam.follower.face_offset - lift.circles.radii[which]
        wanted = 0.01 * 1e3 * jet[2] * omega**2 / np.sqrt(away**2 - over**2)
    found = made.effect(CONTACT_FORCE).normal(phi, "right")
    assert found == pytest.approx(wanted, rel=1e-9, abs=1e-9 * float(np.max(np.abs(wanted))))


@given(
    st.sampled_from(["arcs", "polyline", "spline"]),
    st.sampled_from(["plate_translating", "swallow_tail", "querhub", "tappet", "flat_rocker"]),
    st.sampled_from([1e-1, 1e-2, 1e-3, 1e-4]),
)
@settings(max_examples=16, deadline=None)
def test_the_lift_is_off_by_what_the_tolerance_allows(
    form: Form, scene: str, tolerance: float
) -> None:
    """A contour within eps of the exact one holds the centre within eps of the pitch curve, which
    is reached along the path of the follower within eps over the sine of its angle with the normal;
    so it is for the faces that touch both, over the lever of the contact.
    """
    assume(form != "spline" or scene not in ("tappet", "flat_rocker"))
    made = asked(scene, form, tolerance)
    state, own = state_of(made), Design(load_scene_of(scene)).effects.subject.state
    phi = np.linspace(0.0, 2.0 * math.pi, 2000)
    off = np.abs(state.motion.jet(phi)[0] - own.motion.jet(phi)[0])
    lever = np.abs(own.curve.leverage(phi))
    # To the second order in eps: a tenth more covers the change of the lever over that way.
    assert np.all(off * lever <= 1.1 * state.deviation)
    assert state.deviation <= tolerance


@cache
def load_scene_of(scene: str) -> Any:
    return design(scene, "").scene


def test_the_velocity_jumps_where_the_roller_touches_two_chords() -> None:
    """At a corner that turns in: each chord alone gives q' = -n . dZ/dphi / n . dZ/dq."""
    made = asked("setzhub", "polyline", 1e-2)
    state, (contour, cam) = state_of(made), side_of(made)
    assert state.shocks
    place = on_rocker(cam.follower)
    ways = contour.ends - contour.vertices
    lift = state.motion.lift
    for shock in state.shocks:
        sides = []
        for side in SIDES:
            at = np.array([shock])
            element = int(lift.held_by(lift.number(at, side))[0][0])
            jet = state.motion.jet(at, side)[:, 0]
            centre = complex(place(float(jet[0]))) * np.exp(-1j * cam.rotation * shock)
            normal = -1j * ways[element] / abs(ways[element])
            foot = centre - cam.follower.roller_radius * normal
            share = ((foot - contour.vertices[element]) * np.conj(ways[element])).real
            assert 0.0 <= share <= abs(ways[element]) ** 2  # it touches the chord, not its line
            assert cam.follower.pivot is not None
            arm = centre - complex(cam.follower.pivot) * np.exp(-1j * cam.rotation * shock)
            along = 1j * cam.follower.swing_sense * arm
            turn = -1j * cam.rotation * centre
            velocity = -(np.conj(normal) * turn).real / (np.conj(normal) * along).real
            assert jet[1] == pytest.approx(velocity, abs=1e-9)
            sides.append((velocity, element))
        (before, one), (after, other) = sides
        assert one != other
        assert abs(after - before) > 1e-6


@pytest.mark.parametrize(
    ("scene", "form"), [("setzhub", "arcs"), ("setzhub", "polyline"), ("measured", "spline")]
)
def test_the_order_is_of_the_highest_derivative_that_jumps_nowhere(scene: str, form: Form) -> None:
    """The contour of `measured` is one spline, curved differently at its two ends."""
    state = state_of(asked(scene, form, 1e-2))
    before, after = (state.motion.jet(state.motion.borders, side) for side in SIDES)
    most = np.max(np.abs(after), axis=1)
    jumps = np.max(np.abs(after - before), axis=1) / most
    # Both sides are the same to rounding, some 1e-14; what jumps is far above it.
    assert np.all(jumps[: state.order + 1] < 1e-9)
    assert jumps[state.order + 1] > 1e-6


def test_dwells_stay_dwells_in_arcs_and_none_is_left_in_chords() -> None:
    for form, count in (("arcs", 2), ("polyline", 0)):
        state = state_of(asked("setzhub", form, 1e-3))
        rests = state.motion.dwells
        assert len(rests) == count
        for rest in rests:
            inside = np.linspace(rest.start + 1e-9, rest.start + rest.span - 1e-9, 7)
            assert not np.any(state.motion.jet(inside)[1:])
        spans = [math.degrees(rest.span) for rest in rests]
        assert spans == pytest.approx([20.0, 170.0][:count], abs=1e-6)


YOKE: Final = Path(__file__).resolve().parents[2] / "fixtures" / "effects" / "yoke.toml"


def astride(scene: str, flank: str, form: Form = "arcs", tolerance: float = 1e-2) -> Design:
    """A yoke on its written contour, with rollers or with flat faces."""
    edits = {"motion": "written", "contour": form, "flank": flank}
    made = load_scene(YOKE) if scene == "yoke" else design(scene, "[effects.kinematics]").scene
    return Design(made.with_values({"state": edits, "output.tolerance": tolerance}))


@pytest.mark.parametrize("form", ["arcs", "polyline", "spline"])
@pytest.mark.parametrize("scene", ["yoke", "constant_breadth"])
def test_both_sides_of_a_yoke_are_on_one_contour_half_a_turn_apart(scene: str, form: Form) -> None:
    """The far side is b - 2 h - s(phi + pi) high, s the lift of the near one, for a yoke of the
    breadth b of the exact cam; the play is what a yoke of its own breadth has more.
    """
    if scene == "constant_breadth" and form == "spline":
        pytest.skip("flat faces on splines are refused")
    near, far = (astride(scene, flank, form) for flank in ("main", "opposite"))
    phi = np.linspace(0.0, 2.0 * math.pi, 4001) + 1e-4
    cam = near.cam
    assert cam.breadth is not None
    apart = cam.breadth.best - 2.0 * cam.breadth.height
    here, there = state_of(near).motion, state_of(far).motion
    beyond = here.jet((phi + math.pi) % (2.0 * math.pi))
    # A centre is known to rounding of 100 mm, and a joint lies elsewhere by rounding.
    assert there.jet(phi)[0] == pytest.approx(apart - beyond[0], abs=1e-9)
    speeds = np.abs(there.jet(phi)[1] + beyond[1])
    assert np.quantile(speeds, 0.99) <= 1e-9 * np.max(np.abs(beyond[1]))
    assert state_of(near).sense == -state_of(far).sense == 1
    contours = near.effects.subject.contours
    assert contours is not None
    own = here.jet(phi)
    play = apart - beyond[0] - own[0] + cam.yoke_breadth - cam.breadth.best
    between = (phi[1] - phi[0]) * np.max(np.abs(beyond[1] + own[1]))  # what samples may miss
    assert contours.play.lowest.value == pytest.approx(np.min(play), abs=between)
    assert contours.play.highest.value == pytest.approx(np.max(play), abs=between)
    assert contours.play.lowest.value <= np.min(play) + 1e-9
    assert contours.play.highest.value >= np.max(play) - 1e-9


def test_forces_of_a_yoke_come_near_those_of_the_demanded_motion() -> None:
    """As the square root of the tolerance of cubics; findings tell side, contour and play."""
    exact = load_scene(YOKE)
    demanded = Design(exact).effect(CONTACT_FORCE)
    phi = np.linspace(0.0, 2.0 * math.pi, 2001)
    off = []
    for tolerance in (1e-3, 1e-5):
        made = astride("yoke", "main", "spline", tolerance)
        force = made.effect(CONTACT_FORCE)
        off.append(np.max(np.abs(force.normal(phi, "right") - demanded.normal(phi, "right"))))
    assert off[1] < 0.3 * off[0] < 0.05 * demanded.extremes.magnitude
    told = {each.name: each for each in made.effects.findings(CONTACT_FORCE)}
    assert "of the main side makes all round" in told["written-motion"].sentence
    assert "between the main side and the opposite side" in told["other-contour"].sentence
    assert told["other-contour"].value == pytest.approx(0.01, abs=1e-4)
    assert 'flank = "opposite"' in told["other-side"].sentence


def test_many_shocks_are_one_finding() -> None:
    made = asked(
        "setzhub",
        "polyline",
        1e-3,
        "[effects.inertia]\nmoment_of_inertia = 0.01\n[effects.contact-force]",
    )
    assert len(state_of(made).shocks) > 8
    (told,) = (each for each in made.effects.findings("contact-force") if each.name == "shock")
    assert "more" in told.sentence or "others" in told.sentence
