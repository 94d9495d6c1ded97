"""Programs that judges run: those of the fixture scenes, and random ones."""

from __future__ import annotations

import cmath
import math
import shutil
from collections.abc import Iterator
from pathlib import Path
from random import Random
from typing import Final

import camgeo
from camgeo.design.design import Design
from camgeo.design.product import Product, sides_of
from camgeo.milling import machine as machines
from camgeo_export.gcode.writer import WRITER

FIXTURES: Final = Path(__file__).parents[2] / "fixtures" / "scenes"

JOBS: Final = FIXTURES.with_name("milling")
"""Scenes that state blank, holding and operations."""

PAIRS: Final = FIXTURES.with_name("pairs")
"""Scenes of conjugate pairs in one piece."""

SIX: Final = ("setzhub", "groove", "inch", "conjugate_lever", "straight_moves", "trimmed_ring")
"""Scenes of the small form: mm and inch, several tools' worth of operations, lines, corners."""

TOLERANCE: Final = 0.05


def workshop(folder: Path) -> Path:
    """A copy of the fixture scenes with the profiles beside them, where scenes may name them."""
    for source in (FIXTURES, JOBS):
        shutil.copytree(source, folder, dirs_exist_ok=True)
    for name in machines.names():
        source = Path(machines.__file__).parent / "machines" / f"{name}.toml"
        shutil.copy(source, folder / f"{name}.toml")
    return folder


def milled_scenes() -> list[str]:
    """Names of the fixture scenes that have a milling program."""
    paths = sorted([*FIXTURES.glob("*.toml"), *JOBS.glob("*.toml")])
    return [path.stem for path in paths if camgeo.load(path).scene.milling is not None]


def scene_of(name: str) -> Path:
    """The file of a fixture scene."""
    return next(
        path for each in (FIXTURES, JOBS, PAIRS) if (path := each / f"{name}.toml").exists()
    )


def products(folder: Path, scene: str, machine: str) -> list[Product]:
    """The sides of the discs of a scene in a `workshop`, for a machine; none of those for which it
    would have to change its tools and cannot.
    """
    design = camgeo.load(folder / f"{scene}.toml")
    edited = design.scene.with_values({"output.gcode.machine": f"{machine}.toml"})
    changes = machines.load(machine).tool_change.change
    found = []
    for product in (side for disc in Design(edited).discs for side in sides_of(disc)):
        if changes or len({cut.tool.number for cut in product.milled.cuts}) == 1:
            found.append(product)
    return found


def programs(folder: Path, scene: str, machine: str) -> Iterator[tuple[Product, bytes]]:
    """Each side of each disc of a scene in a `workshop`, and its program for a machine."""
    for product in products(folder, scene, machine):
        yield product, WRITER.write(product, TOLERANCE).data


def random_program(rng: Random, blocks: int, *, absolute_centres: bool) -> str:
    """Lines, arcs and traverses in all the ways in which a controller may be told of them."""
    lines = ["G17 G21 G40 G49 G54 G80 G90 G94 G91.1", "S1000 M3", "F500", "G0 Z5", "G0 X0 Y0"]
    at, z, scale, incremental, absolute = 0j, 5.0, 1.0, False, False

    def word(letter: str, value: float, base: float) -> str:
        return f"{letter}{(value - (base if incremental else 0.0)) / scale:.6f}"

    for _ in range(blocks):
        chance = rng.random()
        end = complex(round(rng.uniform(-50, 50), 3), round(rng.uniform(-50, 50), 3))
        if chance < 0.1:
            incremental = not incremental
            lines.append("G91" if incremental else "G90")
        elif chance < 0.15:
            scale = 26.4 - scale
            lines.append("G20 F20" if scale > 2.0 else "G21 F500")
        elif chance < 0.2 and absolute_centres:
            absolute = not absolute
            lines.append("G90.1" if absolute else "G91.1")
        elif chance < 0.35:
            height = round(rng.uniform(-5, 5), 3)
            lines.append(f"{rng.choice(('G0', 'G01'))} {word('Z', height, z)}")
            z = z + round((height - z) / scale, 6) * scale if incremental else height
        elif chance < 0.6:
            lines.append(
                f"{rng.choice(('G1', 'G0'))}{word('X', end.real, at.real)} "
                f"{word('Y', end.imag, at.imag)}"
            )
            at = _printed(end, at, scale, incremental=incremental)
        else:
            sense, text = rng.choice((2, 3)), ""
            if rng.random() < 0.3:
                chord = abs(end - at)
                radius = chord * rng.uniform(0.6, 3.0) * rng.choice((1, 1, -1))
                text = f"R{radius / scale:.6f}"
            else:
                middle = 0.5 * (at + end)
                centre = middle + 1j * (end - at) * math.tan(rng.uniform(-1.4, 1.4))
                arm = centre if absolute else centre - at
                text = f"I{arm.real / scale:.6f} J{arm.imag / scale:.6f}"
            words = f"{word('X', end.real, at.real)} {word('Y', end.imag, at.imag)} {text}"
            lines.append(f"G{sense} {words}")
            at = _printed(end, at, scale, incremental=incremental)
    return "\n".join([*lines, "G90", "G0 Z50", "M5", "M2", ""])


def _printed(end: complex, at: complex, scale: float, *, incremental: bool) -> complex:
    """Where a controller is behind the printed words."""
    base = at if incremental else 0j
    way = (end - base) / scale
    return base + complex(round(way.real, 6), round(way.imag, 6)) * scale


def random_contour(rng: Random) -> str:
    """A contour of one or two moves under compensation, with sharp corners and tight arcs."""
    side = rng.choice((1, -1))
    lines = ["G17 G21 G40 G49 G54 G80 G90 G94 G91.1", "T1 M6", "G43 H1", "S1000 M3 F500", "G0 Z5"]
    lines += ["G0 X-10 Y0", "G1 Z-1", f"G{'41' if side > 0 else '42'}.1 D{rng.choice((1, 2, 4))}"]
    lines.append("G1 X0 Y0")
    at, heading = 0j, 1 + 0j

    def printed(point: complex) -> complex:
        return complex(round(point.real, 6), round(point.imag, 6))

    for _ in range(rng.randint(1, 2)):
        heading *= cmath.exp(1j * rng.uniform(-2.6, 2.6))
        if rng.random() < 0.5:
            end = printed(at + heading * rng.uniform(0.3, 12.0))
            lines.append(f"G1 X{end.real:.6f} Y{end.imag:.6f}")
        else:
            sense = rng.choice((1, -1))
            arm = printed(1j * sense * heading * rng.uniform(0.5, 12.0))
            end = printed(at + arm - arm * cmath.exp(1j * sense * rng.uniform(0.2, 2.5)))
            word = "G3" if sense > 0 else "G2"
            words = f"X{end.real:.6f} Y{end.imag:.6f} I{arm.real:.6f} J{arm.imag:.6f}"
            lines.append(f"{word} {words}")
            away = 1j * sense * (end - at - arm)
            heading = away / abs(away)
        at = end
    off = at + 60j * side * heading
    lines += ["G40", f"G1 X{off.real:.4f} Y{off.imag:.4f}", "G0 Z5", "M5", "M2"]
    return "\n".join([*lines, ""])
