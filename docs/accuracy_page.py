"""Writes docs/accuracy.md and its pictures: `python docs/accuracy_page.py`.

Measures all fixture cams, which takes some minutes. A test repeats some of its rows; its seconds of
computing are those of one machine, and no test checks them.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Final

import camgeo
from camgeo.geometry.contour.contour import Effort, Form
from camgeo.pictures.accuracy import figure
from camgeo.studies.accuracy.benefit import advice, benefit_rows, find_knee
from camgeo.studies.accuracy.contours import EFFORTS, FORMS, ContourRow, contour_rows
from camgeo.studies.accuracy.survey import STEPS, Survey, scene_rows, solid_rows, survey, table_rows
from camgeo.units import RPM
from camgeo_export.plots import render

PAGE: Final = Path(__file__).with_name("accuracy.md")
IMAGES: Final = Path(__file__).with_name("images")
SCENES: Final = Path(__file__).resolve().parents[1] / "fixtures" / "scenes"

TOLERANCES: Final = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
"""Of the tables [mm]."""

PICTURED: Final = ("setzhub", "groove")
"""Cams with a picture."""

SPEED: Final = 300.0
"""Of the cam with masses and a spring in the picture of cost and benefit [rev/min]."""

AT_SPEED: Final = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5)
"""Tolerances of that picture [mm]."""

DETAILED: Final = "setzhub"
"""The cam whose computing times, solids and value tables are shown."""

HEAD = """# What accuracy costs

<!-- Made by docs/accuracy_page.py; change it there. -->

A tolerance is paid for in pieces: each decade makes the file larger, and where the pieces become
too short for the feed, the part is milled more slowly. `camgeo accuracy SCENE` measures it for the
contour that the scene's drawing has, for tolerances from 0.1 to 1e-6 mm, and prints a row for each:
the number of pieces, the bytes of the drawing, the seconds to fit, prove, write and read it, the
machining time, and with `--ripple` or `--speed` by how much the follower's acceleration is off.
Below, it says what the last step up to the recommended tolerance costs and buys, as in "from 0.01
mm to 0.001 mm costs 17 pieces, 10 ms and 2.4 kB, machining the same", and gives its advice.

`--all` measures all forms of the contour, each with both fits: the ratio of the pieces to the lower
limit, the proved deviation, programs, triangles and bytes of the solids, how much accuracy a value
table loses between its rows, and the numerical effects. `--json` prints all of this for programs,
`-o FILE` draws what was measured.

Seconds of computing are CPU time, so that other work on the machine is not counted. What takes less
than a second is done several times, with all that does not depend on the tolerance computed before;
the median is given, and as `spread` the ratio of the upper quartile to the lower one. Other work
still slows a processor down, by what they share: beside two busy processes two calls differ by up
to a fifth, and their spread is rarely above 1.2.

`--bill` also builds the scene within each tolerance, all its formats, and bills the CPU time by
stage, from the ledger of that very build: evaluate, fit, prove, write, read back; with the pieces,
the bytes of all files and the machining time. Drawn together with `--ripple`, the bill rises and
the ripple falls over the tolerance, with the advice marked in both.

## Which tolerance for this cam at 600 rev/min?

```sh
camgeo accuracy fixtures/scenes/setzhub.toml --tolerances 1e-1,1e-2,1e-3,1e-4,1e-5 --speed 600
```

ends with

```text
at 600 rev/min: arcs within 0.0001 mm, the acceleration is off by up to 9.75 % of its peak;
tighter ones change none of its benefits by more than 5 %
```

It is the loosest of these tolerances beyond which no tighter one changes the acceleration, the
contact force or the lift-off speed by more than 5 % of the exact motion's: the follower is run on
the written contour itself, straight pieces, arcs or splines; a flat face on splines is refused, as
its motion on them is not computed, and the row says so. Forces are those of the effects that the
scene names at that constant speed, whatever speed a motor would have, with the elastic train of the
scene; with one they are computed on contours of up to 500 pieces. What the tolerance costs is in
the tables, and with `--bill` in the seconds of a build.

