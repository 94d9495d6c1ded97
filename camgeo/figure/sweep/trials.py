"""Pictures of an optimisation: the Pareto front, or how the objective became better."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from camgeo.figure.layout import box, limits
from camgeo.figure.marks import Line, Mark, Style, over
from camgeo.figure.model import Axis, Entry, Figure, Legend, Panel
from camgeo.figure.style import LIMIT, LINE
from camgeo.figure.sweep.pictures import ACROSS, BOTTOM, HEIGHT, LEFT, MOST, RIGHT, TOP
from camgeo.numeric.arrays import FloatArray
from camgeo.optimise.optimise import Found
from camgeo.optimise.trials import Trial
from camgeo.wording import counted

BEST = Style(LIMIT, 1.2)
ON_FRONT = Style(LIMIT, 0.0, marker="o", size=5.0)
WITHIN = Style(LINE, 0.0, marker="o", size=3.0)
BEYOND = Style("0.7", 0.0, marker="x", size=3.0)
CHOSEN = Style("black", 0.0, marker="o", size=7.0)


def of_search(found: Found, units: Sequence[str]) -> Figure:
    """The first two objectives over each other with the front, or one objective over the trials.

    Of more trials than a picture has, only the first are drawn besides the front and the best.
    """
    words = [each.asked.word for each in found.task.goals]
    places = [found.task.asked.index(each.asked) for each in found.task.goals]
    labels = [
        f"{word} [{units[place]}]" if units[place] else word
        for word, place in zip(words, places, strict=True)
    ]
    name = found.task.family.scene.name
    shown = [each for each in found.trials[:MOST] if not np.isnan(each.costs).any()]
    beyond = [each for each in shown if not each.feasible]
    within = [each for each in shown if each.feasible]
    marks: list[Mark] = []
    several = len(places) > 1

    def across(trials: Sequence[Trial]) -> FloatArray:
        return (
            _answers(trials, places[0]) if several else np.array([float(t.number) for t in trials])
        )

    def up(trials: Sequence[Trial]) -> FloatArray:
        return _answers(trials, places[1 if several else 0])

    entries = []
    for label, trials, style in (
        ("beyond a limit", beyond, BEYOND),
        ("within all limits", within, WITHIN),
    ):
        if trials:
            marks.append(Line(over(across(trials), up(trials)), style))
            entries.append(Entry(label, style))
    if several:
        title = f"{name}: {counted(len(found.front), 'design')} that no other beats"
        front = sorted(found.front, key=lambda each: float(across([each])[0]))
        if front:
            style = ON_FRONT if len(places) > 2 else Style(LIMIT, 1.2, marker="o", size=5.0)
            marks.append(Line(over(across(front), up(front)), style, layer=3.0))
            entries.append(Entry("Pareto front", style))
    else:
        title = f"{name}: {found.task.goals[0].sense} {words[0]}"
        if within:
            best = np.minimum.accumulate([each.costs[0] for each in within])
            sense = found.task.goals[0].cost(1.0)
            marks.append(Line(over(across(within), sense * best), BEST, layer=3.0))
            entries.append(Entry("best so far", BEST))
    chosen = found.best if found.made is None else found.made
    if not np.isnan(chosen.costs).any():
        marks.append(Line(over(across([chosen]), up([chosen])), CHOSEN, layer=4.0))
        entries.append(Entry("chosen" if chosen.feasible else "nearest", CHOSEN))
    width = LEFT + ACROSS + RIGHT
    frame = box(LEFT / width, BOTTOM / HEIGHT, ACROSS / width, 1.0 - (TOP + BOTTOM) / HEIGHT)
    seen = [*shown, *found.front]
    x = Axis(limits([across(seen)]), labels[0] if several else "design")
    y = Axis(limits([up(seen)]), labels[1 if several else 0])
    legend = Legend(tuple(entries), "upper left", (1.02, 1.0), size=7.5, gap=0.0)
    return Figure((width, HEIGHT), (Panel(frame, x, y, tuple(marks), title, legend=legend),))


def _answers(trials: Sequence[Trial], place: int) -> FloatArray:
    return np.array([each.values[place] for each in trials], dtype=float)
