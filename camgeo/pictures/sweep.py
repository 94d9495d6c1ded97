"""Pictures of several designs: of a sweep, of an optimisation, and a few over each other."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from camgeo.design.design import Design
from camgeo.design.value_table import Columns, bare, quantities
from camgeo.errors import GeometryError, SceneError, UnknownNameError
from camgeo.numeric.arrays import FloatArray, frozen
from camgeo.pictures.model import (
    AUXILIARY,
    LIMIT,
    LINE,
    SAMPLES,
    ZERO,
    Area,
    Axis,
    Box,
    Entry,
    Figure,
    Fill,
    Frame,
    Legend,
    Line,
    Mark,
    Panel,
    Style,
    Text,
    box,
    diagram_angles,
    entries,
    grid,
    limits,
    over,
    plane,
    turn_axis,
)
from camgeo.studies.optimise.optimise import OptimisationResult, Trial, front
from camgeo.studies.sweep.family import Family
from camgeo.studies.sweep.rows import canonical
from camgeo.studies.sweep.sweep import SweepResult
from camgeo.units import MM_PER, TURN, counted

ACROSS, HEIGHT = 4.9, 4.6
LEFT, RIGHT, TOP, BOTTOM = 0.95, 1.75, 0.45, 0.6
"""Width of a panel, height of a figure, and margins [inch]; the legend is on the right."""

MOST: Final = 20_000
"""Largest number of designs in a picture; more could not be told apart."""

AXIS: Final = 1.3
"""Distance of parallel axes [inch]."""

EDGE: Final = 0.04
"""Space above and below the values of a parallel axis, as a fraction of their range."""

POINT: Final = 5.0
"""Size of a design in a map of samples [points]."""

FRONT: Final = Style(LIMIT, 1.2, marker="o", size=5.0)
OTHERS: Final = Style(LINE, 0.0, marker="o", size=3.5)


def map_figure(result: SweepResult) -> Figure:
    """A map of each answer over the two keys that vary: cells of a grid, or points of samples.

    Over a single key the answers are curves.
    """
    keys, answers = sweep_columns(result)
    variables = result.family.variables
    firsts = [keys[result.family.keys.index(variable.keys[0])] for variable in variables]
    if len(firsts) == 1:
        rows = [_curve(firsts[0], answer, result) for answer in answers]
    else:
        rows = [_map(firsts[0], firsts[1], answer, result) for answer in answers]
    if len(rows) == 1:
        return rows[0]
    width = max(row.size[0] for row in rows)
    return Figure((width, HEIGHT * len(rows)), rows=tuple(rows))


def _frame(width: float, left: float = LEFT) -> Frame:
    """The frame of the only panel of a figure, with room for a legend on its right."""
    return box(
        left / width,
        BOTTOM / HEIGHT,
        1.0 - (left + RIGHT) / width,
        1.0 - (TOP + BOTTOM) / HEIGHT,
    )


def _page(
    axes: tuple[Axis, Axis],
    marks: Sequence[Mark],
    title: str,
    room: float,
    legend: Legend | None = None,
) -> Figure:
    """A figure of one panel, with `room` [inch] for words beside its vertical axis."""
    left = LEFT + room
    width = left + ACROSS + RIGHT
    panel = Panel(_frame(width, left), *axes, tuple(marks), title, legend=legend)
    return Figure((width, HEIGHT), (panel,))


def _curve(key: SweepColumn, answer: SweepColumn, result: SweepResult) -> Figure:
    """An answer as a curve over the only key that varies."""
    order = np.argsort(key.values, kind="stable")
    points = over(key.values[order], answer.values[order])
    # Words have no order that a line could follow.
    width = 0.0 if key.words or answer.words else 1.2
    line = Line(points, Style(LINE, width, marker="o", size=3.5))
    title = f"{result.family.scene.name}: {answer.label}"
    return _page((key.axis, answer.axis), [line], title, answer.room)


def _map(x: SweepColumn, y: SweepColumn, answer: SweepColumn, result: SweepResult) -> Figure:
    if result.family.sample is None:
        marks, axes = _cells(x, y, answer)
    else:
        marks, axes = _dots(x, y, answer), (x.axis, y.axis)
    title = f"{result.family.scene.name}: {answer.label}"
    return _page(axes, marks, title, y.room, answer.legend)


def _cells(
    x: SweepColumn, y: SweepColumn, answer: SweepColumn
) -> tuple[list[Mark], tuple[Axis, Axis]]:
    """A rectangle for each design; its borders lie half way to its neighbours."""
    (left, right, x_places), (low, high, y_places) = _borders(x), _borders(y)
    marks: list[Mark] = []
    for column, row, value in zip(x.values, y.values, answer.values, strict=True):
        i, k = int(np.searchsorted(x_places, column)), int(np.searchsorted(y_places, row))
        corners = [(left[i], low[k]), (right[i], low[k]), (right[i], high[k]), (left[i], high[k])]
        missing = np.isnan(value)
        fill = FAILED if missing else Fill(answer.colour(answer.level(value)), width=0.0)
        marks.append(Area((np.array(corners),), fill, layer=1.2 if missing else 1.0))
    axes = (_cell_axis(x, left, right), _cell_axis(y, low, high))
    return marks, axes


def _cell_axis(column: SweepColumn, low: FloatArray, high: FloatArray) -> Axis:
    """The axis of a column, which ends at the borders of the outermost cells."""
    axis = column.axis
    return Axis((float(low[0]), float(high[-1])), axis.label, ticks=axis.ticks, names=axis.names)


def _borders(column: SweepColumn) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Lower and upper borders of the cells around the distinct values, and these values."""
    places = np.unique(column.values)
    if len(places) == 1:
        return places - 0.5, places + 0.5, places
    middle = 0.5 * (places[:-1] + places[1:])
    # The outermost cells extend as far outwards as inwards.
    first, last = 2.0 * places[0] - middle[0], 2.0 * places[-1] - middle[-1]
    return np.concatenate(([first], middle)), np.concatenate((middle, [last])), places


