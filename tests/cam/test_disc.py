"""The curves of a disc, against the roller's own place; what remains of its flanks."""

from __future__ import annotations

import math
import pickle
from decimal import Decimal
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from camgeo.cam.cam import Cam, Contact, Disc, Drive
from camgeo.design.design import Design
from camgeo.errors import GeometryError
from camgeo.geometry.outline.path import Flank, Stretch
from camgeo.geometry.outline.path import Path as Outline
from camgeo.geometry.pieces import Extremes
from camgeo.geometry.pitch_curve import PitchCurve
from camgeo.kinematics.laws import make_law
from camgeo.kinematics.mechanism.follower import Follower
from camgeo.kinematics.mechanism.oscillating_roller import OscillatingRoller
from camgeo.kinematics.mechanism.translating_flat import TranslatingFlat
from camgeo.kinematics.mechanism.translating_roller import TranslatingRoller
from camgeo.kinematics.plan import Dwell, MotionPlan, Move
from camgeo.scene.scene import load_scene
from camgeo.units import TURN

SCENES = Path(__file__).parents[2] / "fixtures" / "scenes"

LAW = make_law("polynomial-345")


def plan(lift: float) -> MotionPlan:
    return MotionPlan(
        (Dwell(Decimal(70)), Move(Decimal(140), lift, LAW), Move(Decimal(150), 0.0, LAW))
    )


MM, RAD = Drive(plan(12.0)), Drive(plan(0.3), unit="rad")

SLIDE = TranslatingRoller(45.0, 7.0, 5.0, 0.7)
ROCKER = OscillatingRoller(-70.0 - 40.0j, 70.0, 50.0, 6.0)
FACE = TranslatingFlat(45.0)

ANGLES = np.linspace(0.0, TURN, 61)


@cache
def design(name: str) -> Design:
    return Design(load_scene(SCENES / f"{name}.toml"))


@pytest.mark.parametrize("clearance", [0.0, 0.08])
@pytest.mark.parametrize("rotation", [1, -1])
@pytest.mark.parametrize(("drive", "follower"), [(MM, SLIDE), (RAD, ROCKER)])
def test_both_flanks_run_beside_the_roller_centre(
    drive: Drive, follower: Follower, rotation: int, clearance: float
) -> None:
    """In the fixed frame the centre is where the follower holds it; in the disc it turns back."""
    cam = Cam(drive, follower, rotation, Contact.GROOVE, clearance)
    disc = cam.disc
    centre = disc.pitch_curve.point(ANGLES) * np.exp(1j * rotation * ANGLES)
    lift = drive.plan.jet(ANGLES)[0]
    if follower is SLIDE:
        way = np.exp(0.7j)
        start = 5.0 * way / 1j + math.sqrt(45.0**2 - 5.0**2) * way
        assert centre == pytest.approx(start + lift * way, rel=1e-13)
    else:
        arm = centre - ROCKER.pivot
        assert np.abs(arm) == pytest.approx(70.0, rel=1e-13)
        assert np.angle(arm / arm[0]) == pytest.approx(np.sign(ROCKER.reach) * lift, abs=1e-13)
    half = follower.roller_radius + 0.5 * clearance
    assert disc.flank_distance == pytest.approx(half, rel=1e-15)
    assert [name for name, _ in disc.flanks] == ["inner", "outer"]
    for flank, sign, (_, curve) in zip(Flank, (-1.0, 1.0), disc.flanks, strict=True):
        assert curve is disc.curve(flank)
        beside = curve.point(ANGLES) - disc.pitch_curve.point(ANGLES)
        assert np.abs(beside) == pytest.approx(half, rel=1e-12)
        # Away from the axis, as the disc's curves are without a hollow here.
        assert np.all(sign * (beside * np.conj(disc.pitch_curve.point(ANGLES))).real > 0.0)
    assert cam.distances == pytest.approx((-half, half))
    for contact, wanted in ((Contact.INNER, (-half,)), (Contact.OUTER, (half,))):
        one = Cam(drive, follower, rotation, contact, clearance)
        assert one.distances == pytest.approx(wanted)
        assert [name for name, _ in one.disc.flanks] == [contact.value]


