"""Writes docs/effects.md and its pictures: `python docs/effects_page.py`.

The texts are in docs/effects, one file per effect. `<!-- word -->` in them is replaced from the
code by declarations, findings of the example scenes, tables and pictures, and `{name}` by a number.
A test compares the page with the texts and the code. Pictures are renewed by running this script
and are not compared, because their bytes also depend on the version of matplotlib.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from camgeo.app.answers.answer import finding_lines
from camgeo.app.answers.check import check
from camgeo.app.answers.explain import Explanation, explain, tree_lines
from camgeo.check.finding import MOST_ALIKE
from camgeo.design.design import Design
from camgeo.dynamics.effects.balance import MOST_HOLES
from camgeo.dynamics.effects.contact_pressure import HEAVY, SHEAR_DEPTH, SHEAR_SHARE
from camgeo.dynamics.effects.effect import TOLERANCE
from camgeo.dynamics.effects.friction import NEAR
from camgeo.dynamics.effects.gravity import STANDARD_GRAVITY
from camgeo.dynamics.effects.lift_off.elastic_speed import MOST_STEPS, SEARCHED
from camgeo.dynamics.effects.lift_off.flight import (
    MOST_ELASTIC_TURNS,
    MOST_PERIODS,
    MOST_REBOUNDS,
    MOST_TURNS,
)
from camgeo.dynamics.effects.registry import EFFECTS, find_effect
from camgeo.dynamics.effects.results import STABLE
from camgeo.dynamics.effects.shock_spectrum import measured
from camgeo.dynamics.effects.spring_surge import CLEAR
from camgeo.dynamics.effects.spring_surge import FARTHEST as FARTHEST_SURGE
from camgeo.dynamics.effects.vibration import AMPLIFICATION, SETTLED
from camgeo.dynamics.oscillator.steady import QUIET, Shock, shock
from camgeo.kinematics.laws import FAMILIES, make_law
from camgeo.kinematics.laws.law import Law
from camgeo.numeric.arrays import FloatArray, Side
from camgeo.numeric.extremes import piecewise_extremes
from camgeo.part.materials import MATERIALS, PER_CUBIC_CM
from camgeo.scene.scene import load_scene
from camgeo.studies.accuracy.survey import effect_rows

if TYPE_CHECKING:  # pages are made without pictures too
    from camgeo.pictures.model import Figure

HERE: Final = Path(__file__).parent
PAGE: Final = HERE / "effects.md"
TEXTS: Final = HERE / "effects"
IMAGES: Final = HERE / "images"
SCENES: Final = HERE.parent / "fixtures" / "effects"

NOTE: Final = (
    "<!-- Made from docs/effects and the code by docs/effects_page.py; change it there. -->\n"
)

BEFORE: Final = ("conventions",)
AFTER: Final = ("materials", "example", "accuracy")
"""Texts before and after those of the effects."""

FARTHEST: Final = 20.0
"""Natural periods per move up to which the largest residuals of the laws are searched for."""

QUIET_END: Final = 40.0
"""From here on the bounds of all laws are below the share that counts as small."""

RATIOS: Final = (1.0, 1.5, 2.0, 3.0, 5.0, 10.0)
"""Ratios above which the table gives the largest residual."""

TOLERANCES: Final = (1e-3, 1e-6, 1e-9)
"""Of the table of accuracy."""

LEAST: Final = 1e-13
"""Smallest stated error estimate: anything below is rounding and differs between machines."""

MARGIN: Final = 2.0
"""Factor from an estimate to the stated value."""

NUMBERS: Final[dict[str, Any]] = {
    "contact": ", ".join(each for each in EFFECTS if find_effect(each).premise == "contact"),
    "gravity": STANDARD_GRAVITY / 1e3,
    "near": math.degrees(NEAR),
    "alike": MOST_ALIKE,
    "rebounds": MOST_REBOUNDS,
    "searched": f"{SEARCHED:g}",
    "steps": MOST_STEPS,
    "flight_turns": MOST_TURNS,
    "elastic_turns": MOST_ELASTIC_TURNS,
    "elastic_periods": MOST_PERIODS,
    "shear_share": SHEAR_SHARE,
    "shear_depth": SHEAR_DEPTH,
    "heavy": HEAVY,
    "settled": f"{100.0 * SETTLED:g}",
    "amplification": AMPLIFICATION,
    "quiet": f"{100.0 * QUIET:g}",
    "most_holes": MOST_HOLES,
    "stable": STABLE,
    "clear": CLEAR,
    "farthest_surge": FARTHEST_SURGE,
    "farthest": FARTHEST,
    "tolerance": TOLERANCE,
    "least": LEAST,
}
"""Numbers in the texts, by name."""

PICTURES: Final[dict[str, tuple[str, tuple[str, ...]]]] = {
    "effects-press-forces": (
        "press",
        (
            "inertia force",
            "weight force",
            "load",
            "spring force",
            "jamming margin",
            "contact force",
        ),
    ),
    "effects-press-drive": (
        "press",
        ("drive torque", "static drive torque", "dynamic drive torque", "cam speed"),
    ),
    "effects-press-stress": (
        "press",
        ("contact pressure", "subsurface shear", "vibration deflection", "output acceleration"),
    ),
    "effects-groove": ("groove_lever", ("contact force", "drive torque", "static drive torque")),
}
"""Scene and columns of each picture over the cam angle."""

SPECTRUM: Final = "effects-spectrum"
MOVES: Final = "effects-press-spectra"
SPECTRA: Final = (SPECTRUM, MOVES)

ALT: Final = {
    "effects-press-forces": "forces, jamming margin and contact force of press over the cam angle",
    "effects-press-drive": "drive torque and speed of press over the cam angle",
    "effects-press-stress": "contact pressure and vibration of press over the cam angle",
    "effects-groove": "contact force and drive torque of groove_lever over the cam angle",
    SPECTRUM: "shock spectra of the laws from rest to rest",
    MOVES: "shock spectra of the moves of press, with the natural frequency of its train",
}


def page() -> str:
    """The page's text."""
    head, *rest = (section(name) for name in (*BEFORE, *EFFECTS, *AFTER))
    title, _, below = head.partition("\n")
    return f"{title}\n\n{NOTE}{below}" + "".join(f"\n{text}" for text in rest)