With `--all` it has such a line for each form of the contour, and each row has the octave of the
cam's frequency in which most of the deviation of the acceleration is; `--json` has all octaves.

Drawn with `-o FILE`, cost and benefit are in one panel for the form of the scene's drawing: costs
as multiples of those at the loosest tolerance, rising; what is off in per cent of the exact
motion's, falling; the recommendation is marked with its reason. Further panels compare the forms,
and show the spectrum. [What accuracy buys](ripple.md) has this cam with masses and a spring, at
three speeds and for all forms of the contour; at 300 rev/min it is

![Deviations and costs of arcs over the tolerance, with what is enough](images/accuracy-speed.svg)

*The cam of ripple.md at 300 rev/min, above, and all costs; the dashed line is what is enough.*

[The bill of the fixture scenes](bill.md) has the seconds of a build by stage, and what the same
tolerances buy.

## What is possible

For a small tolerance eps, a contour of pieces of order k needs at least

    N = (C/eps)^(1/k) * integral of |D|^(1/k) ds

pieces, where D is the derivative that a piece cannot follow and C |D| h^k is the least error on a
span of length h.

| form | k | D | C | each decade of accuracy costs |
|---|---|---|---|---|
| straight pieces | 2 | kappa | 1/16 | 3.16 times the pieces |
| arcs, tangent | 3 | d kappa/ds | sqrt(3)/216 | 2.15 times |
| cubic spline, C2 | 4 | kappa'' - kappa^3 | 1/768 | 1.78 times |

So N = 0.2002 eps^(-1/3) times the integral for arcs. Dwells and turns about corners are one arc
each, whatever the tolerance; they are not in N and not in the ratios, except for straight pieces,
which have no arcs. A finite contour needs a little more than N: the number of pieces is a whole
number, and there is a joint wherever the motion has a break.

## Machining time

A controller has some blocks planned ahead, and runs so that it can stop at the end of the last of
them, slows down in corners and on tight arcs, and needs a least time for each block: many short
blocks cost time. The model is that of Grbl's planner, with which it agrees to a millionth, and of
what LinuxCNC's does in corners; `[dynamics]` of the machine profile has its numbers. The tables
give the time for one round along the flanks at the scene's feed, and the shortest one, as fast as
the controller can run these pieces: where the feed of the scene is low, only this one shows what
the tolerance costs. `certificate.json` has the estimate for the whole program, traverses and
plunges included. Jerk is not included. LinuxCNC's profile has the acceleration of its sample
machine, 508 mm/s^2.

## The knee

A power law has no knee of its own; the use of the pieces introduces one. The advice is the loosest
of these tolerances, for the form and the fit of the scene's drawing:

- time: the tightest at which a round takes at most 5 % longer than the quickest one;
- decimals: the tightest whose program needs no more decimals than the controller uses;
- with `--ripple`, the tightest up to which the ripple falls; with `--speed`, the one that is
  enough, see above;
- without both, cost: the tightest whose contour costs at most two steps of a factor 1.5 more than
  the cheapest, as the geometric mean of its pieces, bytes and seconds. Up to there header and
  layers are the larger part of a drawing, and what every fit does of the seconds; beyond, each
  decade multiplies all three. On this page seconds are left out of it.

If none of them ends within the tolerances that were tried, the advice says so: the end of a range
is no knee.

## The fixture cams

Each cell gives the number of pieces of the near-optimal fit, its ratio to N, and the ratio of the
fast fit. The DXF columns give thousands of bytes with straight pieces, arcs and splines; the milled
round is in seconds, with straight pieces and with arcs, first at the feed of the scene, then as
fast as the controller can run it. All of this is the same on every machine, except for last digits
that another processor rounds differently; the computing times further below are not.
"""

TABLE = """
### {name}

| tolerance [mm] | straight pieces | arcs | spline | DXF [kB] | round [s] | shortest [s] |
|---|---|---|---|---|---|---|
"""

PICTURE = """
![{name}: number of pieces and its limits, bytes and machining time over the tolerance]\
(images/accuracy-{name}.svg)

