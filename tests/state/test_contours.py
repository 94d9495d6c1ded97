"""Followers that are held both ways, on the side of a written contour that the scene states.

Oracles: a roller pressed against points of the contour, by bisection, and the free body of the
follower; their lifts are in `tests.state.test_written`.
"""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np
import pytest

from camgeo.design.design import Design
from camgeo.dynamics.effects.lift_off.result import flank_changes
from camgeo.dynamics.effects.results import CONTACT_FORCE
from camgeo.dynamics.state.state import FIRST, SECOND
from camgeo.dynamics.state.written import Contours, Written
from camgeo.errors import SceneError
from camgeo.geometry.contour.contour import Contour
from camgeo.geometry.outline.roller import PlayedLift
from camgeo.geometry.pitch_curve import WorkingCurve
from camgeo.kinematics.mechanism.follower_path import path_of
from camgeo.numeric.arrays import ComplexArray, FloatArray
from tests.effects.scenes import course_of, design
from tests.effects.test_premises import GROOVE
from tests.findings import finding_of
from tests.state.test_written import SIDED, asked, side_of, state_of

WIDE: Final = ("thickness = 10", "thickness = 10\nrim = 125\ngroove_depth = 5")

SIDES: Final = {"inner": FIRST, "main": FIRST, "outer": SECOND, "return": SECOND}


def sided(scene: str, flank: str, tolerance: float = 1e-3) -> Design:
    guided = scene in ("plate_translating", "groove_clearance")
    own = "mass = 2" if guided else "moment_of_inertia = 0.01"
    text = f"[effects.inertia]\n{own}\n[effects.contact-force]\n[effects.kinematics]\n"
    return asked(scene, "arcs", tolerance, text, flank)


def contours_of(made: Design) -> Contours:
    found = made.effects.subject.contours
    assert found is not None
    return found


def press(flank: str) -> int:
    """+1 where the roller runs outside of its contour, -1 where inside."""
    return -1 if flank == "outer" else 1


def places_of(cam: Any, lift: FloatArray, phi: FloatArray) -> ComplexArray:
    """(n,) roller centres [mm] in the cam."""
    follower = cam.follower
    if follower.lift_unit == "mm":
        height = math.sqrt(follower.base_radius**2 - follower.offset**2)
        seen = complex(follower.way) * (height + lift - 1j * follower.offset)
    else:
        turned = np.exp(1j * follower.swing_sense * lift)
        seen = complex(follower.pivot) + complex(follower.start_arm) * turned
    found: ComplexArray = seen * np.exp(-1j * cam.rotation * phi)
    return found


def points_on(contour: Contour, spacing: float) -> ComplexArray:
    """Points [mm] of the contour, `spacing` [mm] apart at most."""
    found = []
    for start, end, centre, sweep in zip(
        contour.vertices, contour.ends, contour.centres, contour.sweeps, strict=True
    ):
        length = abs(end - start) if sweep == 0.0 else abs(sweep) * abs(start - centre)
        shares = np.linspace(0.0, 1.0, 2 + int(length / spacing))
        on_line = start + shares * (end - start)
        on_arc = centre + (start - centre) * np.exp(1j * sweep * shares)
        found.append(on_line if sweep == 0.0 else on_arc)
    return np.concatenate(found)


def pressed_on(made: Design, flank: str, phi: FloatArray, spacing: float) -> FloatArray:
    """(n,) lift of a roller that is pushed until it comes to a point of the contour."""
    contour, cam = side_of(made, flank)
    points, radius = points_on(contour, spacing), cam.follower.roller_radius
    start = made.drive.motion.jet(phi)[0]
    reach = 0.02 if cam.lift_unit == "rad" else 1.0
    step = np.full(len(phi), 1e-3 * reach)
    outwards = np.sign(
        np.abs(places_of(cam, start + step, phi)) - np.abs(places_of(cam, start, phi))
    )
    clear, hit = (start + sign * press(flank) * outwards * reach for sign in (1, -1))
    for _ in range(45):
        middle = 0.5 * (clear + hit)
        centres = places_of(cam, middle, phi)
        apart = np.array([np.min(np.abs(points - each)) for each in centres])
        clear, hit = (
            np.where(apart >= radius, middle, clear),
            np.where(apart >= radius, hit, middle),
        )
    return np.asarray(0.5 * (clear + hit))


