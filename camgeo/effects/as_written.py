"""That figures are for the motion on the contour as it is written, and how it is written."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from camgeo.check.finding import STATED, Finding
from camgeo.effects.touching import holds_both_ways, sides_of
from camgeo.effects.wording import at
from camgeo.errors import GeometryError, ToleranceError

if TYPE_CHECKING:
    from camgeo.contour.contour import Form
    from camgeo.effects.effect import Effect, Subject
    from camgeo.state.contours import Contours

WORDS: Final[dict[Form, str]] = {
    "arcs": "lines and arcs",
    "polyline": "straight pieces",
    "spline": "cubic splines",
}
"""Forms of a contour, in words."""


def as_written(effect: Effect, subject: Subject) -> Iterator[Finding]:
    """That the figures are for the motion that the contour makes as it is written; of two, of
    which, and how far the other one is.
    """
    contours = subject.contours
    if contours is None or effect.premise == "disc" or effect.of_plan:
        return
    writing, held = contours.writing, holds_both_ways(subject)
    _, unit = STATED["mm"]
    whose = "the written contour makes"
    names, noun = sides_of(subject)
    if held:
        whose = f"the written contour of the {names[contours.sense]} {noun} makes all round"
    yield Finding(
        name="written-motion",
        severity="ok",
        sentence=(
            f"these figures are for the motion that {whose},"
            f" {WORDS[writing.form]} within {writing.tolerance:g} {unit}"
        ),
        value=writing.tolerance,
        unit=unit,
    )
    if held:
        yield _between(subject, contours)


def _between(subject: Subject, contours: Contours) -> Finding:
    """How far the other written contour is from the one whose motion it is."""
    names, noun = sides_of(subject)
    own, other = (f"the {names[each]} {noun}" for each in (contours.sense, -contours.sense))
    try:
        play = contours.play
    except (GeometryError, ToleranceError) as error:
        return Finding(
            "other-contour", "warning", f"how far {other} is from {own} is not known: {error}"
        )
    factor, unit = STATED[subject.cam.lift_unit]
    low, high = (factor * each.value for each in (play.lowest, play.highest))
    who = "roller" if subject.returning is None else "follower"
    written = f"the written contours of {own} and {other} leave"
    if subject.cam.yoke is not None:
        written = f"between {own} and {other}, the written contour leaves"
    sentence = (
        f"{written} the {who} {low:.4g} to {high:.4g} {unit} of lift, least {at(play.lowest.place)}"
    )
    if low < 0.0:
        sentence += "; less than 0 is squeezed, which is not computed"
    return Finding(
        name="other-contour",
        severity="warning" if low < 0.0 else "ok",
        sentence=sentence,
        value=low,
        limit=0.0,
        unit=unit,
        cam_angle=play.lowest.place,
    )
