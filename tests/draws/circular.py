"""Discs whose outline is exactly a circle, built in every format and read back by others' rules.

Eccentric discs under flat tappets, discs that only rest under every follower, and discs of which a
part is an arc; sizes and tolerances over five decades, bores with flats and keyways. The circle
follows from the dimensions alone: with s = e (1 - cos phi) the distance of the face from the axis
is the support function of a circle of radius r + e about a point e before the start.

Prints what the dearest build has taken, apart from starting Python: CPU time, and memory at most.
"""

from __future__ import annotations

import cmath
import math
import os
import re
import sys
import tempfile
import zipfile
from argparse import Namespace
from collections.abc import Iterator
from dataclasses import astuple, dataclass
from pathlib import Path
from random import Random
from typing import Any, Final

import numpy as np
import tomlkit
from ezdxf.entities.lwpolyline import LWPolyline
from ezdxf.filemanagement import readfile

from tests.draws.run import Case as Row
from tests.draws.run import parser_of, run_cases

KINDS: Final = (
    "eccentric", "translating-flat", "oscillating-flat", "translating-roller", "oscillating-roller",
    "knife-edge", "ring", "groove", "yoke", "small",
)  # fmt: skip
"""All but `MOVING` only rest. Of "small" the roller is nearly as large as the base circle, so that
little is left of the disc."""

MOVING: Final = ("eccentric", "yoke")

RIMMED: Final = ("ring", "groove")
"""Of these the circle lies inside the disc."""

ENTITIES: Final = ("arcs", "lines-and-arcs", "polyline", "spline")

PLANE: Final = ("dxf", "cut-svg", "csv", "svg", "step")
"""Formats of any size and tolerance."""

SHOP: Final = ("gcode", "drawing", "png")
"""Formats of what a shop makes, `MILLED` in size."""

MILLED: Final = (5.0, 500.0)
"""Sizes [mm] that machines and sheets have room for."""

LEAST: Final = 0.05
"""Radius [mm] that a disc has at least."""

FACETED: Final = ("stl", "3mf")
"""Formats of facets, whose number grows with size and tolerance."""

FINEST: Final = 1e-5
"""Least tolerance of facets, as a fraction of the radius: some thousand of them."""

COARSE: Final = 5e-3
"""Least tolerance of programs [mm], whose numbers have three decimals."""

ROUNDED: Final = 2.0**-22
"""Rounding of single precision, as a fraction of the coordinates."""

DIGITS: Final = 1e-9
"""Rounding of the numbers of a drawing [mm]."""


CIRCLES: Final = {
    "cut-svg": ("arc", r"A ?([0-9.e+-]+)"),
    "step": ("circle", r"CIRCLE\('[^']*',#\d+,([0-9.E+-]+)\)"),
    "gcode": ("arc", r"I(-?[0-9.]+) J(-?[0-9.]+)"),
}
"""What the circle is in a file that states it, and where its radius, or its arm, stands."""


Table = dict[str, Any]


@dataclass(frozen=True)
class Case:
    """A scene and a circle of it.

    Attributes
    ----------
    text : the scene.
    kind, entity : of the follower, and of the DXF.
    size : base radius [mm].
    centre, radius : of the outline, or of the outer flank of a ring or groove [mm].
    tool : diameter of the cutter [mm].
    tolerance : [mm].
    """

    text: str
    kind: str
    entity: str
    size: float
    centre: complex
    radius: float
    tool: float
    tolerance: float

    @property
    def formats(self) -> tuple[str, ...]:
        """What is made of it."""
        milled = MILLED[0] < self.size < MILLED[1] and self.kind != "small"
        return PLANE + FACETED + (SHOP if milled else ())

    @property
    def has_rim(self) -> bool:
        """Whether the circle lies inside the disc."""
        return self.kind in RIMMED

    def tolerance_of(self, name: str) -> float:
        """The tolerance [mm] of one format."""
        faceted = name in FACETED or (name == "dxf" and self.entity == "polyline")
        least = COARSE if name == "gcode" else FINEST * self.radius if faceted else 0.0
        return max(self.tolerance, least)


