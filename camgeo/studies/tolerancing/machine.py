"""The machine that a cam is put into, on the flank that the cam was made with.

With R the place on the cam, in the frame, of what touches it, n the unit normal there and W the
same place on the follower, contact is R = W; a flat face touches where it is tangent. Where R is
displaced by dR and W, at the same lift, by dW, virtual displacements give

    dq = n . (dR - dW) / (n . dW/dq),

q the lift; n . dW/dq is `PitchCurve.leverage`, in which the transmission angle is. So a roller that
is too large, whose centre is pushed outward, raises it by its excess over the leverage.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camgeo.cam.cam import Cam
from camgeo.errors import GeometryError
from camgeo.geometry.outline.path import Flank
from camgeo.kinematics.mechanism.linkage import Linkage
from camgeo.numeric.arrays import ComplexArray, FloatArray, dot
from camgeo.studies.tolerancing.sources import Hold, Pose


@dataclass(frozen=True)
class Machine:
    """The nominal machine, where one flank carries the follower.

    Attributes
    ----------
    cam : of one disc.
    flank : that carries the follower.
    hold : the side that it is of a follower that two sides hold: the main disc or the return disc
        of a pair, or the first or the second side of a yoke.
    """

    cam: Cam
    flank: Flank
    hold: Hold = Hold.ANY

    def __post_init__(self) -> None:
        if self.flank not in self.cam.contact.flanks:
            used = " or ".join(f'"{each}"' for each in self.cam.contact.flanks)
            message = f"is not where the follower runs; must be {used}"
            raise GeometryError(message, "tolerance.flank", self.flank)

    def require_whole(self) -> None:
        """GeometryError if the flank is not the whole curve: at its corners the follower's motion
        is no smooth function of any dimension.
        """
        outline = self.cam.disc.outline(self.flank)
        if outline.is_trimmed or not outline.path.is_whole:
            raise GeometryError(
                f"the {self.flank} flank of this {self.cam.follower.kind} follower has corners, by"
                " undercut or by a jump of the velocity: tolerances are analysed for flanks that"
                " are one smooth curve all round; `camgeo check` says what removes the corners,"
                " `camgeo replay` what the follower does there",
                key="follower",
            )

    @property
    def half_turn(self) -> bool:
        """Whether it is the side of a yoke that runs half a turn behind the first."""
        return self.hold is Hold.RETURN and self.cam.yoke is not None

    @property
    def linkage(self) -> Linkage | None:
        """Behind the follower."""
        return self.cam.drive.linkage

    @cached_property
    def pose(self) -> Pose:
        """Of the roller's centre, or of the foot of the cam axis on a flat face, with the lift."""
        follower = self.cam.follower
        start, centre, way = (
            np.full((1, 1), each, complex)
            for each in (follower.traced_point(0.0), follower.pivot or 0.0, follower.way)
        )
        return Pose(start, centre, float(follower.swing_sense), way)

    def nominal(self, phi: FloatArray) -> Nominal:
        """The contact at the cam angles `phi` (n,) [rad], right-hand.

        Raises GeometryError where the roller centre stands still in the cam.
        """
        pitch = self.cam.disc.pitch_curve
        relative = pitch.relative_jet(phi, order=1)
        places, rates = pitch.in_cam(relative, phi, relative.along[:2], relative.across[:2])
        leverage = pitch.leverage(phi)
        if np.any(leverage == 0.0):
            place = float(np.degrees(phi[np.argmin(np.abs(leverage))]))
            message = f"the cam cannot move the follower at cam angle {place:.6g} deg"
            raise GeometryError(f"{message}: its position there is no function of any dimension")
        normals = 1j * pitch.rotation * rates / pitch.speed(relative)
        turn = np.exp(1j * pitch.rotation * phi)
        return Nominal(phi, places * turn, normals * turn, turn, leverage)


@dataclass(frozen=True, slots=True, eq=False)
class Nominal:
    """The contact of the nominal machine at n cam angles.

    Attributes
    ----------
    phi : (n,) [rad].
    places : (n,) W [mm], in the frame.
    normals : (n,) n, outward, in the frame.
    turn : (n,) exp(i sigma phi), from the axes of the cam to those of the frame.
    leverage : (n,) n . dW/dq [1 or mm/rad].
    """

    phi: FloatArray
    places: ComplexArray
    normals: ComplexArray
    turn: ComplexArray
    leverage: FloatArray

    def across(self, displacement: ComplexArray | complex) -> FloatArray:
        """(n,) [mm] part of a displacement in the frame along the normals."""
        return dot(self.normals, displacement)
