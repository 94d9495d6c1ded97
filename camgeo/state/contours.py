"""The contours of a cam as they are written, and the follower pressed against each.

A follower on a single flank has the motion of that one. One that is held both ways, in a groove,
between two discs or by a yoke on both sides of one, runs on the side that carries, and passes to
the other where the force on it changes sign. From one written contour to the other its lift would
jump by the play between them, which no finite force brings about, and which is an impact across the
clearance if there is any. So the state is the motion on one side all round, the one that the scene
says; how far the other one is from it, `Contours.play`, and where that one carries is told with
every figure.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

from camgeo.cam.cam import Cam
from camgeo.contour.contour import Contour, Effort, Form
from camgeo.contour.spline import SplineContour
from camgeo.curve.pitch_curve import PitchCurve
from camgeo.errors import GeometryError
from camgeo.numeric.extremes import Extreme, Extremes
from camgeo.outline.path import Flank
from camgeo.outline.replay import replay_contour
from camgeo.outline.replay_result import Replay, extreme_play
from camgeo.part.boundary import written_contour
from camgeo.state.state import FIRST, SECOND
from camgeo.state.written import KEY, MODEL, Written

if TYPE_CHECKING:
    from camgeo.part.part import Part


class HasPart(Protocol):
    """A disc that computes its part on demand."""

    @property
    def cam(self) -> Cam: ...

    @property
    def part(self) -> Part: ...


@dataclass(frozen=True, slots=True)
class Writing:
    """How a contour is written.

    Attributes
    ----------
    form : of its pieces.
    tolerance : within which it keeps to the exact curve [mm].
    effort : of the fit.
    """

    form: Form
    tolerance: float
    effort: Effort = "fewest"


@dataclass(frozen=True, slots=True)
class Pressed:
    """The follower pressed against one written contour.

    Attributes
    ----------
    cam : whose flank it is.
    contour : that is written.
    replay : of the contour.
    deviation : proved, of the contour from the exact curve [mm].
    """

    cam: Cam
    contour: Contour | SplineContour
    replay: Replay
    deviation: float


@dataclass(frozen=True)
class Contours:
    """The contours on which a follower runs, as they are written.

    Attributes
    ----------
    discs : the main one, and the return disc of a conjugate pair, or the main one once more as the
        second side of its yoke touches it.
    writing : how they are written.
    sense : side on which a follower runs that is held both ways, as `State.sense`.
    """

    discs: tuple[HasPart, ...]
    writing: Writing
    sense: int = FIRST

    @property
    def is_held_both_ways(self) -> bool:
        """Whether there are two of them, or one that is touched twice."""
        return len(self.discs) > 1 or self.discs[0].cam.contact.closed_by_form

    def state_of(self, cam: Cam) -> Written:
        """The motion on them, as `cam` sees it, which is that of one of the discs.

        Raises
        ------
        GeometryError
            With the key, if the follower drops off an edge of the contour; from the replay, if it
            cannot be followed.
        ToleranceError
            If the tolerance cannot be reached.
        UndercutError
            If there is no disc.
        """
        found = self._carrying
        if len(found.replay.drops):
            raise GeometryError(
                "the follower drops off an edge of the contour: its velocity is unbounded there",
                key=KEY,
                value=MODEL,
            )
        sense = self.sense if self.is_held_both_ways else cam.contact.push
        return Written(
            cam, found.contour, found.replay, found.deviation, sense, cam.drive.time_course,
            touches=cam is found.cam,
        )  # fmt: skip

    @cached_property
    def play(self) -> Extremes:
        """How far [mm or rad of the lift] the other side lets the follower move off, over the turn;
        negative where both squeeze it. Of two sides only; raises as `state_of`.
        """
        sides = {self.sense: self._carrying, -self.sense: self._opposite}
        found = extreme_play(sides[FIRST].replay, sides[SECOND].replay)
        main = self.discs[0].cam
        if main.breadth is None:
            return found
        # The second side is that of a yoke as wide as the exact cam.
        wider = main.yoke_breadth - main.breadth.best
        ends = (Extreme(each.value + wider, each.place) for each in (found.lowest, found.highest))
        return Extremes(*ends)

    @cached_property
    def _carrying(self) -> Pressed:
        """The follower on the contour whose motion it is."""
        main = self.discs[0].cam
        return self._pressed(self.sense if self.is_held_both_ways else main.contact.push)

    @cached_property
    def _opposite(self) -> Pressed:
        return self._pressed(-self.sense)

    def _pressed(self, sense: int) -> Pressed:
        disc, name, flank = self.discs[0], "outline", Flank.INNER
        if len(self.discs) > 1:
            disc = self.discs[0 if sense == FIRST else 1]
        else:
            flank = Flank.INNER if sense == FIRST else Flank.OUTER
        if disc.cam.contact.closed_by_form:
            name = f"{flank} flank"
        (boundary,) = (each for each in disc.part.boundaries if each.name == name)
        writing = self.writing
        fit = written_contour(boundary, writing.form, writing.effort, writing.tolerance)
        replay = _replayed(disc.cam.disc.pitch_curve, fit.contour, flank)
        return Pressed(disc.cam, fit.contour, replay, fit.deviation)


def _replayed(pitch: PitchCurve, contour: Contour | SplineContour, flank: Flank) -> Replay:
    if isinstance(contour, SplineContour):
        if not pitch.follower.has_pitch_curve:
            raise GeometryError(
                "a flat face on splines: its motion is not computed", key=KEY, value=MODEL
            )
        from camgeo.contour.spline_replay import replay_spline  # few contours are splines

        return replay_spline(pitch, contour, flank)
    return replay_contour(pitch, contour, flank)
