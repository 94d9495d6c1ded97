"""The flight of the roller across its clearance in a groove, and the impact at its end.

Where the contact changes sides, the roller leaves one flank and is free until it has crossed the
backlash. The free follower lacks the generalised force R of the contact: its coordinate deviates by
d from the prescribed one, and M d'' = -R with its generalised mass M. Since the backlash is small,
R and M are taken at the prescribed motion, and the gap at the flank left behind is |dn/dq d|, with
the leverage dn/dq of the normal: Newton's law, to first order in the backlash (form-closed cams
with clearance: Norton, Cam Design and Manufacturing Handbook, on crossover shock; Volmer,
Kurvengetriebe). Where R passes 0 smoothly, d grows as R' t^3 / (6 M). The impact speed is the rate
of the gap at the moment when it equals the backlash. Between two discs the gap is measured along
the normal of the disc that takes over, and the backlash is the clearance of its roller.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.effects.effect import Subject
from camgeo.effects.lift_off.cells import MOST_HALVINGS, ORDERS, ROUNDING, Nodes, cells_from
from camgeo.effects.ranges import runs
from camgeo.effects.results import ContactForce, Inertia
from camgeo.effects.touching import leverage_of
from camgeo.effects.wording import degrees, missed
from camgeo.motion.time_course import TimeCourse
from camgeo.numeric.arrays import FloatArray
from camgeo.numeric.roots import bracketed_roots, sign_changes
from camgeo.units import TURN

MOST_AT_ONCE: Final = 64
"""Cells that are evaluated at a time at most."""

PROBES: Final = 65
"""Points of a cell at which the end of the flight is searched for."""


@dataclass(frozen=True, slots=True)
class Change:
    """The roller leaves one flank for the other.

    Attributes
    ----------
    leaving : cam angle [rad] in [0, 2 pi) up to which the first flank carries.
    carrying : from which the other one does; the same unless there is a range without force.
    sense : of the flank left behind, +1 for the inner one, -1 for the outer one.
    """

    leaving: float
    carrying: float
    sense: int


def flank_changes(contact: ContactForce) -> tuple[int, tuple[Change, ...]]:
    """The flank that carries first, 0 if none does, and the changes over a turn.

    `contact.edges` has all angles at which the force changes sign. Ranges without force belong to
    no flank.
    """
    edges = contact.edges
    sign = np.sign(contact.normal(0.5 * (edges[:-1] + edges[1:]), "right")).astype(int)
    both = [(pieces, sense) for sense in (1, -1) for pieces in runs(sign == sense)]
    if not both:
        return 0, ()
    both.sort(key=lambda each: each[0][0])
    found = []
    for (pieces, sense), (others, other) in zip(both, both[1:] + both[:1], strict=True):
        if sense != other:
            leaving, carrying = edges[pieces[-1] + 1], edges[others[0]]
            found.append(Change(float(leaving % edges[-1]), float(carrying), sense))
    found.sort(key=lambda change: change.leaving)
    return both[0][1], tuple(found)


@dataclass(frozen=True, slots=True)
class Impact:
    """The end of a flight.

    Attributes
    ----------
    cam_angle : [rad] in [0, 2 pi).
    duration : of the flight, as a cam angle [rad].
    speed : of the roller relative to the flank, along the normal [mm/s].
    crossed : whether the roller has crossed the clearance; if not, it is back on its flank.
    error : estimate of the relative error of `speed`.
    """

    cam_angle: float
    duration: float
    speed: float
    crossed: bool
    error: float


@dataclass(frozen=True, slots=True, eq=False)
class _Cell:
    """A cell [low, high] of cam angles [rad], and at n angles in it what moves the free follower.

    Attributes
    ----------
    angles : (n,) [rad].
    lever : (n,) leverage of the normal of the side that takes over.
    push : (n,) acceleration of the deviation, per s^2.
    pace : (n,) speed of the cam [rad/s].
    """

    low: float
    high: float
    angles: FloatArray
    lever: FloatArray
    push: FloatArray
    pace: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Clearance:
    """The clearance of a roller between the two flanks, or of a follower between two discs.

    Attributes
    ----------
    subject : the design.
    contact : the contact force.
    inertia : its mass must be above 0 over the whole turn.
    backlash : [mm], above 0.
    """

    subject: Subject
    contact: ContactForce
    inertia: Inertia
    backlash: float

    def impact_after(self, change: Change, tolerance: float) -> Impact | None:
        """The impact after `change`, None if the flight does not end within a turn.

        Its speed has the relative accuracy `tolerance`.

        Raises
        ------
        EffectError
            If the tolerance cannot be reached.
        """
        for halvings in range(MOST_HALVINGS + 1):
            rough, fine = (self._flight(change, Nodes.of(n), halvings) for n in ORDERS)
            if fine is None and rough is None:
                return None
            error = 1.0
            if fine is not None and rough is not None and rough[2] == fine[2]:
                error = abs(rough[1] - fine[1]) / abs(fine[1])
            if error <= max(tolerance, ROUNDING):
                break
        else:
            left = f"the impact speed after cam angle {degrees(change.leaving)}"
            raise missed(left, error, "itself", tolerance, change.leaving)
        assert fine is not None  # its error would be 1
        angle, speed, crossed = fine
        return Impact(
            cam_angle=angle % TURN,
            duration=angle - change.leaving,
            speed=abs(speed),
            crossed=crossed,
            error=max(error, 2.0**-52),
        )

    def _flight(
        self, change: Change, nodes: Nodes, halvings: int
    ) -> tuple[float, float, bool] | None:
        """Cam angle [rad] of the impact, rate of the gap [mm/s] there, whether it has crossed."""
        course = self.subject.state.course
        assert course is not None  # there is inertia, which needs a speed
        velocity = way = 0.0
        cells = cells_from(change.leaving, self.contact.edges, 0.5**halvings)
        for cell in self._sampled(change, course, cells, nodes.places):
            low, high = ends = cell.low, cell.high
            rate = nodes.integral(cell.push / cell.pace, velocity, ends)
            path = nodes.integral(rate(cell.angles) / cell.pace, way, ends)
            gap = nodes.function(cell.lever * path(cell.angles), ends)
            end = _first(gap, low, high, self.backlash)
            if end is not None:
                angle, crossed = end
                omega = float(course.rates(np.array([angle % TURN]))[0, 0])
                speed = float(gap.deriv()(angle)) * omega
                return angle, speed if crossed else speed * self._share(change, angle), crossed
            velocity, way = float(rate(high)), float(path(high))
        return None

    def _sampled(
        self,
        change: Change,
        course: TimeCourse,
        cells: Iterator[tuple[float, float]],
        x: FloatArray,
    ) -> Iterator[_Cell]:
        """The cells with these ends [rad], sampled at the places `x` (n,) of each, from -1 to 1.

        Many are evaluated at a time, the more the longer the flight.
        """
        size = 1
        while block := list(itertools.islice(cells, size)):
            lows, highs = np.array(block).T[:, :, None]
            angles = 0.5 * (lows + highs) + 0.5 * (highs - lows) * x
            phi = np.mod(angles, TURN).ravel()
            rates = course.rates(phi)
            # n of the side that takes over points towards it; in a groove it is the other gap.
            lever = -leverage_of(self.subject, phi, "right", -change.sense)
            push = -self.contact.demand(phi, "right") / self.inertia.to_follower(phi, "right")
            found = (each.reshape(angles.shape) for each in (lever, push, rates[0]))
            for ends, *values in zip(block, angles, *found, strict=True):
                yield _Cell(*ends, *values)
            size = min(2 * size, MOST_AT_ONCE)

    def _share(self, change: Change, angle: float) -> float:
        """Motion along the normal of the side left, relative to the next side; 1 in a groove."""
        here = np.array([angle % TURN])
        left, met = (
            float(leverage_of(self.subject, here, "right", sense)[0])
            for sense in (change.sense, -change.sense)
        )
        return -left / met


def _first(
    gap: Callable[[FloatArray], FloatArray], low: float, high: float, backlash: float
) -> tuple[float, bool] | None:
    """Where in a cell the gap first reaches the backlash (True) or closes again (False)."""
    probes = np.linspace(low, high, PROBES)
    values = gap(probes)
    found = []
    # A closing gap above this level is rounding; at the start it is 0.
    for level, crossed in ((backlash, True), (-1e-9 * backlash, False)):
        ends = sign_changes(probes, values - level)
        roots = bracketed_roots(lambda x, level=level: gap(x) - level, *ends)  # type: ignore[misc]  # mypy infers no type for a lambda with defaults
        found += [(float(root), crossed) for root in roots[:1]]
    return min(found) if found else None
