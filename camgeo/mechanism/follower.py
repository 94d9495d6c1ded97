"""What a follower is: from the lift to the roller centre, or to the contact of a flat face.

With W(phi) the roller centre minus the cam axis in the fixed frame and sigma = +1 for a cam that
turns counter-clockwise, the pitch curve in cam coordinates is Z = W exp(-i sigma phi), and

    Z^(k) = R_k exp(-i sigma phi),
    R_0 = W, R_1 = W' - i sigma W, R_2 = W'' - 2 i sigma W' - W,
    R_3 = W''' - 3 i sigma W'' - 3 W' + i sigma W.

Curvature and transmission angle need the R_k only, not the rotation. u and v are the parts of R_1
across and along the follower's own direction: |Z'|^2 = u^2 + v^2, and the transmission angle mu,
the acute angle between rocker (or the normal of the guide) and the normal of the pitch curve, is
tan mu = |u| / |v|.

For a flat face W is the point of contact, so that Z is the cam's own outline; u and v are then the
parts of R_1 that tell the transmission angle, with u^2 + v^2 = |Z'|^2 as well.

The R_k are kept as two real arrays: a third of the cost of complex ones, as most terms are real.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from camgeo.mechanism.kind import Touching, Unit
from camgeo.motion.motion import FULL_ORDER, Jet
from camgeo.numeric.arrays import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class RelativeJet:
    """The roller centre at n cam angles as the turning cam sees it, in axes that do not turn.

    Attributes
    ----------
    along, across : (order + 1, n) parts of R_0, R_1, ... [mm per rad^k] along two axes at right
        angles, the second counter-clockwise of the first.
    axis : angle of the first axis from the x axis [rad].
    u, v : (n,) [mm/rad], see the module.
    turning : (n,) or a number, rate at which the follower's direction turns in the fixed frame,
        per unit cam speed, counter-clockwise; 0 for a guide.
    reach : (n,) or a number, way of the roller centre, or of the follower's point in contact, a
        unit of lift [1 or mm/rad], signed as `Follower.reach`.
    """

    along: FloatArray
    across: FloatArray
    axis: float
    u: FloatArray
    v: FloatArray
    turning: FloatArray | float
    reach: FloatArray | float


@dataclass(frozen=True, slots=True, eq=False)
class TangentJet:
    """Z' in the axes of the follower's own direction, which turns with the rocker.

    R_1 = sigma (u + i w) times the direction across the follower's path. All but u and w themselves
    vanishes in a rest, so that what a small motion does to the curvature keeps its digits.

    Attributes
    ----------
    u, w : (2, n) [mm/rad^k], with their derivatives.
    turning : (n,) rate at which the follower's direction turns in the fixed frame, per unit cam
        speed, counter-clockwise; 0 for a guide.
    swerve : (n,) [mm^2/rad^3] sigma (u w'' - w u'') + u u' + w w' + sigma turning' |Z'|^2, in which
        all that is linear in the follower's acceleration has cancelled.
    """

    u: FloatArray
    w: FloatArray
    turning: FloatArray
    swerve: FloatArray


class Follower(Protocol):
    """A follower; lengths in mm.

    Attributes
    ----------
    base_radius : r_G, cam axis to roller centre, or square across to a flat face, at cam angle 0.
    roller_radius : r_R; 0 for a flat face, whose contact is the curve itself.
    reach : way of the roller centre a unit of lift [1 or mm/rad], positive if a positive lift moves
        the rocker counter-clockwise, or the roller outward along the guide. Of a flat face that
        rocks, whose contact wanders, the one at cam angle 0 if the cam rests there.
    lift_unit : of its lift.
    touching : what of it touches the cam, "roller" or "face", as sentences call it.
    pivot : what it swings about, seen from the cam axis, complex [mm]; None on a guide.
    rocks : whether it swings about a pivot, its lift an angle; else it slides along a guide.
    is_flat : whether a flat face touches the cam; else a roller does.
    ahead : derivatives of the lift that R_k takes beyond the k-th. A flat face takes one, so that
        it has no R_3: a motion has three.
    """

    @property
    def base_radius(self) -> float: ...

    @property
    def reach(self) -> float: ...

    @property
    def roller_radius(self) -> float: ...

    @property
    def lift_unit(self) -> Unit: ...

    @property
    def touching(self) -> Touching: ...

    @property
    def pivot(self) -> complex | None: ...

    @property
    def rocks(self) -> bool: ...

    @property
    def is_flat(self) -> bool: ...

    @property
    def ahead(self) -> int: ...

    def relative_jet(self, jet: Jet, rotation: int, order: int = FULL_ORDER) -> RelativeJet:
        """R_0 to R_`order`, order at least 1, for lifts `jet` (order + 1 or more, n).

        As far as there are any: `ahead` rows more of the lift are needed, up to the third.
        `rotation` is sigma, +1 for a cam that turns counter-clockwise, -1 clockwise.
        """

    def tangent_jet(self, jet: Jet, rotation: int) -> TangentJet:
        """Z' in the follower's own axes for lifts `jet` (4, n), `rotation` as above."""

    def speed_bounds(self, jet: Jet, bounds: Jet, half: FloatArray, rotation: int) -> FloatArray:
        """(3, n) upper bounds of |Z'|, |Z''|, |Z'''| [mm/rad^k] over cells of cam angle.

        `jet` is the lift in the middle of the cells, `bounds` as of `Motion.jet_and_bounds`, `half`
        (n,) half their widths [rad]. Where there is no Z''' the third one says how far Z'' may be
        off its value in the middle, see `camgeo.mechanism.face`.
        """
