"""What of a design decides undercut, and how far it is from it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from camgeo.check.follower import check_follower
from camgeo.check.standstill import check_standstill
from camgeo.curve.curvature import curvature_extremes
from camgeo.curve.extremes import Extremes
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.curve.working_curve import WorkingCurve
from camgeo.errors import GeometryError
from camgeo.mechanism.linkage import LinkedMotion
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.mechanism.translating_roller import TranslatingRoller
from camgeo.motion.motion import Motion
from camgeo.motion.plan import SNAP, MotionPlan
from camgeo.numeric.arrays import FloatArray
from camgeo.outline.cusps import CUSP
from camgeo.units import TURN

if TYPE_CHECKING:
    from camgeo.mechanism.linkage_protocol import Linkage

Flanks = tuple[WorkingCurve, ...]

Pairs = tuple[tuple[float, float], ...]
"""Crossings of the flanks in use, each by the two cam angles [rad] in [0, 2 pi)."""

Crossed = Callable[[Flanks], Pairs]
"""Finds the crossings of the flanks in use; asked only where these are regular."""


@dataclass(frozen=True, slots=True)
class Cam:
    """The parts of a specification that decide undercut.

    Attributes
    ----------
    plan : the motion demanded, the slider's if there is a linkage.
    linkage : between slider and rocker, or None.
    follower : the roller follower.
    rotation : +1 for a cam that turns counter-clockwise, -1 clockwise.
    contact : the flank on which the roller runs; both for a groove.
    clearance : groove's width less the roller's diameter [mm].
    """

    plan: MotionPlan
    linkage: Linkage | None
    follower: TranslatingRoller | OscillatingRoller
    rotation: int
    contact: Literal["inner", "outer", "groove"]
    clearance: float = 0.0
    _made: Motion | None = field(default=None, repr=False, compare=False)

    @property
    def motion(self) -> Motion:
        """The follower's own motion; GeometryError if the linkage does not close."""
        if self._made is not None:
            return self._made
        return self.plan if self.linkage is None else LinkedMotion(self.plan, self.linkage)

    def pitch_curve(self) -> PitchCurve:
        """The pitch curve; GeometryError if the linkage does not close."""
        return PitchCurve(self.motion, self.follower, self.rotation)

    @property
    def distances(self) -> tuple[float, ...]:
        """d [mm] of each flank in use: negative for the inner one, positive for the outer one."""
        half = self.flank_distance
        return {"inner": (-half,), "outer": (half,), "groove": (-half, half)}[self.contact]

    @property
    def flank_distance(self) -> float:
        """Distance of either flank from the pitch curve [mm]: r_R, or half the groove's width."""
        return self.follower.roller_radius + 0.5 * self.clearance

    def flanks(self) -> Flanks:
        """The working curves in use."""
        pitch = self.pitch_curve()
        return tuple(WorkingCurve(pitch, distance) for distance in self.distances)

    def sized(self, **sizes: float) -> Cam:
        """The same cam with other dimensions of the follower; GeometryError if it has none.

        The motion, whose linkage is looked at all round when it is made, is made once.
        """
        changes: dict[str, Any] = dict(sizes)
        return replace(self, follower=replace(self.follower, **changes), _made=self.motion)

    def moved(self, plan: MotionPlan) -> Cam:
        """The same cam with another motion plan."""
        return replace(self, plan=plan, _made=None)


def margin(cam: Cam) -> float | None:
    """Smallest 1 + d kappa over the flanks in use; positive without cusp and local undercut.

    None if there is no such mechanism: it does not close, its roller covers the cam axis, its guide
    touches the base circle, or its roller centre stands still at an angle that is looked at.
    """
    bends = bends_of(cam)
    return None if bends is None else float(np.min(margins(cam, bends)))


def bends_of(cam: Cam) -> Extremes | None:
    """The extremes of the pitch curve's curvature; None as of `margin`."""
    inner = cam.contact != "outer"
    if check_follower(cam.follower, runs_on_inner=inner, clearance=cam.clearance):
        return None
    try:
        return curvature_extremes(cam.pitch_curve())
    except GeometryError:
        return None


def margins(cam: Cam, bends: Extremes) -> FloatArray:
    """The smaller 1 + d kappa (k,) of the flanks in use at the places of `bends`."""
    every = [1.0 + distance * bends.values for distance in cam.distances]
    return np.asarray(np.min(every, axis=0))


def margin_within(cam: Cam, bends: Extremes, start: float, end: float) -> float:
    """Smallest 1 + d kappa over the cam angles [start, end] [rad], its ends seen from inside.

    `start` and `end` are breaks, or the ends of a rest.
    """
    shift = TURN if start < bends.phi[0] - SNAP else 0.0
    first = int(np.searchsorted(bends.phi, start + shift + SNAP, side="right")) - 1
    last = int(np.searchsorted(bends.phi, end + shift - SNAP, side="left"))
    return float(np.min(margins(cam, bends)[max(first, 0) : last + 1]))


def crossings_of(cam: Cam, crossed: Crossed) -> Pairs | None:
    """The crossings of the flanks in use: none of a sound cam.

    None if there is worse: no mechanism, cusp, local undercut, standstill, or crossings that
    cannot be decided.
    """
    least = margin(cam)
    if least is None or least <= CUSP:
        return None
    flanks = cam.flanks()
    if check_standstill(flanks[0].pitch):
        return None
    try:
        return crossed(flanks)
    except GeometryError:
        return None


def is_sound(cam: Cam, crossed: Crossed) -> bool:
    """True if the cam exists without cusp, undercut, crossing or standstill, and that is sure."""
    return crossings_of(cam, crossed) == ()


def crossings(flanks: Flanks) -> Pairs:
    """The crossings of each flank with itself, see `camgeo.outline.crossings`."""
    from camgeo.outline.crossings import find_crossings  # only a regular flank asks for them

    return tuple((each.first, each.second) for flank in flanks for each in find_crossings(flank))
