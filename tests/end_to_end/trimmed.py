"""What is left of a flank that undercuts, found by sampling and Newton's method.

Nothing of `camgeo.geometry.outline` is used: a sample of the flank is covered if it is nearer to
the pitch curve than the roller's radius, and where covered stretches begin and end the flank
crosses itself. It finds what the fixture scenes have, tails wider than its samples, and no more.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camgeo.design.design import Design
from camgeo.numeric.arrays import FloatArray
from tests.end_to_end.exact import TURN, WHOLE, Flank, Kept, half_width
from tests.measuring import DensePath

SAMPLES = 5_000
"""Of a flank between two jumps of the velocity."""

PITCH = 100_000
"""Points of the pitch curve: chords of 4e-2 mm at most, sagitta h^2 kappa/8 below `COVERED`."""

COVERED = 2e-5
"""A sample this much nearer [mm] than the roller's radius is covered."""

KINK = 1e-6
"""A larger angle between the tangents at a joint [rad] is a jump of the velocity."""

STEPS = 30
"""Largest number of steps of Newton's method."""

SETTLED = 1e-14
"""Its last step [rad]."""


@dataclass
class _Run:
    """A stretch whose samples are clear; an end that is sharp lies at a jump of the velocity."""

    start: float
    end: float
    sharp_start: bool
    sharp_end: bool


def kept_of(design: Design, side: int) -> Kept:
    """What is left of the inner (-1) or outer (+1) flank; whole if the scene does not trim."""
    if design.scene.limits.undercut != "trim":
        return WHOLE
    flank = Flank(design, side * half_width(design))
    runs = _runs(flank)
    following = {k: _next(flank, runs, k) for k in range(len(runs))}
    for k, j in following.items():
        if not runs[k].sharp_end:
            runs[k].end, runs[j].start = _crossing(flank, runs[k].end, runs[j].start)
    loops, left = [], set(following)
    while left:
        loop = [min(left)]
        while following[loop[-1]] != loop[0]:
            loop.append(following[loop[-1]])
        left -= set(loop)
        loops.append(_loop(flank, [runs[k] for k in loop]))
    (main,) = [kept for kept in loops if _winds(Flank(design, flank.distance, kept))]
    return main


def pitch_of(design: Design) -> Kept:
    """The pitch curve, its corners as hinges."""
    kinks = [float(angle) for angle in _kinks(design)]
    if not kinks:
        return WHOLE
    stretches = tuple(zip(kinks, [*kinks[1:], kinks[0] + TURN], strict=True))
    ends = np.array([end for _, end in stretches])
    return Kept(stretches, tuple(complex(z) for z in design.cam.disc.pitch_curve.point(ends)))


def _kinks(design: Design) -> FloatArray:
    """Cam angles [rad] at which the velocity jumps."""
    phi = np.unique(np.append(design.cam.drive.motion.breaks, 0.0))
    before, after = (design.cam.disc.pitch_curve.jet(phi, side)[1] for side in ("left", "right"))
    return np.asarray(phi[np.abs(np.angle(after / before)) > KINK])


def _runs(flank: Flank) -> list[_Run]:
    design = flank.design
    path = DensePath(Flank(design, 0.0, pitch_of(design)).dense(PITCH))
    runs = []
    kinks = [float(angle) for angle in _kinks(design)]
    for start, end in pitch_of(design).stretches:
        phi = np.linspace(start, end, SAMPLES)
        points = np.append(flank.points(phi[:-1]), flank.points(phi[-1:], left=True))
        clear = path.distances(points) > abs(flank.distance) - COVERED
        edges = np.flatnonzero(np.diff(np.concatenate(([False], clear, [False]))))
        for first, behind in zip(edges[::2], edges[1::2], strict=True):
            run = _Run(
                start=float(phi[first]),
                end=float(phi[behind - 1]),
                sharp_start=bool(kinks) and first == 0,
                sharp_end=bool(kinks) and behind == len(phi),
            )
            runs.append(run)
        if not kinks and clear[0] and len(runs) > 1:  # the turn's beginning is none of the flank's
            runs[-1].end = runs.pop(0).end + TURN
    return runs


def _next(flank: Flank, runs: list[_Run], k: int) -> int:
    """The run that begins where run `k` ends: beyond the jump there, or at the crossing."""
    if runs[k].sharp_end:
        (j,) = [
            j
            for j, run in enumerate(runs)
            if run.sharp_start and abs((run.start - runs[k].end + 1.0) % TURN - 1.0) < KINK
        ]
        return j
    starts = [j for j, run in enumerate(runs) if not run.sharp_start]
    gaps = np.abs(
        flank.points(np.array([runs[j].start for j in starts]))
        - flank.points(np.array([runs[k].end]))
    )
    return starts[int(np.argmin(gaps))]


def _crossing(flank: Flank, first: float, second: float) -> tuple[float, float]:
    """Cam angles [rad] near those given at which the flank is at the same point."""
    pair = np.array([first, second])
    for _ in range(STEPS):
        points, rates = flank.rates(pair)
        gap = points[1] - points[0]
        slopes = np.array([[rates[0].real, -rates[1].real], [rates[0].imag, -rates[1].imag]])
        step = np.linalg.solve(slopes, np.array([gap.real, gap.imag]))
        pair = pair + step
        if np.max(np.abs(step)) < SETTLED:
            break
    points = flank.points(pair)
    assert abs(points[1] - points[0]) < 1e-12 * abs(points[0])
    assert np.max(np.abs(pair - (first, second))) < 0.01 * TURN
    return float(pair[0]), float(pair[1])


def _loop(flank: Flank, runs: list[_Run]) -> Kept:
    hinges = []
    for run in runs:
        end = np.array([run.end])
        point = flank.design.cam.disc.pitch_curve.point(end) if run.sharp_end else flank.points(end)
        hinges.append(complex(point[0]))
    return Kept(tuple((run.start, run.end) for run in runs), tuple(hinges))


def _winds(flank: Flank) -> bool:
    """Whether the outline goes round the cam axis."""
    points = flank.dense(SAMPLES)
    turned = np.angle(np.roll(points, -1) / points)
    return round(abs(float(np.sum(turned))) / TURN) == 1
