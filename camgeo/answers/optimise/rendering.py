"""What `camgeo optimise` finds, as text, as a table and as a picture."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

from camgeo.answers.optimise import Bound, Optimum, Tried
from camgeo.answers.sweep.rendering import aligned, exact, shown, shown_in
from camgeo.units import unit_in
from camgeo.wording import counted, shortened

if TYPE_CHECKING:
    from camgeo.figure.model import Figure

MOST_FRONT: Final = 20
"""Designs of a front that are printed."""

MOST_BROKEN: Final = 4

LONGEST: Final = 140
"""Characters of what is violated."""


def text(answer: Optimum) -> str:
    """The best design beside that of the scene, the front, and what the search was."""
    sought = [f"{each.sense} {each.asked}" for each in answer.objectives]
    lines = [f"{answer.scene.name}: {', '.join(sought)}"]
    if answer.limits:
        lines.append(f"limits, besides the other ones of the scene: {', '.join(answer.limits)}")
    if answer.ignored:
        lines.append(f"limits of the scene that do not count: {', '.join(answer.ignored)}")
    lines += ["", *_designs(answer), ""]
    if answer.written is None:
        lines.append("no design that was tried keeps all limits; the nearest violates:")
        lines += _broken(answer.best)
        lines.append("")
    lines += [f"beyond a limit that does not count: {each}" for each in answer.remarks]
    if answer.front:
        lines += [f"{counted(len(answer.front), 'design')} that no other beats:", *_front(answer)]
        lines.append("")
    lines += [_searched(answer), *(f"  {_bounds(each)}" for each in answer.bounds)]
    return "\n".join(lines)


def _designs(answer: Optimum) -> list[str]:
    """A column for the scene's own design and one for the best."""
    written, length = answer.written, answer.scene.unit
    best = answer.best if written is None else written
    columns: list[tuple[str, Tried]] = [("nearest" if written is None else "best", best)]
    if answer.start is not None:
        columns.insert(0, ("scene", answer.start))
    rows = [["", *(name for name, _ in columns)]]
    for key in best.values:
        rows.append([key, *(shown(each.values[key]) for _, each in columns)])
    for word, unit in zip(best.answers, answer.units, strict=True):
        texts = [shown_in(length, each.answers[word], unit) for _, each in columns]
        shown_unit = texts[0][1]
        rows.append([f"{word} [{shown_unit}]" if unit else word, *(text for text, _ in texts)])
    if answer.start is not None and answer.start.violated:
        kept = ["no" if each.violated else "yes" for _, each in columns]
        rows.append(["keeps all limits", *kept])
    return aligned(rows)


def _broken(design: Tried) -> list[str]:
    found = [f"  {shortened(each, LONGEST)}" for each in design.violated[:MOST_BROKEN]]
    rest = len(design.violated) - MOST_BROKEN
    return [*found, f"  and {rest} more"] if rest > 0 else found


def _front(answer: Optimum) -> list[str]:
    words = [each.asked for each in answer.objectives]
    length, units = answer.scene.unit, {each.asked: each.unit for each in answer.objectives}
    heads = [f"{word} [{unit_in(unit, length)[0]}]" if unit else word
             for word, unit in units.items()]  # fmt: skip
    rows = [[*heads, *answer.best.values]]
    designs = answer.front
    if len(designs) > MOST_FRONT:  # evenly spaced, both ends among them
        last = len(designs) - 1
        designs = tuple(designs[k * last // (MOST_FRONT - 1)] for k in range(MOST_FRONT))
    for each in designs:
        answers = (shown_in(length, each.answers[word], units[word])[0] for word in words)
        rows.append([*answers, *(shown(value) for value in each.values.values())])
    more = len(answer.front) - len(designs)
    told = [f"  and {counted(more, 'design')} between these"] if more else []
    return [*(f"  {line}" for line in aligned(rows)), *told]


def _searched(answer: Optimum) -> str:
    count = counted(answer.evaluations, "design")
    return (
        f"tried {count} with seed {answer.found.seed}, {answer.kept:,} of them within all limits;"
        f" ended: {answer.found.ended}"
    )


def _bounds(bound: Bound) -> str:
    keys = ", ".join(bound.keys)
    if bound.start is not None and bound.stop is not None:
        return f"{keys} from {bound.start:g} to {bound.stop:g}"
    values = ["/".join(map(shown, dict.fromkeys(row))) for row in bound.values]
    if len(values) > 8:
        values = [*values[:3], "...", values[-1]]
    return f"{keys} one of {', '.join(values)}"


def comma_separated(answer: Optimum) -> bytes:
    """All designs that were tried as CSV in UTF-8, in their order."""
    found = io.StringIO(newline="")
    rows = csv.writer(found, lineterminator="\n")
    words = [each.word for each in answer.found.task.asked]
    heads = [f"{word} [{unit}]" if unit else word
             for word, unit in zip(words, answer.units, strict=True)]  # fmt: skip
    rows.writerow(["number", *answer.found.task.family.keys, *heads, "violation", "violated"])
    for trial in answer.found.trials:
        values: Mapping[str, object] = answer.found.task.family.edits(trial.point)
        cells = [exact(each) for each in (*values.values(), *trial.values)]
        rows.writerow([trial.number, *cells, repr(trial.violation), "; ".join(trial.broken)])
    return found.getvalue().encode()


def figure(answer: Optimum) -> Figure:
    """The front of several objectives, or how one became better."""
    from camgeo.figure.sweep.trials import of_search

    return of_search(answer.found, answer.units)
