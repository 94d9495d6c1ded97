"""The bill of a build: where its seconds of CPU time go, from the build itself.

A new design is built into a folder of its own, and its ledger says what each quantity took without
what it asked for. Each belongs to one stage; what no quantity took, the certificate and the disk,
belongs to writing. So the stages add up to the whole, from the loaded scene to the last file.
"""

from __future__ import annotations

import math
import tempfile
import time
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Final, Literal, cast

from camgeo.design.design import Design
from camgeo.design.writing import Report
from camgeo.lazy import Run
from camgeo.part.boundaries import CurveBoundary
from camgeo.part.part import written_contour
from camgeo.scene.formats.dxf import FORMAT
from camgeo.scene.scene import Scene
from camgeo.studies.accuracy.contours import NOT_WRITTEN, Clock, Progress, reason, repeated

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
    spread : of the seconds, as `camgeo.studies.accuracy.contours.Timing`.
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
    spread: float = 1.0

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
    with suppress(*NOT_WRITTEN):
        _built(design.scene, max(tolerances), Clock())
    for tolerance in tolerances:
        progress(f"build, {tolerance:g} mm")
        rows.append(_row(design.scene, BillRow(tolerance)))
    return tuple(rows)


def _built(scene: Scene, tolerance: float, clock: Clock) -> tuple[Design, Report, int]:
    """The design built, what was written, and how many bytes, with the time of each stage."""
    design, build = Design(scene), Clock()
    design.ledger.clock = time.process_time
    with tempfile.TemporaryDirectory() as folder:
        report = build.step("build", lambda: design.write(folder, tolerance=tolerance))
        size = sum(path.stat().st_size for path in report.paths)
    clock.seconds.update(staged(design.ledger.runs, build.seconds["build"]))
    return design, report, size


def _row(scene: Scene, row: BillRow) -> BillRow:
    try:
        (design, report, size), timing = repeated(partial(_built, scene, row.tolerance))
    except NOT_WRITTEN as error:
        return replace(row, fault=reason(error))
    return replace(
        row,
        **cast("Any", timing.seconds),
        spread=timing.spread,
        pieces=_pieces(design, row.tolerance),
        size=size,
        machining_seconds=_machining(report),
    )


def staged(runs: Iterable[Run], total: float) -> dict[str, float]:
    """Seconds by stage of a build that took `total` seconds, in which `runs` were computed."""
    found: dict[str, list[float]] = {stage: [] for stage in STAGES}
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
