"""Answer of `camgeo optimise`: the best design, its scene, and the record of the search."""

from __future__ import annotations

import argparse
import signal
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from camgeo.app.answers.answer import BROKEN, FINE, STOPPED, Answer, Key, aligned
from camgeo.app.answers.sweep import display_value, encode_csv, value_text
from camgeo.app.cli.command import (
    FORCE,
    IMAGES,
    SCENE_FILE,
    WORKERS,
    Argument,
    CallError,
    Written,
    document,
    draw_figure,
    engine_for,
    notify,
    number,
    objective_options,
    repeated_option,
    require_new,
    show,
    suffix_type,
    write_files,
)
from camgeo.pictures.model import Figure
from camgeo.scene.scene import Scene, load_scene
from camgeo.scene.values import Value
from camgeo.studies.optimise.optimise import OptimisationResult, Trial, optimise, task_of
from camgeo.studies.sweep.family import Range, Variable, split_names
from camgeo.units import counted, shortened, unit_and_divisor


@dataclass(frozen=True, slots=True)
class Tried:
    """One design that was tried.

    Attributes
    ----------
    number : in the order of the trials, from 1.
    values : by the keys that vary.
    answers : values of the requested quantities by name; None where there is none.
    violated : in words, the limits that it breaks, or why there is no such design; the worst first.
    """

    number: int
    values: Mapping[str, Value]
    answers: Mapping[str, float | None]
    violated: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Bound:
    """The range of a variable: numbers from `start` to `stop`, or one of `values`."""

    keys: tuple[str, ...]
    start: float | None
    stop: float | None
    values: tuple[tuple[Value, ...], ...]


@dataclass(frozen=True, slots=True)
class Objective:
    """A quantity to be made as small ("least") or large ("largest") as possible, with its unit."""

    question: str
    sense: str
    unit: str


@dataclass(frozen=True, slots=True)
class Optimum(Answer):
    """The outcome of an optimisation.

    Attributes
    ----------
    search : the task, all trials and the best.
    """

    search: OptimisationResult

    @property
    def scene(self) -> Scene:
        """The scene that the search starts from."""
        return self.search.task.family.scene

    @property
    def objectives(self) -> tuple[Objective, ...]:
        """The objectives, in the order of the call."""
        questions = self.search.task.questions
        return tuple(
            Objective(goal.question.word, goal.sense, self.units[questions.index(goal.question)])
            for goal in self.search.task.goals
        )

    @property
    def units(self) -> tuple[str, ...]:
        """Units of the requested quantities; empty where no design has a value."""
        places = range(len(self.search.task.questions))
        # Designs without a value have no unit: the first one that states it counts.
        rows = [trial.units for trial in self.search.trials if trial.units]
        return tuple(next((row[place] for row in rows if row[place]), "") for place in places)

    @property
    def limits(self) -> tuple[str, ...]:
        """The limits stated with the call, in words."""
        return tuple(map(str, self.search.task.limits))

    @property
    def ignored(self) -> tuple[str, ...]:
        """Names of the findings whose limits in the scene were ignored."""
        return tuple(sorted(self.search.task.ignored))

    @property
    def bounds(self) -> tuple[Bound, ...]:
        """The ranges of the variables."""
        return tuple(map(_bound, self.search.task.family.variables))

    @property
    def evaluations(self) -> int:
        """Number of designs that were tried."""
        return len(self.search.trials)

    @property
    def feasible_count(self) -> int:
        """Number of designs that keep all limits."""
        return sum(trial.feasible for trial in self.search.trials)

    @property
    def start(self) -> Tried | None:
        """The design of the scene; None if it is not within the bounds."""
        return None if self.search.start is None else self.tried(self.search.start)

    @property
    def best(self) -> Tried:
        """The best design as the search found it; if none keeps the limits, the one that violates
        them least.
        """
        return self.tried(self.search.best)

    @property
    def written(self) -> Tried | None:
        """The best design with rounded numbers, as it is written; None if none keeps the limits."""
        return None if self.search.made is None else self.tried(self.search.made)

    @property
    def remarks(self) -> tuple[str, ...]:
        """Limits of the scene that the written design breaks and that were ignored."""
        return () if self.search.made is None else self.search.made.remarks

    @property
    def front(self) -> tuple[Tried, ...]:
        """The non-dominated designs of several objectives; empty for a single one."""
        several = len(self.search.task.goals) > 1
        return tuple(map(self.tried, self.search.front)) if several else ()

    @property
    def exit_code(self) -> int:
        """1 if no design keeps the limits."""
        return BROKEN if self.search.made is None else FINE

    def tried(self, trial: Trial) -> Tried:
        """A trial with its values by key and its answers by name."""
        words = [question.word for question in self.search.task.questions]
        values = self.search.task.family.edits(trial.point)
        answers = dict(zip(words, trial.values, strict=True))
        return Tried(trial.number, values, answers, trial.broken)