@pytest.mark.parametrize(
    ("scene", "both"), [("groove", ("inner", "outer")), ("conjugate_lever", ("main", "return"))]
)
def test_the_play_is_that_between_rollers_pressed_against_both_contours(
    scene: str, both: tuple[str, str]
) -> None:
    """Between points h apart a roller goes deeper by h^2 / 8 (1/r - kappa) at most, less than
    h^2 / 4r here, over the lever of its lift.
    """
    phi, spacing = np.linspace(0.05, 6.2, 11), 0.02
    made = [sided(scene, each, 1e-2) for each in both]
    lever = np.abs(made[0].effects.subject.state.curve.leverage(phi))
    deeper = 1.1 * spacing**2 / (4.0 * made[0].cam.follower.roller_radius) / lever
    levers = np.abs(made[0].effects.subject.state.curve.leverage(np.linspace(0.0, 6.28, 400)))
    lifts = [state_of(each).motion.jet(phi)[0] for each in made]
    for each, flank, lift in zip(made, both, lifts, strict=True):
        assert np.all(np.abs(pressed_on(each, flank, phi, spacing) - lift) <= deeper + 1e-12)
    outward = state_of(made[0]).replay.lift.outward
    play = contours_of(made[0]).play
    assert play == contours_of(made[1]).play
    assert np.all(outward * (lifts[1] - lifts[0]) >= play.lowest.value - 1e-12)
    assert np.all(outward * (lifts[1] - lifts[0]) <= play.highest.value + 1e-12)
    own = sum(state_of(each).deviation for each in made)
    assert play.magnitude <= 1.1 * own / np.min(levers)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4])
@pytest.mark.parametrize(("scene", "flank"), SIDED)
def test_the_lift_comes_to_that_on_the_exact_flank(
    scene: str, flank: str, tolerance: float
) -> None:
    """Within eps over the lever, as for a single flank; with side clearance, to the played lift."""
    made = sided(scene, flank, tolerance)
    state, cam = state_of(made), made.cam
    phi = np.linspace(0.0, 6.28, 300)
    exact = made.drive.motion.jet(phi)[0]
    if cam.clearance:
        curve = WorkingCurve(cam.disc.pitch_curve, -press(flank) * 0.5 * cam.clearance)
        exact = PlayedLift(path_of(cam.follower, cam.rotation), curve).jet(phi)[0]
    off = np.abs(state.motion.jet(phi)[0] - exact)
    lever = np.abs(side_of(made, flank)[1].disc.pitch_curve.leverage(phi))
    assert np.all(off * lever <= 1.1 * state.deviation)
    assert state.deviation <= tolerance


def test_both_discs_see_one_motion() -> None:
    made = sided("conjugate_lever", "return")
    subject = made.effects.subject
    assert subject.returning is not None
    state, other = subject.state, subject.returning.state
    assert isinstance(state, Written)
    assert isinstance(other, Written)
    assert state.replay is other.replay
    assert (state.touches, other.touches) == (False, True)
    assert made.effect(CONTACT_FORCE).state.sense == SECOND


@pytest.mark.parametrize(("scene", "flank"), [("plate_translating", ""), *SIDED[1:]])
def test_the_force_is_that_of_the_free_body_where_that_side_carries(scene: str, flank: str) -> None:
    """m q'' omega^2 over the lever of the line through the centre of the touched arc."""
    made = sided(scene, flank)
    state, (contour, cam), course = state_of(made), side_of(made, flank), course_of(made)
    phi = np.linspace(0.01, 6.27, 120)
    jet, omega = state.motion.jet(phi), course.rates(phi)[0]
    lift = state.motion.lift
    elements, _ = lift.held_by(lift.number(phi))
    assert np.all(elements >= 0)
    centres, bent = contour.centres[elements], contour.sweeps[elements]
    along = contour.ends[elements] - contour.vertices[elements]
    here = places_of(cam, jet[0], phi)
    tiny = 1e-6
    way = (places_of(cam, jet[0] + tiny, phi) - places_of(cam, jet[0] - tiny, phi)) / (2.0 * tiny)
    outwards = np.where(bent == 0.0, -1j * along, np.sign(bent) * (here - centres))
    lever = (np.conj(press(flank) * outwards / np.abs(outwards)) * way).real
    mass = 2e-3 if cam.lift_unit == "mm" else 10.0  # t, or t mm^2
    wanted = mass * jet[2] * omega**2 / lever
    normal = made.effect(CONTACT_FORCE).normal(phi, "right")
    carried = wanted > 0.0
    assert np.sum(carried) > 20
    sense = SECOND if flank else FIRST
    assert sense * normal[carried] == pytest.approx(wanted[carried], rel=1e-6)
    assert not np.any(sense * normal[~carried] > 0.0)


