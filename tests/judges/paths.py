"""Paths of other interpreters, compared with ours."""

from __future__ import annotations

import cmath
import math
from collections import defaultdict
from dataclasses import dataclass

from camgeo_export.interpreter.moves import CutterMove, ProgramRun


@dataclass(frozen=True)
class Leg:
    """A move as another interpreter runs it [mm].

    `centre` is that of an arc, `turn` positive counter-clockwise; None and 0 for lines. They are
    those of the `plane`, whose axes are two of XYZ: ZX and YZ in this order. `feed` [mm/min] is
    that of a cut, NaN if it is not known.
    """

    line: int
    kind: str
    end: tuple[float, float, float]
    centre: complex | None = None
    turn: int = 0
    plane: str = "XY"
    feed: float = math.nan


def difference(found: ProgramRun, legs: list[Leg]) -> float:
    """The largest distance [mm] of an end or a centre, over all moves; they must be of one kind.

    Moves to places that a program does not state, such as the machine's reference, are left out.
    """
    by_line: dict[int, list[Leg]] = defaultdict(list)
    last = (math.inf,) * 3
    for leg in legs:
        if leg.centre is not None or math.dist(leg.end, last) > 1e-9:
            by_line[leg.line].append(leg)
        last = leg.end
    worst = 0.0
    for move in found.moves:
        if math.isinf(move.z_end):
            by_line.pop(move.line, None)
            continue
        if move.kind != "arc" and (move.end, move.z_end) == (move.start, move.z_start):
            continue
        if cmath.isnan(move.start + move.z_start) and not by_line[move.line]:
            continue  # from where it is not known, and so perhaps to where it was
        assert by_line[move.line], f"line {move.line}: only we move"
        leg = by_line[move.line][0]
        if leg.plane == "XY":
            worst = max(worst, _apart(move, by_line[move.line].pop(0)))
            continue
        worst = max(worst, _off(move, leg))
        if math.dist((move.end.real, move.end.imag, move.z_end), leg.end) <= NEAR:
            by_line[move.line].pop(0)
    rest = [leg for each in by_line.values() for leg in each]
    assert not rest, f"line {rest[0].line}: only the other one moves"
    return worst


NEAR = 5e-3
"""How near the end of the last chord must be to that of its arc [mm]."""


def _off(move: CutterMove, leg: Leg) -> float:
    """How far a chord's end is off an arc in another plane than XY; those of a spiral are not
    compared.
    """
    assert leg.centre is not None
    axes = ["XYZ".index(axis) for axis in leg.plane]
    ends = (leg.end, (move.end.real, move.end.imag, move.z_end))
    last, own = (abs(complex(*(end[axis] for axis in axes)) - leg.centre) for end in ends)
    assert move.kind == "line", f"line {move.line}: {move.kind}"
    return 0.0 if abs(own - last) <= SPIRAL else abs(own - last)


SPIRAL = 0.1
"""Difference of the radii at the ends of an arc that a control takes [mm]."""


def _apart(move: CutterMove, leg: Leg) -> float:
    assert move.kind == leg.kind, f"line {move.line}: {move.kind} and {leg.kind}"
    pairs = zip((move.end.real, move.end.imag, move.z_end), leg.end, strict=True)
    apart = [abs(own - other) for own, other in pairs if not math.isnan(own)]
    if move.kind != "rapid" and not math.isnan(leg.feed):
        apart.append(abs(move.feed - leg.feed))
    if leg.centre is not None:
        assert (move.sweep > 0.0) == (leg.turn > 0), f"line {move.line}: another sense"
        turns = math.ceil(abs(move.sweep) / math.tau - 1e-9)
        assert turns == abs(leg.turn), f"line {move.line}: {turns} turns and {leg.turn}"
        apart.append(abs(move.centre - leg.centre))
    return max(apart, default=0.0)
