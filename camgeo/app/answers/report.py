"""Answer of `camgeo report`: all that is known of a design, to be viewed on one page."""

from __future__ import annotations

import argparse
import base64
import json
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from camgeo.app.answers.answer import FINDING, MANY, MARKS, SCENE, Answer, Key, one_line
from camgeo.app.answers.check import Check, check
from camgeo.app.cli.command import SCENE_FILE, Argument, opened, output_options, show, write_files
from camgeo.check.cures.remedies import Cure
from camgeo.check.finding import RETURN, Finding, Severity
from camgeo.design.writing import CERTIFICATE, make_files
from camgeo.errors import CamgeoError
from camgeo.pictures import plots
from camgeo.pictures.mechanism import Animation, animation
from camgeo.pictures.model import Figure
from camgeo.pictures.motion import readings
from camgeo.pictures.plots import MOTION_TITLE, Chart, disc_diagrams, motion_diagram, of_effects
from camgeo.units import counted

if TYPE_CHECKING:
    from camgeo.design.design import Design
    from camgeo.design.value_table import Table
    from camgeo.scene.scene import Scene
    from camgeo.studies.accuracy.survey import Survey


STEP: Final = 5
"""Step of the value table [degrees]: as many rows as fit on a sheet."""

TOLERANCES: Final = (1e-2, 1e-3, 1e-4)
"""Tolerances of the price list [mm]."""

FACETS, LEAST = 5e-4, 1e-3
"""Tolerance of the solid, relative to the base radius, and the least [mm]: finer than is seen."""

Progress = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class Advised:
    """A finding with the next step.

    Attributes
    ----------
    subject : what was checked: the cam, an effect, a part or a program.
    finding : the finding.
    step : the next step; empty if there is none.
    """

    subject: str
    finding: Finding
    step: str


@dataclass(frozen=True, slots=True, eq=False)
class Report(Answer):
    """All that is known of a design.

    Attributes
    ----------
    scene : of the design.
    check : the findings.
    advised : all findings, each with its next step.
    animation : a turn of the mechanism; None if there is none, or if it has no position somewhere.
    charts : the diagrams, with their extremes.
    table : the value table, a row every STEP degrees; None if it cannot be computed.
    prices : what accuracy costs in pieces, bytes and milling time; None if it was not requested or
        there is no disc.
    solids : binary STL files of the bodies, coarser than they are made, by their names; empty if
        the part has no thickness.
    certificate : of the files that the scene asks for, as it would be written with them; None if it
        was not requested or there is no disc.
    omissions : what the page lacks, and why.
    """

    scene: Scene
    check: Check
    advised: tuple[Advised, ...]
    animation: Animation | None
    charts: tuple[Chart, ...]
    table: Table | None
    prices: Survey | None
    solids: Mapping[str, bytes]
    certificate: Mapping[str, Any] | None
    omissions: tuple[str, ...]

    @property
    def certified(self) -> str | None:
        """The hash of the scene in the certificate; None if there is no certificate."""
        return None if self.certificate is None else str(self.certificate["scene"]["sha256"])

    @property
    def exit_code(self) -> int:
        """The exit code of the check."""
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
    omissions: list[str] = []

    def tried(what: str, make: Callable[[], Any]) -> Any:
        progress(what)
        try:
            return make()
        except CamgeoError as error:
            omissions.append(f"{what}: {one_line(error)}")
            return None

    turn = None
    if design.scene.follower is None:
        omissions.append("mechanism: the scene has no follower, so there is no disc")
    else:
        turn = tried("mechanism", lambda: animation(design.disc))
    wanted = [(MOTION_TITLE, partial(motion_diagram, design))]
    wanted += tried("diagrams of the disc", lambda: [*_disc_charts(design)]) or ()
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
        omissions.append("price list of accuracy and certificate: --quick leaves them out")
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
        tuple(omissions),
    )


def _disc_charts(design: Design) -> Iterator[tuple[str, Callable[[], Figure]]]:
    """The title of each diagram that needs a disc, and the function that makes it."""
    if design.scene.follower is None:
        return
    yield from ((title, make) for _, title, make in disc_diagrams(design))
    if design.scene.effects:
        yield from of_effects(design.disc)
    if plots.SPECTRUM in design.scene.effects:
        yield "shock spectra", lambda: plots.of_design(design, [plots.SPECTRUM])[0]


def advised(checked: Check) -> tuple[Advised, ...]:
    """All findings of a check, each with its next step."""
    groups = [("cam", checked.findings), *checked.effects.items()]
    groups += [(f"part {name}", part.findings) for name, part in checked.parts.items()]
    if checked.machining is not None:
        groups += [
            (f"program {name}", program.findings)
            for name, program in checked.machining.programs.items()
        ]
    groups.append(("formats", checked.formats))
    return tuple(
        Advised(subject, finding, next_step(finding, checked.cures))
        for subject, findings in groups
        for finding in findings
    )


