"""A cam whose axis is to be placed beside its follower, whatever touches the cam.

A place is a complex number [mm] in axes in which the follower starts in a fixed position, which
each kind states.
"""

from __future__ import annotations

import cmath
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Self

from camgeo.cam.cam import Cam
from camgeo.check.finding import forbidding
from camgeo.check.judge import linkage_findings
from camgeo.check.limits import Limits
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.motion.motion import Motion


@dataclass(frozen=True, slots=True)
class Placing(ABC):
    """See the module.

    Attributes
    ----------
    cam : the present design; all dimensions of the follower that are not placed are kept.
    second : the quantity that, with the base radius, determines a place.
    held : the pivot [mm]; None on a guide.
    present : place of the cam axis in the present design [mm].
    seen : signs of x and y in a picture for the real and the imaginary part of a place.
    """

    cam: Cam

    second: ClassVar[str]
    held: ClassVar[complex | None]

    if TYPE_CHECKING:  # that every kind has

        @property
        def seen(self) -> tuple[int, int]: ...

    @property
    @abstractmethod
    def present(self) -> complex:
        """See the class."""

    @abstractmethod
    def second_of(self, place: complex) -> float:
        """The `second` quantity [mm] at `place`."""

    @abstractmethod
    def base_radius_at(self, place: complex) -> float:
        """r_G [mm] with the cam axis at `place`."""

    @abstractmethod
    def moved(self, place: complex) -> dict[str, float | complex]:
        """Values [mm] of the follower, by its scene's keys, with the cam axis at `place`."""

    @property
    def motion(self) -> Motion:
        """The follower's own motion [mm or rad]."""
        return self.cam.drive.motion

    @property
    def follower(self) -> Any:
        """The follower of the present design."""
        return self.cam.follower

    @property
    def arm_side(self) -> int | None:
        """The side of a rocker's arm; None on a guide."""
        side: int = self.follower.arm_side if self.held is not None else 0
        return side or None

    @property
    def hopeless(self) -> str | None:
        """Why no size will do, if the linkage is at fault; else None."""
        found = forbidding(linkage_findings(self.cam.drive, Limits()))
        return found[0].sentence if found else None

    @property
    def sides(self) -> tuple[Self, ...]:
        """The task itself, and a rocker also on the other side of the line pivot -> cam axis.

        On a guide there is nothing else to find: its mirror image is another offset.
        """
        if self.arm_side is None:
            return (self,)
        return self, replace(self, cam=self.cam.sized(arm_side=-self.arm_side))

    def lengths_at(self, place: complex) -> dict[str, float | complex]:
        """All lengths of the follower [mm] that `place` decides, by their scene's keys."""
        return {"base_radius": self.base_radius_at(place), **self.moved(place)}

    def cam_at(self, place: complex) -> Cam:
        """The cam with its axis at `place`; a rocker keeps the direction of its pivot.

        GeometryError if there is no such mechanism.
        """
        return self.cam.sized(**self.lengths_at(place))

    def follower_at(self, place: complex) -> Any:
        """The follower of `cam_at`."""
        return replace(self.follower, **self.lengths_at(place))

    def pitch_curve_at(self, place: complex) -> PitchCurve:
        """The pitch curve of `cam_at`."""
        return PitchCurve(self.motion, self.follower_at(place), self.cam.rotation)


class Rocking(Placing):
    """Beside a rocker: its pivot is the origin, the follower starts along the x axis, and the axes
    are mirrored if it lies clockwise of the line pivot -> cam axis.
    """

    __slots__ = ()

    second = "pivot at"
    held = 0j

    @property
    def present(self) -> complex:
        """See `Placing`."""
        return cmath.rect(self.follower.centre_distance, -self.follower.start_angle)

    @property
    def seen(self) -> tuple[int, int]:
        """See `Placing`."""
        return 1, self.follower.arm_side

    def second_of(self, place: complex) -> float:
        """See `Placing`: the distance of the pivot from the cam axis."""
        return abs(place)
