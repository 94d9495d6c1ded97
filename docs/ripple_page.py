"""Writes docs/ripple.md and its pictures: `python docs/ripple_page.py` (three minutes).

A test measures some of its rows again.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import camgeo
from camgeo.design.design import Design
from camgeo.geometry.contour.contour import Form
from camgeo.pictures.accuracy import benefit_figure, spectrum_figure
from camgeo.studies.accuracy.benefit import OCTAVES, BenefitRow, benefit_rows
from camgeo.studies.accuracy.contours import FORMS, ORDER
from camgeo.units import RPM
from camgeo_export.plots import render

PAGE: Final = Path(__file__).with_name("ripple.md")
IMAGES: Final = Path(__file__).with_name("images")
SCENE: Final = Path(__file__).resolve().parents[1] / "fixtures" / "scenes" / "setzhub.toml"

LOADED: Final = {
    "effects.inertia.mass": 1.2,
    "effects.inertia.moment_of_inertia": 0.004,
    "effects.inertia.roller_mass": 0.06,
    "effects.spring.stiffness": 3.0,
    "effects.spring.preload": 480.0,
}
"""Slider [kg], rocker about its pivot [kg m^2], roller [kg]; the spring on the slider [N/mm, N]:
those of fixtures/effects/linked_press.toml, which has the same cam."""

TOLERANCES: Final = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
"""[mm]"""

SPEEDS: Final = (90.0, 200.0, 300.0)
"""[rev/min]"""

NAMES: Final[dict[Form, str]] = {
    "polyline": "straight pieces", "arcs": "arcs", "spline": "cubic splines",
}  # fmt: skip

HEAD = """# What accuracy buys

<!-- Made by docs/ripple_page.py; change it there. -->

[What accuracy costs](accuracy.md) is counted in pieces, bytes and seconds. What it buys is a
follower that moves as demanded: `camgeo.studies.accuracy.benefit.benefit_rows` replays the follower
on the contour as it is written and tells how far acceleration and contact force are off, and at
which speed the follower leaves the cam. In a scene `motion = "written"` of `[state]` computes all
effects for that motion.

## How fast it falls

A contour of n pieces of order k keeps to the exact curve within eps, in proportion to n^-k, and its
curvature is off in proportion to n^-(k - 2). The acceleration of the follower depends on the
curvature, so its error goes with eps^(1 - 2/k).

| contour | k | lift | velocity | acceleration |
|---|---|---|---|---|
| straight pieces | 2 | eps | eps^(1/2) | does not fall |
| arcs, tangent | 3 | eps | eps^(2/3) | eps^(1/3) |
| cubic spline, C2 | 4 | eps | eps^(3/4) | eps^(1/2) |

**The acceleration on straight pieces never comes near the demanded one**, however tight the
tolerance. Along a piece the roller's centre runs straight, and about a vertex it turns on an arc of
the roller's own radius: the curvature of its path is 0 or one over that radius, and never that of
the pitch curve. Only the share of the turn in which it is the one or the other makes the right
mean. Where the flank is hollow the roller touches two pieces at once, and the velocity jumps, the
less the tighter the tolerance. What the machine makes of such a program is smoother than that: the
cutter's own radius, the controller and the material round it. The figures here are those of the
contour in the file.

## The Setzhub cam

fixtures/scenes/setzhub.toml with a slider of 1.2 kg, a rocker of 0.004 kg m^2, a roller of 0.06 kg
and a spring of 480 N and 3 N/mm on the slider, as in fixtures/effects/linked_press.toml; without
friction, weights and load. With the demanded motion the slider is accelerated by {accelerations}
m/s^2 at {speeds} rev/min, the contact force lies {forces} N, and the roller leaves the cam from
{lift_off} rev/min on.

The table has the largest deviation from the demanded acceleration of the slider, in per cent of its
peak (ripple) and, at each speed, in m/s^2; that of the contact force in N; the least contact force
in N, which is negative where the roller would have to be pulled; and the speed from which the
roller leaves the cam. All are extremes over the whole turn, exact but for rounding.

| contour | tolerance [mm] | ripple | {columns} | lifts off [rev/min] |
|---|---|---|---|---|---|---|
"""

TAIL = """
In a cell: deviation of the acceleration, of the force; least force.

![Deviation of the acceleration, of the contact force and speed of lift-off over the tolerance]\
(images/ripple-setzhub.svg)

*Over the tolerance, for straight pieces, arcs and cubic splines: the largest deviation of the
slider's acceleration and of the contact force at {speeds} rev/min, and the speed from which the
roller leaves the cam; the dashed line is that of the demanded motion.*

From the coarsest to the tightest tolerance the ripple falls with the power

| contour | expected | found |
|---|---|---|
"""

SPECTRUM = """
## At which frequencies

A contour of few pieces is off over long arcs, one of many pieces over short ones: so a tighter
tolerance makes the ripple not only smaller, but moves it to higher harmonics of the cam's speed. A
follower train answers to what lies at its own frequency: at {speed:g} rev/min harmonic k has k
times {hertz:g} Hz. The lowest harmonics fall about as the tolerance does or faster, and much sooner
than the largest deviation: a train whose frequency is at the twentieth harmonic is shaken by the
contour within 0.1 mm, and hardly by the one within 0.001 mm.

The table has the effective value of the deviation of the slider's acceleration at {speed:g} rev/min
in each octave of these harmonics, in mm/s^2, the jumps of the velocity included, and the number of
the strongest harmonic. Values of the 511 harmonics are Fourier integrals piece by piece, each off
by at most {error} mm/s^2.

