"""Solids against trimesh's own extrusion: triangles, bytes of STL, CPU time, peak memory.

Two tables, each of one run. The first is of the disc of a fixture scene at the same deviation: what
trimesh gets is a shapely polygon with vertices on the exact curve, evenly over the cam angle, as
few as lie within the tolerance by camgeo's proof, and those of the bore evenly on its arcs. How
many they are is known beforehand, so the times of trimesh are those of points, polygon, extrusion
and export, those of camgeo include the fit of the fewest chords with its proof.

The second gives the same points to both, an ellipse with a bore in 36 to 36,000 points: what the
body and its file alone take, and with which power of their number that grows.

Each measurement is a fresh process; the time is CPU time, the memory what the peak of the process
grows by. The files are written by trimesh in both.

    python benchmarks/extrusion.py [--scene setzhub] [--tolerances 0.1,0.01,0.001,0.0001]
        [--sizes 36,360,3600,36000] [--rounds 3]
"""

from __future__ import annotations

import argparse
import json
import math
import platform
import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import shapely
import trimesh

import camgeo
from camgeo.geometry.contour.contour import Contour, Fit
from camgeo.numeric.arrays import ComplexArray, FloatArray
from camgeo.part.boundaries import CurveBoundary, ExactBoundary, chord_fit
from camgeo.part.part import Layer, Part
from camgeo_export.solid.prism import body

ROOT: Final = Path(__file__).resolve().parents[1]

MIB: Final = 1024.0
"""Of the kibibytes in which the peak is told."""

MOST: Final = 2**20
"""Points of a polygon."""

HEIGHT: Final = 10.0
"""Of the bodies of given points [mm]."""

KEYS: Final = ("triangles", "bytes", "s")
"""Figures that are compared as ratios; the peak often does not grow at all."""

Found = dict[str, float]


@dataclass(frozen=True, eq=False)
class Given:
    """A boundary whose chords are known."""

    name: str
    hole: bool
    points: ComplexArray
    corner_radius: None = None

    def polyline(self, tolerance: float, effort: str = "fewest") -> Fit:
        return Fit(Contour.polygon(self.points), 0.0, tolerance)

    def offset(self, distance: float) -> Given:
        raise NotImplementedError


def measured(make: Callable[[], tuple[int, bytes]]) -> Found:
    """Triangles, bytes, CPU time [s] and growth of the peak [MiB] of one call."""
    before, began = _peak(), time.process_time()
    triangles, data = make()
    took = time.process_time() - began
    return {"triangles": triangles, "bytes": len(data), "s": took, "MiB": _peak() - before}


def _peak() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / MIB


def single(values: FloatArray) -> FloatArray:
    """The numbers of an STL file."""
    return values.astype(np.float32).astype(np.float64)


def by_camgeo(part: Part, tolerance: float) -> tuple[int, bytes]:
    """The body that the writers of solids take, in the same file."""
    solid = body(part, tolerance, single)
    mesh = trimesh.Trimesh(solid.vertices, solid.triangles, process=False)
    return len(mesh.faces), stl(mesh)


def stl(mesh: trimesh.Trimesh) -> bytes:
    """A binary STL file."""
    data = mesh.export(file_type="stl")
    assert isinstance(data, bytes)
    return data


def by_trimesh(outer: ComplexArray, holes: list[ComplexArray], height: float) -> tuple[int, bytes]:
    """The same of a polygon of these points, by trimesh."""
    rings = [np.column_stack((each.real, each.imag)) for each in (outer, *holes)]
    mesh = trimesh.creation.extrude_polygon(shapely.Polygon(rings[0], rings[1:]), height)
    return len(mesh.faces), stl(mesh)


def disc(scene: str) -> Part:
    """The part of a fixture scene, which must be one layer."""
    part = camgeo.load(ROOT / "fixtures" / "scenes" / f"{scene}.toml").disc.drawn.part
    if len(part.layers) != 1:
        raise SystemExit(f"{scene} has hubs or floors, trimesh extrudes one polygon")
    return part


def evenly(boundary: CurveBoundary, count: int) -> ComplexArray:
    """`count` points of a flank, evenly over the cam angle."""
    (stretch,) = boundary.path.stretches
    phi = np.linspace(stretch.start, stretch.end, count, endpoint=False)
    points: ComplexArray = np.asarray(stretch.curve.point(phi), dtype=np.complex128)
    return points