def _prices(design: Design, progress: Progress) -> Survey:
    """The price list of the contours alone, without times: it is the same on every machine."""
    from camgeo.studies.accuracy.benefit import find_knee
    from camgeo.studies.accuracy.contours import contour_rows
    from camgeo.studies.accuracy.survey import Survey, scene_rows

    rows = contour_rows(design, TOLERANCES, ripple=False, progress=progress, timed=False)
    return Survey(rows, (), (), find_knee(scene_rows(design.scene, rows), timed=False))


def coarse_solids(design: Design, progress: Progress = lambda _: None) -> dict[str, bytes]:
    """Binary STL files of the bodies by name, coarser than made; raises as `make_files`."""
    coarse = max(FACETS * design.cam.follower.base_radius, LEAST)
    contents, _ = make_files(design.discs, ("stl",), coarse, progress=progress)
    return {name: data for name, data in contents.items() if name != CERTIFICATE}


def _certificate(design: Design, progress: Progress) -> dict[str, Any]:
    """The certificate of the files that the scene asks for; none of them is written."""
    output = design.scene.output
    contents, _ = make_files(design.discs, output.formats, output.tolerance, progress=progress)
    certificate: dict[str, Any] = json.loads(contents[CERTIFICATE])
    return certificate


# -- document -------------------------------------------------------------------------------------
# The keys of its JSON document.


DOCUMENT: Final = Key(
    "What the page of `camgeo report` shows of a design, in numbers and words; its table is that"
    " of `camgeo table`.",
    {
        "scene": SCENE,
        "findings": Key(
            "All findings, each with its next step.",
            {
                "about": Key(
                    "What was checked: the cam, an effect, a part or a program.", of="subject"
                ),
                "finding": FINDING,
                "step": "What to do about it; empty if there is nothing to do.",
            },
            of="advised",
        ),
        "charts": Key(
            "The diagrams, without their curves.",
            {
                "title": "Title of the diagram.",
                "sentence": "A description of the diagram.",
                "readings": Key(
                    "The extremes of its curves.",
                    {
                        "name": "Name of the quantity, with its unit in brackets.",
                        "low": Key("Smallest value; null if it is infinite.", type=float | None),
                        "low_at_deg": Key(
                            "Cam angle at which the smallest value is reached first.",
                            of="low_angle",
                        ),
                        "high": Key("Largest value; null if it is infinite.", type=float | None),
                        "high_at_deg": Key(
                            "Cam angle at which the largest value is reached first.",
                            of="high_angle",
                        ),
                    },
                ),
            },
        ),
        "certificate": Key(
            "SHA-256 of the scene in the certificate of its files; null if none was made.",
            of="certified",
        ),
        "left_out": Key("What the page lacks, and why.", of="omissions"),
    },
    type=Report,
)


# -- rendering ------------------------------------------------------------------------------------
# The answer of `camgeo report` in words.


def text(answer: Report) -> str:
    """The numbers of findings, the diagrams, what the page lacks, and the next steps."""
    verdicts = Counter[str](entry.finding.verdict for entry in answer.advised)
    # In the order of the marks, the worst first.
    several = (verdict for verdict in MARKS if verdicts[verdict])
    summary = ", ".join(
        counted(verdicts[verdict], MARKS[verdict], MANY[verdict]) for verdict in several
    )
    lines = [f"{answer.scene.name}: {counted(len(answer.advised), 'finding')}: {summary}"]
    lines += [f"  {chart.title}: {chart.sentence}" for chart in answer.charts]
    lines += [f"  left out: {omission}" for omission in answer.omissions]
    lines += [
        f"{MARKS[entry.finding.severity]:8}{entry.finding.name}: {entry.step}"
        for entry in answer.advised
        if entry.step
    ]
    return "\n".join(lines)


# -- steps ----------------------------------------------------------------------------------------
# The next step for each finding: what a designer can do about it, and with which command.


SIZE: Final = "camgeo size looks for the smallest cam that keeps this limit"
LAWS: Final = "camgeo laws compares the laws that fit"