def section(name: str) -> str:
    """A text with its insertions."""
    text = (TEXTS / f"{name}.md").read_text(encoding="utf-8")
    text = re.sub(r"\{(\w+)(:[^}]*)?\}", _number_of, text)

    def put(match: re.Match[str]) -> str:
        word, *arguments = match[1].split()
        return INSERTS[word](name, *arguments)

    return re.sub(r"<!-- (.*?) -->\n", put, text)


def _number_of(match: re.Match[str]) -> str:
    return format(NUMBERS[match[1]], (match[2] or ":").removeprefix(":"))


@cache
def explained(scene: str) -> tuple[Design, Explanation]:
    """The example scene of that name, and what `camgeo explain` says of a check of it."""
    found = Design(load_scene(str(SCENES / f"{scene}.toml")))
    return found, explain(found)


def design(scene: str) -> Design:
    """The example scene of that name."""
    return explained(scene)[0]


# What is put in ---------------------------------------------------------------------------------


def _declarations(_name: str) -> str:
    """A row for each effect."""
    heads = ("effect", "gives", "needs", "takes into account", "of the scene", "for others")
    rows = []
    for name in EFFECTS:
        effect = find_effect(name)
        rows.append(
            [
                f"[{name}](#{name})" + (", numerical" if effect.numerical else ""),
                effect.title,
                _named(effect.needs),
                _named(effect.uses),
                "; ".join(_of_scene(name)),
                "" if effect.tabled else "yes",
            ]
        )
    return _table(heads, rows)


def _refinements(_name: str) -> str:
    """What each effect takes as simpler than another effect of the scene does."""
    rows = [
        [name, each.assumption, f"[{each.effect}](#{each.effect})"]
        for name in EFFECTS
        for each in find_effect(name).refined_by
        if not each.followed
    ]
    return _table(("figures of", "hold for", "simpler than in"), rows)


def _declared(name: str) -> str:
    """Needs and kind of one effect in a line."""
    effect = find_effect(name)
    parts = []
    if effect.needs:
        parts.append(f"needs {_named(effect.needs)}")
    if effect.uses:
        parts.append(f"takes into account {_named(effect.uses)}")
    if keys := _of_scene(name):
        parts.append(f"the scene has {'; '.join(keys)}")
    parts.append("numerical" if effect.numerical else "exact")
    text = ". ".join(f"{part[0].upper()}{part[1:]}" for part in parts)
    return f"*{text}.* Keys: [scene.md](scene.md#effects{name}).\n"


def _of_scene(name: str) -> list[str]:
    """What a scene must have for the effect, besides the effects that it needs."""
    effect = find_effect(name)
    found = [" or ".join(f"`{key}`" for key in keys) for keys in effect.keys]
    required = find_effect(name).schema.get("required", [])
    if effect.tabled:
        found.append(f"`effects.{name}`")
    found += [f"`effects.{name}.{key}`" for key in required]
    return found


