"""Checks of the linkage: dead centres, the distance from them, and the branch."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.mechanism.linkage import LinkedMotion
from camgeo.mechanism.positions import MonotoneRuns, monotone_runs, position_text
from camgeo.motion.extremes import turning_angles
from camgeo.numeric.arrays import FloatArray, Side, dot, merged
from camgeo.units import TURN

if TYPE_CHECKING:
    from camgeo.mechanism.linkage_protocol import Linkage

DEAD_CENTRE = 1e-9
"""Crank and coupler are at a dead centre within this fraction of their lengths."""

PARALLEL = math.radians(0.1)
"""The coupler counts as parallel to the guide within this angle: printed dimensions are rounded."""


LINES: Final = {
    "slider": ("crank and coupler come to be in line", "the rocker's acceleration"),
    "lever": ("crank and coupler come to be in line", "the rocker's acceleration"),
    "crank": ("the coupler comes to be square to the guide", "the slider's velocity"),
}
"""What a dead centre is and what becomes infinite there, by the member whose motion is demanded."""


def check_linkage(motion: LinkedMotion) -> tuple[Finding, ...]:
    """A dead centre within the motion (no disc), else the distance from one and the smallest angle
    between coupler and crank; a coupler not parallel to the guide (warning).

    That angle has no limit: the force comes from the cam, and what suits the crank need not suit
    the far end.
    """
    runs = monotone_runs(motion.demanded)
    spare = _to_dead_centre(motion, runs)
    if spare.severity == "no-disc":
        return (spare, *_branch(motion.linkage))
    return (spare, _transmission_angle(motion, runs), *_branch(motion.linkage))


def _to_dead_centre(motion: LinkedMotion, runs: MonotoneRuns) -> Finding:
    """The length to spare where the linkage is nearest to a dead centre."""
    linkage = motion.linkage
    position, missing = motion.tightest(runs.range)
    spare = max(0.0, -missing)
    limit = DEAD_CENTRE * (linkage.crank + linkage.coupler)
    phi = runs.first_angle(position)
    what, infinite = LINES[linkage.member]
    place = f"at {position_text(linkage, position)}, cam angle {math.degrees(phi):.6g} deg"
    phi = math.fmod(phi, TURN)
    if spare > limit:
        sentence = f"the linkage stays {spare:.6g} mm clear of a dead centre, nearest {place}"
        return Finding("dead-centre", "ok", sentence, spare, limit, "mm", phi)
    from camgeo.mechanism.closing import clear_range, kept_between  # few linkages reach one

    sentence = f"{what} {place}: a dead centre, {infinite} becomes infinite there"
    # If the motion starts in one, it cannot stay clear of it.
    kept = [] if 0.0 in clear_range(linkage) else kept_between(linkage)
    sentence += f"; {kept[0]} there is none" if kept else ""
    return Finding("dead-centre", "no-disc", sentence, spare, limit, "mm", phi)


def _transmission_angle(motion: LinkedMotion, runs: MonotoneRuns) -> Finding:
    """The smallest acute angle between coupler and crank."""
    value, place = _smallest_sine(motion, runs)
    angle = math.degrees(math.asin(min(1.0, value)))
    statement = (
        f"smallest angle between coupler and crank {angle:.3f} deg at cam angle"
        f" {math.degrees(place):.3f} deg"
    )
    place = math.fmod(place, TURN)
    return Finding(
        "linkage-transmission-angle", "ok", statement, angle, unit="deg", cam_angle=place
    )


def _smallest_sine(motion: LinkedMotion, runs: MonotoneRuns) -> tuple[float, float]:
    """Smallest magnitude of the sine of the angle from crank to coupler, and its cam angle [rad].

    The area of the triangle that crank and coupler close is concave in the square of the pin's
    distance: smallest where that is extreme, as is the missing length. For a slider-driven crank
    the whole turn is searched.
    """
    linkage, demanded = motion.linkage, motion.demanded
    if linkage.member != "crank":
        low, high = runs.range
        positions = np.array([low, high, *linkage.turning_positions(low, high)])
        sines = np.abs(_sine(linkage, positions))
        least = int(np.argmin(sines))
        return float(sines[least]), runs.first_angle(float(positions[least]))

    from camgeo.numeric.extremes import grid_of, piecewise_extremes
    from camgeo.numeric.roots import roots_on_grid

    def sine(phi: FloatArray, side: Side) -> FloatArray:
        return _sine(linkage, demanded.jet(phi, side, 1)[0])

    edges = merged(np.concatenate((demanded.borders, turning_angles(demanded), [0.0, TURN])))
    found = piecewise_extremes(sine, edges)
    if found.lowest.value < 0.0 < found.highest.value:
        crossed = roots_on_grid(lambda phi: sine(phi, "right"), grid_of(edges))
        return 0.0, float(min(crossed, default=found.lowest.place))
    end = found.lowest if found.lowest.value >= 0.0 else found.highest
    return abs(end.value), end.place


def _sine(linkage: Linkage, positions: FloatArray) -> FloatArray:
    """(n,) sine of the angle from crank to coupler at `positions` (n,) [mm or rad]."""
    pin, tip = linkage.joints(positions)
    return dot(pin - tip, 1j * tip) / (linkage.crank * linkage.coupler)


def _branch(linkage: Linkage) -> tuple[Finding, ...]:
    """A warning if the dimensions of a slider-crank are meant for the other branch."""
    tilt, limit = math.degrees(linkage.coupler_tilt), math.degrees(PARALLEL)
    if linkage.coupler_tilt <= PARALLEL:
        return ()
    statement = (
        f"at stroke 0 the coupler is {tilt:.3f} deg off the guide's direction, though the"
        " dimensions are defined for a parallel one: the other `branch` may be meant"
    )
    return (Finding("linkage-branch", "warning", statement, tilt, limit, "deg", cam_angle=0.0),)