BY_NAME: Final[Mapping[str, str]] = {
    "transmission-angle": f"Enlarge the base radius or lengthen the move; {SIZE}.",
    "radius-ratio": f"Take a smaller roller, a larger base radius or a longer move; {SIZE}.",
    "undercut": f"Take a smaller roller, a larger base radius or a longer move; {SIZE}.",
    "cusp": f"Take a smaller roller, a larger base radius or a longer move; {SIZE}.",
    "outline": f"Take a smaller roller, a larger base radius or a longer move; {SIZE}.",
    "lost-stroke": (
        "Decide whether the machine can do without the lost stroke; otherwise remove the undercut."
    ),
    "lobe": (
        "Decide whether the part is meant to be without the lobe; otherwise remove the undercut."
    ),
    "dead-centre": "Change crank, coupler or stroke until the linkage stays clear of it.",
    "linkage-branch": "Change crank, coupler or stroke until the linkage stays on its branch.",
    "linkage-transmission-angle": "Lengthen the coupler, or shorten the stroke or swing.",
    "linkage-back-angle": "Lengthen the crank that the rocker turns, or shorten the stroke.",
    "roller-over-axis": "Enlarge the base radius or shorten the stroke.",
    "face-over-axis": "Enlarge the base radius or shorten the stroke.",
    "standstill": "Move the pivot, or change the arm, away from this position.",
    "joints": f"Let both segments meet with the same velocity and acceleration; {LAWS}.",
    "shock": f"Take a law that begins and ends without a jump of velocity; {LAWS}.",
    "jerk": f"Take a law without jumps of acceleration; {LAWS}.",
    "overshoot": f"Lengthen the move or choose another law; {LAWS}.",
    "closure": "Let the last segment end where the first one begins.",
    "tangent-closure": "Let the motion end with the velocity with which it begins.",
    "convexity": f"Enlarge the base radius: a flat face needs a convex cam; {SIZE}.",
    "face-length": "Make the face longer, or state none to have it as long as needed.",
    "form-closure": "Change the return follower until both keep contact, or add a spring.",
    "closing-error": "Change the return follower, or allow the play that the sentence states.",
    "lift-off": "Strengthen the spring, or lower the speed or the moving mass.",
    "contact-force": "Lower the speed, the moving mass or the spring's preload.",
    "contact-pressure": "Widen the contact, enlarge the roller, or take another material.",
    "roller-life": "Take a larger roller, or lower the contact force.",
    "drive-torque": "Lower the load or the speed, or lengthen the move.",
    "largest-diameter": "Take a smaller base radius, or a blank that holds the disc.",
    "mass": "Take a lighter material, lightening holes, or a larger limit.",
}
"""The next step, by the name of a finding or its beginning; the longest match applies."""

OTHERWISE: Final[Mapping[Severity, str]] = {
    "ok": "",
    "warning": "Decide whether it matters here; files are written in spite of it.",
    "broken": (
        "Change what the sentence names until its limit is kept; or state another limit in the"
        " scene, if this one is not meant."
    ),
    "no-disc": "Change the scene until such a disc exists; no file can be made before.",
    "invalid": "Change the scene: it describes no mechanism that can be made.",
}

FAULTS: Final[Mapping[str, str]] = {
    "undercut": "undercut",
    "cusp": "undercut",
    "outline": "undercut",
    "convexity": "convexity",
    "radius-ratio": "radius ratio",
    "transmission-angle": "transmission angle",
}
"""The fault that remedies remove, by the beginning of the name of the finding."""


def next_step(finding: Finding, cures: Sequence[Cure]) -> str:
    """What to do about a finding; empty if nothing has to be done.

    It is the cheapest of the `cures` that works, if there is one, otherwise general advice.
    """
    if finding.severity == "ok":
        return ""
    base_name = finding.name.removeprefix(f"{RETURN}: ")
    faults = [fault for name, fault in FAULTS.items() if base_name.startswith(name)]
    works = [cure.sentence for cure in cures if cure.works and cure.fault in faults]
    if works:
        return f"{works[0][:1].upper()}{works[0][1:]}; camgeo check lists further remedies."
    names = [name for name in BY_NAME if base_name.startswith(name)]
    return BY_NAME[max(names, key=len)] if names else OTHERWISE[finding.severity]


# -- triangles ------------------------------------------------------------------------------------
# The triangles of solids, as the scripts of pages take them.


FACET: Final = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
"""A triangle of a binary STL."""

PREFIX: Final = 84
"""Bytes of a binary STL before its triangles: a header of 80, and their number in 4."""


def triangles(stl: bytes) -> str:
    """Three coordinates [mm] of three corners of each triangle of a binary STL, in base 64: single
    precision, little-endian.
    """
    corners = np.frombuffer(stl, FACET, offset=PREFIX)["corners"]
    return base64.b64encode(np.ascontiguousarray(corners).tobytes()).decode()


# -- command line ----------------------------------------------------------------------------------


PAGES: Final = "camgeo.pages"
"""Entry points of pages: callables that make an HTML file of an answer."""

EXAMPLE: Final = "camgeo report fixtures/scenes/setzhub.toml -o setzhub.html"


ARGUMENTS: Final = (
    SCENE_FILE,
    *output_options("page to write, .html; default: print a summary", (".html",)),
    Argument(
        "--quick",
        action="store_true",
        help="leave out price list and certificate, for which files are made",
    ),
)


def run(arguments: argparse.Namespace) -> int:
    """Print the summary, or write the page."""
    from importlib.metadata import entry_points

    answer = report(opened(arguments), quick=arguments.quick, progress=arguments.progress)
    if arguments.output is None or arguments.json:
        code = show(answer, arguments)
    if arguments.output is not None:
        page: bytes = entry_points(group=PAGES)["report"].load()(answer)
        write_files([(Path(arguments.output), page, "report")], arguments)
        code = answer.exit_code
    return code
