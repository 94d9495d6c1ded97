"""Drawings, bodies and setup sheets of the fixture scenes, for programs of others to judge."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from ezdxf import bbox
from ezdxf.filemanagement import read

import camgeo
from camgeo.cli.main import main
from camgeo.writing.writer import Writer
from camgeo_export.dxf.writer import WRITER as DXF
from camgeo_export.stl.writer import WRITER as STL
from camgeo_export.threemf.writer import WRITER as THREEMF
from tests.judges.programs import FIXTURES, TOLERANCE, scene_of

WRITERS: Final[dict[str, Writer]] = {"dxf": DXF, "stl": STL, "3mf": THREEMF}


@dataclass(frozen=True)
class Given:
    """A file, and what a judge must find in it.

    Attributes
    ----------
    path : of the file.
    size : width and height of all that is drawn [mm]; of drawings.
    volume : [mm^3]; of bodies.
    """

    path: Path
    size: tuple[float, float] = (0.0, 0.0)
    volume: float = 0.0


def scenes(kind: str) -> list[str]:
    """Names of the fixture scenes that have a file of a kind: "dxf", "stl" or "3mf"."""
    found = []
    for path in sorted(FIXTURES.glob("*.toml")):
        scene = camgeo.load(path).scene
        solid = scene.part is not None and scene.part.thickness is not None
        if scene.follower is not None and (kind == "dxf" or solid):
            found.append(path.stem)
    return found


def files(folder: Path, kind: str, names: list[str]) -> Iterator[Given]:
    """The files of a kind of all discs of scenes."""
    for name in names:
        for number, product in enumerate(camgeo.load(FIXTURES / f"{name}.toml").discs):
            written = WRITERS[kind].write(product, TOLERANCE)
            path = folder / f"{name}_{number}.{kind}"
            path.write_bytes(written.data)
            if kind == "dxf":
                yield Given(path, size=_size(written.data))
            else:
                yield Given(path, volume=float(str(written.facts["volume_mm3"])))


def sheets(into: Path, names: list[str]) -> Iterator[Path]:
    """The pages of setup sheets of scenes."""
    for name in names:
        page = into / f"{name}.html"
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            main(["setup", str(scene_of(name)), "-o", str(page)])
        yield page


def _size(data: bytes) -> tuple[float, float]:
    """Width and height [mm] as ezdxf reads them."""
    drawing = read(io.StringIO(data.decode()))
    scale = {1: 25.4, 4: 1.0}[drawing.units]
    box = bbox.extents(drawing.modelspace())
    return scale * box.size.x, scale * box.size.y
