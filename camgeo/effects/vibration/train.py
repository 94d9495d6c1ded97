"""The elastic train that follows from what a scene says of it."""

from __future__ import annotations

import math

from camgeo.effects.effect import Request
from camgeo.effects.results import INERTIA
from camgeo.effects.vibration.spec import Spec
from camgeo.errors import GeometryError
from camgeo.numeric.oscillator.train import Train, one_mass, two_masses


def train_of(request: Request[Spec]) -> Train | None:
    """The elastic train; None if it is rigid, for there is no mass.

    With a stiffness k, w^2 = k / m for the mass m that [effects.inertia] gives. With a second mass
    m is both of them together, so that the first one is m / (1 + mass_ratio).

    Raises
    ------
    GeometryError
        If the masses are missing.
    """
    spec = request.spec
    frequency = spec.natural_frequency
    if frequency is None:
        stiffness = spec.stiffness if spec.stiffness is not None else spec.torsional_stiffness
        assert stiffness is not None  # `parse` refuses a table without
        inertia = request.results.get(INERTIA)
        if inertia is None:
            raise GeometryError(
                "is missing: with a stiffness the natural frequency needs the masses",
                key="effects.inertia",
            )
        linkage = request.subject.cam.drive.linkage
        if inertia.moved == 0.0 and linkage is not None and linkage.member != "slider":
            raise GeometryError(
                "is missing: with a stiffness the natural frequency needs the moment of inertia at"
                " the far end of the linkage; or give natural_frequency",
                key="effects.inertia.output_moment",
            )
        if inertia.moved == 0.0:
            return None
        share = 1.0 if spec.second is None else 1.0 + spec.second.mass_ratio
        frequency = math.sqrt(share * stiffness / inertia.moved)
    if math.isinf(frequency):
        return None if spec.second is None else one_mass(spec.second.frequency, spec.second.damping)
    if spec.second is None:
        return one_mass(frequency, spec.damping)
    return two_masses(frequency, spec.damping, spec.second)