def _dots(x: SweepColumn, y: SweepColumn, answer: SweepColumn) -> list[Mark]:
    """A point for each design, in the colour of its answer."""
    marks: list[Mark] = []
    missing = np.isnan(answer.values)
    if missing.any():
        style = Style(LIMIT, 0.0, marker="x", size=POINT)
        marks.append(Line(over(x.values[missing], y.values[missing]), style, layer=2.5))
    # One mark for each colour, however many designs have it.
    levels = np.array([-1 if np.isnan(value) else answer.level(value) for value in answer.values])
    for level in np.unique(levels[levels >= 0]):
        here = levels == level
        style = Style(answer.colour(int(level)), 0.0, marker="o", size=POINT, edge=AUXILIARY,
                      edge_width=0.3)  # fmt: skip
        marks.append(Line(over(x.values[here], y.values[here]), style))
    return marks


def parallel(result: SweepResult) -> Figure:
    """Parallel axes: one for each key and each answer, and a line through them for each design.

    Colours are those of the last answer. Designs that lack an answer are left out.
    """
    keys, answers = sweep_columns(result)
    columns = [*keys, *answers]
    last = columns[-1]
    width = LEFT + AXIS * len(columns) + RIGHT
    whole = np.flatnonzero(~np.isnan([column.values for column in columns]).any(axis=0))
    heights = np.stack([_heights(column) for column in columns])
    marks: list[Mark] = []
    places = np.arange(float(len(columns)))
    # Designs with larger answers are drawn later, and so on top.
    for design in whole[np.argsort(last.values[whole], kind="stable")]:
        colour = last.colour(last.level(float(last.values[design])))
        marks.append(Line(over(places, heights[:, design]), Style(colour, 0.7)))
    for place, column in enumerate(columns):
        marks.append(Line(over([place] * 2, [0.0, 1.0]), Style("black", 1.0), layer=3.0))
        marks += _scale(float(place), column)
    lost = len(last.values) - len(whole)
    title = f"{result.family.scene.name}: {counted(len(whole), 'design')}"
    title += f", without {lost:,} that lack an answer" if lost else ""
    x, y = Axis((-0.5, len(columns) - 0.5), numbered=False), Axis((-0.12, 1.04), numbered=False)
    panel = Panel(_frame(width), x, y, tuple(marks), title, legend=last.legend, bare=True)
    return Figure((width, HEIGHT), (panel,))


def _heights(column: SweepColumn) -> FloatArray:
    """The values of a column between 0 and 1."""
    low, high = _ends(column)
    return (column.values - low) / (high - low)


def _ends(column: SweepColumn) -> tuple[float, float]:
    low, high = column.extent or (0.0, 1.0)
    # Equal values have no range, but their axis needs a length.
    space = EDGE * (high - low) or max(abs(high), 1.0) * EDGE
    return low - space, high + space


