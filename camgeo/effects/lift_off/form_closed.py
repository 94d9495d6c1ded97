"""A follower held in both directions: where the contact changes sides, and the impact after it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.check.finding import Finding
from camgeo.effects.effect import Bound, Subject
from camgeo.effects.immovable import shocks
from camgeo.effects.lift_off.crossing import Change, Clearance, Impact, flank_changes
from camgeo.effects.results import ContactForce, Inertia, Leaving
from camgeo.effects.touching import sides_of
from camgeo.effects.wording import at, degrees, placed
from camgeo.numeric.extremes import Extreme, piecewise_lowest
from camgeo.wording import counted

LISTED: Final = 12
"""Largest number of changes that are listed one by one."""


@dataclass(frozen=True, slots=True, eq=False)
class FormClosed(Leaving):
    """The contact of a roller in a groove, or of a follower between two discs.

    Attributes
    ----------
    errors : of the impact speeds, relative to the largest.
    first : side that carries first in the turn, +1 inner, -1 outer or return, 0 if none does.
    changes : changes of side.
    impacts : after each change, None where there is none; empty if they were not computed.
    """

    first: int
    changes: tuple[Change, ...]
    impacts: tuple[Impact | None, ...]


def of_groove(
    subject: Subject,
    contact: ContactForce,
    inertia: Inertia | None,
    backlash: float,
    tolerance: float,
) -> FormClosed:
    """The findings for a groove or pair; impact speeds to the relative `tolerance`."""
    sides = _Sides("roller" if subject.returning is None else "follower", *sides_of(subject))
    first, changes = flank_changes(contact)
    found = [sides.change(change) for change in changes[:LISTED]]
    if len(changes) > LISTED:
        found.append(sides.more(len(changes)))
    if not changes:
        found.append(sides.steady(first))
    impacts: tuple[Impact | None, ...] = ()
    if changes and backlash > 0.0:
        why = _why_not(subject, contact, inertia)
        if why or inertia is None:
            sentence = f"no impact speed is given: {why}"
            found.append(Finding("impact-speed", "warning", sentence))
        else:
            clearance = Clearance(subject, contact, inertia, backlash)
            impacts = tuple(clearance.impact_after(change, tolerance) for change in changes)
            found += sides.impacts(changes, impacts, backlash)
    hits = [impact for impact in impacts if impact is not None]
    errors = {}
    if hits:
        fastest = max(each.speed for each in hits)
        bound = Bound(max(each.error * each.speed for each in hits), fastest)
        errors = dict.fromkeys(("impact-speed", "largest-impact-speed"), bound)
    return FormClosed(first, changes, impacts, findings=tuple(found), errors=errors)


def _why_not(subject: Subject, contact: ContactForce, inertia: Inertia | None) -> str:
    """Why there is no impact speed; empty if there is one."""
    if inertia is None or subject.state.course is None:
        return "it needs [effects.inertia]; without mass the clearance is crossed instantly"
    if not piecewise_lowest(inertia.to_follower, contact.edges).value > 0.0:
        return "the follower has no mass, so the clearance is crossed instantly"
    if contact.behind is not None:
        return (
            "behind an elastic train the masses move on by themselves; [state] output ="
            ' "rigid" gives the impact of a rigid one'
        )
    jumps = shocks(subject, contact.struck)
    if jumps:
        return f"the velocity jumps {at(jumps[0])}, which is itself a shock"
    return ""


@dataclass(frozen=True, slots=True)
class _Sides:
    """The wording of the findings.

    Attributes
    ----------
    who : changes sides: "roller" or "follower".
    names : of the sides.
    noun : what the sides are: "flank" or "disc".
    """

    who: str
    names: dict[int, str]
    noun: str

    def change(self, change: Change) -> Finding:
        free = change.leaving != change.carrying
        until = f", with no force on either until {degrees(change.carrying)}" if free else ""
        return Finding(
            name="flank-change",
            severity="ok",
            sentence=(
                f"at cam angle {degrees(change.leaving)} the {self.who} moves from the"
                f" {self.names[change.sense]} to the {self.names[-change.sense]} {self.noun}{until}"
            ),
            cam_angle=change.leaving,
            cam_range=(change.leaving, change.carrying) if free else None,
        )

    def more(self, count: int) -> Finding:
        often = f"{counted(count, 'time')} per turn"
        sentence = f"the {self.who} moves from one {self.noun} to the other {often}"
        return Finding("flank-change", "ok", sentence, float(count))

    def steady(self, first: int) -> Finding:
        sentence = f"there is no force on either {self.noun}"
        if first:
            sentence = f"the {self.names[first]} {self.noun} carries over the whole turn"
        return Finding("flank-change", "ok", sentence, 0.0)

    def impacts(
        self, changes: tuple[Change, ...], impacts: tuple[Impact | None, ...], backlash: float
    ) -> list[Finding]:
        """The impact after each change, and the fastest."""
        found = []
        for change, impact in list(zip(changes, impacts, strict=True))[:LISTED]:
            left = f"after it leaves the {self.names[change.sense]} {self.noun}"
            left += f" at {degrees(change.leaving)}"
            if impact is None:
                sentence = f"{left} the {self.who} hits neither {self.noun} within a turn"
            else:
                met = self.names[-change.sense if impact.crossed else change.sense]
                back = "" if impact.crossed else " again, because it has not crossed the clearance"
                sentence = (
                    f"{left} the {self.who} hits the {met} {self.noun}{back}"
                    f" at {degrees(impact.cam_angle)} at {impact.speed:.6g} mm/s"
                )
            found.append(
                Finding(
                    name="impact-speed",
                    severity="ok" if impact is not None else "warning",
                    sentence=sentence,
                    value=None if impact is None else impact.speed,
                    unit="mm/s",
                    cam_angle=None if impact is None else impact.cam_angle,
                )
            )
        hits = [impact for impact in impacts if impact is not None]
        if hits:
            fastest = hits[int(np.argmax([each.speed for each in hits]))]
            sentence = (
                f"the {self.who} crosses its clearance of {backlash:g} mm and hits the {self.noun}"
                f" at up to {fastest.speed:.6g} mm/s, {at(fastest.cam_angle)}"
            )
            end = Extreme(fastest.speed, fastest.cam_angle)
            found.append(placed("largest-impact-speed", sentence, end, "mm/s", severity="warning"))
        return found
