"""Writes docs/opticurv.md: `python docs/opticurv_page.py`. A test holds the page to it.

Every figure is computed: the published program is ported line by line, with a switch for each of
its six faults in the derivatives, and compared with the value table of the scene made from its
project.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Callable, Collection, Iterable
from pathlib import Path
from typing import Final

import numpy as np

from camgeo.app.cli.import_ import FIELDS, RANGES, import_project, project_numbers
from camgeo.design.design import Design
from camgeo.numeric.arrays import FloatArray
from camgeo.scene.scene import parse_scene
from camgeo_export.table import COLUMNS, POINTS, point_columns

PAGE = Path(__file__).with_name("opticurv.md")

PROJECTS = Path(__file__).resolve().parents[1] / "fixtures" / "reference" / "ocv"

TABLES: Final = {"schnitt": "Table 5", "setzhub": "Table 6", "vorschub": "Table 7"}
"""Projects whose numbers are all printed, with their tables."""

DEGREE: Final = math.pi / 180.0

FAULTS: Final = {
    "rad": "psi' and psi'' per degree are used where those per radian are needed",
    "arg": "psi' and psi'' take the increment psi + beta for the angle theta of the crank",
    "M": "psi'' has a variable of the previous row in its denominator instead of 2 l_sk X",
    "RT": "the terms of psi'' in x'' and y'' have the wrong sign in two of four places",
    "y": "y'_Bik has the wrong sign, undone in the working curves but not in r_K",
    "sign": "psi' and psi'' are not negated where the answer to question 24 is negativ",
}
"""Faults of the derivatives; all must be corrected before the working curves and r_K are right."""

UNITS: Final = {
    "phi": "deg", "s": "mm", "psi": "deg", "psi_rad": "rad", "psi'": "1", "psi''": "1/rad",
    "mue": "deg", "r_K": "mm",
}  # fmt: skip
"""Of the columns; all others are mm."""

EQUAL: Final = 1e-9
"""A difference below this, in the unit of its column, is rounding."""

AGREE: Final = 1e-11
"""Within this the corrected program and camgeo agree, in the units of the columns; for r_K in that
of its reciprocal."""

Columns = dict[str, FloatArray]


def opticurv(numbers: dict[str, float], faults: Collection[str] = tuple(FAULTS)) -> Columns:
    """`COLUMNS` as opticurv 1.0.3 computes them, with those `faults` of `FAULTS` that are named.

    The source uses long double and increments phi; this uses doubles and exact angles. Its variable
    M has no value in the first row; here it is 0.
    """
    phi: FloatArray = np.arange(math.ceil(360.0 / numbers["n"])) * np.float64(numbers["n"])
    s, s1, s2 = _stroke(numbers, phi)  # per degree
    arm, crank, coupler = numbers["l_3"], numbers["l_sk"], numbers["l_4"]
    alpha, beta = numbers["alpha_sk"] * DEGREE, numbers["beta"]
    lean = crank * math.sin(alpha)
    if numbers["Q21"] == 1.0:
        start = (coupler - lean) * (1.0 if numbers["Q25"] == 1.0 else -1.0)
    else:
        start = coupler + lean
    height = crank * math.cos(alpha)
    eps = 1.0 if numbers["Q22"] == 1.0 else -1.0
    branch = 1.0 if numbers["Q23"] == 1.0 else -1.0
    tau = 1.0 if numbers["Q24"] == 1.0 else -1.0

    def angle(reach: FloatArray) -> FloatArray:
        a, b = 2.0 * crank * reach, -2.0 * crank * height
        c = reach**2 + height**2 - coupler**2 + crank**2
        root = np.sqrt(a**2 + b**2 - c**2)
        return np.asarray(2.0 * np.arctan((b + branch * root) / (a - c)) - beta * DEGREE)

    reach = start + eps * s
    psi_sk = angle(reach)
    psi = tau * (psi_sk - angle(np.array([start]))) / DEGREE
    theta = (psi + beta) * DEGREE if "arg" in faults else psi_sk + beta * DEGREE
    cosine, sine = np.cos(theta), np.sin(theta)
    across, along = 2.0 * crank * reach, 2.0 * crank * height
    psi1 = (2.0 * crank * eps * s1 * cosine + 2.0 * reach * eps * s1) / (
        across * sine + along * cosine
    )
    l_1 = math.hypot(numbers["x_A0"], numbers["y_A0"])
    cosine_g = (arm**2 + l_1**2 - numbers["r_G"] ** 2) / (2.0 * l_1 * arm)
    gamma = (math.degrees(math.acos(cosine_g)) + psi + phi) * DEGREE
    turned, k = phi * DEGREE, arm / l_1
    m = 1.0 - np.cos(turned) + k * np.cos(gamma)
    n = -np.sin(turned) + k * np.sin(gamma)
    below = np.concatenate(([0.0], m[:-1])) if "M" in faults else across
    above = (
        -across * psi1**2 * cosine
        + along * psi1**2 * sine
        - eps * 4.0 * crank * s1 * psi1 * sine
        + eps * 2.0 * crank * s2 * cosine
        + 2.0 * s1**2
        + eps * 2.0 * reach * s2
    )
    psi2 = above / (along * cosine + below * sine)
    if "sign" not in faults:
        psi1, psi2 = tau * psi1, tau * psi2
    first, second = (psi1, psi2) if "rad" in faults else (psi1 / DEGREE, psi2 / DEGREE**2)
    x_a0, y_a0 = numbers["x_A0"], numbers["y_A0"]
    x, y = x_a0 * m - y_a0 * n, x_a0 * n + y_a0 * m
    x1 = x_a0 * np.sin(turned) + y_a0 * np.cos(turned)
    x1 -= k * (first + 1.0) * (x_a0 * np.sin(gamma) + y_a0 * np.cos(gamma))
    y1 = x_a0 * np.cos(turned) - y_a0 * np.sin(turned)
    y1 -= k * (first + 1.0) * (x_a0 * np.cos(gamma) - y_a0 * np.sin(gamma))
    length = np.hypot(x1, y1)
    across_x, across_y = numbers["r_R"] * y1 / length, numbers["r_R"] * x1 / length
    sine_mu = abs(x1 * (y - y_a0) + (x - x_a0) * y1) / (np.hypot(x - x_a0, y - y_a0) * length)
    mue = abs(-0.5 * math.pi + np.arccos(np.minimum(sine_mu, 1.0))) / DEGREE
    if "y" not in faults:
        y1 = -y1
    even = np.cos(turned) - k * np.cos(gamma) * (first + 1.0) ** 2
    odd = np.sin(turned) - k * np.sin(gamma) * (first + 1.0) ** 2
    p, q = k * np.sin(gamma) * second, k * np.cos(gamma) * second
    wrong = -1.0 if "RT" in faults else 1.0
    x2 = x_a0 * (even - p) - y_a0 * (odd + wrong * q)
    y2 = x_a0 * (odd + q) + y_a0 * (even - wrong * p)
    r_k = np.sqrt(abs(x1**2 + y1**2) ** 3) / (x1 * y2 - x2 * y1)
    values = (
        *(phi, s, psi, psi * DEGREE, psi1 / DEGREE, psi2 / DEGREE**2, x, y),
        *(x + across_x - x_a0, y + across_y - y_a0, x - x_a0, y - y_a0),
        *(x - across_x - x_a0, y - across_y - y_a0, mue, r_k),
    )
    return dict(zip(COLUMNS, values, strict=True))


def _stroke(numbers: dict[str, float], phi: FloatArray) -> tuple[FloatArray, ...]:
    """s, s' and s'' [mm per degree^k] at `phi` (n,) [degrees]."""
    lift = numbers["s_H"]
    out = np.zeros((3, len(phi)))
    joints = np.cumsum([numbers[f"phi_H{k}"] for k in ("01", "12", "23", "34")])
    for begin, end, sign in ((joints[0], joints[1], 1.0), (joints[2], joints[3], -1.0)):
        inside, span = (phi >= begin) & (phi < end), end - begin
        z = (phi[inside] - begin) / span
        out[0, inside] = 10.0 * z**3 - 15.0 * z**4 + 6.0 * z**5
        if sign < 0.0:
            out[0, inside] = 1.0 - out[0, inside]
        out[1, inside] = sign * 30.0 * z**2 * (1.0 - z) ** 2 / span
        out[2, inside] = sign * 60.0 * z * (1.0 - z) * (1.0 - 2.0 * z) / span**2
    out[0, (phi >= joints[1]) & (phi < joints[2])] = 1.0
    return tuple(lift * out)