def _named(names: Iterable[str]) -> str:
    return ", ".join(f"[{name}](#{name})" for name in names)


def _check(_name: str, scene: str, *effects: str) -> str:
    """Part of what `camgeo check` prints of a scene."""
    found = check(design(scene)).effects
    parts = ["\n".join((f"{name}:", *finding_lines(found[name]))) for name in effects]
    return _block(f"$ camgeo check fixtures/effects/{scene}.toml\n...\n" + "\n\n".join(parts))


def _explain(_name: str, scene: str) -> str:
    """The lines of `camgeo explain` for a scene that are about effects."""
    lines = [line for line in tree_lines(explained(scene)[1]) if "  effects." in line]
    return _block("\n".join((f"{'all':>10}{'own':>10}", *lines)))


def _picture(_name: str, file: str) -> str:
    return f"![{ALT[file]}](images/{file}.png)\n"


def _spectrum(name: str) -> str:
    return _picture(name, SPECTRUM)


def _residuals(_name: str) -> str:
    """The largest residual from chosen ratios on, for each law from rest to rest."""
    heads = ["law", *(f"from {ratio:g} on" for ratio in RATIOS), f"below {NUMBERS['quiet']} % from"]
    rows = []
    for names, move in shocks():
        assert move.bound(QUIET_END) < QUIET
        quiet = measured(move, 0.0, QUIET_END)[1]
        largest = [f"{100.0 * share:.3g}" for share in largest_residuals(move)]
        rows.append([names, *largest, f"{quiet:.3f}"])
    return _table(heads, rows)


@cache
def shocks() -> tuple[tuple[str, Shock], ...]:
    """The laws from rest to rest with default parameters; equal ones are grouped."""
    ratios = np.linspace(0.3, 5.3, 26)
    found: list[tuple[list[str], Shock, FloatArray]] = []
    for name, family in FAMILIES.items():
        if "R-R" not in family.parameters:
            continue
        move = _move_by(make_law(name, "R-R"))
        values = move.residual(ratios)
        for names, _, others in found:
            if np.allclose(values, others, rtol=0.0, atol=1e-9):
                names.append(name)
                break
        else:
            found.append(([name], move, values))
    return tuple((", ".join(names), move) for names, move, _ in found)


def _move_by(law: Law) -> Shock:
    """The move from rest to rest by `law`; velocities at its ends are shocks."""
    edges = np.array([0.0, *law.borders, 1.0])
    jumps = np.zeros(len(edges))
    jumps[0], jumps[-1] = law.start.velocity, -law.end.velocity
    return shock(lambda z: law(z)[0], lambda z: law(z)[2], edges, jumps)


def largest_residuals(move: Shock) -> list[float]:
    """The largest residual from each of `RATIOS` up to `FARTHEST`, as shares of the stroke."""

    def residual(ratios: FloatArray, _side: Side) -> FloatArray:
        return move.residual(ratios)

    largest, found = 0.0, []
    for low, high in reversed([*pairwise((*RATIOS, FARTHEST))]):
        edges = np.linspace(low, high, math.ceil(high - low) + 1)
        largest = max(largest, piecewise_extremes(residual, edges).highest.value)
        found.append(largest)
    return found[::-1]


def _materials(_name: str) -> str:
    heads = ("name", "", "E [GPa]", "ν", "density [g/cm³]", "limit [MPa]", "source")
    rows = [
        [
            f"`{each.name}`",
            each.title,
            f"{each.modulus / 1e3:g}",
            f"{each.poisson:g}",
            f"{each.density / PER_CUBIC_CM:g}",
            "–" if each.pressure is None else f"{each.pressure:g}",
            each.source,
        ]
        for each in MATERIALS.values()
    ]
    return _table(heads, rows)


Estimates = dict[str, list[tuple[float | None, float | None]]]
"""Estimate, None if exact, and difference from the best at each of `TOLERANCES`, by effect."""


@cache
def estimates(scene: str) -> Estimates:
    """Of the numerical effects of a scene."""
    found: Estimates = {}
    for row in effect_rows(design(scene), TOLERANCES, progress=lambda _: None):
        assert not row.fault, row.fault
        found.setdefault(row.effect, []).append((row.error, row.difference))
    return found


