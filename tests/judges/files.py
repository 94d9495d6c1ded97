"""Drawings, bodies and setup sheets of the fixture scenes, for programs of others to judge."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from ezdxf import bbox
from ezdxf.filemanagement import read

import camgeo
from camgeo.app.cli.main import main
from camgeo.design.design import Design
from camgeo.design.product import Product
from camgeo.design.writing import Writer, pieces_of
from camgeo.part.part import Part
from camgeo.scene.formats.step import WALLS
from camgeo_export.dxf.writer import WRITER as DXF
from camgeo_export.step.writer import WRITER as STEP
from camgeo_export.stl import WRITER as STL
from camgeo_export.threemf.writer import WRITER as THREEMF
from tests.judges.programs import FIXTURES, PAIRS, TOLERANCE, scene_of
from tests.judges.programs_of_others import Refusal

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
    return [piece for disc in design.discs for piece in pieces_of(writer, disc)]


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
