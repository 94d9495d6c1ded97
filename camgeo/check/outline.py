"""Checks of what remains of a flank: global undercut, and the stroke lost on the real disc."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from camgeo.check.finding import STATED, Finding, Severity
from camgeo.outline.outline import Outline
from camgeo.units import TURN, LiftUnit
from camgeo.wording import at_cam_angles, counted, over_cam_angles

if TYPE_CHECKING:
    from camgeo.outline.replay_result import Replay

Range = tuple[float, float]
"""Cam angles [rad], the end below the start if the range passes cam angle 0."""


def check_outline(
    outline: Outline,
    name: str,
    undercut: list[Range],
    severity: Severity,
    kinks: Sequence[float] = (),
) -> tuple[Finding, ...]:
    """Where the flank `name` is cut off in spite of its curvature, and lobes that fall away.

    Parameters
    ----------
    undercut : ranges of local undercut, which `check_undercut` reports.
    severity : of a flank that is cut off: "no-disc" if no disc is made then, else "broken".
    kinks : cam angles [rad] at which the velocity jumps, which `check_closure` reports.
    """
    found, crossing = [], f"global-undercut-{name}"
    known = np.array([*(start for start, _ in undercut), *kinks])
    for start, end in outline.dropped:
        if np.any((known - start) % TURN <= end - start):  # a noisy table has thousands of both
            continue
        width, where = math.degrees(end - start), (start, end % TURN)
        sentence = (
            f"{name} flank: cut off {over_cam_angles(start, end, '.6f')} though its radius of"
            " curvature suffices: two of its sides are closer than the roller is wide (global"
            " undercut)"
        )
        found.append(Finding(crossing, severity, sentence, width, 0.0, "deg", start, where))
    for lobe in outline.lobes:
        from camgeo.outline.moments import area  # few cams have lobes to be measured

        size = abs(area(lobe))
        sentence = f"{name} flank: a lobe of {size:.6g} mm^2 is cut off and falls away"
        found.append(Finding(f"lobe-{name}", severity, sentence, size, 0.0, "mm^2"))
    if not outline.is_trimmed:
        sentence = f"{name} flank: it does not cross itself"
        found.append(Finding(crossing, "ok", sentence, 0.0, 0.0, "deg"))
    return tuple(found)


def check_lost_stroke(replay: Replay, name: str, unit: LiftUnit, severity: Severity) -> Finding:
    """How much of its lift the follower loses on the real disc, with shocks and drops.

    `unit` is that of the lift.
    """
    loss = replay.largest_loss
    scale, shown = STATED[unit]
    value = scale * loss.value
    jumps = []
    if len(replay.shocks):
        jumps.append(counted(len(replay.shocks), "shock"))
    if len(replay.drops):
        jumps.append(counted(len(replay.drops), "drop") + " off an edge")
    statement = (
        f"{name} flank: on the real disc the follower loses up to {value:.4g} {shown} of its lift,"
        f" {at_cam_angles(loss.place, form='.6f')}"
    )
    if jumps:
        statement += f", with {' and '.join(jumps)}"
    return Finding(f"lost-stroke-{name}", severity, statement, value, 0.0, shown, loss.place)