def _bound(variable: Variable) -> Bound:
    values = variable.values
    if isinstance(values, Range) and values.steps is None:
        return Bound(variable.keys, float(values.start), float(values.stop), ())
    listed = tuple(values.row(place) for place in range(values.count))
    return Bound(variable.keys, None, None, listed)


# -- document -------------------------------------------------------------------------------------
# The keys of its JSON document.


TRIED: Final = Key(
    "A design that was tried.",
    {
        "number": "Number of the trial, from 1.",
        "values": "Values of the design by the keys that vary, in the units of the scene.",
        "answers": "Values of the requested quantities by name, objectives first; null where"
        " there is none.",
        "violated": (
            "The limits that it breaks, or why there is no such design, the worst first; empty if"
            " it keeps all."
        ),
    },
)

DOCUMENT: Final = Key(
    "The best design that a search found, and the designs that were tried.",
    {
        "scene": Key(
            "The scene that the search starts from.",
            {
                "name": "Name of the scene.",
                "sha256": Key(
                    "SHA-256 of everything that it states but [sweep], hexadecimal.", of="identity"
                ),
            },
        ),
        "objectives": Key(
            "The objectives.",
            {
                "asked": Key(
                    "Name of a finding, or of a column after min:, max: or peak:.", of="question"
                ),
                "sense": Key("Direction of the objective.", type=Literal["least", "largest"]),
                "unit": "Unit of its answers; empty if it has none, or if no design has an answer.",
            },
        ),
        "limits": "Limits stated with the call, in the units of the answers.",
        "ignored": ('Findings whose limits in the scene were ignored; "limits" stands for all.'),
        "bounds": Key(
            "The variables and their ranges.",
            {
                "keys": "The keys that take the value.",
                "from": Key("One end of the range; null for a list.", of="start"),
                "to": Key("The other end; null for a list.", of="stop"),
                "values": "What could be chosen, a value for each key; empty for a range.",
            },
        ),
        "seed": Key("Seed of the random numbers.", of="search.seed"),
        "evaluations": "Number of designs that were tried.",
        "allowed": Key("Number of designs that could be tried.", of="search.most"),
        "kept": Key("Number of designs that keep all limits.", of="feasible_count"),
        "ended": Key("Why the search ended.", of="search.ended"),
        "start": Key(
            "The design of the scene; null if it was not tried, as it is not within the bounds.",
            TRIED,
        ),
        "best": Key(
            "The best design as the search found it, of several objectives one in the middle of"
            " the front; if none keeps the limits, that which violates them least.",
            TRIED,
        ),
        "written": Key(
            "The best design with rounded numbers, as it is written; null if none keeps the"
            " limits.",
            TRIED,
        ),
        "remarks": "Limits that it breaks and that were ignored.",
        "front": Key(
            "The non-dominated designs of several objectives; empty for a single one.", TRIED
        ),
    },
    type=Optimum,
)


# -- rendering ------------------------------------------------------------------------------------
# The answer of `camgeo optimise` as text, as a table and as a picture.


MOST_FRONT: Final = 20
"""Designs of a front that are printed."""

MOST_BROKEN: Final = 4

LONGEST: Final = 140
"""Characters of a violated limit that are printed."""


