"""Nanoseconds per point of the exact curves, relative to the bare functions that they need.

Timed over one turn, each alone and with nothing shared: the pitch curve with three derivatives, the
inner working curve, the transmission angle and the curvature. Next to each stand the sines,
cosines, roots and arc tangents that it cannot do without, on the same array and into an existing
one. Arithmetic, memory and the search for the motion's segment are not counted on that side.

What cannot be avoided, at each point of the array:

- pitch and working curve: the cosine and the sine of the cam angle, for the rotation into the cam.
  Curvature and transmission angle do not depend on the rotation;
- working curve and curvature: a root, for the length of Z'; transmission angle: an arc tangent;
- oscillating roller: the cosine and the sine of the rocker angle. Translating roller: nothing;
- slider-crank: a root, for the area of the triangle of crank, coupler and pin. The direction of the
  crank is algebraic in it, so behind a linkage the rocker's cosine and sine cost nothing more;
- motion laws, at the points of their moves: a sine and a cosine for the laws of sines, at half of
  the points for the modified trapezoid; nothing for polynomials.

That is "least". Linkage and follower, however, are two parts each of which fits any other, and an
angle is what they exchange: "parts" counts its arc tangent, cosine and sine as needed too. Without
a linkage the two are the same.


    python benchmarks/evaluate.py [--points 1000,10000,100000,1000000] [--rounds 15] [SCENE ...]
"""

from __future__ import annotations

import argparse
import itertools
import platform
import statistics
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

import numpy as np

from camgeo.curve.pitch_curve import PitchCurve
from camgeo.curve.working_curve import WorkingCurve
from camgeo.design import Design
from camgeo.mechanism.linkage import LinkedMotion
from camgeo.mechanism.oscillating_roller import OscillatingRoller
from camgeo.motion.plan import MotionPlan, Move
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.load import load_scene
from camgeo.units import TURN

SCENES: Final = Path(__file__).resolve().parents[1] / "fixtures" / "scenes"

DEFAULT: Final = ("setzhub", "groove", "plate_translating")
"""Slider-crank and rocker with a polynomial; rocker with polynomial and modified trapezoid;
translating roller with modified sine and polynomial."""

LEAST_TIME: Final = 2e-3
"""A measurement is repeated until it takes this long [s], of which a clock tick is below 0.1 %."""

LAW_SHARE: Final = {
    "straight-line": 0.0,
    "quadratic-parabola": 0.0,
    "polynomial-345": 0.0,
    "simple-sine": 1.0,
    "inclined-sine": 1.0,
    "modified-trapezoid": 0.5,
    "modified-sine": 1.0,
}
"""Share of a move's points at which the law needs a sine and a cosine."""

Counts = dict[str, float]
"""Calls a point of each bare function."""

BARE: Final[dict[str, Callable[[FloatArray, FloatArray], object]]] = {
    "sin": lambda phi, out: np.sin(phi, out=out),
    "cos": lambda phi, out: np.cos(phi, out=out),
    "sqrt": lambda phi, out: np.sqrt(phi, out=out),
    "arctan2": lambda phi, out: np.arctan2(phi, 1.0, out=out),
}


def needed(curve: PitchCurve, plan: MotionPlan, *, parts: bool) -> dict[str, Counts]:
    """Bare calls a point of each quantity, see the module; `parts` with an angle handed over."""
    law = sum(
        LAW_SHARE[segment.law.name] * float(segment.span) / 360.0
        for segment in plan.segments
        if isinstance(segment, Move)
    )
    lift: Counts = {"sin": law, "cos": law}
    linked = isinstance(curve.motion, LinkedMotion)
    if linked:
        lift = added(lift, {"sqrt": 1.0})
    if linked and parts:
        lift = added(lift, {"arctan2": 1.0})
    if isinstance(curve.follower, OscillatingRoller) and (parts or not linked):
        lift = added(lift, {"sin": 1.0, "cos": 1.0})
    rotation: Counts = {"sin": 1.0, "cos": 1.0}
    return {
        "pitch curve, 3 derivatives": added(lift, rotation),
        "working curve": added(lift, rotation, {"sqrt": 1.0}),
        "transmission angle": added(lift, {"arctan2": 1.0}),
        "curvature": added(lift, {"sqrt": 1.0}),
    }


def added(*counts: Counts) -> Counts:
    """The sum, function by function."""
    return {name: sum(count.get(name, 0.0) for count in counts) for name in BARE}


def nanoseconds(work: Callable[[], object], points: int) -> float:
    """Time of `work` [ns] for each of its points, once."""
    repeats = 0
    began = time.perf_counter()
    while True:
        work()
        repeats += 1
        took = time.perf_counter() - began
        if took >= LEAST_TIME:
            return 1e9 * took / (repeats * points)


def measure(design: Design, curve: PitchCurve, plan: MotionPlan, points: int, rounds: int) -> None:
    """Print the table of one scene at one length of array."""
    phi = np.linspace(0.0, TURN, points, endpoint=False)
    out = np.empty_like(phi)
    inner = WorkingCurve(curve, -design.cam.follower.roller_radius)
    asked = (phi + start for start in itertools.count(0.0, 1e-9))  # none twice
    work: dict[str, Callable[[], object]] = {
        "pitch curve, 3 derivatives": lambda: curve.jet(next(asked)),
        "working curve": lambda: inner.point(next(asked)),
        "transmission angle": lambda: curve.transmission_angle(next(asked)),
        "curvature": lambda: curve.curvature(next(asked)),
    }
    bare = {name: (lambda call=call: call(phi, out)) for name, call in BARE.items()}
    times: dict[str, list[float]] = {name: [] for name in (*work, *bare)}
    for call in (*work.values(), *bare.values()):
        call()
    for _ in range(rounds):
        for name, call in (*work.items(), *bare.items()):
            times[name].append(nanoseconds(call, points))
    median = {name: statistics.median(values) for name, values in times.items()}

    print(f"\n{design.name}, {points} points; bare [ns]: ", end="")
    print(", ".join(f"{name} {median[name]:.2f}" for name in bare))
    print(f"{'':<28}{'ns a point':>11}{'least':>9}{'ratio':>8}{'parts':>9}{'ratio':>8}")
    least, parts = needed(curve, plan, parts=False), needed(curve, plan, parts=True)
    total = np.zeros(3)
    for name in work:
        row = [
            median[name],
            *(sum(n * median[f] for f, n in c[name].items()) for c in (least, parts)),
        ]
        total += row
        print_row(name, *row)
    print_row("all four", *(float(value) for value in total))


def print_row(name: str, own: float, least: float, parts: float) -> None:
    """One line of the table, all in ns a point."""

    def against(bare: float) -> str:
        return f"{bare:>9.1f}{own / bare:>8.1f}" if bare > 0.0 else f"{'none':>9}{'':>8}"

    print(f"{name:<28}{own:>11.1f}{against(least)}{against(parts)}")


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", default=[str(SCENES / f"{n}.toml") for n in DEFAULT])
    parser.add_argument("--points", default="1000,10000,100000,1000000")
    parser.add_argument("--rounds", type=int, default=15)
    arguments = parser.parse_args()
    print(
        f"Python {platform.python_version()}, numpy {np.__version__}, {platform.machine()},"
        f" median of {arguments.rounds} rounds"
    )
    for path in arguments.scenes:
        scene = load_scene(path)
        design = Design(scene)
        for points in arguments.points.split(","):
            measure(design, design.cam.disc.pitch_curve, scene.plan, int(points), arguments.rounds)


if __name__ == "__main__":
    main()
