"""What an optimisation seeks: objectives, limits, and the family in which it looks."""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, Literal

from camgeo.design import Design
from camgeo.errors import GeometryError
from camgeo.scene.scene import Scene
from camgeo.scene.varied import OPTIMISE
from camgeo.sweep.asked import VERDICT, Asked, asked_of, canonical
from camgeo.sweep.family import Family, Sample
from camgeo.sweep.stated import family_of, variables_in
from camgeo.sweep.variables import Variable

Sense = Literal["least", "largest"]

EVALUATIONS: Final = 2000
"""Designs that are tried unless another number is stated."""

MOST_GOALS: Final = 5
"""Objectives; of more, nearly every design is on the front."""

FORM: Final = re.compile(r"\s*(?P<word>[^<>=]+?)\s*(?P<sign><=|>=)\s*(?P<bound>[^<>=\s]+)\s*")

ALL: Final = "limits"
"""Leaves all limits of the scene out of account."""


@dataclass(frozen=True, slots=True)
class Goal:
    """An objective: what is asked, and whether it should be small or large."""

    asked: Asked
    sense: Sense

    def cost(self, value: float) -> float:
        """The value so that less is better."""
        return value if self.sense == "least" else -value


@dataclass(frozen=True, slots=True)
class Limit:
    """A limit that is stated with the call.

    Attributes
    ----------
    asked : what is limited.
    sign : "<=" or ">=".
    bound : the limit, in the unit in which the answer is stated.
    """

    asked: Asked
    sign: str
    bound: float

    def __str__(self) -> str:
        return f"{self.asked.word} {self.sign} {self.bound:g}"

    def margin(self, value: float) -> float:
        """How far the value is within the limit, relative to it; negative beyond."""
        apart = value - self.bound if self.sign == ">=" else self.bound - value
        return apart / (abs(self.bound) or 1.0)


@dataclass(frozen=True, slots=True)
class Effort:
    """How long is sought, unless the call says otherwise.

    Attributes
    ----------
    seed : of what is drawn.
    evaluations : designs that may be tried.
    seconds : after which no other is tried; None for no limit.
    """

    seed: int = 0
    evaluations: int = EVALUATIONS
    seconds: float | None = None

    @classmethod
    def of(cls, table: Mapping[str, Any]) -> Effort:
        """What a table of a scene states."""
        seconds = table.get("seconds")
        return cls(
            int(table.get("seed", 0)),
            int(table.get("evaluations", EVALUATIONS)),
            None if seconds is None else float(seconds),
        )


@dataclass(frozen=True, slots=True)
class Sought:
    """What makes a design good or bad.

    Attributes
    ----------
    goals : the objectives.
    limits : stated with the call; one on a finding replaces that of the scene.
    ignored : findings of which a broken limit does not matter.
    """

    goals: tuple[Goal, ...]
    limits: tuple[Limit, ...]
    ignored: frozenset[str]

    @property
    def asked(self) -> tuple[Asked, ...]:
        """What is asked of each design, each once: objectives, then limits."""
        found = [*(goal.asked for goal in self.goals), *(limit.asked for limit in self.limits)]
        return tuple(dict.fromkeys(found))

    @property
    def replaced(self) -> frozenset[str]:
        """Findings whose limits in the scene have others in their place."""
        return frozenset(each.asked.name for each in self.limits if each.asked.how == "value")

    @property
    def machining(self) -> bool:
        """Whether the milling programs count: whoever asks for their time means to run them."""
        return any(each.group == "machining" for each in self.asked)

    def matters(self, name: str) -> bool:
        """Whether a broken limit of the scene, of the finding of that name, matters."""
        return ALL not in self.ignored and name not in self.ignored | self.replaced


@dataclass(frozen=True, slots=True)
class Task(Sought):
    """What is sought, and where.

    Attributes
    ----------
    family : its variables, of which ranges without a count are continuous.
    effort : how long is sought.
    """

    family: Family
    effort: Effort


def task_of(
    scene: Scene,
    vary: Sequence[str | Variable] = (),
    *,
    least: Iterable[str] = (),
    largest: Iterable[str] = (),
    keep: Iterable[str] = (),
    ignore: Iterable[str] = (),
) -> Task:
    """The task from texts as of the command line, and from `[optimise]` in the scene.

    Parameters
    ----------
    vary : variables; if there are none, those that the scene states in `[optimise]`, else in
        `[sweep]`.
    least, largest : objectives, see `camgeo.sweep.asked`; if there are none at all, those of the
        scene.
    keep : limits, as "transmission-angle>=50"; if there are none, those of `[optimise]`.
    ignore : findings whose limits in the scene do not count, or "limits" for all of them; likewise.

    Raises
    ------
    SceneError
        With a key that there is not, and the nearest one.
    GeometryError
        For an empty range, a limit that is none, and objectives that are none.
    UnknownNameError
        For a name that no finding or column has, with the nearest one.
    """
    # Of designs that are drawn, ranges need no count; how many is not used.
    family = family_of(scene, vary or variables_in(scene, OPTIMISE), Sample(1))
    table = scene.values.get(OPTIMISE, {})
    least, largest = tuple(least), tuple(largest)
    if not least and not largest:
        least, largest = table.get("least", ()), table.get("largest", ())
    keep, ignore = tuple(keep) or table.get("keep", ()), tuple(ignore) or table.get("ignore", ())
    design = Design(family.scene)
    goals = (
        *(Goal(_number(design, word), "least") for word in least),
        *(Goal(_number(design, word), "largest") for word in largest),
    )
    names = [goal.asked.word for goal in goals]
    if not goals:
        raise GeometryError("names no objective: say what should be --least or --largest", "least")
    if len(set(names)) < len(names):
        raise GeometryError("names an objective twice", "least", ", ".join(names))
    if len(goals) > MOST_GOALS:
        message = f"{len(goals)} objectives are more than {MOST_GOALS}"
        raise GeometryError(message, "least", ", ".join(names))
    limits = tuple(_limit(design, text) for text in keep)
    words = [canonical(word) for word in ignore]
    named = [word for word in words if word != ALL]
    ignored = [each.name for each in asked_of(design, named)] if named else []
    everything = [ALL] if ALL in words else []
    return Task(goals, limits, frozenset([*ignored, *everything]), family, Effort.of(table))


def _number(design: Design, word: str) -> Asked:
    (found,) = asked_of(design, [word])
    if found.name == VERDICT and found.how == "value":
        raise GeometryError("is a word, which is neither small nor large", VERDICT)
    return replace(found, word=canonical(word))


def _limit(design: Design, text: str) -> Limit:
    parts = FORM.fullmatch(text)
    bound = math.nan
    if parts is not None:
        with contextlib.suppress(ValueError):
            bound = float(parts["bound"])
    if parts is None or not math.isfinite(bound):
        message = 'must be NAME>=NUMBER or NAME<=NUMBER, e.g. "transmission-angle>=50"'
        raise GeometryError(message, "keep", text)
    return Limit(_number(design, parts["word"]), parts["sign"], bound)
