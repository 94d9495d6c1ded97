"""Time of sizing: the smallest base circle, and the map of possible places of the cam axis.

For each scene, the best of several rounds in one process:

- "smallest": the exact smallest base circle for the scene's transmission angle alone; then with the
  rule for the radius of curvature, Flocke's construction and the ratings of all of them;
- "map": 200 x 200 places of the cam axis around the answer, exactly, and by brute force: u and v of
  the transmission angle at 720 cam angles for each place, with the motion evaluated once for all.
  Also the transmission angle as the rest of camgeo computes it, place by place, for a sample of the
  places, extrapolated to all of them.

Brute force answers less than the exact map, since it sees only its cam angles. The places at which
the two differ are counted.

    python benchmarks/sizing.py [--scenes setzhub,plate_translating,schnitt] [--rounds 5]
        [--angles 720]
"""

from __future__ import annotations

import argparse
import math
import platform
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

import numpy as np

import camgeo
from camgeo.check.disc import transmission_angle_limit
from camgeo.check.sizing.smallest import Sizing, row_limits, smallest_place
from camgeo.check.sizing.task import RollerTask
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import BoolArray, FloatArray

SCENES: Final = Path(__file__).parents[1] / "fixtures" / "scenes"
POINTS: Final = 200
EVERY: Final = 20
"""One row and column in so many is asked of the pitch curve itself."""


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Time of sizing.")
    parser.add_argument("--scenes", default="setzhub,plate_translating,schnitt")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--angles", type=int, default=720)
    arguments = parser.parse_args()
    print(f"Python {platform.python_version()}, numpy {np.__version__}; ms, best of rounds")
    head = ("angle alone", "with ratio", "map", "brute", "brute/map", "one by one", "differ")
    print(f"{'scene':20}" + "".join(f"{name:>13}" for name in head))
    for name in arguments.scenes.split(","):
        measure(name, arguments.rounds, arguments.angles)


def measure(name: str, rounds: int, angles: int) -> None:
    """Print the row of a scene."""
    design = camgeo.load(SCENES / f"{name}.toml")
    task, limits = RollerTask.from_cam(design.cam), design.scene.limits
    angle, ratio = transmission_angle_limit(task.cam, limits), limits.radius_ratio
    tangent = math.tan(angle)
    alone = best(lambda: smallest_place(task, tangent), rounds)
    both = best(lambda: Sizing.solve(task, angle, ratio), rounds)
    found = Sizing.solve(task, angle, ratio).answer
    if found is None:
        print(f"{name:20}infeasible")
        return
    columns = found.place.real + found.base_radius * np.linspace(-2.0, 2.0, POINTS)
    rows = found.place.imag + found.base_radius * np.linspace(-3.0, 1.5, POINTS)
    exact = best(lambda: feasible_map(task, tangent, columns, rows), rounds)
    brute = best(lambda: brute_map(task, tangent, columns, rows, angles), rounds)
    single = best(lambda: one_by_one(task, columns[::EVERY], rows[::EVERY], angles), rounds)
    differ = np.sum(
        feasible_map(task, tangent, columns, rows)
        != brute_map(task, tangent, columns, rows, angles)
    )
    cells = (alone, both, exact, brute)
    reported = "".join(f"{1e3 * cell:13.2f}" for cell in cells)
    print(f"{name:20}{reported}{brute / exact:13.1f}{1e3 * EVERY**2 * single:13.0f}{differ:13d}")


def feasible_map(
    task: RollerTask, tangent: float, columns: FloatArray, rows: FloatArray
) -> BoolArray:
    """(rows, columns) whether mu >= atan(`tangent`) all round with P at these places [mm]."""
    low, high = row_limits(task, tangent, rows)
    inside: BoolArray = (columns >= low[:, np.newaxis]) & (columns <= high[:, np.newaxis])
    return inside


def brute_map(
    task: RollerTask, tangent: float, columns: FloatArray, rows: FloatArray, angles: int
) -> BoolArray:
    """As `feasible_map`, by the transmission angle at so many cam angles at every place."""
    terms = task.terms(np.linspace(0.0, 2.0 * np.pi, angles, endpoint=False))
    out = np.empty((len(rows), len(columns)), dtype=np.bool_)
    for number, row in enumerate(rows):
        u, v = terms.across_and_along((columns + 1j * row)[:, np.newaxis])
        out[number] = np.all((u > 0.0) & (u >= tangent * np.abs(v)), axis=1)
    return out


def one_by_one(task: RollerTask, columns: FloatArray, rows: FloatArray, angles: int) -> int:
    """How many of the places have a mechanism, each with its smallest transmission angle."""
    phi = np.linspace(0.0, 2.0 * np.pi, angles, endpoint=False)
    count = 0
    for row in rows:
        for column in columns:
            try:
                np.min(task.pitch_curve(complex(column, row)).transmission_angle(phi))
            except GeometryError:
                continue
            count += 1
    return count


def best(call: Callable[[], object], rounds: int) -> float:
    """Shortest time [s] of some calls."""
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        call()
        times.append(time.perf_counter() - start)
    return min(times)


if __name__ == "__main__":
    main()
