"""The bill of a build: where its seconds go, from the build itself.

A new design is built into a folder of its own, and its ledger says what each quantity took without
what it asked for. Each belongs to one stage; what no quantity took, the certificate and the disk,
belongs to writing. So the stages add up to the whole, from the loaded scene to the last file.
"""

from __future__ import annotations

import math
import tempfile
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

from camgeo.accuracy.contours import Progress, reason
from camgeo.design import Design
from camgeo.errors import FileError, GeometryError, SceneError, ToleranceError
from camgeo.formats.dxf import FORMAT
from camgeo.lazy import Run
from camgeo.part.boundaries import CurveBoundary
from camgeo.part.boundary import written_contour
from camgeo.writing.write import Report

Stage = Literal["evaluate", "fit", "prove", "write", "read"]

STAGES: Final[tuple[Stage, ...]] = ("evaluate", "fit", "prove", "write", "read")
"""Motion, mechanism, findings, part, effects and tool paths; the contours with the proofs that
decide their fit; further proofs, also of what was read back; files; reading them back."""

FITS: Final = ("arcs of ", "chords of ", "cubics of ", "distances from ")
PROOFS: Final = ("proof of ",)
WRITTEN, READ = " file", " file, measured"
"""What names of quantities of these stages begin with, or have in them."""


@dataclass(frozen=True, slots=True)
class BillRow:
    """A build within one tolerance.

    Attributes
    ----------
    tolerance : [mm].
    evaluate, fit, prove, write, read : seconds of the stages, see `STAGES`; None if nothing was
        built.
    pieces : of the flanks of all discs, as drawings have them.
    size : of all files, the certificate included [bytes].
    machining_seconds : estimated by the programs; None if there are none that know it.
    fault : why nothing was built; else empty.
    """

    tolerance: float
    evaluate: float | None = None
    fit: float | None = None
    prove: float | None = None
    write: float | None = None
    read: float | None = None
    pieces: int | None = None
    size: int | None = None
    machining_seconds: float | None = None
    fault: str = ""

    @property
    def stages(self) -> dict[Stage, float]:
        """Seconds by stage; empty if nothing was built."""
        found: dict[Stage, float | None] = {name: getattr(self, name) for name in STAGES}
        return {name: seconds for name, seconds in found.items() if seconds is not None}

    @property
    def total(self) -> float | None:
        """Seconds from the loaded scene to the last file; None if nothing was built."""
        return math.fsum(self.stages.values()) if self.stages else None


def bill_rows(
    design: Design, tolerances: Sequence[float], *, progress: Progress = lambda _: None
) -> tuple[BillRow, ...]:
    """One row per tolerance [mm]: the scene built within it, all its formats."""
    rows = []
    progress("build, to load what all builds use")
    _row(Design(design.scene), BillRow(max(tolerances)))
    for tolerance in tolerances:
        progress(f"build, {tolerance:g} mm")
        rows.append(_row(Design(design.scene), BillRow(tolerance)))
    return tuple(rows)


def _row(design: Design, row: BillRow) -> BillRow:
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        try:
            report = design.write(folder, tolerance=row.tolerance)
        except (ToleranceError, GeometryError, SceneError, FileError) as error:
            return replace(row, fault=reason(error))
        total = time.perf_counter() - start
        size = sum(path.stat().st_size for path in report.paths)
    spent = staged(design.ledger.runs, total)
    return replace(
        row,
        evaluate=spent["evaluate"],
        fit=spent["fit"],
        prove=spent["prove"],
        write=spent["write"],
        read=spent["read"],
        pieces=_pieces(design, row.tolerance),
        size=size,
        machining_seconds=_machining(report),
    )


def staged(runs: Iterable[Run], total: float) -> dict[Stage, float]:
    """Seconds by stage of a build that took `total` seconds, in which `runs` were computed."""
    found: dict[Stage, list[float]] = {stage: [] for stage in STAGES}
    for run in runs:
        found[stage_of(run.name)].append(run.own_seconds)
    spent = {stage: math.fsum(seconds) for stage, seconds in found.items()}
    spent["write"] += total - math.fsum(spent.values())
    return spent


def stage_of(name: str) -> Stage:
    """The stage of the quantity of that name."""
    if READ in name:
        return "read"
    if WRITTEN in name:
        return "write"
    if name.startswith(FITS):
        return "fit"
    return "prove" if name.startswith(PROOFS) else "evaluate"


def _pieces(design: Design, tolerance: float) -> int:
    """Of the flanks of all discs; where drawings were written, these are known."""
    output = design.scene.output
    form = output.options[FORMAT].form
    return sum(
        len(written_contour(each, form, output.fit, tolerance).contour)
        for disc in design.discs
        for each in disc.drawn.part.boundaries
        if isinstance(each, CurveBoundary)
    )


def _machining(report: Report) -> float | None:
    """Seconds that the programs state, together."""
    known = [float(each.facts[MACHINED]) for each in report.files if MACHINED in each.facts]
    return math.fsum(known) if known else None


MACHINED: Final = "machining_time_s"
"""The fact of a program that has its time."""