def case_of(rng: Random, number: int) -> Case:
    """The case of a number."""
    kind = KINDS[number % len(KINDS)] if number % 2 else "eccentric"
    size = 10.0 ** rng.uniform(-1.0, 4.0)
    tolerance = min(10.0 ** rng.uniform(-6.0, -1.0), 1e-2 * size)
    guide, entity = rng.uniform(0.0, 360.0), rng.choice(ENTITIES)
    inward = rng.random() < 0.5 and kind not in ("ring", "groove", "yoke")
    left = max(10.0 ** rng.uniform(-4.0, -1.0), LEAST / size) if kind == "small" else 0.8
    tolerance = min(tolerance, 1e-2 * left * size)
    roller, centre = (1.0 - left) * size, 0j
    motion: list[Table] = [{"dwell": 360}]
    if kind in MOVING:
        e = size * rng.uniform(0.01, 0.4)
        motion = [{"law": "simple-sine", "span": 180, "to": to} for to in (2.0 * e, 0.0)]
        centre = (e if inward else -e) * cmath.exp(1j * math.radians(guide))
        radius = size - e if inward else size + e
    elif "flat" in kind or kind == "knife-edge":
        radius = size
    else:
        radius = size + roller if kind in RIMMED else size - roller
    cam = {"rotation": rng.choice(("cw", "ccw"))}
    follower = _follower(kind, size, roller, guide)
    follower |= {"direction": "inward"} if inward else {}
    follower |= {"yoke": {"breadth": 2.0 * radius}} if kind == "yoke" else {}
    least = radius - abs(centre)
    diameter = 0.3 * size if kind == "groove" else min(0.1 * size, 0.4 * least)
    tool: Table = {"number": 1, "diameter": diameter, "flute_length": size, "spindle_speed": 3000}
    tool |= {"feed": 300, "plunge_feed": 100, "stepdown": 0.1 * size, "stepover": 0.4 * diameter}
    scene = {
        "camgeo": 1,
        "name": "circular",
        "cam": cam,
        "follower": follower,
        "motion": motion,
        "part": {"thickness": 0.3 * size, **_part(rng, kind, size, least)},
        "tool": [tool],
        "holding": {"kind": "fixture", "through": 0.01 * size},
        "output": {
            "formats": ["dxf"],
            "tolerance": tolerance,
            "dxf": {"entity": entity, "auxiliary": False},
        },
    }
    text = tomlkit.dumps(scene)
    return Case(text, kind, entity, size, centre, radius, diameter, tolerance)


def _follower(kind: str, size: float, roller: float, guide: float) -> Table:
    """The keys of a follower, its direction apart."""
    keys: Table = {"base_radius": size}
    if "flat" not in kind and kind not in MOVING:
        keys["roller_radius"] = 0 if kind == "knife-edge" else roller
    if kind.startswith("oscillating"):
        keys |= {"kind": kind, "pivot": [-2.0 * size, size if "flat" in kind else 0.0]}
        keys |= {"arm": 2.0 * size} if "roller" in kind else {}
    else:
        flat = kind in (*MOVING, "translating-flat")
        keys |= {"kind": "translating-flat" if flat else "translating-roller"}
        keys["guide_angle"] = guide
    if kind in RIMMED:
        keys["contact"] = "outer" if kind == "ring" else "groove"
    return keys


def _part(rng: Random, kind: str, size: float, least: float) -> Table:
    """Rim, groove and bore, with a flat or a keyway, of a disc whose outline is at least `least`
    from the axis.
    """
    rim: Table = {"rim": 3.0 * size} if kind in RIMMED else {}
    if kind == "groove":
        return {**rim, "groove_depth": 0.15 * size, "bore": 0.5 * size}
    if kind == "ring":
        return rim
    bore, shape = 0.5 * least, rng.choice(("round", "flat", "keyway"))
    angle = rng.uniform(0.0, 360.0)
    shapes: dict[str, Table] = {
        "round": {},
        "flat": {"d_shaft": {"across": 1.8 * bore, "angle": angle}},
        "keyway": {"keyway": {"width": 0.4 * bore, "depth": 0.2 * bore, "angle": angle}},
    }
    return {"bore": 2.0 * bore, **shapes[shape]}


@dataclass(frozen=True)
class Cost:
    """CPU time [s], and largest memory [MB]."""

    seconds: float
    memory: float


def built(case: Case, name: str, folder: Path) -> tuple[str, Cost]:
    """What a build of one format in its own process has said, "" if it has worked; its cost."""
    error = folder / "error"
    process = os.fork()
    if not process:  # pragma: no cover
        try:
            write(case, name, folder)
        except BaseException as fault:
            error.write_text(f"{type(fault).__name__}: {fault}")
        finally:
            os._exit(0)
    _, status, usage = os.wait4(process, 0)
    said = error.read_text() if error.exists() else "" if not status else f"status {status}"
    return said, Cost(usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024.0)


