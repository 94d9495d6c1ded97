"""The curve on which machines touch the cam: the pitch curve, grown and waved.

With the pitch curve Z(u), its unit tangent t and normal N = i sigma t, its pace v = |Z'| and its
curvature kappa, P = Z + c N has

    P'  = v (1 + c kappa) t + c' N,
    P'' = (v' (1 + c kappa) + v c kappa' + 2 v c' kappa) t + (c'' - v^2 kappa (1 + c kappa)) N.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.curve.pitch_curve import PitchCurve, curvature_slope
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import ComplexArray, FloatArray, dot
from camgeo.tolerancing.freedoms import Deviations, Way


@dataclass(frozen=True, slots=True, eq=False)
class FlankCurve:
    """The curves of m machines.

    Attributes
    ----------
    pitch : the nominal one.
    deviations : of the machines.
    """

    pitch: PitchCurve
    deviations: Deviations

    def at(self, u: FloatArray) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """(m, n) each: P [mm] and two derivatives at the parameters u (m, n) [rad].

        Raises
        ------
        GeometryError
            Where a roller that is too large, or waves, undercut.
        """
        pitch, angles = self.pitch, u.ravel()
        follower, rotation = pitch.follower, pitch.rotation
        motion = pitch.motion.jet(angles)
        relative = follower.relative_jet(motion, rotation, 2)
        jet = pitch.in_cam(relative, angles, relative.along[:3], relative.across[:3])
        z, z1, z2 = jet.reshape(3, *u.shape)
        grown = self._growth(u)
        if grown is None:
            return z, z1, z2
        c, c1, c2 = grown
        v = np.abs(z1)
        kappa = follower.curvature(relative, v.ravel(), rotation).reshape(u.shape)
        slope = curvature_slope(follower.tangent_jet(motion, rotation), rotation).reshape(u.shape)
        t = z1 / v
        normal = 1j * rotation * t
        whole = 1.0 + c * kappa
        if not np.all(whole > 0.0):
            raise GeometryError(
                "within the tolerances the follower undercuts: a larger roller or a wave of the"
                " flank leaves no smooth curve; make the tolerances, or the waves, smaller"
            )
        first = v * whole * t + c1 * normal
        second = (dot(t, z2) * whole + v * c * slope + 2.0 * v * c1 * kappa) * t
        second += (c2 - v * v * kappa * whole) * normal
        return z + c * normal, first, second

    def _growth(self, u: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray] | None:
        """c [mm] and two derivatives; None if there is none anywhere."""
        growth, waves = self.deviations.real(Way.GROWTH), self.deviations.waves
        if not waves and not np.any(growth):
            return None
        c, c1, c2 = growth + np.zeros_like(u), np.zeros_like(u), np.zeros_like(u)
        for k, amplitude in waves.items():
            wave = amplitude * np.exp(-1j * k * u)
            c += wave.real
            c1 += k * wave.imag
            c2 -= k * k * wave.real
        return c, c1, c2