def text(answer: Optimum) -> str:
    """The best design next to that of the scene, the front, and how the search went."""
    goals = [f"{objective.sense} {objective.question}" for objective in answer.objectives]
    lines = [f"{answer.scene.name}: {', '.join(goals)}"]
    if answer.limits:
        lines.append(f"limits, besides the other ones of the scene: {', '.join(answer.limits)}")
    if answer.ignored:
        lines.append(f"ignored limits of the scene: {', '.join(answer.ignored)}")
    lines += ["", *_designs(answer), ""]
    if answer.written is None:
        lines.append("no design that was tried keeps all limits; the nearest violates:")
        lines += _broken(answer.best)
        lines.append("")
    lines += [f"beyond an ignored limit: {remark}" for remark in answer.remarks]
    if answer.front:
        lines += [f"{counted(len(answer.front), 'non-dominated design')}:", *_front(answer)]
        lines.append("")
    lines += [_searched(answer), *(f"  {_bounds(bound)}" for bound in answer.bounds)]
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
        rows.append([key, *(value_text(design.values[key]) for _, design in columns)])
    for word, unit in zip(best.answers, answer.units, strict=True):
        texts = [display_value(length, design.answers[word], unit) for _, design in columns]
        display_unit = texts[0][1]
        rows.append([f"{word} [{display_unit}]" if unit else word, *(text for text, _ in texts)])
    if answer.start is not None and answer.start.violated:
        verdicts = ["no" if design.violated else "yes" for _, design in columns]
        rows.append(["keeps all limits", *verdicts])
    return aligned(rows)


def _broken(design: Tried) -> list[str]:
    lines = [f"  {shortened(limit, LONGEST)}" for limit in design.violated[:MOST_BROKEN]]
    rest = len(design.violated) - MOST_BROKEN
    return [*lines, f"  and {rest} more"] if rest > 0 else lines


