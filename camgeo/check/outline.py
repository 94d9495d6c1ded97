"""Check of what is left of a flank: global undercut, and what the real disc leaves out."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

from camgeo.check.finding import Finding, Severity
from camgeo.outline.outline import Outline
from camgeo.units import TURN

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
    """Where the flank `name` is cut off though its curvature holds, and lobes that fall away.

    Parameters
    ----------
    undercut : ranges of local undercut, which `check_undercut` tells.
    severity : of a flank that is cut off: "fatal" if no disc is made of it, else "broken".
    kinks : cam angles [rad] at which the velocity jumps, which `check_closure` tells.
    """
    found = []
    told = [*(start for start, _ in undercut), *kinks]
    for start, end in outline.dropped:
        if any((place - start) % TURN <= end - start for place in told):
            continue
        found.append(
            Finding(
                name=f"global-undercut-{name}",
                severity=severity,
                sentence=(
                    f"{name} flank: cut off from cam angle {_degrees(start)} to {_degrees(end)} deg"
                    " though its radius of curvature holds: two of its sides are closer than the"
                    " roller is wide (global undercut)"
                ),
                value=math.degrees(end - start),
                limit=0.0,
                unit="deg",
                cam_angle=start,
                cam_range=(start, end % TURN),
            )
        )
    for lobe in outline.lobes:
        from camgeo.outline.area import area  # few cams have lobes to be measured

        size = abs(area(lobe))
        found.append(
            Finding(
                name=f"lobe-{name}",
                severity=severity,
                sentence=f"{name} flank: a lobe of {size:.6g} mm^2 is cut off and falls away",
                value=size,
                limit=0.0,
                unit="mm^2",
            )
        )
    if not outline.is_trimmed:
        found.append(
            Finding(
                name=f"global-undercut-{name}",
                severity="ok",
                sentence=f"{name} flank: it does not cross itself",
                value=0.0,
                limit=0.0,
                unit="deg",
            )
        )
    return tuple(found)


def check_lost_stroke(
    replay: Replay, name: str, unit: Literal["mm", "rad"], severity: Severity
) -> Finding:
    """How much of its lift the follower loses on the real disc, and what that does to it.

    `unit` is that of the lift.
    """
    loss = replay.largest_loss
    value, told = (loss.value, "mm") if unit == "mm" else (math.degrees(loss.value), "deg")
    jumps = []
    if len(replay.shocks):
        jumps.append(f"{len(replay.shocks)} shocks")
    if len(replay.drops):
        jumps.append(f"{len(replay.drops)} drops off an edge")
    return Finding(
        name=f"lost-stroke-{name}",
        severity=severity,
        sentence=(
            f"{name} flank: on the real disc the follower loses up to {value:.4g} {told} of its"
            f" lift, at cam angle {_degrees(loss.place)} deg"
            + (f", with {' and '.join(jumps)}" if jumps else "")
        ),
        value=value,
        limit=0.0,
        unit=told,
        cam_angle=loss.place,
    )


def no_outline(name: str, reason: str) -> Finding:
    """The finding that a flank leaves no disc, or none that can be told."""
    return Finding(name=f"outline-{name}", severity="fatal", sentence=f"{name} flank: {reason}")


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle % TURN):.6f}"