*Number of pieces of the near-optimal fit (filled) and the fast one (hollow) with the limits (thin);
file sizes; time for milling once round. The dashed line is the advice.*
"""

SECONDS = """
## Computing time

{name}, in seconds, on one machine and rounded to one digit: near-optimal fit with its proof, fast
fit with its proof, a new proof from the finished contour, writing the drawing, and reading it back
with proof.

| contour | tolerance [mm] | fewest | fast | proof | write | read |
|---|---|---|---|---|---|---|
"""

SOLIDS = """
## Solids

{name}: for STL and 3MF the flanks are tessellated within the tolerance, STEP has a face for each
arc. STL has single precision, which moves vertices by about 4e-6 mm at 50 mm from the axis; a file
that cannot meet the tolerance is not written.

A closed body of V vertices with g holes through it has 2V - 4 + 4g triangles, however its faces are
divided: two for each chord of a wall, and n - 2 + 2h for a flat face of n corners with h holes. So
the fewest chords give the fewest triangles; solids of all fixture scenes have at most 1.05 times as
many (`tests/end_to_end/test_triangles.py`).

| tolerance [mm] | triangles, STL | bytes | triangles, 3MF | bytes | faces, STEP | bytes |
|---|---|---|---|---|---|---|
"""

TABLES = """
## Value tables

{name}: rows and bytes over the step, and a bound on the error of the lift between two rows with
linear interpolation, max|s''| h^2/8, plus a term for jumps of the velocity.

| step [degrees] | rows | bytes | error [mm] |
|---|---|---|---|
"""

Found = Mapping[tuple[Form, Effort, float], ContourRow]


def by_key(rows: tuple[ContourRow, ...]) -> Found:
    """The rows by form, effort and tolerance."""
    return {(row.form, row.effort, row.tolerance): row for row in rows}


def cell(found: Found, form: Form, tolerance: float) -> str:
    """Pieces, their ratio, and that of the fast fit."""
    counts = [found[form, effort, tolerance].count for effort in EFFORTS]
    ratios = [
        "-" if count is None or count.ratio is None else f"{count.ratio:.2f}" for count in counts
    ]
    best = counts[0]
    return ", ".join(["-" if best is None else f"{best.pieces:,}", *ratios])


def line(found: Found, tolerance: float) -> str:
    """The line of a cam's table."""
    fewest = [found[form, EFFORTS[0], tolerance] for form in FORMS]
    sizes = ["-" if row.drawing is None else f"{row.drawing.size / 1e3:,.0f}" for row in fewest]
    cells = [f"{tolerance:g}", *(cell(found, form, tolerance) for form in FORMS)]
    cells += [
        ", ".join(sizes),
        rounds(row.round_seconds for row in fewest[:2]),
        rounds(row.shortest_seconds for row in fewest[:2]),
    ]
    return f"| {' | '.join(cells)} |\n"


def rounds(times: Iterable[float | None]) -> str:
    """Seconds, with a dash for what is not known."""
    return ", ".join("-" if time is None else f"{time:.1f}" for time in times)


def cam(name: str, rows: tuple[ContourRow, ...]) -> str:
    """The section of a cam."""
    found = by_key(rows)
    lines = [line(found, tolerance) for tolerance in sorted({key[2] for key in found})[::-1]]
    return "".join((TABLE.format(name=name), *lines))


def survey_section(name: str, measured: Survey) -> str:
    """The advice for a cam."""
    sentence = f"Advice: {advice(measured.knee)}."
    line = f"\n{textwrap.fill(sentence, 100, break_on_hyphens=False)}\n"
    return "".join((line, PICTURE.format(name=name) if name in PICTURED else ""))


