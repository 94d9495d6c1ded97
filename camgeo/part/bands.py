"""The faces around a part: upright ones, and chamfers at their ends."""

from __future__ import annotations

from dataclasses import dataclass

from camgeo.numeric.checked import finite, hold, instance, positive
from camgeo.part.boundary import Boundary, require_boundary


@dataclass(frozen=True, slots=True)
class Bevel:
    """A chamfer along one end of a wall.

    Attributes
    ----------
    boundary : that of the wall.
    edge : where the chamfer meets the flat face, the parallel of the boundary at `width`.
    width : on the face [mm].
    height : along the wall [mm].
    z : height of the face [mm].
    upper : whether the face is the upper end of the wall.
    """

    boundary: Boundary
    edge: Boundary
    width: float
    height: float
    z: float
    upper: bool

    def __post_init__(self) -> None:
        for each in (self.boundary, self.edge):
            require_boundary(each)
        hold(self, width=positive("part", self.width, "mm"), z=finite("part", self.z, "mm"))
        hold(self, height=positive("part", self.height, "mm"))
        instance("part", self.upper, bool, "true or false")

    @property
    def foot(self) -> float:
        """Height at which it meets the wall [mm]."""
        return self.z - self.height if self.upper else self.z + self.height


@dataclass(frozen=True, slots=True)
class Band:
    """The face around a part between two heights: what chamfers leave of a wall, or a chamfer.

    Attributes
    ----------
    wall : the boundary that the face runs along.
    lower, upper : its edges, the same for an upright face.
    z0, z1 : their heights [mm].
    width : of a chamfer, in the plane [mm]; 0 of an upright face.
    """

    wall: Boundary
    lower: Boundary
    upper: Boundary
    z0: float
    z1: float
    width: float = 0.0

    @property
    def is_upright(self) -> bool:
        """Whether it is no chamfer."""
        return self.lower is self.upper

    def section(self, z: float) -> Boundary:
        """Its section at a height between both [mm]."""
        if self.is_upright:
            return self.wall
        away = self.z1 - z if self.lower is not self.wall else z - self.z0
        distance = self.width * away / (self.z1 - self.z0)
        return self.wall.inset(distance, f"section of the {self.wall.name}")
