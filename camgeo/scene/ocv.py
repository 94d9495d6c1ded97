"""A project of opticurv 1.0.3 as the text of a scene."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Final

from camgeo.errors import Fault, SceneError
from camgeo.scene.load import parse_scene
from camgeo.scene.ocv_layout import FIELDS, project_numbers, shortest

LONGEST_NAME: Final = 100
"""Of a scene."""

TOGETHER: Final = {
    "follower.pivot": "x_A0, y_A0",
    "follower": "l_3, x_A0, y_A0, r_G",
    "linkage": "l_sk, l_4, alpha_sk, s_H",
}
"""Numbers of a project behind faults that no single one of them has."""


def scene_name(stem: str) -> str:
    """A name that a scene may have, from the name of a file without its ending."""
    return re.sub(r"[^A-Za-z0-9_-]+", "-", stem).strip("-")[:LONGEST_NAME] or "opticurv"


def import_project(data: bytes, name: str, file: str = "") -> str:
    """The text of the scene that says what the project `data` says; it loads.

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
        raise SceneError([_of_project(fault) for fault in error.faults], file) from error
    return text


def ignored_answer(numbers: dict[str, float]) -> bool:
    """Whether Q25 says "negative" where the program does not heed it: for Q21 = 2, "nein"."""
    return numbers["Q21"] == 2.0 and numbers["Q25"] == 2.0


def _of_project(fault: Fault) -> Fault:
    """A fault of the scene as one of the project it was made from, which has no lines."""
    names = {field.key: field.name for field in FIELDS if field.key} | TOGETHER
    name = names.get(fault.key, "")
    if not name:
        return replace(fault, line=None)
    return replace(fault, key=name, hint=fault.hint or f"{fault.key} in the scene", line=None)


def _scene_text(numbers: dict[str, float], name: str) -> str:
    """The scene, with the project's names in its comments."""
    words = {field: shortest(number) for field, number in numbers.items()}
    pivot = f"[{shortest(-numbers['x_A0'])}, {shortest(-numbers['y_A0'])}]"

    def answer(question: str, first: str, second: str) -> str:
        return first if numbers[question] == 1.0 else second

    # The program multiplies s_0 by -1 in the branch "ja" of question 21 only (source line 961).
    side = "left" if ignored_answer(numbers) else answer("Q25", "left", "right")
    noted = "; opticurv does not heed it" if ignored_answer(numbers) else ""
    return TEMPLATE.format(
        name=name,
        pivot=pivot,
        leans=answer("Q21", "away", "toward"),
        way=answer("Q22", "left", "right"),
        branch=answer("Q23", "cw", "ccw"),
        mirrored=answer("Q24", "false", "true"),
        side=side,
        noted=noted,
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
# stand as they were given. beta = {beta}, x_H = {x_H} and y_H = {y_H} of the project
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
slider_side = "{side}"  # question 25: {said[Q25]}{noted}
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