def seconds(measured: Survey) -> str:
    """The lines of the table of seconds."""
    found = by_key(measured.contours)
    lines = []
    for form in FORMS:
        for tolerance in sorted({key[2] for key in found})[::-1]:
            fewest, fast = (found[form, effort, tolerance] for effort in EFFORTS)
            count, quick, drawing = fewest.count, fast.count, fewest.drawing
            values = [
                count and count.fit_seconds,
                quick and quick.fit_seconds,
                count and count.proof_seconds,
                drawing and drawing.write_seconds,
                drawing and drawing.read_seconds,
            ]
            cells = ["-" if value is None else f"{value:.1g}" for value in values]
            lines.append(f"| {form} | {tolerance:g} | {' | '.join(cells)} |\n")
    return "".join(lines)


def solids(measured: Survey) -> str:
    """The lines of the table of solids."""
    files = {(row.format, row.tolerance): row.file for row in measured.solids}
    lines = []
    for tolerance in sorted({key[1] for key in files})[::-1]:
        cells = []
        for kind, counted in (("stl", "triangles"), ("3mf", "triangles"), ("step", "faces")):
            file = files[kind, tolerance]
            cells += ["-", "-"] if file is None else [
                f"{file.facts[counted]:,}", f"{file.size:,}",
            ]  # fmt: skip
        lines.append(f"| {tolerance:g} | {' | '.join(cells)} |\n")
    return "".join(lines)


def tables(measured: Survey) -> str:
    """The lines of the value tables."""
    return "".join(
        f"| {row.step} | {row.rows:,} | {row.size:,} | {row.error:.2g} |\n"
        for row in measured.tables
    )


def page(cams: Mapping[str, Survey]) -> str:
    """The page's text from the measurements of the cams, by name."""
    parts = [HEAD]
    for name, measured in cams.items():
        parts += [cam(name, measured.contours), survey_section(name, measured)]
    detailed = cams[DETAILED]
    parts += [SECONDS.format(name=DETAILED), seconds(detailed)]
    parts += [SOLIDS.format(name=DETAILED), solids(detailed)]
    parts += [TABLES.format(name=DETAILED), tables(detailed)]
    return "".join(parts)


def scenes() -> list[str]:
    """Names of the fixture cams."""
    return sorted(path.stem for path in SCENES.glob("*.toml"))


def measure(name: str) -> Survey:
    """All that the page shows of a cam."""
    design, detailed = camgeo.load(SCENES / f"{name}.toml"), name == DETAILED
    rows = rows_of(name, TOLERANCES, timed=detailed)
    bodies = solid_rows(design, TOLERANCES, progress=print) if name in (DETAILED, *PICTURED) else ()
    tables = table_rows(design, STEPS, progress=print) if detailed else ()
    return Survey(rows, bodies, tables, find_knee(scene_rows(design.scene, rows), timed=False))


def rows_of(
    name: str, tolerances: tuple[float, ...], *, timed: bool = False
) -> tuple[ContourRow, ...]:
    """The contours of a cam at a few tolerances."""
    design = camgeo.load(SCENES / f"{name}.toml")
    programs = name in PICTURED
    return contour_rows(
        design, tolerances, ripple=False, progress=print, programs=programs, timed=timed
    )


def draw(name: str, measured: Survey) -> bytes:
    """The picture of a cam, without seconds of computing."""
    title = f"{name}: what accuracy costs"
    return render(figure(measured, title=title, computing=False), ".svg")


def draw_speed() -> bytes:
    """The picture of cost and benefit, without seconds of computing."""
    ripple_page = import_module("ripple_page")  # beside this script

    loaded = ripple_page.design()
    benefits = benefit_rows(loaded, AT_SPEED, (SPEED * RPM,), forms=("arcs",))
    measured = survey(camgeo.load(ripple_page.SCENE), AT_SPEED, timed=False)
    title = "setzhub: what accuracy costs and buys"
    return render(figure(measured, title=title, computing=False, benefits=benefits), ".svg")


if __name__ == "__main__":
    (IMAGES / "accuracy-speed.svg").write_bytes(draw_speed())
    everything = {name: measure(name) for name in scenes()}
    PAGE.write_text(page(everything), encoding="utf-8")
    for pictured in PICTURED:
        target = IMAGES / f"accuracy-{pictured}.svg"
        target.write_bytes(draw(pictured, everything[pictured]))
