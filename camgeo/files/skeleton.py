"""The skeleton of a mechanism: its links and joints in one position, put together for a picture."""

from __future__ import annotations

import cmath

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.files.mechanism_sketch import Guide, MechanismSketch
from camgeo.mechanism.crank_slider import CrankSlider
from camgeo.mechanism.four_bar import FourBar
from camgeo.mechanism.kinds import AnyFlat, AnyFollower
from camgeo.mechanism.linkage_protocol import Linkage
from camgeo.mechanism.oscillating_flat import OscillatingFlat
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.translating_flat import TranslatingFlat
from camgeo.motion.extremes import lift_range

GUIDE = 0.8
"""Way from a carriage at its farthest to its guide, in base radii."""

ROD = 0.3
"""By so much the rod of a carriage stands out of its guide at lift 0, in base radii."""

BRACKET = 1.2
"""Way round the discs from the one roller of a carriage to the other, in their largest radii."""


def skeleton(cam: Cam, returning: AnyFollower | None, phi: float) -> MechanismSketch:
    """The mechanism of `cam` at the cam angle `phi` [rad].

    `returning` is the follower on the return disc of a conjugate pair, None if there is none.
    """
    follower, linkage, curve = cam.follower, cam.drive.linkage, cam.disc.pitch_curve
    motion = cam.drive.motion
    lift = float(motion.jet(np.array([phi]))[0, 0])
    lifts = lift_range(motion)
    farthest = max(lifts, key=lambda each: follower.reach * each)
    found = _follower(follower, lift, farthest, face_ends(curve))
    if returning is not None:
        found += _returning(follower, returning, lift, lifts)
    if cam.yoke_breadth > 0.0:
        found += _far_side(follower, lift, face_ends(curve), cam.yoke_breadth)
    if linkage is None:
        return found
    position = float(cam.drive.plan.jet(np.array([phi]))[0, 0])
    if isinstance(follower, OscillatingRoller | OscillatingFlat):
        return found + _rocker_linkage(linkage, follower.pivot, position)
    assert isinstance(linkage, CrankSlider)  # the only one with a guided follower
    out = cmath.exp(1j * follower.guide_angle)
    rod_end = _follower(follower, 0.0, farthest, (0.0, 0.0)).links[0][-1]
    return found + _crank(linkage, rod_end, follower.direction * out, position)


def face_ends(curve: PitchCurve) -> tuple[float, float]:
    """Where a flat face begins and ends [mm]: as the scene says, else as the contact needs it.

    Zeros for a roller, which has no face.
    """
    follower = curve.follower
    if not isinstance(follower, TranslatingFlat | OscillatingFlat):
        return 0.0, 0.0
    if follower.face is not None:
        return follower.face
    from camgeo.outline.convex import contact_extremes  # few cams have a flat face

    places = contact_extremes(curve)
    return places.smallest()[0], places.largest()[0]


def _follower(
    follower: AnyFollower, lift: float, farthest: float, ends: tuple[float, float]
) -> MechanismSketch:
    """The follower at the lift `lift` [mm or rad].

    `farthest` is the lift farthest from the cam; `ends` are where a flat face begins and ends [mm],
    as its contact is counted, and of no meaning for a roller.
    """
    if isinstance(follower, OscillatingRoller):
        contact = _roller_centre(follower, lift)
        return MechanismSketch(
            links=((follower.pivot, contact),),
            shafts=(follower.pivot,),
            rollers=((contact, follower.roller_radius),),
        )
    if isinstance(follower, OscillatingFlat):
        foot, _ = _face(follower, lift)
        face = face_line(follower, lift, (min(0.0, ends[0]), max(0.0, ends[1])))
        return MechanismSketch(
            links=((follower.pivot, foot),), shafts=(follower.pivot,), faces=(face,)
        )
    out = cmath.exp(1j * follower.guide_angle)
    held, start, here = (
        _face(follower, at)[0] if follower.is_flat else _roller_centre(follower, at)
        for at in (farthest, 0.0, lift)
    )
    middle = held + GUIDE * follower.base_radius * out
    end = middle + here - start + ROD * follower.base_radius * out
    rod = MechanismSketch(links=((here, end),), guides=(Guide(middle, out, block=False),))
    if isinstance(follower, TranslatingFlat):
        return rod + MechanismSketch(faces=(face_line(follower, lift, ends),))
    return rod + MechanismSketch(rollers=((here, follower.roller_radius),))