def test_what_is_not_stated_is_a_plate_that_turns_counter_clockwise_without_play() -> None:
    for made, other in (
        (Cam(MM, SLIDE), Cam(MM, SLIDE, 1, Contact.INNER, 0.0, None, None)),
        (Disc(MM, SLIDE), Disc(MM, SLIDE, 1, Contact.INNER, 0.0)),
    ):
        assert made == other
        assert "ledger" not in repr(made)
        assert made != type(made)(MM, SLIDE, -1)
        assert pickle.loads(pickle.dumps(made)).rotation == 1
    disc = Cam(MM, SLIDE, -1, Contact.OUTER, 0.5).disc
    assert (disc.rotation, disc.contact, disc.clearance) == (-1, Contact.OUTER, 0.5)
    assert disc.drive is MM
    assert disc.follower is SLIDE


@pytest.mark.parametrize("kind", [Cam, Disc])
def test_a_contact_goes_by_its_name(kind: type[Cam] | type[Disc]) -> None:
    made = kind(MM, SLIDE, contact="groove")  # type: ignore[arg-type]  # as who does not check types
    assert made.contact is Contact.GROOVE
    with pytest.raises(GeometryError, match='must be one of "inner", "outer", "groove"') as caught:
        kind(MM, SLIDE, contact="side")  # type: ignore[arg-type]  # as above
    assert caught.value.key == "follower.contact"
    assert caught.value.value == "side"


@pytest.mark.parametrize("name", ["plate_translating", "setzhub", "groove", "swallow_tail"])
def test_no_curvature_lies_beyond_the_bends(name: str) -> None:
    """Dense differences of the curve's own points, from the tangent's angle."""
    disc = design(name).cam.disc
    pitch = disc.pitch_curve
    phi = np.linspace(0.0, TURN, 4001)
    kappa = pitch.curvature(phi)
    (low, at_low), (high, at_high) = disc.bends.smallest(), disc.bends.largest()
    assert low <= np.min(kappa) + 1e-12
    assert high >= np.max(kappa) - 1e-12
    for value, at in ((low, at_low), (high, at_high)):
        sides = [pitch.curvature(np.array([at]), side)[0] for side in ("left", "right")]
        assert min(abs(each - value) for each in sides) <= 1e-9 * abs(value)


