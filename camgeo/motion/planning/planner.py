"""From requests to a motion plan: classes, values and laws, in this order."""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import Decimal
from typing import Final

import numpy as np

from camgeo.errors import GeometryError
from camgeo.motion.boundary import over_span
from camgeo.motion.laws import make_law
from camgeo.motion.laws.law import Law
from camgeo.motion.piece import SNAP
from camgeo.motion.plan import Dwell, MotionPlan, Move, Segment, SplineMove
from camgeo.motion.planning.build import keyed, law_without_stroke, named_law, normalised
from camgeo.motion.planning.chain import STRAIGHT, Chain, Link, chain_of
from camgeo.motion.planning.request import (
    AUTO,
    MoveRequest,
    PointsRequest,
    Request,
    TableRequest,
    Unit,
)
from camgeo.motion.planning.tasks import settle_straight_lines, settle_tasks, task_of
from camgeo.motion.planning.values import settle_values
from camgeo.motion.spans import joints_of
from camgeo.numeric import checked

RESOLVED: Final = 4.0 * SNAP
"""Shortest part of a law [rad]; two cam angles closer than `SNAP` are the same."""

PLAIN: Final = Unit()
"""No unit: messages state values as they are, per radian."""

MOMENT: Final = Dwell(Decimal(0))
"""A rest of zero length: no link of a chain, but a segment of the plan."""


def plan_motion(requests: Sequence[Request], unit: Unit = PLAIN) -> MotionPlan:
    """The motion plan of `requests`, in the order of the cam angle, over one turn.

    Joints get the values that are stated; a rest or a straight line on one side decides the rest.
    A turn has the acceleration that a neighbouring law requires, where there is no choice, or that
    suits the laws on both sides, see `camgeo.motion.planning.turns`. What is still open is chosen
    as smooth as possible, see `camgeo.motion.planning.values`.

    Segment k of the plan is that of request k, also where a rest has no length.

    `unit` is the unit of positions in messages.

    Raises
    ------
    GeometryError
        With the key of the segment: if the laws cannot join, no law exists with the required
        values, or the segments do not make a turn (see `MotionPlan`).
    """
    _check_spans(requests)
    chain = chain_of(requests, unit)
    settle_straight_lines(chain)
    if any(isinstance(request, TableRequest) for request in requests):
        from camgeo.motion.planning.tables import settle_tables

        settle_tables(chain)
    settle_tasks(chain)
    settle_values(chain)
    made = {link.number: _segment(chain, index) for index, link in enumerate(chain.links)}
    numbers = range(len(requests))
    return MotionPlan(tuple(made.get(number, MOMENT) for number in numbers))


def _check_spans(requests: Sequence[Request]) -> None:
    """The checks of `MotionPlan` on spans, before anything is planned with them."""
    kinds = (Dwell, MoveRequest, PointsRequest, TableRequest)
    for number, request in enumerate(checked.instances("motion", requests, kinds, "requests")):
        if request.span == 0 and not isinstance(request, Dwell):
            raise GeometryError(
                "a move of zero length cannot change the position (infinite velocity)",
                key=f"motion[{number + 1}].span",
                value=str(request.span),
            )
    joints_of(request.span for request in requests)


def _segment(chain: Chain, number: int) -> Segment:
    link = chain.links[number]
    match link.request:
        case Dwell():
            return link.request
        case MoveRequest():
            return _move(chain, number, link.request)
        case PointsRequest():
            return _spline_move(chain, number, link.request)
        case TableRequest():
            from camgeo.motion.planning.tables import fit

            return fit(chain, number)


def _move(chain: Chain, number: int, request: MoveRequest) -> Move:
    link, task = chain.links[number], task_of(chain, number)
    if link.straight:
        return Move(request.span, request.to, make_law(STRAIGHT, "G-G"))
    if link.stroke == 0.0:
        moving = law_without_stroke(chain, number)
        law = moving or make_law("polynomial-345")
        return Move(request.span, request.to, law, scale=1.0 if moving else None)
    if request.law == AUTO:
        from camgeo.motion.planning.auto import best_law

        with keyed(link):
            law = best_law(task, normalised(chain, number), request.parameters, request.optimise)
    else:
        law = named_law(chain, number, task)
    _check_resolved(link, law)
    return Move(request.span, request.to, law)


def _check_resolved(link: Link, law: Law) -> None:
    """GeometryError if a part of a law is too short for cam angles to distinguish its ends.

    The least allowed is a millionth of the shortest span.
    """
    if law.inflection is None:
        return
    curved = law.parameters.get("curved", 1.0)
    shorter = curved * min(law.inflection, 1.0 - law.inflection) * link.length
    if shorter < RESOLVED:
        raise GeometryError(
            f"would speed up or slow down within {math.degrees(shorter):.2g} degrees of its"
            f" {math.degrees(link.length):.6g}, too few for cam angles to distinguish from a jump;"
            f" allowed: {math.degrees(RESOLVED):.2g} or more. A longer span beside a sharp turn, a"
            " dwell there, even dwell = 0, or a larger inflection or curved part makes it possible",
            key=f"{link.key}.law",
            value=law.name,
        )


def _spline_move(chain: Chain, number: int, request: PointsRequest) -> SplineMove:
    link, start, end = chain.links[number], chain.before(number), chain.after(number)
    length = link.length
    inner = {index + 1: over_span(values, length) for index, values in request.given.items()}
    from camgeo.motion.points import clamped_spline

    try:
        spline = clamped_spline(
            np.concatenate(([0.0], request.shares, [1.0])),
            np.concatenate(([0.0], request.positions - start.position, [link.stroke])),
            over_span(start.values, length),
            over_span(end.values, length),
            inner,
        )
    except GeometryError as error:
        raise GeometryError(error.message, f"{link.key}.points", error.value) from error
    return SplineMove(request.span, start.position + link.stroke, spline)
