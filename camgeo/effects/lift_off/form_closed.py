"""A follower held in both directions: where the contact changes sides, and its flights between."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from camgeo.check.finding import Finding
from camgeo.effects.effect import Subject
from camgeo.effects.lift_off.crossing import Change, flank_changes
from camgeo.effects.results import ContactForce, Inertia, Leaving
from camgeo.effects.touching import sides_of
from camgeo.effects.wording import degrees

if TYPE_CHECKING:
    from camgeo.effects.lift_off.flown import Flight


@dataclass(frozen=True, slots=True, eq=False)
class FormClosed(Leaving):
    """The contact of a roller in a groove, or of a follower between two discs or in a yoke.

    Attributes
    ----------
    first : side that carries first in the turn, +1 inner, -1 outer or return, 0 if none does.
    changes : changes of side.
    flights : across the clearance, with their rebounds, as far as they can be computed.
    """

    first: int
    changes: tuple[Change, ...]
    flights: tuple[Flight, ...]


def of_groove(
    subject: Subject,
    contact: ContactForce,
    inertia: Inertia | None,
    backlash: float,
    restitution: float,
    tolerance: float,
) -> FormClosed:
    """The findings for a groove, pair or yoke; impact speeds to the relative `tolerance`."""
    sides = _Sides("roller" if subject.returning is None else "follower", *sides_of(subject))
    first, changes = flank_changes(contact)
    found = [sides.change(change) for change in changes]
    if not changes:
        found.append(sides.steady(first))
    if not changes or backlash == 0.0:
        return FormClosed(first, changes, (), findings=tuple(found))
    from camgeo.effects.lift_off.landing import crossed_by  # many grooves are stated without play

    flown = crossed_by(subject, contact, inertia, backlash, restitution, tolerance)
    return FormClosed(
        first,
        changes,
        flown.flights,
        findings=(*found, *flown.findings),
        flown=flown.ranges,
        errors=flown.errors,
    )


@dataclass(frozen=True, slots=True)
class _Sides:
    """The wording of the findings.

    Attributes
    ----------
    who : changes sides: "roller" or "follower".
    names : of the sides.
    noun : what the sides are: "flank", "disc" or "side".
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

    def steady(self, first: int) -> Finding:
        sentence = f"there is no force on either {self.noun}"
        if first:
            sentence = f"the {self.names[first]} {self.noun} carries over the whole turn"
        return Finding("flank-change", "ok", sentence, 0.0)
