"""The exact steady state of an elastic follower, relative to scipy's integrators at equal error.

The train of one mass has a natural frequency of 40.3 times the speed of the cam (no harmonic
coincides with this ratio) and the given damping. The exact solution is timed over a whole turn:
series of the demanded acceleration, modes, steady state. Each integrator of
`scipy.integrate.solve_ivp` starts in the steady state, which saves it the transient, and runs over
the same turn once, piece by piece, calling the motion as it needs it; its relative tolerances are
tried one after the other, and the fastest run counts whose error at ten points of each piece is
within the limit. "bare" is the time of that run without its calls of the motion, each counted at
its shortest time: no other way of providing the motion could save more. The reference is the exact
solution with the finest series, whose own error estimate is printed.

In addition, the cost of evaluating the response is compared with that of evaluating the motion at
the same points.


    python benchmarks/vibration.py [--scene plate_translating] [--damping 0.02] [--rounds 15]
"""

from __future__ import annotations

import argparse
import itertools
import platform
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, Final

import numpy as np
from scipy.integrate import solve_ivp

from camgeo.design.design import Design
from camgeo.dynamics.effects.vibration import Clock, motion_clock
from camgeo.dynamics.oscillator.steady import Base, Response, steady_state
from camgeo.dynamics.oscillator.train import one_mass
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.scene.scene import load_scene
from camgeo.units import TURN

SCENES: Final = Path(__file__).resolve().parents[1] / "fixtures" / "scenes"

RATIO: Final = 40.3

METHODS: Final = ("DOP853", "LSODA", "Radau", "RK45")

TOLERANCES: Final = tuple(10.0**-power for power in range(3, 14))

ASKED: Final = (1e-4, 1e-6, 1e-8, 1e-10)
"""Largest errors of the deflection, as shares of the stroke."""

MOST_SECONDS: Final = 6.0
"""A run that takes longer ends the search of its method."""

INSIDE: Final = 10
"""Points of each piece at which the error is evaluated."""


def smallest(work: Callable[[], object], rounds: int) -> float:
    """The least time of `work` [s]."""
    best = float("inf")
    for _ in range(rounds):
        began = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - began)
    return best


def integrated(
    base: Base, exact: Response, w: float, damping: float, **how: Any
) -> tuple[float, int]:
    """One turn by `solve_ivp`, from the steady state on.

    The largest error of the deflection, and how often the motion was called.
    """
    calls = 0
    z = exact.states(np.zeros(1), "right")[:2, 0]
    worst = 0.0
    for low, high in zip(base.edges[:-1].tolist(), base.edges[1:].tolist(), strict=True):
        middle = 0.5 * (low + high)

        def rate(t: float, z: FloatArray, middle: float = middle) -> tuple[float, float]:
            side: Side = "right" if t < middle else "left"
            forced = base.jet(np.array([t]), side)[2, 0]
            return z[1], -2.0 * damping * w * z[1] - w * w * z[0] - forced

        asked = np.linspace(low, high, INSIDE + 1)[1:]
        found = solve_ivp(rate, (low, high), z, t_eval=asked, **how)
        if not found.success:
            return float("inf"), calls
        calls += int(found.nfev)
        z = found.y[:, -1]
        worst = max(worst, float(np.max(np.abs(found.y[0] - exact.states(asked, "left")[0]))))
    return worst, calls


def runs(
    base: Base, exact: Response, w: float, damping: float, stroke: float
) -> list[tuple[float, float, float, str]]:
    """(error by the stroke, seconds, bare seconds, method) of all integrators and tolerances."""
    found = []
    once = itertools.cycle((np.array([0.3 * base.period]), np.array([0.4 * base.period])))
    call = smallest(lambda: base.jet(next(once), "right"), 200)
    for method in METHODS:
        for tolerance in TOLERANCES:
            how = {"method": method, "rtol": tolerance, "atol": 1e-2 * stroke * tolerance}
            began = time.perf_counter()
            error, calls = integrated(base, exact, w, damping, **how)
            took = time.perf_counter() - began
            found.append(
                (error / stroke, took, took - calls * call, f"{method}, rtol {tolerance:.0e}")
            )
            if took > MOST_SECONDS:
                break
    return found


def measure(design: Design, damping: float, rounds: int) -> None:
    """Print both tables."""
    course = design.drive.time_course
    assert course is not None
    clock: Clock = motion_clock(design.effects.subject, course)
    base = clock.base
    w = RATIO * TURN / base.period
    stroke = float(np.max(np.abs(design.cam.drive.plan.jet(clock.edges)[0])))
    exact = steady_state(one_mass(w, damping), base, 0.0)
    print(
        f"{design.name}: natural frequency {RATIO:g} times the speed, damping {damping:g}, "
        f"estimate of the reference's error {exact.error / stroke:.1e} of the stroke"
    )
    others = runs(base, exact, w, damping, stroke)
    print(
        f"{'error asked':>12}{'exact [ms]':>12}{'solve_ivp [ms]':>16}{'ratio':>8}"
        f"{'bare':>8}{'ratio':>8}  best"
    )
    for asked in ASKED:
        own = smallest(partial(steady_state, one_mass(w, damping), base, asked), rounds)
        coarse = steady_state(one_mass(w, damping), base, asked)
        within = [(took, bare, how) for error, took, bare, how in others if error <= asked]
        if coarse.error / stroke > asked or not within:
            print(f"{asked:>12.0e}{1e3 * own:>12.2f}{'not reached':>16}")
            continue
        took, bare, how = min(within)
        print(
            f"{asked:>12.0e}{1e3 * own:>12.2f}{1e3 * took:>16.1f}{took / own:>8.0f}"
            f"{1e3 * bare:>8.1f}{bare / own:>8.0f}  {how}"
        )
    own = smallest(lambda: steady_state(one_mass(w, damping), base, 0.0), rounds)
    print(f"{'finest':>12}{1e3 * own:>12.2f}")
    print(f"\n{'points':>12}{'motion [ns]':>12}{'response [ns]':>16}{'ratio':>8}  a point")
    for points in (1_000, 10_000, 100_000):
        t = np.linspace(0.0, base.period, points, endpoint=False)
        motion = smallest(partial(base.jet, t, "right"), rounds)
        answer = smallest(partial(exact.states, t, "right"), rounds)
        scale = 1e9 / points
        print(f"{points:>12}{scale * motion:>12.0f}{scale * answer:>16.0f}{answer / motion:>8.1f}")


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", default="plate_translating")
    parser.add_argument("--damping", type=float, default=0.02)
    parser.add_argument("--rounds", type=int, default=15)
    arguments = parser.parse_args()
    print(
        f"Python {platform.python_version()}, numpy {np.__version__}, {platform.machine()},"
        f" least of {arguments.rounds} rounds"
    )
    design = Design(load_scene(SCENES / f"{arguments.scene}.toml"))
    measure(design, arguments.damping, arguments.rounds)


if __name__ == "__main__":
    main()