def right(name: str) -> Columns:
    """`COLUMNS` of a project as camgeo computes them."""
    data = (PROJECTS / f"{name}.ocv").read_bytes()
    return point_columns(Design(parse_scene(import_project(data, name))).disc)


def numbers_of(name: str) -> dict[str, float]:
    """The numbers of a project."""
    return project_numbers((PROJECTS / f"{name}.ocv").read_bytes())


def off(wrong: Columns, true: Columns, flank: str) -> FloatArray:
    """(n,) distance [mm] of the points of "i" (inner), "B" (pitch) or "a" (outer)."""
    x, y = f"x_{flank}_vers", f"y_{flank}_vers"
    return np.hypot(wrong[x] - true[x], wrong[y] - true[y])


# The page -----------------------------------------------------------------------------------------

HEAD = """# opticurv

<!-- Made by docs/opticurv_page.py; change it there. -->

opticurv 1.0.3 is the program of Wirsig's thesis ([sources.md](sources.md)). It computes a plate cam
that drives a slider through a rocker with a roller and a slider-crank. `camgeo import` turns its
projects into scenes, and the format `asc` writes its two point files with correct values:

```sh
camgeo import fixtures/reference/ocv/setzhub.ocv -o setzhub.toml
camgeo build setzhub.toml -o out --only asc       # setzhub1.asc, setzhub2.asc
```

`fixtures/reference/ocv` has the projects of Tables 4 to 7. The printed Table 4 is corrupt beyond
repair; `querhub.ocv` is one way to complete it, not the cam of the source.

## The project file

24 double-precision numbers, 192 bytes, nothing else. An answer is 1 for the first choice and 2 for
the second. The source calls the crank l_4 and the coupler l_3, and the roller lever l; the thesis
calls them l_sk, l_4 and l_3, and so does this page.

| no. | thesis | source | what | allowed | scene |
|---|---|---|---|---|---|
"""