def fewest(boundary: CurveBoundary, tolerance: float) -> int:
    """How many points, evenly over the cam angle, lie within the tolerance [mm]."""

    def off(count: int) -> float:
        return boundary.deviation(Contour.polygon(evenly(boundary, count)))

    high = 64
    while off(high) > tolerance and high < MOST:
        high *= 2
    low = high // 2
    while high - low > max(1, high // 200):
        middle = (low + high) // 2
        low, high = (low, middle) if off(middle) <= tolerance else (middle, high)
    return high


def ellipse(count: int) -> tuple[ComplexArray, ComplexArray]:
    """A disc and its bore, of `count` points together."""
    turn = np.exp(2j * math.pi * np.arange(count - count // 3) / (count - count // 3))
    bore = 8.0 * np.exp(2j * math.pi * np.arange(count // 3) / (count // 3))
    return 50.0 * turn.real + 40.0j * turn.imag, bore


def one(job: dict[str, Any]) -> Found:
    """What a process measures."""
    if job["kind"] == "scene":
        part, tolerance = disc(job["scene"]), float(job["tolerance"])
        outline, bore = part.boundaries
        assert isinstance(outline, CurveBoundary)
        assert isinstance(bore, ExactBoundary)
        evenly(outline, 4)  # what the curve keeps is there for both
        if job["by"] == "camgeo":
            return measured(lambda: by_camgeo(part, tolerance))
        return measured(
            lambda: by_trimesh(
                evenly(outline, job["points"]),
                [chord_fit(bore.exact, tolerance).contour.vertices],
                part.thickness,
            )
        )
    outer, inner = ellipse(job["points"])
    if job["by"] == "camgeo":
        boundaries: Any = (Given("outline", False, outer), Given("bore", True, inner))
        layers = (Layer(-HEIGHT, 0.0, boundaries),)
        return measured(lambda: by_camgeo(Part(layers), 1e-3))
    return measured(lambda: by_trimesh(outer, [inner], HEIGHT))


def asked(job: dict[str, Any], rounds: int) -> Found:
    """Medians of some fresh processes."""
    runs: list[Found] = []
    for _ in range(rounds):
        call = [sys.executable, __file__, "--job", json.dumps(job)]
        done = subprocess.run(call, capture_output=True, text=True, check=True)
        runs.append(json.loads(done.stdout))
    return {key: statistics.median(run[key] for run in runs) for key in runs[0]}


def row(label: str, own: Found, other: Found) -> str:
    """What camgeo needs, with its ratio to what trimesh does; the memory of both."""
    cells = [f"{own[key]:>10.4g} {own[key] / other[key]:>7.2f}" for key in KEYS]
    return f"{label:>10} {' '.join(cells)} {own['MiB']:>8.0f} {other['MiB']:>8.0f}"


def main() -> int:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", default="setzhub")
    parser.add_argument("--tolerances", default="0.1,0.01,0.001,0.0001")
    parser.add_argument("--sizes", default="36,360,3600,36000")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--job", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.job:
        print(json.dumps(one(json.loads(options.job))))
        return 0
    print(
        f"Python {platform.python_version()}, trimesh {trimesh.__version__}, {platform.machine()}"
    )
    head = " ".join(f"{key:>10} {'ratio':>7}" for key in ("triangles", "bytes", "CPU s"))
    head += f" {'MiB':>8} {'trimesh':>8}"
    print(
        f"\n{options.scene} at the same deviation; ratios are camgeo by trimesh\n{'mm':>10} {head}"
    )
    outline = disc(options.scene).boundaries[0]
    assert isinstance(outline, CurveBoundary)
    for tolerance in map(float, options.tolerances.split(",")):
        job = {"kind": "scene", "scene": options.scene, "tolerance": tolerance}
        points = fewest(outline, tolerance)
        own, other = (
            asked({**job, "by": by, "points": points}, options.rounds)
            for by in ("camgeo", "trimesh")
        )
        print(row(f"{tolerance:g}", own, other))
    print(f"\nthe same points to both\n{'points':>10} {head}")
    sizes = [int(each) for each in options.sizes.split(",")]
    times: dict[str, list[float]] = {"camgeo": [], "trimesh": []}
    for size in sizes:
        found = {}
        for by, list_ in times.items():
            found[by] = asked({"kind": "points", "points": size, "by": by}, options.rounds)
            list_.append(found[by]["s"])
        print(row(str(size), found["camgeo"], found["trimesh"]))
    for by, list_ in times.items():
        power = math.log(list_[-1] / list_[0]) / math.log(sizes[-1] / sizes[0])
        last = math.log(list_[-1] / list_[-2]) / math.log(sizes[-1] / sizes[-2])
        print(f"{by}: CPU time grows with the power {power:.2f}, between the last two {last:.2f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
