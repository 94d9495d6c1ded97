"""What `camgeo report` gathers: all that is known of a design, to be looked at on one page."""

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

from camgeo.app.answers.answer import FINDING, MANY, MARKS, SCENE, Answer, Key, in_a_line
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
"""Of the value table [degrees]: as many rows as a sheet holds."""

TOLERANCES: Final = (1e-2, 1e-3, 1e-4)
"""Of the price list [mm]."""

FACETS, LEAST = 5e-4, 1e-3
"""Tolerance of the solid, relative to the base radius, and the least [mm]: finer than is seen."""

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
            left_out.append(f"{what}: {in_a_line(error)}")
            return None

    turn = None
    if design.scene.follower is None:
        left_out.append("mechanism: the scene has no follower, so there is no disc")
    else:
        turn = tried("mechanism", lambda: animation(design.disc))
    wanted = [(MOTION_TITLE, partial(motion_diagram, design))]
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


def _of_discs(design: Design) -> Iterator[tuple[str, Callable[[], Figure]]]:
    """The title of each diagram that needs a disc, and what makes it."""
    if design.scene.follower is None:
        return
    yield from ((title, make) for _, title, make in disc_diagrams(design))
    if design.scene.effects:
        yield from of_effects(design.disc)
    if plots.SPECTRUM in design.scene.effects:
        yield "shock spectra", lambda: plots.of_design(design, [plots.SPECTRUM])[0]


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
    """Of the files that the scene asks for; none of them is written."""
    output = design.scene.output
    contents, _ = make_files(design.discs, output.formats, output.tolerance, progress=progress)
    found: dict[str, Any] = json.loads(contents[CERTIFICATE])
    return found


# -- document -------------------------------------------------------------------------------------
# What JSON has of the answer.


DOCUMENT: Final = Key(
    "What the page of `camgeo report` shows of a design, in numbers and words; its table is that"
    " of `camgeo table`.",
    {
        "scene": SCENE,
        "findings": Key(
            "All findings, each with its next step.",
            {
                "about": "What was judged: the cam, an effect, a part or a program.",
                "finding": FINDING,
                "step": "What to do about it; empty if there is nothing to do.",
            },
            of="advised",
        ),
        "charts": Key(
            "The diagrams, without their curves.",
            {
                "title": "What it shows.",
                "sentence": "The same in words.",
                "readings": Key(
                    "The extremes of its curves.",
                    {
                        "name": "Of the quantity, with its unit in brackets.",
                        "low": Key("Smallest value; null if it is infinite.", type=float | None),
                        "low_at_deg": Key("Cam angle of its first place.", of="low_angle"),
                        "high": Key("Largest value; null if it is infinite.", type=float | None),
                        "high_at_deg": Key("Cam angle of its first place.", of="high_angle"),
                    },
                ),
            },
        ),
        "certificate": Key(
            "SHA-256 of the scene in the certificate of its files; null if none was made.",
            of="certified",
        ),
        "left_out": "What the page lacks, and why.",
    },
    type=Report,
)


# -- rendering ------------------------------------------------------------------------------------
# What `camgeo report` gathers, in words.


def text(answer: Report) -> str:
    """The verdict, what the page has, what it lacks, and the next steps."""
    verdicts = Counter[str](each.finding.verdict for each in answer.advised)
    several = (each for each in MARKS if verdicts[each])
    found = ", ".join(counted(verdicts[each], MARKS[each], MANY[each]) for each in several)
    lines = [f"{answer.scene.name}: {counted(len(answer.advised), 'finding')}: {found}"]
    lines += [f"  {chart.title}: {chart.sentence}" for chart in answer.charts]
    lines += [f"  left out: {each}" for each in answer.left_out]
    lines += [
        f"{MARKS[each.finding.severity]:8}{each.finding.name}: {each.step}"
        for each in answer.advised
        if each.step
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
        "Decide whether the machine can do without the lost stroke; else cure the undercut."
    ),
    "lobe": "Decide whether the part without the lobe is meant; else cure the undercut.",
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
"""What helps, by the name of a finding or its beginning."""

OTHERWISE: Final[Mapping[Severity, str]] = {
    "ok": "",
    "warning": "Decide whether it matters here: nothing is refused because of it.",
    "broken": (
        "Change what the sentence names until its limit is kept; or state another limit in the"
        " scene, if this one is not meant."
    ),
    "no-disc": "Change the scene until such a disc exists: no file is made before.",
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
"""The fault that cures remove, by the beginning of the name of the finding."""


def next_step(finding: Finding, cures: Sequence[Cure]) -> str:
    """What to do about it; empty if nothing is to be done.

    The cheapest of the `cures` that works, if there is one.
    """
    if finding.severity == "ok":
        return ""
    about = finding.name.removeprefix(f"{RETURN}: ")
    faults = [fault for name, fault in FAULTS.items() if about.startswith(name)]
    works = [cure.sentence for cure in cures if cure.works and cure.fault in faults]
    if works:
        return f"{works[0][:1].upper()}{works[0][1:]}; camgeo check tells what else cures it."
    found = [name for name in BY_NAME if about.startswith(name)]
    return BY_NAME[max(found, key=len)] if found else OTHERWISE[finding.severity]


# -- triangles ------------------------------------------------------------------------------------
# The triangles of solids, as the scripts of pages take them.


FACET: Final = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
"""A triangle of a binary STL."""

PREFIX: Final = 84
"""Bytes of a binary STL before its triangles."""


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

    found = report(opened(arguments), quick=arguments.quick, progress=arguments.progress)
    if arguments.output is None or arguments.json:
        code = show(found, arguments)
    if arguments.output is not None:
        page: bytes = entry_points(group=PAGES)["report"].load()(found)
        write_files([(Path(arguments.output), page, "report")], arguments)
        code = found.exit_code
    return code
