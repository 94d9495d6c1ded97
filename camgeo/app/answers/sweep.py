"""Answer of `camgeo sweep`: the rows of a family, and the least and greatest values among them."""

from __future__ import annotations

import argparse
import csv
import io
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from camgeo.app.answers.answer import Answer, Key, aligned
from camgeo.app.cli.command import (
    FORCE,
    IMAGES,
    SCENE_FILE,
    WORKERS,
    Argument,
    ArgumentGroup,
    CallError,
    Written,
    document,
    draw_figure,
    engine_for,
    notify,
    objective_options,
    repeated_option,
    require_new,
    show,
    suffix_type,
)
from camgeo.scene.scene import Scene, load_scene
from camgeo.scene.values import Value
from camgeo.studies.sweep.family import Family, Sample, family_of, question_names, split_names
from camgeo.studies.sweep.rows import DesignRow, engine_of
from camgeo.studies.sweep.sweep import SweepResult, sweep
from camgeo.units import LengthUnit, counted, listed, shortened, unit_and_divisor


@dataclass(frozen=True, slots=True)
class Design:
    """One design of the family.

    Attributes
    ----------
    values : by the keys that vary.
    answers : values of the requested quantities by name; None where there is none.
    units : of those answers that designs state in different units.
    reason : why something is missing; empty if nothing failed.
    """

    values: Mapping[str, Value]
    answers: Mapping[str, float | str | None]
    units: Mapping[str, str]
    reason: str


@dataclass(frozen=True, slots=True)
class Span:
    """The range of one requested quantity.

    Attributes
    ----------
    word : name of the quantity.
    units : of the numbers; several if designs state it in different ones.
    count : number of designs with a value.
    least, greatest : the designs with the least and the greatest number, the first of several; None
        if no value is a number, or if units differ.
    words : number of designs for each value that is a word.
    """

    word: str
    units: tuple[str, ...]
    count: int
    least: Design | None
    greatest: Design | None
    words: Mapping[str, int]

    @property
    def mixed(self) -> bool:
        """Whether designs state the numbers in different units."""
        return len(self.units) > 1

    @property
    def unit(self) -> str:
        """Unit of the numbers; empty if there is none, or if they have different ones."""
        return self.units[0] if len(self.units) == 1 else ""


@dataclass(frozen=True, slots=True)
class Sweep(Answer):
    """The rows of a family, which are read from the store on demand.

    Attributes
    ----------
    result : the family with its rows.
    spans : ranges of the requested quantities, in the order of the call.
    reasons : why designs failed, with the number of designs, the most frequent first.
    failed : designs that lack an answer, with a reason.
    count : all designs.
    """

    result: SweepResult
    spans: tuple[Span, ...]
    reasons: Mapping[str, int]
    failed: int
    count: int

    @property
    def scene(self) -> Scene:
        """The scene that the family starts from."""
        return self.result.family.scene

    @property
    def designs(self) -> Iterator[Design]:
        """All designs, in the order of the family."""
        mixed = frozenset(span.word for span in self.spans if span.mixed)
        return (_design(self.result, row, mixed) for row in self.result.rows)

    @property
    def cells(self) -> list[list[str]]:
        """The rows of a small family below a heading; empty for a larger one."""
        if self.count > FEW:
            return []
        length, common = self.scene.unit, {span.word: span.unit for span in self.spans}
        heads = (headed(span, length) for span in self.spans)
        rows = [[*self.result.family.keys, *heads, REASON]]
        for design in self.designs:
            answers = (
                " ".join(filter(None, _answer(design, word, common.get(word, ""), length)))
                for word in design.answers
            )
            rows.append([*map(value_text, design.values.values()), *answers, design.reason])
        # Without failures the column of reasons is empty.
        return rows if self.failed else [row[:-1] for row in rows]


def answer_of(result: SweepResult) -> Sweep:
    """The answer for the rows of a family, which are read once."""
    tallies = [_SpanTally() for _ in result.questions]
    reasons: dict[str, int] = {}
    failed = count = 0
    for row in result.rows:
        count += 1
        if row.failed:
            failed += 1
            reasons[row.reason] = reasons.get(row.reason, 0) + 1
        for tally, value, unit in zip(tallies, row.values, row.units, strict=True):
            tally.note(row, value, unit)
    ordered = sorted(reasons.items(), key=lambda item: -item[1])
    spans = tuple(
        tally.span(result, question.word)
        for tally, question in zip(tallies, result.questions, strict=True)
    )
    return Sweep(result, spans, dict(ordered), failed, count)