@pytest.mark.parametrize(
    ("scene", "flank", "other"),
    [("groove", "outer", "inner flank"), ("conjugate_lever", "main", "return disc")],
)
def test_findings_say_where_the_other_side_carries_and_how_far_it_is(
    scene: str, flank: str, other: str
) -> None:
    made = sided(scene, flank)
    told = finding_of(made, "contact-force", "other-side")
    assert told.severity == "warning"
    assert f"the {other} carries" in told.sentence
    contact = made.effect(CONTACT_FORCE)
    _, changes = flank_changes(contact)
    for change in changes:
        if change.sense == SIDES[flank]:  # it leaves this side
            assert f"{math.degrees(change.carrying):.4f} to" in told.sentence
    assert told.value == pytest.approx(
        max(0.0, -SIDES[flank] * contact.extremes.lowest.value,
            -SIDES[flank] * contact.extremes.highest.value)
    )  # fmt: skip
    figures = [each for each in made.effects.findings("contact-force") if "force" in each.name]
    assert {each.severity for each in figures} == {"warning"}
    for effect in ("kinematics", "contact-force"):
        apart = finding_of(made, effect, "other-contour")
        lowest = contours_of(made).play.lowest
        assert apart.value == pytest.approx(math.degrees(lowest.value), rel=1e-12)
        assert apart.severity == ("warning" if lowest.value < 0.0 else "ok")
        motion = finding_of(made, effect, "written-motion").sentence
        assert f"the written contour of the {flank} {other.split()[1]} makes all round" in motion


def test_what_the_opposite_flank_has_lost_is_told_as_its_own() -> None:
    """Both flanks of this groove are trimmed, and figures are of what one of them makes."""
    scene = design("swallow_tail", "[effects.kinematics]", GROOVE[0], WIDE).scene
    for flank, other in (("inner", "outer"), ("outer", "inner")):
        made = Design(scene.with_values({"state.motion": "written", "state.flank": flank}))
        told = made.effects.findings("kinematics")
        trimmed = [each.sentence for each in told if each.name == "trimmed-motion"]
        (own,) = (each for each in trimmed if f"the trimmed {flank} flank" in each)
        (opposite,) = (each for each in trimmed if f"the trimmed {other} flank" in each)
        assert own.startswith("these figures are for the motion that the trimmed")
        assert opposite.startswith("these figures are for the motion of the other side")
        assert finding_of(made, "kinematics", "highest-velocity").severity == "ok"
        losses = [made.cam.disc.replay(each).largest_loss.value for each in (flank, other)]
        play = contours_of(made).play.highest.value
        assert play == pytest.approx(max(losses), abs=4e-3)  # two tolerances over the lever


def test_flights_between_written_contours_are_refused() -> None:
    scene = sided("groove", "outer").scene.with_values({"effects.lift-off.backlash": 0.02})
    told = finding_of(Design(scene), "lift-off", "impact-speed")
    assert told.value is None
    assert "flights between these are not computed" in told.sentence


@pytest.mark.parametrize(
    ("scene", "edits", "words"),
    [
        ("groove", {"motion": "written", "flank": "main"}, "needs [follower.return]"),
        ("conjugate_lever", {"motion": "written", "flank": "inner"}, "needs contact"),
        ("querhub", {"motion": "written", "flank": "inner"}, "needs contact"),
        ("groove", {"flank": "inner"}, "another motion is the same on both sides"),
        ("plate_translating", {"motion": "written", "flank": "main"}, "needs [follower"),
        ("conjugate_lever", {"motion": "written", "flank": "opposite"}, "needs [follower"),
        ("constant_breadth", {"motion": "written", "flank": "return"}, "needs [follower"),
    ],
)
def test_a_scene_states_one_of_two_sides(scene: str, edits: dict[str, str], words: str) -> None:
    values = {f"state.{key}": value for key, value in edits.items()}
    with pytest.raises(SceneError) as caught:
        design(scene, "").scene.with_values(values)
    (fault,) = caught.value.faults
    assert fault.key == "state.flank"
    assert words in fault.message
