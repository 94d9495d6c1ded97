"""`camgeo import`: a project of opticurv 1.0.3 (Wirsig, appendix A) as the text of a scene.

A project is 24 doubles and nothing else: `OeffnenSlot` and `speichere` of the source read and write
the bytes of ``double[24]`` (source lines 137 to 164 and 202 to 206). They are little-endian, as on
the computers that the program was written for; the source itself leaves the byte order to the
machine.
"""

from __future__ import annotations

import argparse
import math
import re
import struct
from dataclasses import dataclass, replace
from decimal import Decimal
from pathlib import Path
from typing import Final, Literal

from camgeo.app.cli.command import Argument, CallError, deliver, notify, output_options
from camgeo.errors import Fault, SceneError
from camgeo.reading import Limits
from camgeo.scene.scene import parse_scene, read_file

PROJECT: Final = Limits("project", 2_000_000)

COUNT: Final = 24

SIZE: Final = 8 * COUNT
"""Size of a project [bytes]."""

TURN: Final = Decimal(360)

Kind = Literal["rest", "move", "length", "place", "deflection", "free", "step", "choice", "unused"]

RANGES: Final[dict[Kind, tuple[float, float, str]]] = {
    "rest": (0.0, 360.0, "a number from 0 to 360 (degrees)"),
    "move": (1e-6, 360.0, "a number from 1e-6 to 360 (degrees); a move needs a span"),
    "length": (1e-9, 1e9, "a positive length, 1e-9 to 1e9 mm"),
    "place": (-1e9, 1e9, "a length, -1e9 to 1e9 mm"),
    "deflection": (-90.0, 90.0, "a number from -90 to 90 (degrees)"),
    "free": (-1e9, 1e9, "a number, -1e9 to 1e9"),
    "step": (1e-3, 90.0, "a number from 0.001 to 90 (degrees)"),
    "choice": (1.0, 2.0, "1 for the first or 2 for the second answer"),
    "unused": (0.0, 0.0, "0: opticurv 1.0.3 leaves it empty, so another program wrote this"),
}
"""Lowest and highest allowed value of each kind of number, and what messages say is allowed."""


@dataclass(frozen=True, slots=True)
class Field:
    """One number of a project.

    Attributes
    ----------
    name : symbol in the thesis and on the program's pages, or the number of the question.
    code : variable in the source, which has other letters for three lengths.
    kind : decides which values are allowed.
    meaning : in words.
    key : key of the scene that takes the number; empty if it does not affect the cam.
    """

    name: str
    code: str
    kind: Kind
    meaning: str
    key: str = ""


FIELDS: Final = (
    Field("phi_H01", "dphi_R1", "rest", "first rest", "motion[1].dwell"),
    Field("phi_H12", "dphi_An", "move", "rise", "motion[2].span"),
    Field("phi_H23", "dphi_R2", "rest", "rest at the stroke's end", "motion[3].dwell"),
    Field("phi_H34", "dphi_Ab", "move", "return", "motion[4].span"),
    Field("phi_H45", "dphi_R3", "rest", "last rest", "motion[5].dwell"),
    Field("l_3", "dl", "length", "roller lever", "follower.arm"),
    Field("s_H", "ds_H", "place", "stroke of the slider", "motion[2].to"),
    Field(
        "alpha_sk",
        "dalpha_sk",
        "deflection",
        "crank from the perpendicular to the guide",
        "linkage.crank_deflection",
    ),
    Field("l_sk", "dl_4", "length", "crank", "linkage.crank"),
    Field("l_4", "dl_3", "length", "coupler", "linkage.coupler"),
    Field("x_H", "dx_H", "free", "offset of the lever"),
    Field("y_H", "dy_H", "free", "offset of the lever"),
    Field("r_R", "dr_R", "length", "roller radius", "follower.roller_radius"),
    Field("x_A0", "dx_A0", "place", "cam axis, seen from the pivot", "follower.pivot[1]"),
    Field("y_A0", "dy_A0", "place", "cam axis, seen from the pivot", "follower.pivot[2]"),
    Field("beta", "dbeta", "free", "angle from rocker to crank"),
    Field("r_G", "dr_G", "length", "radius of the base circle", "follower.base_radius"),
    Field("n", "dn_1", "step", "step of the cam angle", "output.csv.step"),
    Field("Q21", "dri_schieber", "choice", "crank towards the slider?", "linkage.crank_leans"),
    Field("Q22", "dhub_gleich", "choice", "strokes equally directed?", "linkage.stroke_direction"),
    Field("Q23", "dquadrant", "choice", "quadrant of B_a", "linkage.branch"),
    Field("Q24", "dpsi_positiv", "choice", "rocker positive or negative?", "linkage.mirrored"),
    Field("Q25", "ds_0_positiv", "choice", "s_0 positive or negative?", "linkage.slider_side"),
    Field("-", "-", "unused", "nothing; the array has one place too many"),
)
"""The numbers of a project, in their order."""


