"""Writes docs/bill.md: `python docs/bill_page.py`, some minutes on a machine with nothing else.

Builds every fixture scene within each tolerance, and runs its follower on the written contour.
Seconds are those of one machine, and no test checks them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

import camgeo
from camgeo.app.answers.accuracy import harmonics
from camgeo.design.design import Design
from camgeo.scene.formats.dxf import FORMAT
from camgeo.studies.accuracy.benefit import BenefitRow, benefit_rows
from camgeo.studies.accuracy.survey import STAGES, BillRow, bill_rows
from camgeo.units import RPM

PAGE: Final = Path(__file__).with_name("bill.md")
FIXTURES: Final = Path(__file__).resolve().parents[1] / "fixtures"
FOLDERS: Final = ("scenes", "effects")
"""Of scenes without and with forces."""

TOLERANCES: Final = (1e-1, 1e-2, 1e-3, 1e-4)
"""[mm]"""

ELASTIC: Final = (1e-1, 1e-3)
"""Those at which forces of an elastic train are computed: some seconds each."""

SPEED: Final = 300.0
"""Of a cam whose scene gives none [rev/min]."""

HEAD: Final = """# The bill of the fixture scenes

<!-- Made by docs/bill_page.py; change it there. -->

What a build takes, from the loaded scene to the last file, all formats of the scene: seconds by
stage, those of effects under evaluate, on one machine and rounded to two digits; the pieces of the
flanks of all discs; the bytes of all files with the certificate; and the machining time of all
programs. `camgeo accuracy SCENE --bill` makes it for one scene; [what accuracy costs](accuracy.md)
tells what is in each stage. What the same tolerances [buy](#what-it-buys) is below, scene by scene.

## What it costs

| scene | tolerance [mm] | evaluate | fit | prove | write | read | total [s] | pieces | bytes \
| machining [s] |
|---|---|---|---|---|---|---|---|---|---|---|
"""

BUYS: Final = """
## What it buys

The follower on the written contour, in the form of the scene's drawing, at the constant speed of
the scene, or at {speed:g} rev/min (in brackets) if it gives none, as `camgeo accuracy SCENE
--speed` has it: the largest deviation of the acceleration in per cent of the exact peak (ripple)
and in mm/s^2 or rad/s^2; that of the contact force, and from which speed on the follower leaves the
cam, with the masses, springs and elastic train of the scene, for a train at two tolerances only;
the harmonics of the cam's speed in which most of the deviation of the acceleration is, and its
effective value in them, in the same unit. A dash: the scene has no forces, the follower never
leaves the cam or is held both ways, or no such speed was found. Scenes with forces are those of
fixtures/effects. [What accuracy buys](ripple.md) has one cam in all forms.

| scene | contour | rev/min | tolerance [mm] | ripple [%] | acceleration | force [N] \
| lifts off [rev/min] | octave | in it |
|---|---|---|---|---|---|---|---|---|---|
"""


def scenes() -> list[str]:
    """Names of the fixture scenes, of those with forces with their folder."""
    found = [
        (folder, path.stem) for folder in FOLDERS for path in (FIXTURES / folder).glob("*.toml")
    ]
    return sorted(stem if folder == FOLDERS[0] else f"{folder}/{stem}" for folder, stem in found)


def load(name: str) -> Design:
    """The scene of that name."""
    place = name if "/" in name else f"{FOLDERS[0]}/{name}"
    return camgeo.load(FIXTURES / f"{place}.toml")


def measure(name: str, tolerances: Sequence[float] = TOLERANCES) -> tuple[BillRow, ...]:
    """The builds of a scene."""
    return bill_rows(load(name), tolerances)


def bought(name: str) -> tuple[BenefitRow, ...]:
    """What the contours of a scene do, in the form of its drawing."""
    design = load(name)
    tolerances = ELASTIC if "vibration" in design.scene.effects else TOLERANCES
    speed = design.drive.speed or SPEED * RPM
    form = design.scene.output.options[FORMAT].form
    return benefit_rows(design, tolerances, (speed,), forms=(form,))


def line(name: str, row: BillRow) -> str:
    """The line of a build; of one that is impossible with the reason."""
    if row.fault:
        return f"| {name} | {row.tolerance:g} | {row.fault} |{' |' * 8}\n"
    seconds = [row.stages[stage] for stage in STAGES]
    cells = [name, f"{row.tolerance:g}", *map(_seconds, (*seconds, row.total))]
    cells += [f"{row.pieces:,}", f"{row.size:,}", _seconds(row.machining_seconds)]
    return f"| {' | '.join(cells)} |\n"


def _seconds(value: float | None) -> str:
    return "-" if value is None else f"{value:.2g}" if value < 10.0 else f"{value:,.0f}"


def lines(name: str, rows: Sequence[BenefitRow]) -> list[str]:
    """The lines of what a scene's contours do; one alone if there is the same reason for none."""
    given = load(name).drive.speed is not None
    speed = f"{rows[0].speed / RPM:g}"
    head = f"| {name} | {rows[0].form} | {speed if given else f'({speed})'} |"
    faults = {row.fault for row in rows}
    if len(faults) == 1 and rows[0].acceleration is None:
        return [f"{head} | {rows[0].fault} |{' |' * 5}\n"]
    return [f"{head} {' | '.join(_bought(row))} |\n" for row in rows]


def _bought(row: BenefitRow) -> list[str]:
    octave, lift_off = row.strongest_octave, row.lift_off_speed
    return [
        f"{row.tolerance:g}",
        _three(None if row.ripple is None else 100.0 * row.ripple),
        _three(row.acceleration),
        row.fault or _three(row.force),
        _three(None if lift_off is None or math.isinf(lift_off) else lift_off / RPM),
        "-" if octave is None else harmonics(octave),
        "-" if octave is None else _three(row.octaves[octave]),
    ]


def _three(value: float | None) -> str:
    """Three digits, the units at least."""
    return "-" if value is None else f"{value:,.0f}" if abs(value) >= 100.0 else f"{value:.3g}"


def page(
    found: Mapping[str, Sequence[BillRow]], benefits: Mapping[str, Sequence[BenefitRow]]
) -> str:
    """The page's text, from the builds of the scenes, and from what they buy, by name."""
    costs = [line(name, row) for name, rows in found.items() for row in rows]
    buys = [each for name, rows in benefits.items() for each in lines(name, rows)]
    return "".join((HEAD, *costs, BUYS.format(speed=SPEED), *buys))


if __name__ == "__main__":
    built = {name: measure(name) for name in scenes()}
    PAGE.write_text(page(built, {name: bought(name) for name in scenes()}), encoding="utf-8")
