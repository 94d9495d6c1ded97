"""What `camgeo laws` finds: the motion laws of a task side by side, or those for each task."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import ClassVar, Final

from camgeo.answers.answer import Answer
from camgeo.errors import Fault, SceneError
from camgeo.motion.boundary import ENDS, NAMES, TASKS, ends_of
from camgeo.motion.laws import FAMILIES, find_family
from camgeo.motion.laws.comparison import QUANTITIES, Entry, Running, compare
from camgeo.numeric.extremes import Extreme

UNITS: Final = ("mm/s", "mm/s^2", "mm/s^2", "mm/s^3", "mm/s^3", "N m/kg", "N m/kg")
"""Of the physical values of `QUANTITIES`."""


@dataclass(frozen=True, slots=True)
class Physical:
    """A physical value in `unit`, one of `UNITS`."""

    value: float
    unit: str


@dataclass(frozen=True, slots=True)
class LawRow:
    """One law of a comparison.

    Attributes
    ----------
    entry : the law with its characteristic values, or the reason why there is none.
    physical : `QUANTITIES` of the move, None for what is unbounded; None without a law or a move.
    """

    entry: Entry
    physical: Mapping[str, Physical | None] | None = None

    @property
    def parameters(self) -> Mapping[str, float]:
        """Those of the law, by name; none if there is no law."""
        return {} if self.entry.law is None else self.entry.law.parameters

    @property
    def values(self) -> dict[str, Extreme | None] | None:
        """All characteristic values by name, None for what is unbounded; None without a law."""
        values, unbounded = self.entry.values, self.entry.unbounded
        if values is None:
            return None
        names = [field.name for field in fields(values)]
        return {name: None if name in unbounded else getattr(values, name) for name in names}


@dataclass(frozen=True, slots=True)
class TaskLaws:
    """A motion task (VDI 2143-1, Tafel 1) with the parameters of each family available for it."""

    task: str
    families: Mapping[str, tuple[str, ...]]

    @property
    def ends(self) -> tuple[str, ...]:
        """What the move meets at its start and at its end, in words."""
        names: dict[str, str] = {end: NAMES[end] for end in ENDS}
        return tuple(names[end] for end in ends_of(self.task))


@dataclass(frozen=True, slots=True)
class Laws(Answer):
    """Motion laws.

    Attributes
    ----------
    rows : the laws of one task side by side; None if all tasks are listed.
    running : the move that gives them physical values; None if none was named.
    tasks : all tasks; None if laws of one are compared.
    places : whether the text shows z of the extremes too.
    """

    command: ClassVar[str] = "laws"

    rows: tuple[LawRow, ...] | None = None
    running: Running | None = None
    tasks: tuple[TaskLaws, ...] | None = None
    places: bool = False


def laws_of_task(
    task: str,
    given: Mapping[str, float],
    names: Sequence[str] = (),
    *,
    running: Running | None = None,
    places: bool = False,
) -> Laws:
    """Compare the laws of a task; `task`, `given`, `names` as of `compare`, the rest of `Laws`.

    Raises
    ------
    SceneError
        If none of the laws is possible, with the reason for each.
    """
    found = compare(task, given, names)
    if all(entry.law is None for entry in found):
        raise SceneError(_impossible(found))
    rows = tuple(LawRow(each, _physical(each, running)) for each in found)
    return Laws(rows, running, places=places)


def _impossible(entries: Sequence[Entry]) -> list[Fault]:
    """Why no law is possible: one fault for all laws with the same reason."""
    reasons: dict[str, list[str]] = {}
    for entry in entries:
        reasons.setdefault(entry.reason, []).append(entry.name)
    return [
        Fault(", ".join(names), "", f"not possible: {reason}") for reason, names in reasons.items()
    ]


def laws_of_all_tasks(names: Sequence[str] = ()) -> Laws:
    """List the families available for each task, of all or of `names`; GeometryError if unknown."""
    wanted = {find_family(name).name for name in names}
    return Laws(
        tasks=tuple(
            TaskLaws(
                task,
                {
                    name: family.parameters[task]
                    for name, family in FAMILIES.items()
                    if task in family.tasks and (not wanted or name in wanted)
                },
            )
            for task in TASKS
        )
    )


def _physical(entry: Entry, running: Running | None) -> dict[str, Physical | None] | None:
    if running is None or entry.values is None:
        return None
    found: dict[str, Physical | None] = {}
    for quantity, unit in zip(QUANTITIES, UNITS, strict=True):
        value = entry.bounded(quantity)
        physical = None if value is None else Physical(running.physical(quantity, value), unit)
        found[quantity] = physical
    return found