def project_numbers(data: bytes, file: str = "") -> dict[str, float]:
    """The numbers of a project by their names in the thesis, angles in degrees, lengths in mm.

    Raises
    ------
    SceneError
        If `data` is not a project, or any number is out of range; it lists all faults.
    """
    if not data:
        message = (
            "the project is empty: opticurv empties a project when it opens it, and fills it again"
            " only when it computes"
        )
        raise SceneError([Fault("", "", message)], file)
    if len(data) != SIZE:
        message = f"a project has {SIZE} bytes, {COUNT} doubles; this file has {len(data):,}"
        raise SceneError([Fault("", "", message)], file)
    numbers = struct.unpack(f"<{COUNT}d", data)
    faults = _beyond(numbers)
    # Numbers that are valid in the other byte order show what is wrong with the file.
    if faults and not _beyond(struct.unpack(f">{COUNT}d", data)):
        message = "the doubles are big-endian; a project has them little-endian"
        raise SceneError([Fault("", "", message)], file)
    if not faults:
        faults = _plan_faults(numbers[:5])
    if faults:
        raise SceneError(faults, file)
    return {field.name: number for field, number in zip(FIELDS, numbers, strict=True)}


def shortest(value: float) -> str:
    """The shortest decimal that reads back as `value`; no sign on 0, no ".0"."""
    return repr(value + 0.0).removesuffix(".0")


def _beyond(numbers: tuple[float, ...]) -> list[Fault]:
    """The faults of numbers outside their range."""
    faults = []
    for place, (field, number) in enumerate(zip(FIELDS, numbers, strict=True), 1):
        lowest, highest, words = RANGES[field.kind]
        valid = math.isfinite(number) and lowest <= number <= highest
        if not valid or (field.kind == "choice" and number not in (1.0, 2.0)):
            name = "" if field.name == "-" else f" ({field.name})"
            faults.append(Fault(f"number {place}{name}", shortest(number), f"must be {words}"))
    return faults


def _plan_faults(spans: tuple[float, ...]) -> list[Fault]:
    """The fault of spans that are not one turn, added as they are written in decimals."""
    total = sum((Decimal(repr(span)) for span in spans), Decimal(0))
    if total == TURN:
        return []
    rest = TURN - total + Decimal(repr(spans[-1]))
    hint = f"opticurv ignores phi_H45 and rests for {rest.normalize():f} degrees there"
    message = f"the spans add up to {total.normalize():f} degrees; they must add up to 360"
    return [Fault("phi_H01 to phi_H45", "", message, hint if rest >= 0 else "")]


LONGEST_NAME: Final = 100
"""Most characters of the name of a scene."""

TOGETHER: Final = {
    "follower.pivot": "x_A0, y_A0",
    "follower": "l_3, x_A0, y_A0, r_G",
    "linkage": "l_sk, l_4, alpha_sk, s_H",
}
"""Numbers of a project that together cause a fault at a key of the scene."""


def scene_name(stem: str) -> str:
    """A name that a scene may have, from the name of a file without its ending."""
    return re.sub(r"[^A-Za-z0-9_-]+", "-", stem).strip("-")[:LONGEST_NAME] or "opticurv"


def import_project(data: bytes, name: str, file: str = "") -> str:
    """The text of a valid scene with the content of the project `data`.

    `name` is the scene's, `file` the path of the project, for messages.

    Raises
    ------
    SceneError
        As `project_numbers`; also if there is no such mechanism.
    """
    text = _scene_text(project_numbers(data, file), name)
    try:
        parse_scene(text)
    except SceneError as error:
        raise SceneError([_project_fault(fault) for fault in error.faults], file) from error
    return text


def ignored_answer(numbers: dict[str, float]) -> bool:
    """Whether Q25 says "negative" where the program ignores it: for Q21 = 2, "nein"."""
    return numbers["Q21"] == 2.0 and numbers["Q25"] == 2.0


def _project_fault(fault: Fault) -> Fault:
    """A fault of the scene restated for the project it was made from, which has no lines."""
    names = {field.key: field.name for field in FIELDS if field.key} | TOGETHER
    name = names.get(fault.key, "")
    if not name:
        return replace(fault, line=None)
    return replace(fault, key=name, hint=fault.hint or f"{fault.key} in the scene", line=None)


