"""What the figures of an effect rely on, and where a design does not provide it.

Four things are checked for every effect, whatever it computes: that the follower touches the cam
(`camgeo.effects.touching.lost_contact`), also one that is held both ways and crosses its clearance
(`camgeo.effects.results.Leaving`), which alone makes no figure less than "ok"; that the disc makes
the motion of the state, which a trimmed one does not if that is the demanded motion; that a yoke
fits its cam; and that no other effect of the scene has a better model (`Effect.refined_by`). Each
that fails gives one finding. While one of the first three fails, no figure of the effect is "ok".
Where the state is the motion of a trimmed disc, or of the contour as it is written, that is told
too, and where the train behind the follower is elastic.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from camgeo.check.finding import STATED, Finding
from camgeo.effects.as_written import as_written
from camgeo.effects.results import CONTACT_FORCE
from camgeo.effects.touching import FLANKS, INNER, holds_both_ways, sides_of
from camgeo.effects.wording import angles, at, over
from camgeo.errors import GeometryError
from camgeo.units import TURN
from camgeo.wording import listed

if TYPE_CHECKING:
    from camgeo.cam.disc import Disc
    from camgeo.effects.effect import Effect, Subject
    from camgeo.effects.lost_contact import LostContact
    from camgeo.outline.replay_result import Replay

Range = tuple[float, float]
"""Cam angles [rad]; past cam angle 0 the end is below the start, or beyond a turn."""

OF_TRAIN: Final = Finding(
    "elastic-train",
    "ok",
    "these figures are for the elastic train of the effect vibration, in the steady state",
)

SLACK: Final = 1e-9
"""Cam angles [rad] this close are equal but for rounding."""


def qualified(
    effect: Effect,
    findings: Sequence[Finding],
    subject: Subject,
    lost: LostContact | None,
    named: Sequence[str],
    flown: Sequence[Range] = (),
    *,
    holding: str = "",
    follows: bool = False,
    elastic: bool = False,
) -> tuple[Finding, ...]:
    """The `findings` of `effect`, after those that say what they do not hold for.

    Parameters
    ----------
    lost : where the follower leaves the cam; None if that is not known.
    named : the effects that the scene names.
    flown : where it then flies, or crosses its clearance; empty if that is not known.
    holding : what would hold it there, in words; empty if that is not known.
    follows : whether `effect` takes elastic trains into account.
    elastic : whether its figures are for one.
    """
    if all(each.value is None for each in findings):
        return tuple(findings)  # without figures there is nothing to qualify
    broken: list[Finding] = []
    crossed: list[Finding] = []
    if effect.premise == "contact" and lost:
        broken.append(
            _on_other_side(lost, subject)
            if holds_both_ways(subject)
            else _without_contact(lost, subject, flown, holding)
        )
    elif effect.premise == "contact" and flown:
        crossed.append(_in_clearance(subject, flown))
    trimmed = tuple(trimming(effect, subject))
    uneven = tuple(_of_breadth(effect, subject))
    if broken or uneven or (trimmed and not _follows(effect, subject)):
        findings = [_doubted(each, effect) for each in findings]
    told = [*uneven, *as_written(effect, subject), *((OF_TRAIN,) if elastic else ())]
    told += _simplified(effect, named, follows=follows)
    return (*broken, *crossed, *trimmed, *told, *findings)


def _doubted(finding: Finding, effect: Effect) -> Finding:
    """A figure that relies on a premise which is not true; it is not "ok"."""
    if finding.severity != "ok" or finding.value is None or finding.name in effect.regardless:
        return finding
    return replace(finding, severity="warning")


def _without_contact(
    lost: LostContact, subject: Subject, flown: Sequence[Range], holding: str
) -> Finding:
    """Where contact is lost, though the figures take it for granted."""
    ranges = [(each.start, each.end) for each in lost.ranges]
    touching = subject.cam.follower.touching
    places = [over(ranges)] if ranges else []
    if lost.leaps:
        places.append(f"{angles(lost.leaps)}, where the velocity jumps away from it")
    low = lost.lowest
    flight = f", and flies {over([_in_turn(each) for each in flown])}" if flown else ""
    force = "" if low is None else f": contact force {low.value:.6g} N {at(low.place)}"
    return Finding(
        name="contact-lost",
        severity="broken",
        sentence=(
            f"the {touching} leaves the cam {listed(places)}{force}{flight}; these figures are for"
            f" one that stays on it{holding and f'; {holding}'}"
        ),
        value=None if low is None else low.value,
        limit=0.0,
        unit="N",
        cam_angle=lost.leaps[0] if low is None else low.place,
        cam_range=_only(ranges),
    )


def _on_other_side(lost: LostContact, subject: Subject) -> Finding:
    """Where the other side carries than the one whose written contour makes the motion."""
    sense, low = subject.state.sense, lost.lowest
    names, noun = sides_of(subject)
    ranges = [(each.start, each.end) for each in lost.ranges]
    places = [over(ranges)] if ranges else []
    if lost.leaps:
        places.append(f"{angles(lost.leaps)}, where the velocity jumps away from this one")
    force = "" if low is None else f", with up to {-low.value:.6g} N {at(low.place)}"
    return Finding(
        name="other-side",
        severity="warning",
        sentence=(
            f"the {names[-sense]} {noun} carries {listed(places)}{force}; these figures are for the"
            f' motion on the {names[sense]} one, and flank = "{names[-sense]}" in [state] gives'
            " those of the other"
        ),
        value=None if low is None else -low.value,
        limit=0.0,
        unit="N",
        cam_angle=lost.leaps[0] if low is None else low.place,
        cam_range=_only(ranges),
    )


def _in_clearance(subject: Subject, flown: Sequence[Range]) -> Finding:
    """Where a follower that is held both ways touches nothing."""
    who, where = "follower", "between its discs" if subject.paired else "of its yoke"
    if subject.returning is None:
        who, where = "roller", "between its flanks"
    ranges = [_in_turn(each) for each in flown]
    return Finding(
        name="clearance-crossed",
        severity="warning",
        sentence=(
            f"the {who} crosses the clearance {where} {over(ranges)}; these figures are"
            " for one that always touches, without its impacts"
        ),
        cam_range=_only(ranges),
    )


def _of_breadth(effect: Effect, subject: Subject) -> Iterator[Finding]:
    """Where a yoke does not fit its cam; an even play alters no force, and `lift-off` tells it."""
    breadth = subject.cam.breadth if subject.returning is not None else None
    if breadth is None or not (effect.premise == "contact" or CONTACT_FORCE in effect.needs):
        return
    (least, _), (most, place) = breadth.range
    squeeze = -breadth.play(subject.cam.yoke_breadth)
    told = []
    if breadth.variation > 0.0:
        told.append(
            f"the cam is {least:.6g} to {most:.6g} mm wide, and these figures are for one that is"
            f" {breadth.best:.6g} mm wide everywhere"
        )
    if squeeze > 0.0:
        told.append(
            f"the cam squeezes its yoke by up to {squeeze:.3g} mm, {at(place)}, and the forces of"
            " that are in no figure"
        )
    if told:
        value = max(squeeze, breadth.variation)
        yield Finding("yoke-breadth", "warning", "; ".join(told), value, 0.0, "mm", cam_angle=place)


@dataclass(frozen=True, slots=True)
class _Trimmed:
    """A flank of which less than all is left.

    Attributes
    ----------
    dropped : ranges [rad] in which the disc does not make the demanded motion.
    replay : the motion that it makes.
    """

    dropped: tuple[Range, ...]
    replay: Replay

    @property
    def shocks(self) -> tuple[float, ...]:
        """Cam angles [rad] in these ranges at which velocity or lift jump."""
        jumps = [*self.replay.shocks.phi.tolist(), *self.replay.drops.phi.tolist()]
        return tuple(
            sorted(phi for phi in jumps if any(_inside(phi, each) for each in self.dropped))
        )

    def followed(self, flank: str) -> str:
        """That the figures are for the motion of the disc."""
        return (
            f"these figures are for the motion that the {flank} makes, which is not the demanded"
            f" one {over(self.dropped)}"
        )

    def left_out(self, flank: str) -> str:
        """That they are for the demanded motion."""
        return (
            f"these figures are for the demanded motion, which the {flank} does not make"
            f" {over(self.dropped)}"
        )

    def opposite(self, flank: str) -> str:
        """That they are for the motion on the other side, where this one is missing."""
        return (
            f"these figures are for the motion of the other side, where the {flank} has lost what"
            f" would hold the follower on it {over(self.dropped)}"
        )

    def corners(self, *, included: bool) -> str:
        """What happens at the corners of the disc, and whether it is computed."""
        if not self.shocks:
            where = "at both ends" if included else "at the corner of the disc there"
            computed = ", which is computed" if included else ", which is not computed"
            return f"{where} the acceleration jumps{computed}"
        if included:
            return f"the velocity jumps {angles(self.shocks)}"
        return f"velocity or lift jump {angles(self.shocks)}, and these shocks are not computed"


def _follows(effect: Effect, subject: Subject) -> bool:
    """Whether the figures of `effect` are for the motion that the trimmed disc makes."""
    return subject.state.model != "demanded" and not effect.of_plan


def trimming(effect: Effect, subject: Subject) -> Iterator[Finding]:
    """A warning for each trimmed flank: whose motion the figures are for, and between which cam
    angles the disc does not make the demanded one.
    """
    if effect.premise == "disc" or subject.disc is None:
        return
    factor, unit = STATED[subject.cam.lift_unit]
    for which, disc in _discs(subject):
        for name, _ in disc.flanks:
            trimmed = _trimmed(disc, name)
            if trimmed is None:
                continue
            loss = trimmed.replay.largest_loss
            flank = f"trimmed {which}{name} flank"
            follows = _follows(effect, subject)
            told = trimmed.followed(flank) if follows else trimmed.left_out(flank)
            if follows and holds_both_ways(subject) and not _is_of(subject, disc, name):
                told = trimmed.opposite(flank)
                follows = False
            yield Finding(
                name="trimmed-motion",
                severity="warning",
                sentence=(
                    f"{told}: up to"
                    f" {factor * loss.value:.4g} {unit} of the lift are lost, {at(loss.place)};"
                    f" {trimmed.corners(included=follows)}"
                ),
                value=factor * loss.value,
                limit=0.0,
                unit=unit,
                cam_angle=loss.place,
                cam_range=_only(trimmed.dropped),
            )


def _is_of(subject: Subject, disc: Disc, flank: str) -> bool:
    """Whether the motion of the state is that of this flank, of a follower that is held both
    ways.
    """
    first = subject.state.sense == INNER
    if subject.returning is None:
        return (flank == FLANKS[INNER]) == first
    return (disc is subject.cam.disc) == first


def _discs(subject: Subject) -> Iterator[tuple[str, Disc]]:
    """The discs, each with the words that distinguish it from the other one."""
    yield "", subject.cam.disc
    if subject.returning is not None and subject.paired:
        yield "return disc's ", subject.returning.cam.disc


def _trimmed(disc: Disc, flank: str) -> _Trimmed | None:
    """What a flank has lost; None if nothing, or if there is no disc, which the checks report."""
    try:
        outline = disc.outline(flank)
        return _Trimmed(outline.dropped, disc.replay(flank)) if outline.is_trimmed else None
    except GeometryError:
        return None


def _simplified(effect: Effect, named: Sequence[str], *, follows: bool) -> Iterator[Finding]:
    """A warning if other effects that the scene names have a better model that is not followed."""
    found = [
        each for each in effect.refined_by if each.by in named and not (each.followed and follows)
    ]
    if not found:
        return
    others = listed([each.by for each in found])
    model = "has a better model, which is" if len(found) == 1 else "have better models, which are"
    sentence = (
        f"these figures hold for {listed([each.taken for each in found])}; {others} in the same"
        f" scene {model} not taken into account here"
    )
    cautions = [each.caution for each in found if each.caution]
    yield Finding("simplified", "warning", "; ".join((sentence, *cautions)))


def _in_turn(range_: Range) -> Range:
    """The range with both ends in [0, 2 pi)."""
    return range_[0] % TURN, range_[1] % TURN


def _inside(phi: float, range_: Range) -> bool:
    """Whether the cam angle `phi` lies in the range, its ends included but for rounding."""
    start, end = range_
    return (phi - start + SLACK) % TURN <= (end - start) % TURN + 2.0 * SLACK


def _only(ranges: Sequence[Range]) -> Range | None:
    """The range if there is one alone, its ends in [0, 2 pi]."""
    if len(ranges) != 1:
        return None
    start, end = ranges[0]
    return start % TURN, end if end == TURN else end % TURN