class _SpanTally:
    """Accumulates the range of one requested quantity, row by row."""

    def __init__(self) -> None:
        self._count = 0
        # A dict keeps each unit once, in the order of the rows.
        self._units: dict[str, None] = {}
        self._words: dict[str, int] = {}
        self._least: tuple[float, DesignRow] | None = None
        self._greatest: tuple[float, DesignRow] | None = None

    def note(self, row: DesignRow, value: float | str | None, unit: str) -> None:
        if value is None:
            return
        self._count += 1
        if isinstance(value, str):
            self._words[value] = self._words.get(value, 0) + 1
            return
        self._units[unit] = None
        if self._least is None or value < self._least[0]:
            self._least = value, row
        if self._greatest is None or value > self._greatest[0]:
            self._greatest = value, row

    def span(self, result: SweepResult, word: str) -> Span:
        least, greatest = (
            None if extreme is None or len(self._units) > 1 else _design(result, extreme[1])
            for extreme in (self._least, self._greatest)
        )
        words = dict(sorted(self._words.items()))
        return Span(word, tuple(sorted(self._units)), self._count, least, greatest, words)


def _design(result: SweepResult, row: DesignRow, mixed: frozenset[str] = frozenset()) -> Design:
    words = [question.word for question in result.questions]
    values = result.family.edits(row.point)
    answers = dict(zip(words, row.values, strict=True))
    units = {word: unit for word, unit in zip(words, row.units, strict=True) if word in mixed}
    return Design(values, answers, units, row.reason)


# -- document -------------------------------------------------------------------------------------
# The keys of its JSON document.


DESIGN: Final = Key(
    "A design of the family.",
    {
        "values": "Values of the design by the keys that vary, in the units of the scene.",
        "answers": "Values of the requested quantities, in their units; null where there is none.",
        "units": "Units of those answers that designs state in different ones.",
        "reason": "Why a value is missing; empty if nothing failed.",
    },
)

DOCUMENT: Final = Key(
    "The designs of a family, with the requested quantities of each.",
    {
        "scene": Key(
            "The scene that the family starts from.",
            {
                "name": "Name of the scene.",
                "sha256": Key(
                    "SHA-256 of everything that it states but [sweep], hexadecimal.", of="identity"
                ),
            },
        ),
        "keys": Key("The keys of the scene that vary.", of="result.family.keys"),
        "sample": Key(
            "How designs were drawn; null for all combinations.",
            {
                "method": "Sequence of the samples.",
                "seed": "Seed of the sequence.",
            },
            of="result.family.sample",
        ),
        "count": "Number of designs.",
        "failed": "Number of designs that lack a value, with a reason.",
        "questions": Key(
            "The requested quantities, in the order of the answers.",
            {
                "asked": Key(
                    "Name of a finding, or of a column after min:, max: or peak:.", of="word"
                ),
                "unit": (
                    "Unit of the numbers; empty without one, or if designs state them in different"
                    " ones."
                ),
                "count": "Number of designs with a value.",
                "least": Key(
                    "The design with the least number, the first of several; null if no answer is"
                    " a number, or if units differ.",
                    DESIGN,
                ),
                "greatest": Key("The design with the greatest number, likewise.", DESIGN),
            },
            of="spans",
        ),
        "designs": Key("All designs, in the order of the family.", DESIGN),
    },
    type=Sweep,
)


# -- rendering ------------------------------------------------------------------------------------
# The answer of `camgeo sweep` as text and as a table.


FEW: Final = 40
"""Most rows that are printed; of a larger family, only the least and the greatest values."""

MOST_REASONS: Final = 8

LONGEST: Final = 100
"""Characters of a reason that are printed."""

REASON: Final = "reason"


def text(answer: Sweep) -> str:
    """All rows of a small family; of a larger one the range of each quantity, and the failures."""
    lines = [f"{answer.scene.name}: {counted(answer.count, 'design')}{_sample_text(answer)}"]
    rows = answer.cells
    if answer.failed:
        rows = [[*row[:-1], shortened(row[-1], LONGEST)] for row in rows]
    if rows:
        lines += ["", *aligned(rows)]
    else:
        for span in answer.spans:
            lines += ["", *_span(span, answer.scene.unit)]
    if answer.failed:
        lines += ["", f"{counted(answer.failed, 'design')} failed:"]
        for reason, count in list(answer.reasons.items())[:MOST_REASONS]:
            lines.append(f"  {count:>7,}  {shortened(reason, LONGEST)}")
        rest = len(answer.reasons) - MOST_REASONS
        if rest > 0:
            lines.append(f"           and for {counted(rest, 'other reason')}")
    return "\n".join(lines)


def _sample_text(answer: Sweep) -> str:
    sample = answer.result.family.sample
    if sample is None:
        return ""
    return f", drawn with {sample.method}, seed {sample.seed}"