def write(case: Case, name: str, folder: Path) -> None:
    """Build one format."""
    from camgeo import loads

    loads(case.text).write(folder, [name], tolerance=case.tolerance_of(name))


def misses(case: Case, name: str, folder: Path) -> Iterator[str]:
    """Where the file of a format is not the circle that it should be."""
    within, found = case.tolerance_of(name), sorted(folder.glob("circular*"))
    if len(found) != (3 if name == "drawing" else 1):
        yield f"{len(found)} files"
        return
    if name in ("csv", "svg", "png", "drawing"):
        return
    if name == "dxf":
        yield from _drawn(case, found[0], within)
    elif name in CIRCLES:
        what, pattern = CIRCLES[name]
        radius, allowed = case.radius, within + DIGITS
        if name == "gcode":
            radius, allowed = radius + (-0.5 if case.has_rim else 0.5) * case.tool, 2.0 * within
        radii = [
            abs(complex(*map(float, each.groups())))
            for each in re.finditer(pattern, found[0].read_text())
        ]
        if not any(abs(each - radius) <= allowed for each in radii):
            yield f"no {what} of radius {radius}: {radii[:4]}"
    elif not case.has_rim:
        points = _of_3mf(found[0]) if name == "3mf" else _of_stl(found[0])
        off = abs(float(np.max(np.abs(points - case.centre))) - case.radius)
        if off > within + ROUNDED * (abs(case.centre) + case.radius):
            yield f"farthest corner {off:.3g} mm off"


def _of_stl(file: Path) -> Any:
    layout = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("spare", "<u2")])
    corners = np.frombuffer(file.read_bytes()[84:], layout)["corners"].reshape(-1, 3)
    return corners[:, 0].astype(np.float64) + 1j * corners[:, 1]


def _of_3mf(file: Path) -> Any:
    with zipfile.ZipFile(file) as archive:
        model = archive.read("3D/3dmodel.model").decode()
    pairs = re.findall(r'<vertex x="([^"]+)" y="([^"]+)"', model)
    return np.array([complex(float(x), float(y)) for x, y in pairs])


def _drawn(case: Case, file: Path, within: float) -> Iterator[str]:
    """Misses of a DXF: the circle has at most two arcs, or chords within the tolerance."""
    arcs: list[tuple[complex, float]] = []
    corners: list[complex] = []
    for item in readfile(file).modelspace():
        parts: Iterator[Any] = iter((item,))
        if isinstance(item, LWPolyline):
            corners += [complex(x, y) for x, y in item.get_points("xy")]
            parts = item.virtual_entities()
        for part in parts:
            if part.dxftype() in ("ARC", "CIRCLE"):
                arcs.append((complex(part.dxf.center.x, part.dxf.center.y), part.dxf.radius))
    if case.entity == "polyline":
        if case.has_rim:
            return
        off = abs(max(abs(each - case.centre) for each in corners) - case.radius)
        if off > within + DIGITS:
            yield f"farthest corner {off:.3g} mm off"
        return
    own = [
        radius
        for centre, radius in arcs
        if abs(centre - case.centre) + abs(radius - case.radius) <= within + DIGITS
    ]
    if not 1 <= len(own) <= 2:
        yield f"{len(own)} arcs of radius {case.radius} about {case.centre}, of {len(arcs)}"


def builds(asked: Namespace) -> Iterator[Row]:
    """Each format of each disc; the dearest builds are printed at the end."""
    rng = Random(asked.seed)
    dearest = dict.fromkeys(PLANE + FACETED + SHOP, Cost(0.0, 0.0))
    with tempfile.TemporaryDirectory() as folder:
        for name in dearest:  # the imports of all writers
            write(case_of(Random(3), 0), name, Path(folder) / name)
        for number in range(asked.count):
            case = case_of(rng, number)
            for name in case.formats:
                place = Path(folder) / f"{number}-{name}"
                place.mkdir()
                said, cost = built(case, name, place)
                dearest[name] = Cost(*map(max, astuple(dearest[name]), astuple(cost)))
                row = f"{number} {case.kind} {case.entity} {name} {case.tolerance:.3g} mm"
                row += f" r {case.radius:.6g} {cost.seconds:.3f} s {cost.memory:.0f} MB"
                yield row, [said] if said else [*misses(case, name, place)]
    for name, cost in dearest.items():
        sys.stdout.write(f"{name}: at most {cost.seconds:.2f} s, {cost.memory:.0f} MB\n")


if __name__ == "__main__":
    sys.exit(run_cases(parser_of(__doc__, 100), builds))
