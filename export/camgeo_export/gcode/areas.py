"""How near a program comes to the walls of an area that it clears."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

import numpy as np

from camgeo.contour.nearness import least_distance
from camgeo.toolpath.cut import AreaCut, LetterCut
from camgeo.toolpath.plane.track import Track
from camgeo_export.gcode.moves import CutterMove

FINE = 1e-3
"""Tolerance of the walls [mm]; their proved deviation counts in favour of the program."""


def too_near(cut: AreaCut | LetterCut, moves: Sequence[CutterMove]) -> float:
    """By how much [mm] the cuts among `moves` come nearer to a wall than the cutter's radius and
    the allowance; 0 if none does.
    """
    least = np.inf
    for wall in cut.walls:
        fit = wall.arcs(FINE, "fast")
        around = Track.around(fit.contour)
        for is_cut, group in groupby(moves, _moves_in_the_plane):
            if is_cut:
                least = min(least, least_distance(_track(list(group)), around) + fit.deviation)
    return float(max(0.0, cut.tool.radius + cut.allowance - least))


def _moves_in_the_plane(move: CutterMove) -> bool:
    return move.kind != "rapid" and move.start != move.end


def _track(moves: Sequence[CutterMove]) -> Track:
    vertices = np.array([moves[0].start, *(move.end for move in moves)])
    sweeps = np.array([move.sweep for move in moves])
    return Track(vertices, sweeps, np.array([move.centre for move in moves]))