def _front(answer: Optimum) -> list[str]:
    words = [objective.question for objective in answer.objectives]
    length, units = (
        answer.scene.unit,
        {objective.question: objective.unit for objective in answer.objectives},
    )
    heads = [f"{word} [{unit_and_divisor(unit, length)[0]}]" if unit else word
             for word, unit in units.items()]  # fmt: skip
    rows = [[*heads, *answer.best.values]]
    designs = answer.front
    if len(designs) > MOST_FRONT:  # evenly spaced, both ends among them
        last = len(designs) - 1
        designs = tuple(designs[k * last // (MOST_FRONT - 1)] for k in range(MOST_FRONT))
    for design in designs:
        answers = (display_value(length, design.answers[word], units[word])[0] for word in words)
        rows.append([*answers, *(value_text(value) for value in design.values.values())])
    more = len(answer.front) - len(designs)
    notes = [f"  and {counted(more, 'design')} between these"] if more else []
    return [*(f"  {line}" for line in aligned(rows)), *notes]


def _searched(answer: Optimum) -> str:
    count = counted(answer.evaluations, "design")
    return (
        f"tried {count} with seed {answer.search.seed}, {answer.feasible_count:,} of them"
        f" within all limits; ended: {answer.search.ended}"
    )


def _bounds(bound: Bound) -> str:
    keys = ", ".join(bound.keys)
    if bound.start is not None and bound.stop is not None:
        return f"{keys} from {bound.start:g} to {bound.stop:g}"
    values = ["/".join(map(value_text, dict.fromkeys(row))) for row in bound.values]
    if len(values) > 8:
        values = [*values[:3], "...", values[-1]]
    return f"{keys} one of {', '.join(values)}"


def comma_separated(answer: Optimum) -> bytes:
    """All designs that were tried as CSV in UTF-8, in their order."""
    words = [question.word for question in answer.search.task.questions]
    heads = [f"{word} [{unit}]" if unit else word
             for word, unit in zip(words, answer.units, strict=True)]  # fmt: skip
    family = answer.search.task.family
    rows: list[list[object]] = [["number", *family.keys, *heads, "violation", "violated"]]
    for trial in answer.search.trials:
        cells = (*family.edits(trial.point).values(), *trial.values)
        rows.append([trial.number, *cells, trial.violation, "; ".join(trial.broken)])
    return encode_csv(rows)


def figure(answer: Optimum) -> Figure:
    """The front of several objectives, or how one became better."""
    from camgeo.pictures.sweep import search_figure

    return search_figure(answer.search, answer.units)


# -- command line ----------------------------------------------------------------------------------


SUFFIXES: Final = (".toml", ".json", ".csv", *IMAGES)

EXAMPLE: Final = (
    "camgeo optimise fixtures/scenes/setzhub.toml --vary follower.base_radius=40:60"
    " --vary motion.2.law=modified-sine,polynomial-345 --least diameter"
    " --keep 'transmission-angle>=42' -o best.toml\n"
    "  camgeo optimise my-cam.toml --vary follower.base_radius=36:60 --vary follower.arm=55:70"
    " --least diameter --largest transmission-angle -o best.toml -o front.png"
)


ARGUMENTS: Final = (
    SCENE_FILE,
    repeated_option(
        "--vary",
        "KEY=VALUES",
        "values of a key: LOW:HIGH for any number between, START:STOP:COUNT, or a list as"
        " 5,6,7; KEY,KEY=VALUES ties keys together; may be repeated",
    ),
    *objective_options(
        "objectives that should be {}: findings as transmission-angle, columns as"
        " peak:a, max:NAME or min:NAME, diameter; comma-separated"
    ),
    repeated_option(
        "--keep",
        "LIMIT",
        "'NAME>=NUMBER' or 'NAME<=NUMBER', besides the limits of the scene, or in place of its"
        " own on the same finding; may be repeated",
    ),
    repeated_option(
        "--ignore",
        "NAMES",
        "findings whose limits in the scene are ignored, or limits for all of them",
    ),
    Argument("--seed", type=int, help="seed of the random numbers; default 0"),
    Argument(
        "--evaluations", metavar="COUNT", type=int, help="designs that may be tried; default 2000"
    ),
    Argument(
        "--seconds",
        type=number,
        help="time after which no further design is tried; default: no limit",
    ),
    WORKERS,
    repeated_option(
        "-o",
        "FILE",
        "the scene of the best design, .toml; the record, .json; all designs that were tried,"
        " .csv; the front or the progress of the search, .png, .svg, .pdf; may be repeated",
        suffix_type(SUFFIXES),
        "output",
    ),
    FORCE,
)


def run(arguments: argparse.Namespace) -> int:
    """Search, print the answer, and write the files of the call."""
    files = [Path(name) for name in arguments.output]
    if len({path.parent for path in files}) > 1 or len(set(files)) < len(files):
        raise CallError("-o must name different files in one folder")
    require_new(files, arguments)
    scene = load_scene(arguments.scene)
    folder = Path(arguments.scene).resolve().parent
    for path in files:
        if path.suffix == ".toml" and scene.files and path.resolve().parent != folder:
            raise CallError(f"-o {path} must be in the folder of SCENE, which names files")
    task = task_of(
        scene,
        arguments.vary,
        least=split_names(arguments.least),
        largest=split_names(arguments.largest),
        keep=arguments.keep,
        ignore=split_names(arguments.ignore),
    )
    optimum = optimise(
        task,
        seed=arguments.seed,
        evaluations=arguments.evaluations,
        seconds=arguments.seconds,
        engine=engine_for(arguments.workers),
        progress=arguments.progress,
    )
    answer = Optimum(optimum)
    if optimum.made is not None:
        write_files([_written(answer, path) for path in files], arguments)
    elif files:
        notify("nothing was written: no design that was tried keeps all limits")
    # An interrupted search reports and writes its best design, too.
    code = show(answer, arguments)
    return STOPPED + signal.SIGINT if optimum.interrupted else code


def _written(answer: Optimum, path: Path) -> Written:
    if path.suffix == ".toml":
        scene = answer.search.scene
        assert scene is not None  # as something is written
        return path, scene.to_toml().encode(), "the best design"
    if path.suffix == ".csv":
        return path, comma_separated(answer), counted(answer.evaluations, "row")
    if path.suffix == ".json":
        return path, document(answer).encode(), "the record"
    return path, draw_figure(figure(answer), path.suffix), "picture"
