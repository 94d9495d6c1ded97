"""The table ``[effects.spring]``: the spring."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, Literal

from camgeo.errors import GeometryError

Kind = Literal["compression", "extension", "torsion"]


ENDS: Final = ("anchor", "attachment")


LINEAR: Final = ("stiffness", "preload")


TORSIONAL: Final = ("torsional_stiffness", "preload_torque")


@dataclass(frozen=True, slots=True)
class SpringData:
    """The data of the spring.

    Attributes
    ----------
    kind : see `Kind`.
    stiffness : k [N/mm], or [N mm/rad] for a torsion spring.
    preload : P at cam angle 0 [N], or [N mm].
    anchor, attachment : the ends of a spring on a rocker at cam angle 0, relative to the cam axis
        [mm].
    """

    kind: Kind
    stiffness: float
    preload: float
    anchor: complex | None = None
    attachment: complex | None = None


def parse(table: Mapping[str, Any]) -> SpringData:
    """The data of the table.

    Raises
    ------
    GeometryError
        With the key, if a key for this kind of spring is missing, or one for another kind is given.
    """
    kind: Kind = table.get("kind", "compression")
    article = f"{'an' if kind == 'extension' else 'a'} {kind} spring"
    own, foreign = (TORSIONAL, (*LINEAR, *ENDS)) if kind == "torsion" else (LINEAR, TORSIONAL)
    for key in own:
        if key not in table:
            raise GeometryError(f"is missing: {article} needs {' and '.join(own)}", key=key)
    for key in foreign:
        if key in table:
            raise GeometryError(
                f"does not belong to {article}, which has {' and '.join(own)}", key=key
            )
    for given, other in (ENDS, ENDS[::-1]):
        if given in table and other not in table:
            raise GeometryError(f"is missing: {given} is only one end of the spring", key=other)
    anchor, attachment = (complex(*table[key]) if key in table else None for key in ENDS)
    return SpringData(kind, float(table[own[0]]), float(table[own[1]]), anchor, attachment)
