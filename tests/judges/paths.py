"""Paths of other interpreters, compared with ours."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import dataclass

from camgeo_export.gcode.moves import CutterMove
from camgeo_export.interpreter.run import Run


@dataclass(frozen=True)
class Leg:
    """A move as another interpreter runs it [mm].

    `centre` is that of an arc, `turn` positive counter-clockwise; None and 0 for lines.
    """

    line: int
    kind: str
    end: tuple[float, float, float]
    centre: complex | None = None
    turn: int = 0


def difference(found: Run, legs: list[Leg]) -> float:
    """The largest distance [mm] of an end or a centre, over all moves; they must be of one kind.

    Moves to places that a program does not state, such as the machine's reference, are left out.
    """
    by_line: dict[int, list[Leg]] = defaultdict(list)
    for leg in legs:
        by_line[leg.line].append(leg)
    worst = 0.0
    for move in found.moves:
        if math.isinf(move.z_end):
            by_line.pop(move.line, None)
            continue
        assert by_line[move.line], f"line {move.line}: only we move"
        worst = max(worst, _apart(move, by_line[move.line].pop(0)))
    rest = [leg for each in by_line.values() for leg in each]
    assert not rest, f"line {rest[0].line}: only the other one moves"
    return worst


def _apart(move: CutterMove, leg: Leg) -> float:
    assert move.kind == leg.kind, f"line {move.line}: {move.kind} and {leg.kind}"
    pairs = zip((move.end.real, move.end.imag, move.z_end), leg.end, strict=True)
    apart = [abs(own - other) for own, other in pairs if not math.isnan(own)]
    if leg.centre is not None:
        assert (move.sweep > 0.0) == (leg.turn > 0), f"line {move.line}: another sense"
        apart.append(abs(move.centre - leg.centre))
    return max(apart, default=0.0)
