"""What `camgeo report` gathers: all that is known of a design, to be looked at on one page."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar, Final

from camgeo.answers.answer import Answer
from camgeo.answers.check import Check, check
from camgeo.answers.report.readings import Reading, readings, sentence
from camgeo.answers.report.steps import next_step
from camgeo.errors import CamgeoError, SceneError
from camgeo.figure import diagrams, effects, motion, plots
from camgeo.figure.animation import Animation, animation

if TYPE_CHECKING:
    from camgeo.accuracy.survey import Survey
    from camgeo.check.finding import Finding
    from camgeo.design import Design
    from camgeo.figure.model import Figure
    from camgeo.product.product import Product
    from camgeo.product.value_table import Table
    from camgeo.scene.scene import Scene

STEP: Final = 5
"""Of the value table [degrees]: as many rows as a sheet holds."""

TOLERANCES: Final = (1e-2, 1e-3, 1e-4)
"""Of the price list [mm]."""

FACETS, LEAST = 5e-4, 1e-3
"""Tolerance of the solid, relative to the base radius, and the least [mm]: finer than is seen."""

TOGETHER: Final = 6
"""Most panels of effects in a diagram: as many as fit on a sheet."""

Progress = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class Advised:
    """A finding with what to do about it.

    Attributes
    ----------
    about : what was judged: the cam, an effect, a part or a program.
    finding : the finding.
    step : the next step; empty if there is none.
    """

    about: str
    finding: Finding
    step: str


@dataclass(frozen=True, slots=True, eq=False)
class Chart:
    """A diagram over the cam angle.

    Attributes
    ----------
    title : what it shows.
    figure : the diagram.
    readings : the extremes of its curves.
    """

    title: str
    figure: Figure
    readings: tuple[Reading, ...]

    @property
    def sentence(self) -> str:
        """The diagram in words."""
        return sentence(self.readings)


@dataclass(frozen=True, slots=True, eq=False)
class Report(Answer):
    """A design, as it is looked at.

    Attributes
    ----------
    scene : of the design.
    check : the findings.
    advised : all findings, each with its next step.
    animation : a turn of the mechanism; None if there is none, or if it has no position somewhere.
    charts : the diagrams.
    table : the value table, a row every STEP degrees; None if it cannot be computed.
    prices : what accuracy costs in pieces, bytes and milling time; None if it was not asked for or
        there is no disc.
    solids : binary STL files of the bodies, coarser than they are made, by their names; empty if
        the part has no thickness.
    certificate : of the files that the scene asks for, as it would be beside them; None likewise.
    left_out : what the page lacks, and why.
    """

    command: ClassVar[str] = "report"

    scene: Scene
    check: Check
    advised: tuple[Advised, ...]
    animation: Animation | None
    charts: tuple[Chart, ...]
    table: Table | None
    prices: Survey | None
    solids: Mapping[str, bytes]
    certificate: Mapping[str, Any] | None
    left_out: tuple[str, ...]

    @property
    def certified(self) -> str | None:
        """The hash of the scene in the certificate; None if there is none."""
        return None if self.certificate is None else str(self.certificate["scene"]["sha256"])

    @property
    def exit_code(self) -> int:
        """That of the check."""
        return self.check.exit_code


def report(design: Design, *, quick: bool = False, progress: Progress = lambda _: None) -> Report:
    """Gather all that is known of a design.

    Parameters
    ----------
    quick : whether price list and certificate are left out, for which files are made.
    progress : called with the name of each step.

    Raises
    ------
    CamgeoError
        As `check`. What cannot be shown for another reason is left out, with the reason.
    """
    progress("findings")
    checked = check(design)
    left_out: list[str] = []

    def tried(what: str, make: Callable[[], Any]) -> Any:
        progress(what)
        try:
            return make()
        except CamgeoError as error:
            left_out.append(f"{what}: {_reason(error)}")
            return None

    turn = None
    if design.scene.follower is None:
        left_out.append("mechanism: the scene has no follower, so there is no disc")
    else:
        turn = tried("mechanism", lambda: animation(design.disc))
    wanted = [("motion plan and diagrams", partial(_motion, design))]
    wanted += tried("diagrams of the disc", lambda: [*_of_discs(design)]) or ()
    charts = [
        Chart(what, figure, readings(figure))
        for what, make in wanted
        if (figure := tried(what, make)) is not None
    ]
    table = tried("value table", lambda: design.tabulated.written(STEP))
    solids: dict[str, bytes] = {}
    if turn is not None:
        solids = tried("solid", lambda: coarse_solids(design, progress)) or {}
    prices = certificate = None
    if quick:
        left_out.append("price list of accuracy and certificate: --quick leaves them out")
    elif turn is not None:
        prices = tried("price list of accuracy", lambda: _prices(design, progress))
        certificate = tried("certificate", lambda: _certificate(design, progress))
    return Report(
        design.scene,
        checked,
        advised(checked),
        turn,
        tuple(charts),
        table,
        prices,
        solids,
        certificate,
        tuple(left_out),
    )


def _reason(error: CamgeoError) -> str:
    """The error in a line."""
    several = error.faults if isinstance(error, SceneError) else (error,)
    return " ".join("; ".join(map(str, several)).split())


def _motion(design: Design) -> Figure:
    scene = design.scene
    return motion.of_drive(design.name, scene.unit, design.drive, scene.lift_unit)


def _of_discs(design: Design) -> Iterator[tuple[str, Callable[[], Figure]]]:
    """The title of each diagram that needs a disc, and what makes it."""
    if design.scene.follower is None:
        return
    for disc in design.discs:
        name = "" if disc is design.disc else f" of {disc.name}"
        yield f"transmission angle{name}", partial(diagrams.transmission_angle, disc)
        yield f"curvature{name}", partial(diagrams.curvature, disc)
    if design.scene.effects:
        yield from of_effects(design.disc)
    if plots.SPECTRUM in design.scene.effects:
        yield "shock spectra", lambda: plots.of_design(design, [plots.SPECTRUM])[0]


def of_effects(disc: Product) -> Iterator[tuple[str, partial[Figure]]]:
    """Title and maker of each diagram of the scene's effects, of at most TOGETHER panels."""
    groups = effects.panels(disc.columns())
    parts = [groups[k : k + TOGETHER] for k in range(0, len(groups), TOGETHER)]
    for number, part in enumerate(parts, start=1):
        chosen = tuple(column for group in part for column in group)
        share = f", {number} of {len(parts)}" if len(parts) > 1 else ""
        one = replace(disc, columns=partial(tuple, chosen))
        yield f"forces and effects{share}", partial(effects.figure, one)


