"""What is asked of each design of a family, by the names of findings and of value-table columns.

A bare name is the value of a finding. `min:`, `max:` and `peak:`, the largest magnitude, before the
name of a column are its extremes over the turn. Names are written with hyphens or spaces. A name is
looked up once, in the scene that the family starts from, so that of each design only what answers
it is computed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

from camgeo.errors import (
    EffectError,
    GeometryError,
    ToleranceError,
    UnknownNameError,
)
from camgeo.product.value_table import bare
from camgeo.wording import counted

if TYPE_CHECKING:
    from camgeo.design import Design

How = Literal["value", "min", "max", "peak"]

EXTREMES: Final[dict[str, How]] = {"min": "min", "max": "max", "peak": "peak"}
"""Which extreme of a column, by the prefix of its name."""

Group = Literal[
    "angle", "linkage", "motion", "part", "disc", "verdict", "machining", "curves", "effects"
]
"""What is computed: the transmission angle, the linkage, the motion, the part, all findings on the
disc, the worst severity of all findings, the milling programs, columns of motion and cam, or
effects.
"""

VERDICT: Final = "verdict"
"""Asks for the worst severity of all findings on cam, effects and part, a word."""

DIAMETER: Final = "largest-diameter"

MACHINING_TIME: Final = "machining-time"
"""Asks how long the milling programs of all discs run."""

ALSO: Final = {"diameter": DIAMETER}
"""Shorter names."""

BY_GROUP: Final[dict[Group, tuple[str, ...]]] = {
    "angle": ("transmission-angle",),
    "linkage": (
        "dead-centre",
        "linkage-transmission-angle",
        "linkage-back-angle",
        "linkage-branch",
    ),
    "motion": (
        "largest-velocity",
        "largest-acceleration",
        "largest-jerk",
        "largest-inertia-torque",
        "laws",
        "joints",
        "shock",
        "jerk",
        "overshoot",
        "lift-table",
    ),
    "part": (DIAMETER, "mass", "mass-of-both-discs", "smallest-wall", "wall-ratio"),
    "disc": (
        *(
            f"{what}-{flank}"
            for what in ("radius-ratio", "undercut", "cusp", "global-undercut", "lost-stroke")
            for flank in ("inner", "outer")
        ),
        "closure",
        "tangent-closure",
        "closing-error",
        "form-closure",
        "convexity",
        "face-length",
        "contact-lever",
        "side-clearance",
        "standstill",
    ),
    "verdict": (VERDICT,),
    "machining": (MACHINING_TIME,),
}
"""Names of findings by what has them. Other findings on the disc are looked up in the scene."""

POLES: Final = ("r_K",)
"""Columns that are infinite somewhere, and so have no extremes."""

MOST: Final = 100
"""Names that may be asked for at once."""


@dataclass(frozen=True, slots=True)
class Asked:
    """One quantity that is asked of each design.

    Attributes
    ----------
    word : as it heads its column: `peak:contact-force`.
    name : of the finding or the column, with hyphens.
    how : the value of a finding, or which extreme of a column.
    group : what has it.
    effects : those that may have it, for the group "effects".
    """

    word: str
    name: str
    how: How
    group: Group
    effects: tuple[str, ...] = ()


def asked_of(design: Design, words: Iterable[str]) -> tuple[Asked, ...]:
    """What the `words` ask of designs like this one, each once.

    Raises
    ------
    GeometryError
        If there are none or too many, or one asks for what has no single value, or for the
        machining time where the scene states no milling.
    UnknownNameError
        For a name that no finding or column has, with the nearest one.
    """
    found = {asked.word: asked for asked in (_asked(design, word) for word in words)}
    if not found:
        raise GeometryError("names nothing: say what is asked of each design", "sweep.ask")
    if len(found) > MOST:
        message = f"{counted(len(found), 'name')} are more than {MOST}"
        raise GeometryError(message, "sweep.ask")
    return tuple(found.values())


def _asked(design: Design, word: str) -> Asked:
    before, colon, rest = word.partition(":")
    if colon and before.strip() in EXTREMES:
        return _extreme(design, EXTREMES[before.strip()], hyphened(rest))
    word = hyphened(word)
    name = ALSO.get(word, word)
    for group, names in BY_GROUP.items():
        if name in names:
            if group == "machining" and not design.scene.states_milling:
                message = f"is not stated: {MACHINING_TIME} needs a milling program"
                raise GeometryError(message, "tool")
            return Asked(word, name, "value", group)
    seen, silent = _findings_of_effects(design)
    effect = next((each for each, names in seen.items() if name in names), None)
    if effect is not None:
        return Asked(word, name, "value", "effects", (effect,))
    judged = [hyphened(finding.name) for finding in design.findings]
    if name in judged:
        return Asked(word, name, "value", "disc")
    of_effects = _columns(design)[0].values()
    if name in [*_curves(design), *(each for names in of_effects for each in names)]:
        message = f'is a column over the cam angle: ask for "peak:{name}", "max:{name}" or'
        message += f' "min:{name}"'
        raise GeometryError(message, "sweep.ask", f'"{word}"')
    if silent:  # they may have it in another design
        return Asked(word, name, "value", "effects", silent)
    known = [name for names in BY_GROUP.values() for name in names]
    there = [*known, *ALSO, *(each for names in seen.values() for each in names), *judged]
    raise UnknownNameError("finding", name, dict.fromkeys(there))


def _extreme(design: Design, how: How, name: str) -> Asked:
    word = canonical(f"{how}:{name}")
    if name in (hyphened(pole) for pole in POLES):
        message = "is infinite where the curve is straight, and has no extremes; ask for kappa"
        raise GeometryError(message, "sweep.ask", f'"{word}"')
    curves = _curves(design)
    if name in curves:
        return Asked(word, name, how, "curves")
    seen, silent = _columns(design)
    effect = next((each for each, names in seen.items() if name in names), None)
    if effect is not None or silent:
        return Asked(word, name, how, "effects", silent if effect is None else (effect,))
    there = [*curves, *(each for names in seen.values() for each in names)]
    raise UnknownNameError("column", name, dict.fromkeys(there))


def canonical(word: str) -> str:
    """What is asked, as it heads its column."""
    before, colon, rest = word.partition(":")
    if colon and before.strip() in EXTREMES:
        return f"{before.strip()}:{hyphened(rest)}"
    return hyphened(word)


def hyphened(name: str) -> str:
    """The name with hyphens in place of spaces."""
    return "-".join(name.split())


def _curves(design: Design) -> list[str]:
    from camgeo.product.quantities import quantities

    scene = design.scene
    cam = None if scene.follower is None else design.cam
    columns = quantities(design.drive, scene.lift_unit, cam, scene.unit)
    return [hyphened(bare(heading)) for heading, _ in columns if bare(heading) not in POLES]


Names = tuple[dict[str, list[str]], tuple[str, ...]]
"""Names by effects, and the effects that have no answer."""


def _findings_of_effects(design: Design) -> Names:
    return _names(design, lambda name: (each.name for each in design.effects.findings(name)))


def _columns(design: Design) -> Names:
    return _names(design, lambda name: (each.name for each in design.effect(name).columns))


def _names(design: Design, names: Callable[[str], Iterator[str]]) -> Names:
    found: dict[str, list[str]] = {}
    silent = []
    for effect in _with_needed(design):
        try:
            design.effect(effect)
            found[effect] = [hyphened(each) for each in names(effect)]
        except (EffectError, GeometryError, ToleranceError):
            silent.append(effect)
    return found, tuple(silent)


def _with_needed(design: Design) -> Sequence[str]:
    """The effects that the scene names, then those that they need."""
    found = list(design.scene.effects)
    for name in found:
        found += [each for each in design.effects.inputs(name) if each not in found]
    return found
