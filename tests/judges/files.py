"""What judges are given of the fixture scenes: programs, drawings, bodies and setup sheets; and
random programs.
"""

from __future__ import annotations

import cmath
import io
import math
import shutil
from collections.abc import Iterator, Mapping
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any, Final

from ezdxf import bbox
from ezdxf.filemanagement import read

import camgeo
from camgeo.app.cli.main import main
from camgeo.design.design import Design
from camgeo.design.product import Product, product_sides
from camgeo.design.writing import Writer, file_products
from camgeo.milling import machine as machines
from camgeo.part.part import Part
from camgeo.scene.formats.step import WALLS
from camgeo_export.dxf.writer import WRITER as DXF
from camgeo_export.gcode.writer import WRITER
from camgeo_export.step.writer import WRITER as STEP
from camgeo_export.stl import WRITER as STL
from camgeo_export.threemf.writer import WRITER as THREEMF
from tests.judges.programs_of_others import Refusal

# Programs of the fixture scenes, and random ones --------------------------------------------------


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
    for product in (side for disc in Design(edited).discs for side in product_sides(disc)):
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


# Drawings, bodies and setup sheets ----------------------------------------------------------------


WRITERS: Final[dict[str, Writer]] = {"dxf": DXF, "stl": STL, "3mf": THREEMF, "step": STEP}


@dataclass(frozen=True)
class Given:
    """A file, and what a judge must find in it.

    Attributes
    ----------
    path : of the file.
    size : width and height of all that is drawn [mm]; of drawings.
    volume : [mm^3]; of bodies.
    near : how far, relatively, another program's volume may be from it.
    faces : of a solid; 0 for a body of triangles.
    part : what it is of.
    """

    path: Path
    size: tuple[float, float] = (0.0, 0.0)
    volume: float = 0.0
    near: float = 1e-4
    faces: int = 0
    part: Part | None = None

    def compare(self, volume: float, faces: int = 0, near: float = 0.0) -> float:
        """The relative difference of another volume; Refusal if it is larger than `near`, by
        default that of the file, or if there are other `faces`.
        """
        if faces != self.faces:
            raise Refusal(f"{self.path.name} has {faces} faces, not {self.faces}")
        apart = abs(volume / self.volume - 1.0)
        if apart > (near or self.near):
            raise Refusal(f"{self.path.name}: its volume is {volume:g}, not {self.volume:g} mm^3")
        return apart


EXACT: Final = 1e-12
"""How near a program computes the volume between planes and cylinders; between splines it
integrates more coarsely, as near as that of triangles."""


def scenes(kind: str) -> list[str]:
    """Names of the fixture scenes that have a file of a kind: "dxf", "stl", "3mf" or "step"."""
    found = []
    for path in sorted([*FIXTURES.glob("*.toml"), *PAIRS.glob("*.toml")]):
        scene = camgeo.load(path).scene
        solid = scene.part is not None and scene.part.thickness is not None
        if scene.follower is not None and (kind == "dxf" or solid):
            found.append(path.stem)
    return found


COMPENSATED: Final[Mapping[str, Any]] = {
    "print.bore_clearance": 0.2,
    "print.elephant_foot": {"inset": 0.3, "height": 0.8},
    "print.shrinkage": {"xy": 0.7, "z": 0.3},
}
"""Edits by which bodies are compensated for printing, in a layer of the slicer's height."""


def files(
    folder: Path, kind: str, names: list[str], edits: Mapping[str, Any] | None = None
) -> Iterator[Given]:
    """The files of a kind of all discs of scenes, with `edits` of their values."""
    for name in names:
        design = camgeo.load(scene_of(name))
        if edits is not None:
            design = Design(design.scene.with_values(edits))
        if kind == "step":
            yield from _steps(folder, design)
            continue
        for number, product in enumerate(_pieces(design, WRITERS[kind])):
            written = WRITERS[kind].write(product, TOLERANCE)
            path = folder / f"{name}_{number}.{kind}"
            path.write_bytes(written.data)
            if kind == "dxf":
                yield Given(path, size=_size(written.data))
            else:
                volume = float(str(written.facts["volume_mm3"]))
                yield Given(path, volume=volume, part=product.drawn.printed.target)


def _steps(folder: Path, design: Design) -> Iterator[Given]:
    """The solids of all discs of a design, with either kind of walls."""
    for walls in WALLS:
        for number, product in enumerate(_pieces(design.with_output({"step.walls": walls}), STEP)):
            written = STEP.write(product, TOLERANCE)
            path = folder / f"{product.name}_{walls}_{number}.step"
            path.write_bytes(written.data)
            volume, faces = (written.facts[key] for key in ("volume_mm3", "faces"))
            near = Given.near if "splines" in written.facts else EXACT
            part = product.drawn.part
            yield Given(path, volume=float(volume), near=near, faces=int(faces), part=part)


def _pieces(design: Design, writer: Writer) -> list[Product]:
    """What files of a kind are made of: the discs, or bodies of both in one piece."""
    return [piece for disc in design.discs for piece in file_products(writer, disc)]


def sheets(into: Path, names: list[str]) -> Iterator[Path]:
    """The pages of setup sheets of scenes."""
    for name in names:
        page = into / f"{name}.html"
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            main(["setup", str(scene_of(name)), "-o", str(page)])
        yield page


def reports(into: Path, names: list[str]) -> Iterator[Path]:
    """The pages of reports of scenes, without what takes files."""
    for name in names:
        page = into / f"{name}-report.html"
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            main(["report", str(scene_of(name)), "--quick", "-o", str(page)])
        yield page


def _size(data: bytes) -> tuple[float, float]:
    """Width and height [mm] as ezdxf reads them."""
    drawing = read(io.StringIO(data.decode()))
    scale = {1: 25.4, 4: 1.0}[drawing.units]
    box = bbox.extents(drawing.modelspace())
    return scale * box.size.x, scale * box.size.y