def advised(found: Check) -> tuple[Advised, ...]:
    """All findings of a check, each with its next step."""
    groups = [("cam", found.findings), *found.effects.items()]
    groups += [(f"part {name}", part.findings) for name, part in found.parts.items()]
    if found.machining is not None:
        groups += [
            (f"program {name}", each.findings) for name, each in found.machining.programs.items()
        ]
    groups.append(("formats", found.formats))
    return tuple(
        Advised(about, finding, next_step(finding, found.cures))
        for about, findings in groups
        for finding in findings
    )


def _prices(design: Design, progress: Progress) -> Survey:
    """Of contours alone, with what is the same on every machine."""
    from camgeo.accuracy.contours import contour_rows
    from camgeo.accuracy.knee import knee_of
    from camgeo.accuracy.survey import Survey, own_rows

    rows = contour_rows(design, TOLERANCES, ripple=False, progress=progress, timed=False)
    return Survey(rows, (), (), knee_of(own_rows(design.scene, rows), timed=False))


def coarse_solids(design: Design, progress: Progress = lambda _: None) -> dict[str, bytes]:
    """Binary STL files of the bodies by name, coarser than made; raises as `make_files`."""
    from camgeo.writing.write import CERTIFICATE, make_files

    coarse = max(FACETS * design.cam.follower.base_radius, LEAST)
    contents, _ = make_files(design.discs, ("stl",), coarse, progress=progress)
    return {name: data for name, data in contents.items() if name != CERTIFICATE}


def _certificate(design: Design, progress: Progress) -> dict[str, Any]:
    """Of the files that the scene asks for; none of them is written."""
    from camgeo.writing.write import CERTIFICATE, make_files

    output = design.scene.output
    contents, _ = make_files(design.discs, output.formats, output.tolerance, progress=progress)
    found: dict[str, Any] = json.loads(contents[CERTIFICATE])
    return found
