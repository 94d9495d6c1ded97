"""The texts of programs for all controllers, and of jobs of all kinds, their cuts summed up."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Final

from camgeo.design.design import Design
from camgeo.design.product import Product
from camgeo.milling.machine import load, names
from camgeo.milling.milling import GcodeSpec
from camgeo.milling.tool import Tool
from camgeo.scene.scene import parse_scene
from camgeo_export.gcode.writer import WRITER
from tests.export.stub_product import StubProduct
from tests.interpreter.results import weighted
from tests.toolpath import programs

TOLERANCE: Final = 0.01

SECOND: Final = Tool(
    number=2, diameter=8.0, spindle_speed=2500.0, feed=250.0, plunge_feed=80.0, plunges=True,
    name="two flutes", coolant="flood",
)  # fmt: skip

CUT: Final = re.compile(
    r"(?:N?\d+ )?(?:G[123]|L|C|CC)(?: ?(?:[XYZIJF][-+]?[\d.]+|DR[-+]|R0|G[123]))+"
)
"""A block of a cut and nothing else."""

JOBS: Final = (
    "stated, all kinds", "stated, conventional", "planned, a hub, holes and a mark",
    "stated, a spiral from a plate", "planned, from a plate with tabs", "engraved", "inches",
    "clamps that move",
)  # fmt: skip
"""Scenes of `tests.toolpath.programs`."""


def stubs() -> Iterator[tuple[str, Product]]:
    """Two tools, two walls, for each controller in both units."""
    for machine in names():
        for unit in ("mm", "inch"):
            spec = GcodeSpec(machine=machine)
            tool = SECOND if load(machine).tool_change.change else None
            yield f"{machine}, {unit}", StubProduct(second_tool=tool, gcode=spec, unit=unit)
    spec = GcodeSpec(machine="haas", work_offset="G56", coolant="off", tool_change_height=50.0)
    yield "haas, other options", StubProduct(second_tool=SECOND, gcode=spec)
    spec = replace(spec, machine="linuxcnc", clearance_height=30.0, retract_height=6.0)
    yield "linuxcnc, other options", StubProduct(second_tool=SECOND, gcode=spec)


def product(name: str) -> Product:
    """One of the `stubs`, or the disc of one of the `JOBS`."""
    if name in JOBS:
        return Design(parse_scene(programs.SCENES.get(name, programs.CLAMPS))).disc
    return dict(stubs())[name]


STUBS: Final = tuple(name for name, _ in stubs())


def summed(text: str) -> list[str | float]:
    """The lines; of each run of blocks that only cut, the number of blocks and a sum of theirs."""
    found: list[str | float] = []
    run: list[float] = []
    for line in [*text.splitlines(), ""]:
        if line and CUT.fullmatch(line):
            run.append(weighted(float(each) for each in re.findall(r"[-+]?\d+\.?\d*", line)))
            continue
        if run:
            found += [f"{len(run)} cuts", sum(run)]
            run = []
        found.append(line)
    return found


def said(disc: Product) -> Any:
    """All programs of a product: text, facts, deviation."""
    found = []
    for piece in WRITER.pieces(disc):
        written = WRITER.write(piece, TOLERANCE)
        text = written.data.decode("ascii")
        for given, word in ((piece.version, "VERSION"), (piece.scene_hash, "HASH")):
            text = re.sub(re.escape(given), word, text, flags=re.IGNORECASE)
        facts = {key: str(value) for key, value in written.facts.items()}
        found.append([summed(text), facts, WRITER.measure(piece, written.data)])
    return found