def _roller_centre(follower: AnyFollower, lift: float) -> complex:
    """The roller centre [mm] in the fixed frame at the lift `lift` [mm or rad]."""
    at = follower.relative_jet(_at(lift), 1, 1)
    return complex(at.along[0, 0], at.across[0, 0]) * cmath.exp(1j * at.axis)


def face_line(follower: AnyFlat, lift: float, ends: tuple[float, float]) -> tuple[complex, complex]:
    """The ends [mm] of a flat face in the fixed frame at the lift `lift` [mm or rad]."""
    foot, along = _face(follower, lift)
    return foot + along * ends[0], foot + along * ends[1]


def _face(follower: AnyFollower, lift: float) -> tuple[complex, complex]:
    """Where the contact is counted from on a flat face [mm], and the way in which it counts."""
    if isinstance(follower, OscillatingFlat):
        line = -follower.pivot / abs(follower.pivot)
        chi = follower.arm_side * float(follower.face_angle(np.array([lift]))[0])
        along = line * cmath.exp(1j * chi)
        return follower.pivot + 1j * follower.arm_side * along * follower.face_offset, along
    # At rest the contact of a tappet lies at the foot of the cam axis.
    foot = _roller_centre(follower, lift)
    return foot, -1j * foot / abs(foot)


def _returning(
    main: AnyFollower, other: AnyFollower, lift: float, lifts: tuple[float, float]
) -> MechanismSketch:
    """The return roller of a conjugate pair at the lift `lift` [mm or rad], one of `lifts`."""
    centre = _roller_centre(other, lift)
    roller = MechanismSketch(rollers=((centre, other.roller_radius),))
    if isinstance(other, OscillatingRoller):
        return roller + MechanismSketch(links=((other.pivot, centre),))
    first = _roller_centre(main, lift)
    reach = max(abs(_roller_centre(each, at)) for each in (main, other) for at in lifts)
    return roller + MechanismSketch(links=(_bracket(first, centre, reach),))


def _far_side(
    follower: AnyFollower, lift: float, ends: tuple[float, float], breadth: float
) -> MechanismSketch:
    """The second side of a yoke of `breadth` [mm] at the lift `lift` [mm]."""
    if not isinstance(follower, TranslatingFlat):
        here = _roller_centre(follower, lift)
        there = here - breadth * here / abs(here)
        return MechanismSketch(
            links=(_bracket(here, there, 0.6 * breadth),),
            rollers=((there, follower.roller_radius),),
        )
    here, along = _face(follower, lift)
    there = here - breadth * here / abs(here)
    # The same face, half a turn on.
    face = (there - along * ends[0], there - along * ends[1])
    return MechanismSketch(links=(_bracket(here, there, 0.6 * breadth),), faces=(face,))


def _bracket(first: complex, second: complex, reach: float) -> tuple[complex, ...]:
    """From one side of the cam to the other, clear of a disc of the radius `reach`."""
    aside = 1j * (first - second) / abs(first - second) * BRACKET * reach
    return first, first + aside, second + aside, second


def _rocker_linkage(linkage: Linkage, shaft: complex, position: float) -> MechanismSketch:
    """The linkage that drives the rocker on `shaft` [mm]; its far end is at `position`."""
    pins, tips = linkage.joints(np.array([position]))
    pin, tip = shaft + complex(pins[0]), shaft + complex(tips[0])
    both = MechanismSketch(links=((shaft, tip), (tip, pin)), joints=(tip, pin), shafts=(shaft,))
    if isinstance(linkage, FourBar):
        far = shaft + linkage.shaft
        return both + MechanismSketch(links=((far, pin),), shafts=(far,))
    return both + MechanismSketch(guides=(Guide(pin, 1.0 + 0j),))


def _crank(
    linkage: CrankSlider, carriage: complex, outward: complex, angle: float
) -> MechanismSketch:
    """The crank behind a carriage, at the crank's `angle` [rad].

    `carriage` is where the coupler's pin lies on the carriage at angle 0 [mm], `outward` the unit
    direction of a positive stroke.
    """
    pins, tips = linkage.joints(np.array([0.0, angle]))
    strokes, _ = linkage.inner.joints(np.array([0.0, linkage.crank]))
    way = complex(strokes[1] - strokes[0])
    turn = outward * abs(way) / way
    pin, tip, shaft = (
        carriage + turn * (complex(each) - complex(pins[0])) for each in (pins[1], tips[1], 0j)
    )
    return MechanismSketch(links=((shaft, tip), (tip, pin)), joints=(tip, pin), shafts=(shaft,))


def _at(lift: float) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """(4, 1) a jet at rest."""
    return np.array([[lift], [0.0], [0.0], [0.0]])