def _scale(place: float, column: SweepColumn) -> list[Mark]:
    """The scale of a parallel axis: the name below it, and words or the numbers at both ends."""
    low, high = _ends(column)
    if column.words:
        named = [(float(k), word) for k, word in enumerate(column.words)]
    else:
        named = [(end, f"{end:.4g}") for end in dict.fromkeys(column.extent or ())]
    marks: list[Mark] = []
    for level, text in named:
        spot = (place, (level - low) / (high - low))
        behind = Box(0.5, 0.7)
        marks.append(Text(text, spot, 7.0, offset=(3.0, 0.0), up="center", box=behind, layer=4.0))
    name = column.label.replace(" [", "\n[")
    marks.append(Text(name, (place, -0.03), 7.0, across="center", up="top", layer=4.0))
    return marks


def pareto(result: SweepResult, least: Sequence[str], largest: Sequence[str]) -> Figure:
    """Two answers over each other, with the Pareto front: the designs that no other one dominates.

    Parameters
    ----------
    least, largest : the objectives as they were asked for, what should be small and what large; at
        least two together, of which the first two are on the axes.
    """
    _, answers = sweep_columns(result)
    chosen = objectives([question.word for question in result.questions], least, largest)
    mask = front(np.column_stack([sense * answers[place].values for place, sense in chosen]))
    (x_index, _), (y_index, _) = chosen[:2]
    x, y = answers[x_index], answers[y_index]
    # In ascending order, so that the front of two objectives is a line; of more it is none here.
    order = np.flatnonzero(mask)[np.argsort(x.values[mask], kind="stable")]
    style = FRONT if len(chosen) == 2 else Style(LIMIT, 0.0, marker="o", size=5.0)
    marks: list[Mark] = [
        Line(over(x.values[~mask], y.values[~mask]), OTHERS),
        Line(over(x.values[order], y.values[order]), style, layer=3.0),
    ]
    named = (Entry("Pareto front", style), Entry("other designs", OTHERS))
    title = f"{result.family.scene.name}: {counted(len(order), 'design')} that no other beats"
    legend = Legend(named, "upper left", (1.02, 1.0), size=7.5, gap=0.0)
    return _page((x.axis, y.axis), marks, title, y.room, legend)


def objectives(
    questions: Sequence[str], least: Sequence[str], largest: Sequence[str]
) -> list[tuple[int, float]]:
    """The places of the objectives among the questions, each with 1 if small is good, else -1.

    Raises UnknownNameError for an objective that is no question, GeometryError for fewer than two.
    """
    words = [canonical(word) for word in questions]
    chosen = []
    for names, sense in ((least, 1.0), (largest, -1.0)):
        for name in map(canonical, names):
            if name not in words:
                raise UnknownNameError("answer", name, words)
            chosen.append((words.index(name), sense))
    if len({place for place, _ in chosen}) < max(2, len(chosen)):
        raise GeometryError("a front needs two objectives or more, each once")
    return chosen


def require(family: Family, kind: str) -> None:
    """Raise GeometryError if a picture of that kind cannot show a family, before it is computed."""
    if family.count > MOST:
        size = counted(family.count, "design")
        raise GeometryError(f"a picture has at most {counted(MOST, 'design')}, not {size}")
    count = len(family.variables)
    if kind == "map" and count > 2:
        message = f"a map has one or two variables, not {count}; parallel axes have any number"
        raise GeometryError(message)


PICTURES: Final[dict[str, Callable[[SweepResult], Figure]]] = {
    "map": map_figure,
    "parallel": parallel,
}
"""Functions that make pictures without objectives, by the kind of picture."""


# -- columns --------------------------------------------------------------------------------------
# Columns of a sweep as numbers that can be drawn, and their colours.


COLOURS: Final = (
    "#440154", "#46327e", "#365c8d", "#277f8e", "#1fa187", "#4ac16d", "#a0da39", "#fde725",
)  # fmt: skip
"""Colours from low to high, ascending in lightness too (viridis of matplotlib, CC0)."""

LETTER: Final = 0.08
"""Width of a letter at a tick [inch]."""

FAILED: Final = Fill("#ffffff", "#b3261e", 0.6, hatched=True)
"""Filling of designs without an answer."""


