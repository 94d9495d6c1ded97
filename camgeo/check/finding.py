"""A finding: a value of the design compared with a limit, with its place."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Final, Literal

from camgeo.displayed import Displayed, clipped
from camgeo.units import TURN, LengthUnit, LiftUnit, in_unit
from camgeo.wording import counted, listed

Severity = Literal["ok", "warning", "broken", "no-disc", "invalid"]
"""What a finding means to the designer.

ok: within its limit. warning: worth knowing. broken: beyond its limit, though the disc can be made
all the same. no-disc: no disc makes this motion, and no outline is written. invalid: what the scene
describes is no cam mechanism, which a command treats as a fault of the scene.
"""

NO_OUTLINE: Final = ("invalid", "no-disc")
"""Severities with which no outline is written."""


STATED: Final[dict[LiftUnit, tuple[float, str]]] = {
    "mm": (1.0, "mm"),
    "rad": (math.degrees(1.0), "deg"),
}
"""Factor and unit with which messages state lifts, by the unit of the lift."""


@dataclass(frozen=True, slots=True)
class Finding(Displayed):
    """The answer of one check.

    Attributes
    ----------
    name : of the check, e.g. "transmission-angle".
    severity : see `Severity`.
    sentence : the finding in words, with value, limit and place.
    value : what was found, in `unit`; None if the check has no number.
    limit : what it is compared with, in `unit`; None if there is none.
    unit : "deg", "mm", "" ...
    cam_angle : where, [rad], given in any turn, kept in [0, 2 pi); None for the whole turn.
    cam_range : start and end [rad] of the range over which the limit is broken, the end below the
        start if it passes cam angle 0; None where a single angle says it.
    """

    name: str
    severity: Severity
    sentence: str
    value: float | None = None
    limit: float | None = None
    unit: str = ""
    cam_angle: float | None = None
    cam_range: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if self.cam_angle is not None:
            angle = self.cam_angle % TURN
            # The remainder of a negative angle can round up to the whole turn.
            object.__setattr__(self, "cam_angle", angle if angle < TURN else 0.0)

    def in_unit(self, unit: LengthUnit) -> Finding:
        """The finding with the lengths in its sentence in the unit of a scene; value and limit stay
        as they are.
        """
        figures = (self.value, self.limit) if "mm" in self.unit else ()
        exact = [each for each in figures if each is not None]
        sentence = in_unit(self.sentence, unit, exact)
        return self if sentence == self.sentence else replace(self, sentence=sentence)

    def __repr__(self) -> str:
        return clipped(f"Finding({self.name!r}, {self.severity!r}, {self.sentence!r})")


NAMED: Final = 3
"""Findings of a severity that are named where many are described."""


class Findings(tuple[Finding, ...], Displayed):
    """Several findings, which a notebook shows as a table."""

    __slots__ = ()

    def __repr__(self) -> str:
        names: dict[str, list[str]] = {}
        for each in self:
            names.setdefault(each.severity, []).append(each.name)
        told = [
            f"{len(own)} {severity}" + ("" if severity == "ok" else f" ({listed(own, NAMED)})")
            for severity, own in names.items()
        ]
        head = counted(len(self), "finding")
        return clipped(f"<{': '.join([head, *([', '.join(told)] if told else [])])}>")


def stated_in(unit: LengthUnit, findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """The findings with their sentences in the unit of a scene, see `Finding.in_unit`."""
    return tuple(findings if unit == "mm" else (each.in_unit(unit) for each in findings))


def held(
    name: str,
    statement: str,
    value: float,
    limit: float | None,
    unit: str = "",
    cam_angle: float | None = None,
    *,
    least: bool = False,
) -> Finding:
    """The finding that compares `value` with a `limit` that it must not exceed, or with `least` not
    fall below; with none if that is None. The sentence is `statement` with the verdict.
    """
    if limit is None:
        return Finding(name, "ok", statement, value, unit=unit, cam_angle=cam_angle)
    broken = value < limit if least else value > limit
    beyond, within = ("below", "at least") if least else ("above", "at most")
    verdict = f"{beyond if broken else within} {limit:g} {unit}".rstrip()
    severity: Severity = "broken" if broken else "ok"
    return Finding(name, severity, f"{statement}, {verdict}", value, limit, unit, cam_angle)


def forbidding(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """The findings that rule out the disc."""
    return tuple(each for each in findings if each.severity in NO_OUTLINE)
