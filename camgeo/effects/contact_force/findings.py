"""What the contact force amounts to, in words and numbers."""

from __future__ import annotations

from typing import Any

from camgeo.check.finding import Finding, Severity, held
from camgeo.effects.carrier import INNER, OUTER, holds_both_ways, sides_of
from camgeo.effects.effect import Request, Subject, toucher
from camgeo.effects.results import INERTIA
from camgeo.effects.shocks import shocks
from camgeo.effects.told import at, placed
from camgeo.numeric.extremes import Extreme, Extremes
from camgeo.units import TURN


def force_findings(extremes: Extremes, subject: Subject, limit: float | None) -> list[Finding]:
    """Largest and smallest force of the flank that has to carry, or the largest of each side.

    That is of each flank of a groove, or of each disc of a conjugate pair.
    """
    names, noun = sides_of(subject)
    low, high = extremes.lowest, extremes.highest
    mirrored = Extreme(-low.value, low.place)
    if not holds_both_ways(subject):
        inner = subject.cam.contact.runs_inside
        where = f"the {subject.cam.contact} flank"
        smallest = low if inner else Extreme(-high.value, high.place)
        largest = _largest(high if inner else mirrored, where, limit)
        return [largest, _smallest(smallest, where, toucher(subject))]
    both = sorted(((high, INNER), (mirrored, OUTER)), key=lambda each: -each[0].value)
    found = [_largest(both[0][0], f"the {names[both[0][1]]} {noun}", limit)]
    for extreme, sense in both:
        if extreme.value > 0.0:
            found.append(_on_side(extreme, names[sense], noun))
    return found


def _largest(extreme: Extreme, where: str, limit: float | None) -> Finding:
    told = f"largest contact force {_told(extreme, where)}"
    return held("largest-contact-force", told, extreme.value, limit, "N", extreme.place % TURN)


def _smallest(extreme: Extreme, where: str, what: str) -> Finding:
    lost = extreme.value < 0.0
    tail = f": the {what} is not held to its flank there" if lost else ""
    sentence = f"smallest contact force {_told(extreme, where)}{tail}"
    severity: Severity = "warning" if lost else "ok"
    return placed("smallest-contact-force", sentence, extreme, "N", severity=severity)


def _on_side(extreme: Extreme, name: str, noun: str) -> Finding:
    sentence = f"largest contact force {_told(extreme, f'the {name} {noun}')}"
    return placed(f"largest-contact-force-{name}", sentence, extreme, "N")


def _told(extreme: Extreme, where: str) -> str:
    return f"on {where} {extreme.value:.6g} N {at(extreme.place)}"


def shock_findings(request: Request[Any]) -> list[Finding]:
    """Where the velocity jumps: with a mass the force is infinite there, and not in the values."""
    inertia = request.results.get(INERTIA)
    return [
        Finding(
            name="shock",
            severity="broken",
            sentence=(
                f"the velocity jumps {at(angle)}: the contact force of the masses is infinite for"
                " a moment, which is in none of the values"
            ),
            cam_angle=angle,
        )
        for angle in shocks(request.subject, inertia)
    ]