@dataclass(frozen=True, slots=True, eq=False)
class SweepColumn:
    """A key or an answer, for all designs.

    Attributes
    ----------
    label : its name and unit.
    values : (n,) numbers of all designs, NaN where there is none; for words, their places in
        `words`.
    words : the words, in the order of their first appearance; empty for numbers.
    """

    label: str
    values: FloatArray
    words: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", frozen(self.values, np.float64))

    @property
    def extent(self) -> tuple[float, float] | None:
        """Smallest and largest value; None if there is none."""
        known = self.values[np.isfinite(self.values)]
        return (float(np.min(known)), float(np.max(known))) if len(known) else None

    @property
    def room(self) -> float:
        """Width of its longest word [inch], for the margin beside a vertical axis."""
        return LETTER * max(map(len, self.words), default=0)

    @property
    def axis(self) -> Axis:
        """An axis on which all values lie."""
        if self.words:
            ticks = tuple(float(place) for place in range(len(self.words)))
            return Axis((-0.6, len(self.words) - 0.4), self.label, ticks=ticks, names=self.words)
        return Axis(limits([self.values]), self.label)

    @property
    def levels(self) -> FloatArray:
        """(k + 1,) borders of the equally wide ranges that colours stand for."""
        if self.words:
            return np.arange(float(len(self.words) + 1)) - 0.5
        if self.extent is None:
            return np.array([0.0, 1.0])
        low, high = self.extent
        borders: FloatArray = np.linspace(low, high, len(COLOURS) + 1 if high > low else 2)
        return borders

    def level(self, value: float) -> int:
        """The range that a value lies in, from 0."""
        borders = self.levels
        place = int(np.searchsorted(borders, value, side="right")) - 1
        return max(0, min(place, len(borders) - 2))

    def colour(self, level: int) -> str:
        """The colour of a range."""
        most = max(len(self.levels) - 2, 1)
        return COLOURS[round(level * (len(COLOURS) - 1) / most)]

    @property
    def legend(self) -> Legend:
        """The legend of the ranges, the highest on top, and of designs without an answer."""
        borders = self.levels
        entries = [
            Entry(self._range(borders, level), Fill(self.colour(level), width=0.0))
            for level in reversed(range(len(borders) - 1))
        ]
        if np.isnan(self.values).any():
            entries.append(Entry("no answer", FAILED))
        return Legend(tuple(entries), "upper left", (1.02, 1.0), size=7.5, gap=0.0)

    def _range(self, borders: FloatArray, level: int) -> str:
        if self.words:
            return self.words[level]
        return f"{borders[level]:.4g} to {borders[level + 1]:.4g}"


def sweep_columns(result: SweepResult) -> tuple[list[SweepColumn], list[SweepColumn]]:
    """The columns of the keys that vary, and those of the answers."""
    rows = list(result.rows)
    keys = [
        column(key, [row.point[place] for row in rows])
        for place, key in enumerate(result.family.keys)
    ]
    answers = []
    for place, question in enumerate(result.questions):
        units = sorted({row.units[place] for row in rows if row.units[place]})
        label = f"{question.word} [{' or '.join(units)}]" if units else question.word
        answers.append(column(label, [row.values[place] for row in rows]))
    return keys, answers


def column(label: str, values: Sequence[object]) -> SweepColumn:
    """The column of some values: of numbers, or of words if any of them is a word."""
    if any(isinstance(value, str | bool) for value in values):
        words = dict.fromkeys(_word(value) for value in values if value is not None)
        places = {word: float(place) for place, word in enumerate(words)}
        numbers = [np.nan if value is None else places[_word(value)] for value in values]
        return SweepColumn(label, np.array(numbers), tuple(words))
    numbers = [float(value) if isinstance(value, int | float) else np.nan for value in values]
    return SweepColumn(label, np.array(numbers))


