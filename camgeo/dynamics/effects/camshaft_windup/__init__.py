"""Effect `camshaft-windup`: torsion of the camshaft between its drive and the cam."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from camgeo.dynamics.effects.effect import ELASTIC, Effect, data_of
from camgeo.dynamics.effects.results import CAMSHAFT_WINDUP, DRIVE_TORQUE
from camgeo.errors import GeometryError
from camgeo.record import schema_beside

# -- table ----------------------------------------------------------------------------------------
# The table ``[effects.camshaft-windup]``: the shaft, and what turns with the cam.


@dataclass(frozen=True, slots=True)
class ElasticShaft:
    """The camshaft between its drive and the cam.

    Attributes
    ----------
    stiffness : k [N mm/rad], above 0.
    moment_of_inertia : J of what turns with the cam [t mm^2], above 0.
    damping : D, the ratio to critical damping, in [0, 1).
    limit : largest windup allowed [rad]; None for no limit.
    """

    stiffness: float
    moment_of_inertia: float
    damping: float = 0.0
    limit: float | None = None

    @property
    def natural_frequency(self) -> float:
        """sqrt(k / J) [rad/s]: of the cam without its follower on the shaft."""
        return math.sqrt(self.stiffness / self.moment_of_inertia)

    @property
    def viscosity(self) -> float:
        """c = 2 D sqrt(k J) [N mm s]."""
        return 2.0 * self.damping * math.sqrt(self.stiffness * self.moment_of_inertia)


def parse(table: Mapping[str, Any]) -> ElasticShaft:
    """The data of the table.

    Raises
    ------
    GeometryError
        With the key, if stiffness or moment of inertia are missing or 0.
    """
    for key, words in (
        ("stiffness", "the torsional stiffness of the camshaft"),
        ("moment_of_inertia", "the moment of inertia of what turns with the cam"),
    ):
        if table.get(key) is None:
            raise GeometryError(f"is missing: {words}", key=key)
        if not table[key] > 0.0:
            raise GeometryError(
                f"{words} cannot be 0; allowed: above 0", key=key, value=f"{table[key]:g}"
            )
    return data_of(ElasticShaft, table)


# -- camshaft windup ------------------------------------------------------------------------------


EFFECT: Final = Effect(
    name=CAMSHAFT_WINDUP,
    title="torsion of the camshaft",
    compute="camgeo.dynamics.effects.camshaft_windup.result:compute",
    schema=schema_beside(__file__),
    parse=parse,
    needs=(DRIVE_TORQUE,),
    keys=(("cam.speed",),),
    tabled=True,
    numerical=True,
    refined_by=(ELASTIC,),
)