def _span(span: Span, length: LengthUnit) -> list[str]:
    """The least and the greatest value of a quantity, each with its design."""
    head = headed(span, length)
    if span.words:
        answer_text = ", ".join(f"{word} {count:,}" for word, count in span.words.items())
        return [f"{head}: {answer_text}"]
    if span.mixed:
        return [f"{head}: {counted(span.count, 'answer')} in different units, {listed(span.units)}"]
    if span.least is None or span.greatest is None:
        return [f"{head}: no design has a value"]
    lines = [f"{head}: {counted(span.count, 'answer')}"]
    for what, design in (("least", span.least), ("greatest", span.greatest)):
        answer_text, _ = display_value(length, design.answers[span.word], span.unit)
        values = ", ".join(f"{key} = {value_text(value)}" for key, value in design.values.items())
        lines.append(f"  {what:8}  {answer_text}  at {values}")
    return lines


def headed(span: Span, length: LengthUnit = "mm") -> str:
    """Heading of a column, with the unit of its values if they have one, in a unit of length."""
    unit, _ = unit_and_divisor(span.unit, length)
    return f"{span.word} [{unit}]" if unit else span.word


def _answer(design: Design, word: str, common: str, length: LengthUnit) -> tuple[str, str]:
    """A value as text, with its unit where that is not the `common` one of the column."""
    design_unit = design.units.get(word, "")
    answer_text, unit = display_value(length, design.answers[word], design_unit or common)
    return answer_text, unit if design_unit else ""


def display_value(length: LengthUnit, value: object, unit: str) -> tuple[str, str]:
    """A value and its `unit` for reading, in the unit of length of a scene."""
    unit, divisor = unit_and_divisor(unit, length)
    return value_text(value / divisor if isinstance(value, float) else value), unit


def value_text(value: object) -> str:
    """A value as printed: "-" for none, numbers with seven digits."""
    if value is None:
        return "-"
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:.7g}" if isinstance(value, float) else str(value)


def comma_separated(answer: Sweep) -> bytes:
    """All rows as CSV in UTF-8; each number in the shortest form that reads back the same.

    Where designs state an answer in different units, a column with them follows.
    """

    def rows() -> Iterator[list[object]]:
        heads: list[object] = list(answer.result.family.keys)
        for span in answer.spans:
            heads += [headed(span), *([f"{span.word} unit"] if span.mixed else [])]
        yield [*heads, REASON]
        for design in answer.designs:
            cells: list[object] = list(design.values.values())
            for word, value in design.answers.items():
                cells += [value, *([design.units[word]] if word in design.units else [])]
            yield [*cells, design.reason]

    return encode_csv(rows())


def encode_csv(rows: Iterable[Iterable[object]]) -> bytes:
    """Rows as CSV in UTF-8: numbers in the shortest form that reads back the same, None as an empty
    cell.
    """
    buffer = io.BytesIO()
    stream = io.TextIOWrapper(buffer, "utf-8", newline="")
    spelled = (
        [str(cell).lower() if isinstance(cell, bool) else cell for cell in row] for row in rows
    )
    csv.writer(stream, lineterminator="\n").writerows(spelled)
    # The wrapper keeps the last characters until it is flushed.
    stream.flush()
    return buffer.getvalue()


# -- command line ----------------------------------------------------------------------------------


STORE: Final = ".sqlite"

SUFFIXES: Final = (STORE, ".csv", ".json")

KINDS: Final = ("map", "parallel", "pareto")

METHODS: Final = ("sobol", "random")

EXAMPLE: Final = (
    "camgeo sweep fixtures/scenes/setzhub.toml --vary follower.base_radius=40:60:21"
    " --vary motion.2.law=modified-sine,polynomial-345"
    " --ask transmission-angle,peak:a,diameter -o runs.sqlite\n"
    "  camgeo sweep my-cam.toml --vary follower.base_radius=30:60"
    " --vary follower.roller_radius=5:12 --samples 256 --ask verdict,transmission-angle -o runs.csv"
)