def _accuracy(_name: str, scene: str, *more: str) -> str:
    """Estimates of a scene's effects, and of `more`, each a scene and an effect: "scene/effect"."""
    heads = ["effect", *(f"at {tolerance:g}" for tolerance in TOLERANCES), "off at the first"]
    count = len(TOLERANCES)
    wanted = [(scene, effect) for effect in estimates(scene)]
    for each in more:
        other, _, effect = each.partition("/")
        wanted.append((other, effect))
    rows = []
    for place, effect in wanted:
        found = estimates(place)[effect]
        shown = effect if place == scene else f"{effect} of {place}"
        # One that reaches rounding at once has one row.
        errors = [claim(error) for error, _ in found] + ["the same"] * (count - len(found))
        rows.append([shown, *errors, claim(found[0][1] or 0.0)])
    return _table(heads, rows)


def claim(error: float | None) -> str:
    """What the page states for an estimate."""
    if error is None:
        return "exact"
    return f"<= {rounded_up(max(MARGIN * error, LEAST)):.0e}".replace("e-0", "e-")


def rounded_up(value: float) -> float:
    """To one digit, upwards; `value` above 0."""
    size = math.floor(math.log10(value))
    digit = math.ceil(value / 10.0**size * (1.0 - 1e-12))
    return float(f"{digit}e{size}")


def _block(text: str) -> str:
    return f"```text\n{text}\n```\n"


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [_row(heads), "|" + "---|" * len(heads), *map(_row, rows)]
    return "\n".join(lines) + "\n"


def _row(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"


INSERTS: Final[dict[str, Callable[..., str]]] = {
    "declarations": _declarations,
    "declared": _declared,
    "refinements": _refinements,
    "check": _check,
    "explain": _explain,
    "picture": _picture,
    "spectrum": _spectrum,
    "residuals": _residuals,
    "materials": _materials,
    "accuracy": _accuracy,
}


# Pictures ---------------------------------------------------------------------------------------


def picture(file: str) -> bytes:
    """The picture of that name."""
    from camgeo_export.plots import render

    return render(drawn_spectra(file) if file in SPECTRA else drawn(file), ".png")


def drawn(file: str) -> Figure:
    """Some of the columns of a design's effects over the cam angle."""
    from camgeo.pictures import effects

    scene, names = PICTURES[file]
    whole = design(scene).disc
    columns = {column.name: column for column in whole.columns()}
    chosen = tuple(columns[name] for name in names)
    return effects.figure(replace(whole, columns=lambda: chosen))


CURVES: Final[tuple[tuple[str, tuple[float, ...]], ...]] = (
    ("#7a7a7a", (1.0, 1.0)),
    ("#7a7a7a", (5.0, 1.5)),
    ("#8c5aa8", (3.0, 1.0, 1.0, 1.0)),
    ("#12365c", ()),
    ("#2f7fc1", (6.0, 1.5)),
    ("#b3261e", ()),
    ("#c27c0e", (4.0, 1.5, 1.0, 1.5)),
    ("#3f8f6b", (6.0, 1.5)),
)
"""Colour and dashes of each law."""


def drawn_spectra(file: str) -> Figure:
    """The spectra of the laws, or of the moves of the press."""
    if file == SPECTRUM:
        return drawn_spectrum()
    from camgeo.pictures.plots import SPECTRUM as PLOT
    from camgeo.pictures.plots import of_design

    return of_design(design("press"), [PLOT])[0]


def drawn_spectrum() -> Figure:
    """The shock spectra of all laws from rest to rest."""
    from camgeo.pictures.model import Axis, Figure, Legend, Line, Panel, Style, entries, over

    ratios = np.linspace(0.02, 8.0, 1597)
    marks = []
    for (names, move), (colour, dashes) in zip(shocks(), CURVES, strict=True):
        shares = np.maximum(100.0 * move.residual(ratios), 1e-6)
        marks.append(Line(over(ratios, shares), Style(colour, 1.1, dashes), names))
    panel = Panel(
        (0.11, 0.12, 0.97, 0.92),
        Axis((0.0, 8.0), "t_move / T_n, natural periods a move"),
        Axis((2e-4, 1.5e2), "residual vibration [% of the stroke]", log=True),
        tuple(marks),
        "shock spectra, rest to rest, undamped",
        legend=Legend(entries(marks), "lower left", columns=3, size=7.0),
    )
    return Figure((7.0, 4.4), (panel,))


def write() -> None:
    """Page and pictures."""
    PAGE.write_text(page(), encoding="utf-8")
    for file in (*PICTURES, *SPECTRA):
        (IMAGES / f"{file}.png").write_bytes(picture(file))


if __name__ == "__main__":
    write()
