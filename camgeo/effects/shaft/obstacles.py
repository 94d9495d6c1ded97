"""What leaves a camshaft without a steady state: shocks, and a follower that jams."""

from __future__ import annotations

import numpy as np

from camgeo.effects.bearing_friction import LINEAR, RubbingLaw
from camgeo.effects.effect import Quantity, Subject
from camgeo.effects.immovable import torque_shocks
from camgeo.effects.shaft.mesh import Mesh
from camgeo.effects.wording import at
from camgeo.errors import EffectError


def refuse_shocks(subject: Subject, law: Quantity) -> None:
    """Raise EffectError if the velocity of a mass jumps: the resulting speed change is unknown."""
    edges = subject.state.smooth_angles
    places = torque_shocks(subject, lambda phi, side: law(phi, side)[3], edges)
    if len(places):
        first = float(places[0])
        raise EffectError(
            f"the velocity of the follower jumps {at(first)}: the torque is infinite there, and"
            " the equation of motion does not give the speed after it",
            finding="shock",
            cam_angle=first,
        )


def jamming(inertia: float, mesh: Mesh) -> EffectError:
    """That with the moment of inertia [t mm^2] of the camshaft the follower jams."""
    if len(mesh.laws) == LINEAR:
        moments = inertia + mesh.laws[3] * mesh.laws[4:]
        bad = ~np.all(moments > 0.0, axis=0)
    else:
        bad = np.any(RubbingLaw.of(mesh.laws).jams, axis=0)
    place = float(mesh.nodes[bad][0]) if np.any(bad) else None
    where = "" if place is None else f" {at(place)}"
    return EffectError(
        "with friction no acceleration of the cam satisfies its equation of motion: the"
        f" follower jams{where}",
        finding="jamming",
        cam_angle=place,
    )