ARGUMENTS: Final = (
    SCENE_FILE,
    repeated_option(
        "--vary",
        "KEY=VALUES",
        "values of a key: START:STOP:COUNT, a list as 5,6,7, or START:STOP with --samples;"
        " KEY,KEY=VALUES ties keys together, VALUE/VALUE for different values; may be repeated",
    ),
    repeated_option(
        "--ask",
        "NAMES",
        "what is computed of each design: findings as transmission-angle, columns of the value"
        " table as peak:a, max:NAME or min:NAME, diameter, machining-time, verdict;"
        " comma-separated",
    ),
    Argument("--samples", metavar="COUNT", type=int, help="draw this many designs"),
    Argument("--method", choices=METHODS, help="how designs are drawn; default sobol"),
    Argument("--seed", type=int, help="seed of the samples; default 0"),
    repeated_option(
        "-o",
        "FILE",
        f"rows, {', '.join(SUFFIXES)}; only a store can be resumed; may be repeated",
        suffix_type(SUFFIXES),
        "output",
    ),
    Argument(
        "--picture",
        metavar="FILE",
        type=suffix_type(IMAGES),
        help=f"also draw a picture, {', '.join(IMAGES)}",
    ),
    Argument(
        "--show",
        choices=KINDS,
        help="what it shows: a map over one or two keys, parallel axes, or the Pareto front;"
        " default: the front with --least or --largest, else a map, or axes for more keys",
    ),
    *objective_options("objectives of the front: what of the answers should be {}"),
    ArgumentGroup(
        WORKERS,
        Argument(
            "--cluster",
            metavar="ADDRESS",
            help="compute by the workers of a Dask scheduler, tls://HOST:PORT, or on this machine"
            " tcp://127.0.0.1:PORT; needs the extra camgeo[cluster]",
        ),
    ),
    ArgumentGroup(
        Argument("--resume", action="store_true", help="compute only what the store does not have"),
        FORCE,
    ),
)


def run(arguments: argparse.Namespace) -> int:
    """Sweep, and print or write the answer."""
    store, files = _outputs(arguments)
    cluster = arguments.cluster
    engine = engine_for(arguments.workers) if cluster is None else engine_of("cluster", cluster)
    sample = None
    if arguments.samples is not None:
        sample = Sample(arguments.samples, arguments.method or "sobol", arguments.seed or 0)
    elif arguments.method is not None or arguments.seed is not None:
        raise CallError("--method and --seed need --samples")
    scene = load_scene(arguments.scene)
    family = family_of(scene, arguments.vary, sample)
    ask = question_names(scene, arguments.ask)
    draw = _picture(arguments, family, ask)
    try:
        result = sweep(
            family,
            ask,
            store=store,
            existing="resume" if arguments.resume else "replace" if arguments.force else "refuse",
            engine=engine,
            progress=arguments.progress,
        )
    except KeyboardInterrupt:
        if store is not None and store.exists():
            old = ", or the old ones if none were" if arguments.force else ""
            notify(f"{store}: keeps the rows that were finished{old}; --resume computes the others")
        raise
    try:
        answer = answer_of(result)
        if store is not None:
            known_count = answer.count - result.computed
            known = f", {known_count:,} of them known before" if known_count else ""
            notify(f"{store}: {counted(answer.count, 'row')}{known}")
        written = [_written(answer, file) for file in files]
        return show(answer, arguments, [*written, *draw(result)])
    finally:
        result.close()


def _picture(
    arguments: argparse.Namespace, family: Family, ask: Sequence[str]
) -> Callable[[SweepResult], list[Written]]:
    """A function that draws the picture; a wrong call is refused before anything is computed."""
    least, largest = split_names(arguments.least), split_names(arguments.largest)
    if arguments.picture is None:
        if arguments.show or least or largest:
            raise CallError("--show, --least and --largest need --picture")
        return lambda _: []
    from camgeo.pictures import sweep as pictures

    usual = "pareto" if least or largest else "map" if len(family.variables) < 3 else "parallel"
    kind = arguments.show or usual
    if (kind == "pareto") != bool(least or largest):
        raise CallError("--show pareto, and no other, needs --least or --largest")
    pictures.require(family, kind)
    if kind == "pareto":
        pictures.objectives(ask, least, largest)

    path = Path(arguments.picture)

    def draw(result: SweepResult) -> list[Written]:
        if kind == "pareto":
            figure = pictures.pareto(result, least, largest)
        else:
            figure = pictures.PICTURES[kind](result)
        return [(path, draw_figure(figure, path.suffix), kind)]

    return draw


def _outputs(arguments: argparse.Namespace) -> tuple[Path | None, Sequence[Path]]:
    """The store, and the other files."""
    paths = [Path(name) for name in arguments.output]
    stores = [path for path in paths if path.suffix == STORE]
    files = [path for path in paths if path.suffix != STORE]
    if len(stores) > 1:
        raise CallError("-o may name one store only")
    if arguments.resume and not stores:
        raise CallError(f"--resume needs a store: -o FILE{STORE}")
    all_files = [*files, *map(Path, filter(None, [arguments.picture]))]
    if len({path.parent for path in all_files}) > 1 or len(set(files)) < len(files):
        raise CallError("-o and --picture must name different files in one folder")
    if not stores:  # which keeps what is computed
        require_new(all_files, arguments)
    return (stores[0] if stores else None), files


def _written(answer: Sweep, path: Path) -> Written:

    rows = counted(answer.count, "row")
    if path.suffix == ".csv":
        return path, comma_separated(answer), rows
    return path, document(answer).encode(), rows