def _word(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


# -- trials ---------------------------------------------------------------------------------------
# Pictures of an optimisation: the Pareto front, or how the objective improved.


BEST = Style(LIMIT, 1.2)
ON_FRONT = Style(LIMIT, 0.0, marker="o", size=5.0)
FEASIBLE = Style(LINE, 0.0, marker="o", size=3.0)
INFEASIBLE = Style("0.7", 0.0, marker="x", size=3.0)
CHOSEN = Style("black", 0.0, marker="o", size=7.0)


def search_figure(result: OptimisationResult, units: Sequence[str]) -> Figure:
    """The first two objectives over each other with the front, or the only one over the trials.

    At most the first `MOST` trials are drawn, besides the front and the best design.
    """
    words = [goal.question.word for goal in result.task.goals]
    places = [result.task.questions.index(goal.question) for goal in result.task.goals]
    labels = [
        f"{word} [{units[place]}]" if units[place] else word
        for word, place in zip(words, places, strict=True)
    ]
    name = result.task.family.scene.name
    visible_trials = [trial for trial in result.trials[:MOST] if not np.isnan(trial.costs).any()]
    infeasible = [trial for trial in visible_trials if not trial.feasible]
    feasible = [trial for trial in visible_trials if trial.feasible]
    marks: list[Mark] = []
    several = len(places) > 1

    def x_values(trials: Sequence[Trial]) -> FloatArray:
        return (
            _answers(trials, places[0]) if several else np.array([float(t.number) for t in trials])
        )

    def y_values(trials: Sequence[Trial]) -> FloatArray:
        return _answers(trials, places[1 if several else 0])

    entries = []
    for label, trials, style in (
        ("beyond a limit", infeasible, INFEASIBLE),
        ("within all limits", feasible, FEASIBLE),
    ):
        if trials:
            marks.append(Line(over(x_values(trials), y_values(trials)), style))
            entries.append(Entry(label, style))
    if several:
        title = f"{name}: {counted(len(result.front), 'design')} that no other beats"
        front = sorted(result.front, key=lambda each: float(x_values([each])[0]))
        if front:
            style = ON_FRONT if len(places) > 2 else Style(LIMIT, 1.2, marker="o", size=5.0)
            marks.append(Line(over(x_values(front), y_values(front)), style, layer=3.0))
            entries.append(Entry("Pareto front", style))
    else:
        title = f"{name}: {result.task.goals[0].sense} {words[0]}"
        if feasible:
            best = np.minimum.accumulate([trial.costs[0] for trial in feasible])
            sense = result.task.goals[0].cost(1.0)
            marks.append(Line(over(x_values(feasible), sense * best), BEST, layer=3.0))
            entries.append(Entry("best so far", BEST))
    chosen = result.best if result.made is None else result.made
    if not np.isnan(chosen.costs).any():
        marks.append(Line(over(x_values([chosen]), y_values([chosen])), CHOSEN, layer=4.0))
        entries.append(Entry("chosen" if chosen.feasible else "nearest", CHOSEN))
    seen = [*visible_trials, *result.front]
    x = Axis(limits([x_values(seen)]), labels[0] if several else "design")
    y = Axis(limits([y_values(seen)]), labels[1 if several else 0])
    legend = Legend(tuple(entries), "upper left", (1.02, 1.0), size=7.5, gap=0.0)
    return _page((x, y), marks, title, 0.0, legend)


def _answers(trials: Sequence[Trial], place: int) -> FloatArray:
    return np.array([trial.values[place] for trial in trials], dtype=float)


# -- overlaid --------------------------------------------------------------------------------------
# A few designs over each other: flanks, motion, acceleration and transmission angle.


OVERLAID_WIDTH, OVERLAID_HEIGHT = 11.0, 6.4
OVERLAID_MIDDLE: Final = 5.6
"""Left edge of the diagrams, to the right of the flanks [inch]."""

OVERLAID_MARGINS: Final = (0.8, 0.2, 0.4, 0.55)
"""Left, right, above and below [inch]."""

OVERLAID_LEFT, _, OVERLAID_TOP, OVERLAID_BOTTOM = OVERLAID_MARGINS

DESIGN_COLOURS: Final = (
    "#12365c", "#c05a00", "#2e7d32", "#8e24aa", "#6d4c41", "#0097a7", "#9e9d24", "#b3261e",
)  # fmt: skip
"""Colours of the designs; more of them could not be told apart."""

SPELLED: Final = {"mu [": "transmission angle μ [", "psi": "ψ", "chi": "χ", "theta": "θ",
                  "alpha_": "α ", "^2": "²", "deg": "°"}  # fmt: skip

DASHES: Final = ((), (5.0, 2.0), (1.5, 1.5), (6.0, 1.5, 1.5, 1.5))
"""Dashes of the lines, in turn, so that a print in grey can be read."""


def of_designs(designs: Sequence[tuple[str, Design]]) -> Figure:
    """The designs over each other, by their names; curves that a design lacks are left out."""
    size = OVERLAID_WIDTH, OVERLAID_HEIGHT
    flanks: list[Mark] = []
    rows: list[list[tuple[str, Line]]] = [[], [], []]
    for number, (name, design) in enumerate(designs):
        style = _style(number)
        flanks += _flanks(design, name, style)
        for row, curves in zip(rows, _curves(design, style), strict=True):
            row += curves
    panels = [_disc(flanks, designs[0][1].scene.unit)] if flanks else []
    left = OVERLAID_MIDDLE if flanks else OVERLAID_LEFT
    frames = grid(size, (left, *OVERLAID_MARGINS[1:]), len(rows), 1, (0.12, 0.0))
    for number, (row, frame) in enumerate(zip(rows, frames, strict=True)):
        lines = [line for _, line in row]
        label = " or ".join(dict.fromkeys(_spelled(heading) for heading, _ in row))
        extent = limits([line.points[:, 1] for line in lines], [0.0])
        y = Axis(extent, label, powers=(-3, 5), label_place=0.62)
        turn = turn_axis(numbered=number == len(rows) - 1)
        panels.append(Panel(frame, turn, y, (*lines, ZERO)))
    names = [Line(over([], []), _style(number), name) for number, (name, _) in enumerate(designs)]
    legend = Legend(
        entries(names), "upper left", (OVERLAID_LEFT / OVERLAID_WIDTH, 1.0), len(names), pad=0.2
    )
    return Figure(size, tuple(panels), legend=legend)


figure = of_designs
"""Its name in `camgeo.pictures.compare`, which docs/sweep.md named."""


def _spelled(heading: str) -> str:
    """The heading of a column as the label of an axis."""
    for words, letters in SPELLED.items():
        heading = heading.replace(words, letters)
    return heading


def _style(number: int) -> Style:
    return Style(DESIGN_COLOURS[number % len(DESIGN_COLOURS)], 1.3, DASHES[number % len(DASHES)])


def _disc(flanks: list[Mark], unit: str) -> Panel:
    points = np.concatenate([line.points for line in flanks if isinstance(line, Line)])
    frame = box(
        OVERLAID_LEFT / OVERLAID_WIDTH,
        OVERLAID_BOTTOM / OVERLAID_HEIGHT,
        (OVERLAID_MIDDLE - OVERLAID_LEFT - 0.9) / OVERLAID_WIDTH,
        1.0 - (OVERLAID_TOP + OVERLAID_BOTTOM) / OVERLAID_HEIGHT,
    )
    x, y = (Axis(limits([points[:, k]], [0.0]), f"{'xy'[k]} [{unit}]") for k in (0, 1))
    axis = Line(over([0.0], [0.0]), Style("black", 0.0, marker="+", size=8.0))
    return Panel(frame, x, y, (*flanks, axis), equal=True)


def _flanks(design: Design, name: str, style: Style) -> Iterator[Line]:
    """The working curves of the main disc; undercut ones are drawn with their loops."""
    if design.scene.follower is None:
        return
    disc, phi = design.cam.disc, np.linspace(0.0, TURN, SAMPLES)
    for flank, curve in disc.flanks:
        try:
            points = curve.point(phi) / MM_PER[design.scene.unit]
        except GeometryError:  # the roller centre stands still in the cam
            continue
        yield Line(plane(points), style, f"{name}, {flank}")


def _curves(design: Design, style: Style) -> list[list[tuple[str, Line]]]:
    """Position, acceleration and transmission angle with their headings, if there are any."""
    scene = design.scene
    cam = None if scene.follower is None else design.cam
    all_columns = quantities(design.drive, scene.lift_unit, cam, scene.unit)
    timed = [
        column for column in all_columns if bare(column[0]) == "a" or column[0].startswith("alpha_")
    ]
    chosen: list[Columns] = [
        all_columns[:1],
        timed[:1] or all_columns[2:3],
        [column for column in all_columns if bare(column[0]) == "mu"],
    ]
    phi = diagram_angles(design.drive.joints)
    return [[*_curve_lines(columns, phi, style)] for columns in chosen]


def _curve_lines(columns: Columns, phi: FloatArray, style: Style) -> Iterator[tuple[str, Line]]:
    for heading, quantity in columns:
        try:
            yield heading, Line(over(np.degrees(phi), quantity(phi, "right")), style)
        except (GeometryError, SceneError):  # there is no such curve
            continue
