"""PrusaSlicer reads bodies: closed, of one part, and of the volume that we wrote."""

from __future__ import annotations

import re
from typing import Final

from tests.judges.files import Given
from tests.judges.programs_of_others import Refusal, absent, found, run

VARIABLE: Final = "CAMGEO_PRUSA_SLICER"
NAMES: Final = ("prusa-slicer", "PrusaSlicer")

REPAIRS: Final = (
    "open_edges", "facets_reversed", "backwards_edges", "degenerate_facets", "facets_removed",
    "edges_fixed",
)  # fmt: skip
"""What it says if it had to mend a body."""

NEAR: Final = 1e-4
"""Relative difference of volumes: those of STL files are sums of single precision."""


def missing() -> str:
    """Why it cannot judge here; empty if it can."""
    return absent(VARIABLE, *NAMES)


def judge(given: Given) -> float:
    """The relative difference of the volume; Refusal if it finds fault."""
    said = run([found(VARIABLE, *NAMES), "--info", str(given.path)], given.path.parent)
    values = dict(re.findall(r"^(\w+) = +(\S+)$", said, re.MULTILINE))
    if values.get("manifold") != "yes" or values.get("number_of_parts") != "1":
        raise Refusal(f"{given.path.name} is not one closed body: {said[-300:].strip()}")
    mended = [each for each in REPAIRS if int(values.get(each, 0))]
    if mended:
        raise Refusal(f"{given.path.name}: {', '.join(mended)}")
    apart = abs(float(values["volume"]) / given.volume - 1.0)
    if apart > NEAR:
        raise Refusal(f"{given.path.name}: its volume is {values['volume']}, not {given.volume:g}")
    return apart
