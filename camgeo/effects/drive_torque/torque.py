"""The torque over the cam angle at the speed of the scene, and its static part."""

from __future__ import annotations

from dataclasses import dataclass

from camgeo.effects.drive_torque.law import TorqueLaw
from camgeo.effects.effect import Result
from camgeo.motion.motion import Side
from camgeo.motion.time_course import TimeCourse
from camgeo.numeric.arrays import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class DriveTorque(Result):
    """The torque on the camshaft.

    Attributes
    ----------
    law : the torque as a law of cam angle, speed and acceleration.
    course : how the cam turns; None if the scene gives no speed, then it stands all but still.
    edges, static_edges : (k,) cam angles [rad] from 0 to 2 pi, ascending; between two of them the
        torque, or its static part, is smooth.
    """

    law: TorqueLaw
    course: TimeCourse | None
    edges: FloatArray
    static_edges: FloatArray

    def torque(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) [N mm] with the cam turning as the scene says."""
        if self.course is None:
            return self.static(phi, side)
        omega, alpha = self.course.rates(phi)[:2]
        return self.law.at(phi, side, omega, alpha)

    def static(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) [N mm] with the cam turning very slowly: without inertia and viscous friction."""
        return self.law.at(phi, side, 0.0, 0.0)

    def dynamic(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) [N mm] what the speed adds to the static part."""
        return self.torque(phi, side) - self.static(phi, side)