OPEN = """
Rejected, with every fault reported: another file size; a number that is not finite or out of range;
an answer other than 1 or 2; spans that do not add up to 360 degrees; a triangle or a linkage that
does not close. An empty file is reported as empty: opticurv truncates a project as soon as it opens
it.

What the source leaves open, and how camgeo resolves it:

- **The byte order** is that of the machine. camgeo reads little-endian, as on PCs of the time; a
  project that makes sense only in the other order is rejected.
- **The 24th number** has no value in the source's list, which makes it 0; the program never reads
  it. A file with any other value is rejected as not from opticurv.
- **phi_H45** is ignored by the program: after the return it rests until 360 degrees. A plan that
  does not add up may rely on that, or have a typing error in another span, so it is rejected.
- **Question 25** is ignored if the answer to question 21 is nein. The scene gets the side that the
  program uses, `slider_side = "left"`, and says so.
- **x_H, y_H and beta** do not affect the cam. They are kept in a comment of the scene.
- Sense of rotation: the program computes a cam that turns clockwise, the text one that turns
  counter-clockwise. The scene has `rotation = "cw"`.
- A project has no speed, thickness or bore. The limits are camgeo's defaults, which are those of
  equation (3.36).

## The point files

{files}

Points are in mm from the cam axis, x_Bik and y_Bik from the pivot; psi' and psi'' are per radian;
`i`, `B` and `a` are the inner working curve, the pitch curve and the outer working curve; mue is
the transmission angle; r_K is positive where the pitch curve is convex and `inf` where its
curvature is exactly 0. The program prints six digits; camgeo prints all digits of a double, and its
files, read back, are exact. The program appends to the files of an earlier run; camgeo replaces
them. The working curves are complete, including the parts that undercut removes from the disc. Only
a rocker that drives a slider-crank has all these columns; other scenes are rejected.

## Where the program's numbers are wrong

{compared}

| column | {heads} |
|---|{rules}|
"""

CURVES = """
As distances between points that should coincide:

| curve | {heads} |
|---|{rules}|
"""

RADII = """
r_K passes through infinity at inflections, so its differences say little. What a designer reads
from it, to compare with the roller, is its smallest value of either sign; from mue it is the
smallest value:

| | {heads} |
|---|{rules}|
"""

CAUSES = """
## Why

There are six errors in the derivatives. With all of them corrected, the program agrees with camgeo
to {agree} in every column except mue. With all but one corrected, that one still changes the inner
working curve and the curvature 1/r_K by this much:

| fault | curve [mm] | | | 1/r_K [1/mm] | | |
|---|---|---|---|---|---|---|
| | {names} | {names} |
"""

REST = """
`sign` takes effect only if the answer to question 24 is negativ, which none of these tables has.
`M` and `RT` affect psi'' only, on which no point depends. With `y` alone r_K is wrong in the dwells
too.

mue is not a transmission angle: it is the angle between the radius and the tangent, 90 degrees in
every dwell, whatever the derivatives.

## What else differs

- The label of question 21 is reversed: ja is a crank that leans away from the slider.
- The angle psi_sk0 is labelled as degrees but is in rad; the headings of psi' and psi'' say [rad].
- r_G is an input, as in camgeo; the text computes it from the angles.
- The angle of the cam axis is an arc tangent of y/x, wrong by half a turn for x_A0 < 0. No point
  depends on it.
- The cam angle is incremented by n, so rounding errors accumulate and one row too many is possible.
  camgeo rounds each angle once.
- Nothing is checked: neither the plan, nor whether triangle and linkage close, nor undercut, nor
  the program's own criterion (3.36). `camgeo import` rejects what does not exist, `camgeo check`
  reports the rest.
- The formula for the crank's angle has a pole at 180 degrees, and is 0/0 for a coupler as long as
  the crank. camgeo's has no pole.
"""


