"""What flat faces have in common: the support function of the cam, and its envelope.

The face is the line Re(conj(n) F) = h in the fixed frame, n = exp(i nu) its normal away from the
cam axis and h its distance from it. In the cam the normal has the angle theta = nu - sigma phi, and
the point of contact follows from the face and its rate, theta' = nu' - sigma:

    Z = (h + i h'/theta') exp(i theta).

With the rotation tau = 1 - sigma nu' of the normal in the cam, against the sense in which the
cam turns,

    Z' = p t, t = -i sigma exp(i theta), p = tau h + (h'/tau)',

so that rho = p / tau is the signed radius of curvature of the outline. The cam is convex, and the
face can touch it everywhere, where tau > 0 and p > 0; p = 0 is a cusp, p < 0 undercut, and where
tau <= 0 the face turns back in the cam.

How Z''' is bounded though it does not exist. Z'' contains the third derivative of the lift, and a
motion has no derivative of that. Let |Z''(x) - Z''(m)| <= A |x - m| + D over a cell of half-width
H about its middle m: A from all that is smooth, D from the change of the third derivative. What is
returned for |Z'''| is V = A + 3 D / H. Everything it is used for still holds:

- The remainder of the parabola that Z osculates in the middle is at most A H^3/6 + D H^2/2, which
  is V H^3/6.
- Z' is off the straight line of its parabola by at most A H^2/2 + D H <= V H^2/2.
- Z'' changes by at most A H + D <= V H.

The same three hold for a scalar product of Z with a fixed vector, for its distance from a point and
for the direction of Z', whose other parts are smooth: there A is the part that needs no Z'''.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, cast

import numpy as np

from camgeo.errors import GeometryError
from camgeo.kinematics.mechanism.follower import Follower, RelativeJet
from camgeo.kinematics.mechanism.sketch import MechanismSketch, Places
from camgeo.kinematics.mechanism.values import coordinate
from camgeo.kinematics.motion import FULL_ORDER, Jet
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.numeric.checked import shown

HIGHEST = FULL_ORDER - 1
"""Order of the highest derivative of Z: each needs one more derivative of the lift."""


@dataclass(frozen=True, slots=True, eq=False)
class Touch:
    """A flat face and its contact at n cam angles.

    Attributes
    ----------
    distance : (n,) h [mm], cam axis to face.
    contact : (2, n) [mm/rad^k] place of the contact along the face, and its derivative, see
        `FlatFollower`.
    turn : (2, n) tau and tau' [1/rad]; tau is positive where the face turns forward in the cam.
    pace : (2, n) [mm/rad^k] p and p'; p is infinite where tau = 0.
    """

    distance: FloatArray
    contact: FloatArray
    turn: FloatArray
    pace: FloatArray


class FlatFollower(Follower):
    """A follower with a flat face; its `face` is measured as `Touch.contact` is.

    Attributes
    ----------
    origin : where the position of the contact is measured from, in words.
    least_place : position of the contact [mm] at and below which the cam cannot move the follower.
    raised_by : keys of the lengths that, increased by the same amount, move the face out by it.
    facing : +1 if the position of the contact is positive to the right, looking along the normal
        away from the cam axis, -1 to the left.
    """

    __slots__ = ()

    touching = "face"
    roller_radius = 0.0
    offset = 0.0
    rolls = False
    has_edge = False
    has_pitch_curve = False
    standstill = (
        "the contact of the flat face stands still in the turning cam (Z' = 0): the outline has a"
        " cusp and no normal there"
    )
    ahead = 1

    origin: ClassVar[str]
    least_place: ClassVar[float]
    raised_by: ClassVar[tuple[str, ...]]

    @property
    @abstractmethod
    def facing(self) -> int:
        """See the class."""

    @abstractmethod
    def normal(self, lift: FloatArray) -> ComplexArray:
        """(n,) unit normals of the face away from the cam axis at lifts (n,), in the frame."""

    @abstractmethod
    def touch(self, jet: Jet, rotation: int) -> Touch:
        """The contact for lifts `jet` (4, n); `rotation` as of `Follower.relative_jet`."""

    def curvature(self, relative: RelativeJet, speed: FloatArray, rotation: int) -> FloatArray:
        """See `Follower.curvature`: of the envelope of the face, which is its tangent.

        Nothing cancels where the face nearly stands still in the cam and Z'' is large.
        """
        kappa: FloatArray = (1.0 - rotation * relative.turning) / speed
        return kappa

    def contact_radius(self, kappa: FloatArray, _: float) -> FloatArray:
        """See `Follower.contact_radius`: a face adds no curvature."""
        return 1.0 / kappa

    def on_one_side(self, _: FloatArray) -> bool:
        """See `Follower.on_one_side`."""
        return False

    def return_sketch(self, _: ComplexArray, __: FloatArray, ___: float) -> MechanismSketch[Places]:
        """See `Follower.return_sketch`."""
        return MechanismSketch()


def spread(change: FloatArray, half: FloatArray) -> FloatArray:
    """(n,) 3 D / H, see the module; 0 for cells of zero width, in which nothing changes."""
    return np.divide(3.0 * change, half, out=np.zeros_like(change), where=half > 0.0)


def face_ends(key: str, face: Any) -> tuple[float, float]:
    """Where a face begins and ends [mm]; GeometryError unless it ends beyond its beginning."""
    if not isinstance(face, tuple | list) or len(face) != 2:
        raise GeometryError("must be two lengths, (from, to)", key, shown(face))
    start, end = (coordinate(key, each) for each in face)
    if not start < end:
        raise GeometryError("must end beyond where it begins", key, shown(face))
    return start, end


FaceEnds = Annotated[tuple[float, float], face_ends]


def face_line(
    start: ComplexArray, along: ComplexArray, ends: tuple[float, float]
) -> tuple[ComplexArray, ComplexArray]:
    """The ends of a face [mm] that is measured from `start` in the direction `along`; all (n,)."""
    return start + along * ends[0], start + along * ends[1]


def flat_follower(follower: Follower) -> FlatFollower:
    """`follower`, which has a flat face; GeometryError with key "follower.kind" if it has none."""
    if not hasattr(follower, "touch"):
        message = "this needs a flat-faced follower, and this one has a roller"
        raise GeometryError(message, key="follower.kind")
    return cast("FlatFollower", follower)
