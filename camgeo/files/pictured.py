"""A cam as pictures show it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from camgeo.cam.contact import Contact
from camgeo.errors import GeometryError
from camgeo.files.moving import LIFT, PicturedMotion
from camgeo.files.skeleton import face_ends, skeleton
from camgeo.files.sketch import CutOff, FollowerSketch, cut_off_sketches
from camgeo.mechanism.sketch import MechanismSketch
from camgeo.numeric.arrays import FloatArray

if TYPE_CHECKING:
    from camgeo.cam.cam import Cam
    from camgeo.effects.effect import Column


@dataclass(frozen=True)
class PicturedCam(PicturedMotion):
    """What pictures show of a cam.

    Attributes
    ----------
    cam : the cam.
    returning : the return cam of a conjugate pair, of the same mechanism; None if there is none.
    columns : gives the effects over the cam angle.
    """

    cam: Cam
    returning: Cam | None
    columns: Callable[[], tuple[Column, ...]]

    @property
    def contact(self) -> Contact:
        """The flank on which the follower runs."""
        return self.cam.contact

    @property
    def rotation(self) -> int:
        """Sense in which the disc turns: +1 counter-clockwise, -1 clockwise."""
        return self.cam.rotation

    @property
    def roller_radius(self) -> float:
        """r_R [mm]; 0 for a knife edge and for a flat face."""
        return self.cam.follower.roller_radius

    @property
    def flank_distance(self) -> float:
        """Distance of either flank from the pitch curve [mm]: r_R, or half the groove's width."""
        return self.cam.disc.flank_distance

    @property
    def has_pitch_curve(self) -> bool:
        """False of a flat face, whose contact runs on the outline itself."""
        return self.cam.follower.has_pitch_curve

    @property
    def joints(self) -> tuple[float, ...]:
        """Cam angles [rad] at which the segments of the motion plan begin, from 0 upwards."""
        return self.cam.drive.joints

    @property
    def far_angle(self) -> float:
        """The first cam angle [rad] at which the demanded motion is farthest from its start."""
        return self.cam.drive.far_angle

    @property
    def effect_columns(self) -> tuple[Column, ...]:
        """The effects over the cam angle; nothing of those that have no answer."""
        return self.columns()

    def curve(self, what: str, phi: FloatArray) -> FloatArray:
        """(n, 2) [mm] points of "pitch", "inner" or "outer" at `phi` (n,) [rad]."""
        points = getattr(self.cam.disc, f"{what}_curve").point(phi)
        return np.column_stack((points.real, points.imag))

    def quantity(self, what: str, phi: FloatArray) -> FloatArray:
        """(n,) values at `phi` (n,) [rad]: those of a motion, "transmission_angle" [rad], and
        "curvature" [1/mm].
        """
        if what in LIFT:
            return super().quantity(what, phi)
        curve = self.cam.disc.pitch_curve
        of = {"transmission_angle": curve.transmission_angle, "curvature": curve.curvature}
        return of[what](phi)

    @property
    def follower_sketch(self) -> FollowerSketch:
        """Where the follower is held."""
        return FollowerSketch(*self.cam.follower.held(face_ends(self.cam.disc.pitch_curve)))

    def mechanism_sketch(self, phi: float) -> MechanismSketch:
        """The mechanism at the cam angle `phi` [rad]."""
        other = None if self.returning is None else self.returning.follower
        return skeleton(self.cam, other, phi)

    @property
    def cut_off(self) -> tuple[CutOff, ...]:
        """Where the flanks in use are cut off; empty also if it cannot be told what is left."""
        found: list[CutOff] = []
        for name, curve in self.cam.disc.flanks:
            try:
                outline = self.cam.disc.outline(name)
            except GeometryError:  # which the findings tell
                continue
            found += cut_off_sketches(curve, outline, name)
        return tuple(found)
