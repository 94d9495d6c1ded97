"""LibreCAD draws drawings as PDF at 1:1, of the size that we wrote.

Its paper has dots of 1/1200 inch, so this judges what it reads and in which unit, not how closely.
"""

from __future__ import annotations

import re
import zlib
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from tests.judges.files import Given
from tests.judges.programs_of_others import Program, Refusal

LIBRECAD: Final = Program("CAMGEO_LIBRECAD", "librecad")

POINT: Final = 25.4 / 72.0
"""Of a PDF [mm]."""

NEAR: Final = 0.1
"""What a size may differ by [mm]: ends are rounded to dots of 0.02 mm, arcs are drawn as chords."""


def judge(given: Given) -> float:
    """The largest difference of width and height [mm]; Refusal if it is too large."""
    with TemporaryDirectory() as name:
        words = ["dxf2pdf", "-c", "-s", "1", "-t", name, str(given.path)]
        said = LIBRECAD.run(words, Path(name))
        paper = Path(name, f"{given.path.stem}.pdf")
        if not paper.is_file():
            raise Refusal(f"{given.path.name} is not drawn: {said[-300:].strip()}")
        size = stroked(paper.read_bytes())
    apart = max(abs(size[0] - given.size[0]), abs(size[1] - given.size[1]))
    if apart > NEAR:
        raise Refusal(f"{given.path.name} is drawn {size} mm large, not {given.size}")
    return apart


def stroked(paper: bytes) -> tuple[float, float]:
    """Width and height of all that is stroked on the first page of its PDF [mm]."""
    stream = re.search(rb"stream\r?\n(.*?)endstream", paper, re.DOTALL)
    if stream is None:
        raise Refusal("its PDF is not read")
    scale = POINT
    xs: list[float] = []
    ys: list[float] = []
    path: list[float] = []
    for line in zlib.decompress(stream[1]).decode("ascii", "replace").splitlines():
        *numbers, word = line.split() or [""]
        if word == "cm":
            scale *= abs(float(numbers[0]))
        elif word in ("m", "l", "c"):
            path += map(float, numbers)
        elif word == "S":
            xs += path[::2]
            ys += path[1::2]
            path = []
        elif word in ("n", "f", "f*", "B", "W*"):
            path = []
    if not xs:
        raise Refusal("nothing is drawn")
    return scale * (max(xs) - min(xs)), scale * (max(ys) - min(ys))
