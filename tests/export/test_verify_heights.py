"""Heights of cuts: level at their depths, and on ramps that are printed in steps."""

from __future__ import annotations

import cmath
import math

from hypothesis import assume, given
from hypothesis import strategies as st

from camgeo.milling.cut import Cut
from camgeo_export.gcode.moves import CutterMove
from camgeo_export.verify.gcode import at_no_height
from tests.toolpath.milled import tool

RADIUS = 30.0


def arcs(turns: list[float], z: list[float]) -> list[CutterMove]:
    """Around a circle, from turn to turn and from height to height."""
    return [
        CutterMove(
            "arc",
            RADIUS * cmath.exp(2j * math.pi * turns[k]),
            RADIUS * cmath.exp(2j * math.pi * turns[k + 1]),
            z[k],
            z[k + 1],
            0j,
            2.0 * math.pi * (turns[k + 1] - turns[k]),
            *(0.0, 100.0, 1000.0, "rough", 1, 1, k + 1),
        )
        for k in range(len(turns) - 1)
    ]


def ramps(depths: list[float], joints: list[float], step: float) -> list[CutterMove]:
    """Down a turn to each depth, evenly, and once around the last; heights printed in steps."""
    turns = [0.0]
    for lap in range(len(depths) + 1):
        turns += [lap + each for each in (*joints, 1.0)]
    deep = [0.0, *depths, depths[-1]]
    z = []
    for turn in turns:
        lap = min(int(turn), len(depths))
        exact = deep[lap] + (turn - lap) * (deep[min(lap + 1, len(depths))] - deep[lap])
        z.append(round(exact / step) * step)
    return arcs(turns, z)


def cut_of(depths: list[float]) -> Cut:
    return Cut(name="rough", strategy="slot", tool=tool(8.0), top=0.0, depths=tuple(depths))


@given(
    joints=st.lists(st.floats(1e-3, 0.999), max_size=12, unique=True).map(sorted),
    passes=st.integers(1, 5),
    steps=st.floats(2.1, 40.0),
)
def test_a_ramp_is_none_of_the_depths_and_no_fault(
    joints: list[float], passes: int, steps: float
) -> None:
    """However many of its pieces are printed level."""
    step = 1e-3
    depths = [-step * steps * (k + 1) for k in range(passes)]
    assert at_no_height(cut_of(depths), ramps(depths, joints, step), step) is None


@given(share=st.floats(0.2, 0.8), steps=st.floats(20.0, 4000.0))
def test_a_level_turn_at_no_depth_is_found(share: float, steps: float) -> None:
    step = 1e-3
    depth = -step * steps
    wrong = round(share * steps) * -step
    assume(min(wrong - depth, -wrong) > 4.0 * step)
    moves = arcs([0.0, 0.5, 1.0, 1.5, 2.0, 3.0], [0.0, 0.5 * wrong, wrong, wrong, wrong, depth])
    moves += arcs([3.0, 4.0], [depth, depth])
    found = at_no_height(cut_of([depth]), moves, step)
    assert found is not None
    assert found.z_end == wrong
    assert at_no_height(cut_of([wrong, depth]), moves, step) is None
