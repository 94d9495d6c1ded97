"""The numbers of a project of opticurv 1.0.3 (Wirsig, appendix A), read and checked.

A project is 24 doubles and nothing else: `OeffnenSlot` and `speichere` of the source read and write
the bytes of ``double[24]`` (source lines 137 to 164 and 202 to 206). They are little-endian, as on
the computers that the program was written for; the source itself leaves the order of the bytes to
the machine.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from decimal import Decimal
from typing import Final, Literal

from camgeo.errors import Fault, SceneError

COUNT: Final = 24

SIZE: Final = 8 * COUNT
"""Of a project [bytes]."""

TURN: Final = Decimal(360)

Kind = Literal["rest", "move", "length", "place", "deflection", "free", "step", "choice", "unused"]

RANGES: Final[dict[Kind, tuple[float, float, str]]] = {
    "rest": (0.0, 360.0, "a number from 0 to 360 (degrees)"),
    "move": (1e-6, 360.0, "a number from 1e-6 to 360 (degrees); a move needs a span"),
    "length": (1e-9, 1e9, "a positive length, 1e-9 to 1e9 mm"),
    "place": (-1e9, 1e9, "a length, -1e9 to 1e9 mm"),
    "deflection": (-90.0, 90.0, "a number from -90 to 90 (degrees)"),
    "free": (-1e9, 1e9, "a number, -1e9 to 1e9"),
    "step": (1e-4, 90.0, "a number from 0.0001 to 90 (degrees)"),
    "choice": (1.0, 2.0, "1 for the first or 2 for the second answer"),
    "unused": (0.0, 0.0, "0: opticurv 1.0.3 leaves it empty, so that another program wrote this"),
}
"""Lowest and highest value of each kind of number, both allowed, and how messages describe it."""


@dataclass(frozen=True, slots=True)
class Field:
    """One number of a project.

    Attributes
    ----------
    name : symbol in the thesis and on the program's pages, or the number of the question.
    code : the source's variable, which has other letters for three lengths.
    kind : what values it may have.
    meaning : what it is.
    key : what it becomes in the scene, empty for what does not change the cam.
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
    """The faults of numbers that are beyond their range."""
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
    hint = f"opticurv heeds no phi_H45 and rests for {rest.normalize():f} degrees there"
    message = f"the spans add up to {total.normalize():f} degrees; they must add up to 360"
    return [Fault("phi_H01 to phi_H45", "", message, hint if rest >= 0 else "")]