def page() -> str:
    """The page's text."""
    found = {name: opticurv(numbers_of(name)) for name in TABLES}
    true = {name: right(name) for name in TABLES}
    heads = " | ".join(f"{table}, {name}" for name, table in TABLES.items())
    rules = "---|" * (len(TABLES) - 1) + "---"
    wrong = [
        column
        for column in COLUMNS
        if any(abs(found[name][column] - true[name][column]).max() > EQUAL for name in TABLES)
    ]
    parts = [HEAD]
    for place, field in enumerate(FIELDS, 1):
        words = RANGES[field.kind][2].split(";")[0].split(":")[0]
        key = f"`{field.key}`" if field.key else ""
        parts.append(
            f"| {place} | {field.name} | `{field.code}` | {field.meaning} | {words} | {key} |\n"
        )
    files = (
        "Plain rows of comma-separated numbers, one for each step n of the cam angle (`[output.csv]"
        f" step`), without a heading. `NAME1.asc` has {len(COLUMNS)} columns: {_listed(COLUMNS)}."
        f" `NAME2.asc` has {len(POINTS)}: {_listed(POINTS)}."
    )
    compared = (
        "The largest difference between the published program and the correct values on the cams"
        f" of {', '.join(TABLES.values())}, at steps of 0.5 degrees, with its cam angle."
        f" {_listed([column for column in COLUMNS if column not in wrong])} are correct, up to"
        " rounding."
    )
    wrapped = {"files": _wrapped(files), "compared": _wrapped(compared)}
    parts.append(OPEN.format(**wrapped, heads=heads, rules=rules))
    for column in wrong:
        if column == "r_K":
            continue
        cells = [_largest(true[name], found[name][column] - true[name][column]) for name in TABLES]
        parts.append(f"| `{column}` [{UNITS.get(column, 'mm')}] | {' | '.join(cells)} |\n")
    parts.append(CURVES.format(heads=heads, rules=rules))
    for flank, words in (("i", "inner working curve"), ("B", "pitch curve"), ("a", "outer")):
        cells = [_largest(true[name], off(found[name], true[name], flank)) for name in TABLES]
        parts.append(f"| {words} [mm] | {' | '.join(cells)} |\n")
    parts.append(RADII.format(heads=heads, rules=rules))
    for words, pick in PICKED.items():
        for whose, columns in (("printed", found), ("right", true)):
            cells = [_told(pick(columns[name])) for name in TABLES]
            parts.append(f"| {words}, {whose} | {' | '.join(cells)} |\n")
    return "".join((*parts, *_causes(true), REST))


def _listed(columns: Iterable[str]) -> str:
    return ", ".join(f"`{column}`" for column in columns)


def _wrapped(text: str) -> str:
    return textwrap.fill(text, 100, break_on_hyphens=False)


def _causes(true: dict[str, Columns]) -> list[str]:
    """The section on the faults one by one."""
    parts = [CAUSES.format(agree=f"{AGREE:.0e}", names=" | ".join(TABLES))]
    for fault, words in FAULTS.items():
        alone = {name: opticurv(numbers_of(name), (fault,)) for name in TABLES}
        moved = [off(alone[name], true[name], "i").max() for name in TABLES]
        bent = [abs(1.0 / alone[name]["r_K"] - 1.0 / true[name]["r_K"]).max() for name in TABLES]
        cells = " | ".join(_size(value) for value in (*moved, *bent))
        parts.append(f"| `{fault}`: {words} | {cells} |\n")
    return parts


def _smallest(values: FloatArray) -> float | None:
    return float(values.min()) if len(values) else None


PICKED: Final[dict[str, Callable[[Columns], float | None]]] = {
    "smallest r_K > 0 [mm]": lambda columns: _smallest(columns["r_K"][columns["r_K"] > 0.0]),
    "smallest -r_K of r_K < 0 [mm]": lambda columns: _smallest(
        -columns["r_K"][columns["r_K"] < 0.0]
    ),
    "smallest mue [deg]": lambda columns: _smallest(columns["mue"]),
}
"""Values read from the last two columns."""


def _told(value: float | None) -> str:
    return "none" if value is None else f"{value:.2f}"


def _largest(true: Columns, values: FloatArray) -> str:
    """The largest magnitude and its cam angle."""
    where = int(np.argmax(abs(values)))
    size = _size(float(abs(values[where])))
    return size if size == "0" else f"{size} at {true['phi'][where]:g}"


def _size(value: float) -> str:
    """To three digits; 0 for what is rounding."""
    return "0" if value < EQUAL else f"{value:.3g}"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
