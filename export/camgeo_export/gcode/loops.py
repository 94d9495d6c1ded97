"""The closed paths that the moves of a program run in the plane, level or not."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable

from camgeo.reading import PATHS, PROGRAM, beyond
from camgeo.wording import counted
from camgeo_export.gcode.moves import CutterMove, Loop, loop_of, nearly_closed


def closed_paths(moves: Iterable[CutterMove], gap: float = 0.0) -> list[Loop]:
    """Closed runs of cuts in the plane; leads into and out of them are omitted.

    A run that ends up to `gap` [mm] from where it began is closed, too; its mismatch is larger by
    that. The cutter may come down along a run, or be lifted over tabs; where it moves along Z alone
    or traverses, the run ends.
    """
    found: list[Loop] = []
    run: list[CutterMove] = []
    # A point already visited closes a loop; the search then starts again, so that a path which
    # overlaps its beginning is found once, and no loop contains another.
    reached: dict[complex, int] = {}
    for move in moves:
        cuts = move.kind != "rapid" and not (move.start == move.end and move.sweep == 0.0)
        cuts = cuts and not (cmath.isnan(move.start) or math.isnan(move.z_start))
        if not cuts or (run and run[-1].operation != move.operation):
            found += nearly_closed(run, gap)
            run, reached = [], {}
        if not cuts:
            continue
        reached[move.start] = len(run)
        run.append(move)
        if len(found) > PATHS:
            raise beyond("the program", counted(len(found), "closed path"), PATHS, PROGRAM)
        if move.end in reached:
            found.append(loop_of(run[reached[move.end] :], 0.0))
            run, reached = [], {}
    return found + nearly_closed(run, gap)
