"""Load on the bearings of the camshaft.

The shaft carries -F_c, the weight m g of the disc and the inertia force of its unbalance. All act
in the middle plane of the disc, so that bearings at z_1 and z_2 along the axis, measured from that
plane, carry the shares z_2/(z_2 - z_1) and -z_1/(z_2 - z_1): moments about each of them vanish.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from camgeo.effects.effect import Bound
from camgeo.effects.force import rates_of
from camgeo.effects.reactions.load import Load
from camgeo.effects.turning_disc import part_of, unbalance_force
from camgeo.effects.wording import missed
from camgeo.numeric.arrays import ComplexArray, FloatArray, Side
from camgeo.numeric.extremes import piecewise_highest

if TYPE_CHECKING:
    from collections.abc import Iterable

    from camgeo.check.finding import Finding
    from camgeo.effects.effect import Quantity, Subject
    from camgeo.effects.reactions.bodies import Bodies
    from camgeo.outline.moments import Moments

TAKEN: Final = 0.1
"""Share of the tolerance for the integrals over the outlines of the disc, whose errors add up."""


TOTAL: Final = "camshaft load"


@dataclass(frozen=True, slots=True, eq=False)
class Shaft:
    """The camshaft.

    Attributes
    ----------
    bodies : with the force of the cam.
    disc : its mass [t] and first moment [t mm]; None if the scene does not give its weight.
    bearings : z_1 and z_2 [mm]; None if they are not stated.
    """

    bodies: Bodies
    disc: Moments | None
    bearings: tuple[float, float] | None

    def load(self, phi: FloatArray, side: Side) -> ComplexArray:
        """(n,) [N] on the shaft."""
        found = -self.bodies.of_cam(phi, side)
        if self.disc is not None:
            sigma, rates = (
                self.bodies.subject.cam.rotation,
                rates_of(self.bodies.subject, phi, side),
            )
            found += self.disc.area * self.bodies.loads.pull
            found += unbalance_force(self.disc.first, sigma, phi, rates)
        return found

    def loads(self) -> list[Load]:
        """On the shaft, and on each bearing if they are stated."""

        def share(part: float) -> Quantity:
            return lambda phi, side: abs(part) * np.abs(self.load(phi, side))

        found = [Load(TOTAL, "load on the camshaft", share(1.0))]
        if self.bearings is not None:
            first, second = self.bearings
            for name, part in (("first", second), ("second", -first)):
                words = f"load on the {name} bearing of the camshaft"
                found.append(Load(f"{name} bearing load", words, share(part / (second - first))))
        return found

    def errors(
        self, found: Iterable[Finding], edges: FloatArray, tolerance: float
    ) -> dict[str, Bound]:
        """Of the loads, and of their findings among those `found`.

        Raises
        ------
        EffectError
            If an error exceeds the tolerance, relative to the largest load.
        """
        if self.disc is None:
            return {}

        def per_unbalance(phi: FloatArray, side: Side) -> FloatArray:
            rates = rates_of(self.bodies.subject, phi, side)
            return np.abs(unbalance_force(1.0, 1, phi, rates))

        error = self.disc.first_error * piecewise_highest(per_unbalance, edges).value
        error += self.disc.area_error * abs(self.bodies.loads.pull)
        largest = {each.name: each.value or 0.0 for each in found}
        whole = largest[f"largest-{TOTAL.replace(' ', '-')}"]
        if error > tolerance * whole:
            raise missed("the load on the camshaft", error / whole, "the largest", tolerance)
        out: dict[str, Bound] = {}
        for each in self.loads():
            name = f"largest-{each.name.replace(' ', '-')}"
            bound = Bound(error, whole).times(largest[name] / whole if whole else 0.0)
            out |= {each.name: bound, name: bound}
        return out


def disc_of(subject: Subject, tolerance: float) -> Moments | None:
    """Mass and first moment of the single disc; None if its thickness or density is not stated.

    Raises
    ------
    EffectError
        If there is no disc.
    """
    spec = subject.part_spec
    if subject.paired or spec is None or spec.thickness is None or spec.density is None:
        return None
    from camgeo.part.mass import disc_moments  # few scenes state what the disc is made of

    return disc_moments(part_of(subject, "weigh"), spec.density, TAKEN * tolerance)