| contour | tolerance [mm] | strongest | {columns} |
|---|---|---|{rules}
"""

SPECTRUM_PICTURE = """
![Ripple of the acceleration in each octave, for each form of the contour and each tolerance]\
(images/ripple-spectrum.svg)

*The effective values of the table, drawn at the first harmonic of each octave.*
"""


def design() -> Design:
    """The cam with its masses and its spring."""
    return Design(camgeo.load(SCENE).scene.with_values(LOADED))


def measure(tolerances: Sequence[float] = TOLERANCES) -> tuple[BenefitRow, ...]:
    """All that the page shows."""
    return benefit_rows(design(), tolerances, [speed * RPM for speed in SPEEDS])


def lines(rows: Sequence[BenefitRow]) -> list[str]:
    """The lines of the table; `rows` of all speeds of one contour follow each other."""
    found = []
    for start in range(0, len(rows), len(SPEEDS)):
        same = rows[start : start + len(SPEEDS)]
        first = same[0]
        cells = [
            f"{number(row.acceleration, 1e-3)}, {number(row.force)}; {number(row.lowest)}"
            for row in same
        ]
        found.append(
            f"| {NAMES[first.form]} | {first.tolerance:g} | {number(first.ripple, 100.0)} % |"
            f" {' | '.join(cells)} | {number(first.lift_off_speed, 1.0 / RPM)} |\n"
        )
    return found


def spectrum_lines(rows: Sequence[BenefitRow]) -> list[str]:
    """The lines of the table of harmonics, from rows of one speed."""
    return [
        f"| {NAMES[row.form]} | {row.tolerance:g} | {row.strongest} |"
        f" {' | '.join(map(effective, row.octaves))} |\n"
        for row in rows
    ]


def effective(value: float) -> str:
    """Two digits, the units at least."""
    return f"{value:.2g}" if value < 100.0 else f"{value:,.0f}"


def spectrum_section(rows: Sequence[BenefitRow]) -> str:
    """What the page says of harmonics, from rows of one speed."""
    octaves = [2**octave for octave in range(OCTAVES)]
    speed = rows[0].speed / RPM
    head = SPECTRUM.format(
        speed=speed,
        hertz=speed / 60.0,
        error=f"{max(row.octave_error or 0.0 for row in rows):.1g}",
        columns=" | ".join(["1", *(f"{first}-{2 * first - 1}" for first in octaves[1:])]),
        rules="---|" * OCTAVES,
    )
    return "".join((head, *spectrum_lines(rows), SPECTRUM_PICTURE))


def at_highest_speed(rows: Sequence[BenefitRow]) -> list[BenefitRow]:
    """Those of them."""
    return [row for row in rows if row.speed == SPEEDS[-1] * RPM]


def number(value: float | None, factor: float = 1.0) -> str:
    """Three digits, the units at least."""
    if value is None:
        return "-"
    shown = factor * value
    return f"{shown:.0f}" if abs(shown) >= 100.0 else f"{shown:.3g}"


def slope(rows: Sequence[BenefitRow], form: Form) -> float:
    """Power of the tolerance with which the ripple falls, from the first to the last tolerance."""
    own = [row for row in rows if row.form == form and row.ripple is not None]
    first, last = own[0], own[-1]
    assert first.ripple is not None
    assert last.ripple is not None
    return math.log(first.ripple / last.ripple) / math.log(first.tolerance / last.tolerance)


def page(rows: Sequence[BenefitRow]) -> str:
    """The page's text."""
    speeds = listed([f"{speed:g}" for speed in SPEEDS])
    same = rows[: len(SPEEDS)]
    head = HEAD.format(
        accelerations=listed([number(row.exact_acceleration, 1e-3) for row in same]),
        speeds=speeds,
        forces=listed(
            [f"between {number(row.exact_lowest)} and {number(row.exact_highest)}" for row in same]
        ),
        lift_off=number(same[0].exact_lift_off_speed, 1.0 / RPM),
        columns=" | ".join(f"{speed:g} rev/min" for speed in SPEEDS),
    )
    orders = [
        f"| {NAMES[form]} | {1.0 - 2.0 / ORDER[form]:.2f} | {slope(rows, form):.2f} |\n"
        for form in FORMS
    ]
    return "".join(
        (
            head,
            *lines(rows),
            TAIL.format(speeds=speeds),
            *orders,
            spectrum_section(at_highest_speed(rows)),
        )
    )


def listed(words: list[str]) -> str:
    """The words as a list in a sentence."""
    return f"{', '.join(words[:-1])} and {words[-1]}"


def draw(rows: Sequence[BenefitRow]) -> bytes:
    """The picture."""
    return render(benefit_figure(rows, title="setzhub: what accuracy buys"), ".svg")


def draw_spectrum(rows: Sequence[BenefitRow]) -> bytes:
    """The picture of the harmonics."""
    title = f"setzhub at {SPEEDS[-1]:g} rev/min: ripple in each octave"
    return render(spectrum_figure(at_highest_speed(rows), title=title), ".svg")


if __name__ == "__main__":
    measured = measure()
    PAGE.write_text(page(measured), encoding="utf-8")
    (IMAGES / "ripple-setzhub.svg").write_bytes(draw(measured))
    (IMAGES / "ripple-spectrum.svg").write_bytes(draw_spectrum(measured))
