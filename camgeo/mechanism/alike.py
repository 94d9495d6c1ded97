"""What followers have in common that are held alike, or that touch the cam alike.

Bases of the followers of this package; a follower of its own answers `Follower` without them.
"""

from __future__ import annotations

import cmath
import math
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from camgeo.mechanism.drawn import carriage
from camgeo.mechanism.face import STANDSTILL as FACE_STANDSTILL
from camgeo.mechanism.follower import (
    STANDSTILL,
    RelativeJet,
    bend_of_envelope,
    bend_of_path,
    radius_under_roller,
)
from camgeo.mechanism.kind import Mover, Touching, Unit
from camgeo.mechanism.sketch import MechanismSketch
from camgeo.motion.motion import Jet
from camgeo.numeric.arrays import FloatArray

if TYPE_CHECKING:
    from camgeo.mechanism.follower import Follower


class Guided:
    """A follower that slides along a straight guide."""

    __slots__ = ()

    if TYPE_CHECKING:

        @property
        def base_radius(self) -> float: ...

        @property
        def guide_angle(self) -> float: ...

        @property
        def direction(self) -> int: ...

    lift_unit: ClassVar[Unit] = "mm"
    mover: ClassVar[Mover] = "follower"
    pivot: ClassVar[None] = None
    swing_sense: ClassVar[int] = 0
    farthest: ClassVar[float] = math.inf

    @property
    def lift_scale(self) -> float:
        """See `Follower`."""
        return self.base_radius

    @property
    def reach(self) -> float:
        """See `Follower`: kappa_F."""
        return float(self.direction)

    @property
    def out(self) -> complex:
        """Direction of the guide away from the cam."""
        return cmath.exp(1j * self.guide_angle)

    @property
    def way(self) -> complex:
        """See `Follower`."""
        return self.direction * self.out

    def linked_at(self, farthest: float) -> tuple[complex, complex]:
        """See `Follower.linked_at`: the end of its rod."""
        own: Follower = self  # type: ignore[assignment]
        _, rod = carriage(own, self.out, 0.0, farthest)
        return rod.links[0][-1], self.way


class Rocking:
    """A follower that swings about a fixed pivot."""

    __slots__ = ()

    if TYPE_CHECKING:

        @property
        def pivot(self) -> complex: ...

        @property
        def arm_side(self) -> int: ...

        @property
        def direction(self) -> int | None: ...

    lift_unit: ClassVar[Unit] = "rad"
    mover: ClassVar[Mover] = "rocker"
    offset: ClassVar[float] = 0.0
    lift_scale: ClassVar[float] = 1.0
    way: ClassVar[complex] = 0j

    @property
    def centre_distance(self) -> float:
        """l_1, cam axis to pivot [mm]."""
        return abs(self.pivot)

    @property
    def swing_sense(self) -> int:
        """Sense in which a positive lift turns the rocker: +1 counter-clockwise, -1 clockwise."""
        return 1 if self.direction is None else self.direction * self.arm_side

    def linked_at(self, _: float) -> tuple[complex, complex]:
        """See `Follower.linked_at`."""
        return self.pivot, 0j

    def far_side(self, _: float, __: tuple[float, float], ___: float) -> MechanismSketch:
        """See `Follower.far_side`."""
        return MechanismSketch()


class Rolling:
    """A follower with a roller, or with a knife edge, a roller of radius 0."""

    __slots__ = ()

    if TYPE_CHECKING:

        @property
        def roller_radius(self) -> float: ...

    touching: ClassVar[Touching] = "roller"
    rolls: ClassVar[bool] = True
    has_pitch_curve: ClassVar[bool] = True
    standstill: ClassVar[str] = STANDSTILL
    ahead: ClassVar[int] = 0
    face: ClassVar[tuple[float, float]] = (0.0, 0.0)

    @property
    def has_edge(self) -> bool:
        """See `Follower`."""
        return self.roller_radius == 0.0

    def curvature(self, relative: RelativeJet, speed: FloatArray, rotation: int) -> FloatArray:
        """See `Follower.curvature`."""
        return bend_of_path(relative, speed, rotation)

    def contact_radius(self, kappa: FloatArray, half: float) -> FloatArray:
        """See `Follower.contact_radius`."""
        return radius_under_roller(self.roller_radius, kappa, half)

    def sliding(self, jet: Jet, _: int) -> FloatArray:
        """See `Follower.sliding`: a roller rolls."""
        return np.zeros(jet.shape[1])


class Flat:
    """A follower with a flat face."""

    __slots__ = ()

    touching: ClassVar[Touching] = "face"
    rolls: ClassVar[bool] = False
    has_edge: ClassVar[bool] = False
    has_pitch_curve: ClassVar[bool] = False
    standstill: ClassVar[str] = FACE_STANDSTILL
    ahead: ClassVar[int] = 1
    roller_radius: ClassVar[float] = 0.0
    offset: ClassVar[float] = 0.0

    def curvature(self, relative: RelativeJet, speed: FloatArray, rotation: int) -> FloatArray:
        """See `Follower.curvature`."""
        return bend_of_envelope(relative, speed, rotation)

    def contact_radius(self, kappa: FloatArray, _: float) -> FloatArray:
        """See `Follower.contact_radius`: a face adds no curvature."""
        return 1.0 / kappa

    def on_one_side(self, _: FloatArray) -> bool:
        """See `Follower.on_one_side`."""
        return False

    def beside(self, _: complex, __: float, ___: float) -> MechanismSketch:
        """See `Follower.beside`."""
        return MechanismSketch()
