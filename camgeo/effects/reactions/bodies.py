"""Forces on the free bodies: follower with its roller, and cam.

The cam presses on the roller with F_c = |N| (s n + f_t t), in the notation of `friction`, at its
centre, and the roller turns its pin by the moment -m_p. What pivot and guide carry is defined in
`camgeo.effects.loads`, as friction in them needs it. On a flat face F_c acts at the contact, which
is the distance e to the right of the axis of its guide, so that M = N e; in a conjugate pair it is
that of the disc that carries. For the camshaft see `shaft`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from camgeo.effects.force import at_rates, rates_of
from camgeo.effects.loads import Loads, guide_ends
from camgeo.effects.touching import INNER, OUTER, bearing_of, carrier
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side

if TYPE_CHECKING:
    from camgeo.effects.effect import Subject
    from camgeo.effects.reactions.pins import Pins
    from camgeo.effects.results import ContactForce


@dataclass(frozen=True, slots=True, eq=False)
class Bodies:
    """The bodies and what acts on them.

    Forces are complex [N], in the axes of the drawing, for n cam angles [rad].

    Attributes
    ----------
    subject : the design.
    contact : the contact force.
    loads : what acts on the follower besides the contact.
    pins : the joints of the linkage; None without one.
    """

    subject: Subject
    contact: ContactForce
    loads: Loads
    pins: Pins | None

    def of_cam(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(n,) F_c, of the disc that carries."""
        normal = self.contact.normal(phi, side)
        sliding = np.abs(normal) * bearing_of(self.contact, phi, side).tangential
        found = np.zeros(len(phi), dtype=np.complex128)
        for sense, here in ((INNER, normal >= 0.0), (OUTER, normal < 0.0)):
            if not np.any(here):
                continue
            disc, flank = carrier(self.subject, sense)
            relative = disc.state.curve.relative_jet(phi[here], side, order=1)
            ahead = relative.along[1] + 1j * relative.across[1]
            tangent = ahead / np.abs(ahead) * np.exp(1j * relative.axis)
            across = 1j * disc.cam.rotation * flank * np.abs(normal[here])
            found[here] = (across + sliding[here]) * tangent
        return found

    def of_pivot(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(n,) R on a rocker."""
        loads = at_rates(self.loads.on_pivot(phi, side), rates_of(self.subject, phi, side))
        return np.asarray(loads - self.of_cam(phi, side))

    def of_guide(self, phi: FloatArray, side: Side) -> FloatArray:
        """(2, n) R_1 and R_2 of a guide with two ends; else the side force alone, and 0."""
        friction, loads = self.contact.friction, self.loads
        length, overhang = None, np.zeros(len(phi))
        if friction is not None:
            length, overhang = friction.guide_length, friction.bearing(phi, side, INNER).overhang
        own = at_rates(loads.on_guide(phi, side), rates_of(self.subject, phi, side))
        force, bearing = loads.across(self.of_cam(phi, side)), bearing_of(self.contact, phi, side)
        moment = np.abs(self.contact.normal(phi, side)) * bearing.tilt
        pressed = guide_ends(force, moment, bearing.overhang, length)
        return guide_ends(own, 0.0, overhang, length) + pressed

    def tilting(self, phi: FloatArray, side: Side) -> FloatArray:
        """(n,) M [N mm] of a flat face whose guide has no stated length, about the cam axis's foot
        on it; counter-clockwise positive.
        """
        relative = self.subject.state.curve.relative_jet(phi, side, order=1)
        return np.asarray(self.contact.normal(phi, side) * relative.along[0])