def _scene_text(numbers: dict[str, float], name: str) -> str:
    """The text of the scene, with the names of the project in its comments."""
    words = {field: shortest(number) for field, number in numbers.items()}
    pivot = f"[{shortest(-numbers['x_A0'])}, {shortest(-numbers['y_A0'])}]"

    def answer(question: str, first: str, second: str) -> str:
        return first if numbers[question] == 1.0 else second

    # The program multiplies s_0 by -1 in the branch "ja" of question 21 only (source line 961).
    side = "left" if ignored_answer(numbers) else answer("Q25", "left", "right")
    remark = "; opticurv ignores it" if ignored_answer(numbers) else ""
    return TEMPLATE.format(
        name=name,
        pivot=pivot,
        leans=answer("Q21", "away", "toward"),
        way=answer("Q22", "left", "right"),
        branch=answer("Q23", "cw", "ccw"),
        mirrored=answer("Q24", "false", "true"),
        side=side,
        remark=remark,
        said={f"Q2{k}": answer(f"Q2{k}", *ANSWERS[f"Q2{k}"]) for k in range(1, 6)},
        **words,
    )


ANSWERS: Final = {
    "Q21": ("ja", "nein"),
    "Q22": ("ja", "nein"),
    "Q23": ("erster", "zweiter"),
    "Q24": ("positiv", "negativ"),
    "Q25": ("positiv", "negativ"),
}
"""The answers that 1 and 2 stand for, as the thesis's tables print them."""

TEMPLATE: Final = """\
# Imported from a project of opticurv 1.0.3. Comments name its numbers as the thesis does; answers
# are as they were given. beta = {beta}, x_H = {x_H} and y_H = {y_H} of the project
# have no effect on the cam and are not carried over.

camgeo = 1
name = "{name}"

[cam]
rotation = "cw"  # the sense that opticurv computes
# speed = 90  # rev/min; not in a project, what depends on time needs it

[follower]
kind = "oscillating-roller"
pivot = {pivot}  # -x_A0, -y_A0: the pivot seen from the cam axis
arm = {l_3}  # l_3
arm_side = "ccw"
base_radius = {r_G}  # r_G
roller_radius = {r_R}  # r_R
contact = "inner"

[linkage]
kind = "slider-crank"
crank = {l_sk}  # l_sk
coupler = {l_4}  # l_4
crank_deflection = {alpha_sk}  # alpha_sk
crank_leans = "{leans}"  # question 21: {said[Q21]}; the program's label is the other way round
slider_side = "{side}"  # question 25: {said[Q25]}{remark}
stroke_direction = "{way}"  # question 22: {said[Q22]}
branch = "{branch}"  # question 23: {said[Q23]}
mirrored = {mirrored}  # question 24: {said[Q24]}

[[motion]]
dwell = {phi_H01}  # phi_H01

[[motion]]
law = "polynomial-345"
span = {phi_H12}  # phi_H12
to = {s_H}  # s_H

[[motion]]
dwell = {phi_H23}  # phi_H23

[[motion]]
law = "polynomial-345"
span = {phi_H34}  # phi_H34
to = 0

[[motion]]
dwell = {phi_H45}  # phi_H45

[limits]
radius_ratio = 0.7  # r_R / r_K, equation (3.36), which the program does not check

[output]
formats = ["dxf", "csv"]  # "asc" writes the program's two point files

[output.csv]
step = {n}  # n
"""


# -- command line ---------------------------------------------------------------------------------


EXAMPLE: Final = "camgeo import fixtures/reference/ocv/setzhub.ocv -o setzhub.toml"


ARGUMENTS: Final = (
    Argument("project", metavar="PROJECT", help="project file (.ocv)"),
    *output_options("scene file to write; default: print to the terminal"),
)


def run(arguments: argparse.Namespace) -> int:
    """Print or write the scene."""
    source, target = Path(arguments.project), arguments.output
    if target is not None and Path(target).resolve() == source.resolve():
        raise CallError(f"argument -o: {target} is the project itself")
    data = read_file(source, PROJECT.size)
    text = import_project(data, scene_name(source.stem), str(source))
    if ignored_answer(project_numbers(data)):
        notify(
            "camgeo: question 25 is answered with negativ, which opticurv ignores if"
            ' question 21 is answered with nein: slider_side = "left" is what it computes'
        )
    return deliver(text, arguments, f"written; next: camgeo check {target}")