def test_what_a_search_of_bends_misses_is_found_where_a_flank_needs_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of the curvature only its values at the breaks: the largest one between is still there."""
    whole = design("swallow_tail").cam.disc
    wanted = whole.bends.largest()

    def ends_only(curve: PitchCurve) -> Extremes:
        return Extremes(curve.breaks, curve.curvature(curve.breaks))

    monkeypatch.setattr("camgeo.cam.cam.curvature_extremes", ends_only)
    again = Cam(whole.drive, whole.follower, whole.rotation).disc
    assert again.bends.largest() == pytest.approx(wanted, rel=1e-9)
    dropped = [np.array(each.outline("inner").dropped) for each in (again, whole)]
    assert dropped[0] == pytest.approx(dropped[1], abs=1e-9)


def test_a_flat_face_has_the_bends_of_its_contour() -> None:
    disc = Cam(MM, FACE).disc
    kappa = disc.pitch_curve.curvature(np.linspace(0.0, TURN, 2001))
    assert disc.bends.smallest()[0] <= np.min(kappa) <= np.max(kappa) <= disc.bends.largest()[0]
    assert disc.flank_distance == 0.0
    assert not disc.outline("inner").is_trimmed
    points = points_of(disc.inner_outline.path)
    assert min(abs(points - disc.pitch_curve.point(np.array([1.7]))[0])) < 0.5


def points_of(path: Outline) -> np.ndarray:
    """Points of the stretches of a path, some hundred of each turn."""
    found = []
    for each in path.stretches:
        phi = np.linspace(each.start, each.end, 2 + round(200 * (each.end - each.start)))
        found.append(each.curve.point(phi))
    return np.concatenate(found)


def test_a_groove_that_undercuts_nothing_keeps_both_flanks_whole() -> None:
    disc = design("groove_clearance").cam.disc
    inner, outer = disc.flank_paths
    assert inner is disc.outline("inner").path is disc.inner_outline.path
    assert outer is disc.outline("outer").path is disc.outer_outline.path
    for path, whole, curve in (
        (inner, disc.untrimmed_paths[0], disc.inner_curve),
        (outer, disc.untrimmed_paths[1], disc.outer_curve),
    ):
        assert not disc.inner_outline.is_trimmed
        assert points_of(path) == pytest.approx(points_of(whole), abs=1e-9)
        (stretch,) = path.stretches
        assert stretch.curve == curve
        assert stretch.end - stretch.start == pytest.approx(TURN)


@pytest.mark.parametrize(("contact", "used"), [("inner", 0), ("outer", 1)])
def test_the_flank_on_which_nothing_runs_is_the_whole_curve(contact: str, used: int) -> None:
    disc = Cam(MM, SLIDE, contact=Contact(contact)).disc
    paths = disc.flank_paths
    assert paths[used] is disc.outline(contact).path
    other = (disc.outer_curve, disc.inner_curve)[used]
    assert paths[1 - used].elements == (Stretch(other, 0.0, TURN),)


def test_a_trimmed_flank_loses_what_crosses_and_the_roller_its_stroke() -> None:
    """HC21c: what lies between cam angles 73.0697 and 84.2799 degrees is cut off."""
    disc = design("swallow_tail").cam.disc
    outline = disc.outline("inner")
    assert np.degrees(outline.dropped) == pytest.approx(np.array([[73.0697, 84.2799]]), abs=5e-5)
    assert disc.flank_paths[0] is outline.path
    assert len(points_of(disc.untrimmed_paths[0])) > len(points_of(outline.path))
    replay = disc.replay("inner")
    lost = replay.demanded[0] - replay.actual[0]
    at = np.degrees(replay.phi)
    assert np.max(np.abs(lost[(at < 73.0) | (at > 84.4)])) <= 1e-9
    assert 1e-4 < np.max(lost) < 0.1
    # The roller pressed onto what remains: no point of it is nearer than the radius anywhere.
    remains = points_of(outline.path)
    for phi, lift in zip(replay.phi[::40], replay.actual[0, ::40], strict=True):
        centre = 1j * (25.0 + lift) * np.exp(-1j * phi)
        nearest = np.min(np.abs(remains - centre))
        assert nearest == pytest.approx(disc.follower.roller_radius, abs=2e-3)


def test_the_pitch_path_turns_where_the_velocity_jumps() -> None:
    straight = make_law("straight-line")
    moves = (Move(Decimal(120), 6.0, straight), Move(Decimal(240), 0.0, straight))
    disc = Cam(Drive(MotionPlan(moves)), SLIDE).disc
    path = disc.pitch_path
    assert sorted(np.degrees([each.after for each in path.pivots]) % 360.0) == pytest.approx(
        [0.0, 120.0], abs=1e-9
    )
    assert points_of(path) == pytest.approx(
        np.concatenate(
            [
                disc.pitch_curve.point(
                    np.linspace(each.start, each.end, 2 + round(200 * (each.end - each.start)))
                )
                for each in path.stretches
            ]
        ),
        abs=1e-11,
    )
    lengths = [each.end - each.start for each in path.stretches]
    assert sum(lengths) == pytest.approx(TURN)


def test_another_size_or_motion_makes_another_cam_of_the_same_drive() -> None:
    cam = Cam(MM, SLIDE, -1, Contact.OUTER, 0.0)
    sized = cam.sized(roller_radius=8.5, base_radius=47.0)
    assert sized.drive is MM
    assert sized.follower == TranslatingRoller(47.0, 8.5, 5.0, 0.7)
    assert (sized.rotation, sized.contact) == (-1, Contact.OUTER)
    assert sized.ledger is not cam.ledger
    with pytest.raises(GeometryError):
        cam.sized(base_radius=4.0)  # less than the offset
    moved = cam.moved(plan(3.0))
    assert moved.drive.plan == plan(3.0)
    assert moved.drive.unit == "mm"
    assert moved.follower is SLIDE
    assert np.max(moved.disc.pitch_curve.motion.jet(ANGLES)[0]) == pytest.approx(3.0)
    assert moved.ledger is moved.drive.ledger
    assert cam.lift_unit == "mm"
    assert Cam(RAD, ROCKER).lift_unit == "rad"
