"""Rows of a sweep, and the work that computes them, in the form in which workers receive it."""

from __future__ import annotations

import math
import pkgutil
import platform
import time
from collections.abc import Callable, Generator, Hashable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, fields, replace
from functools import cached_property, lru_cache, partial
from itertools import islice
from operator import length_hint
from pathlib import Path
from typing import Any, Final, Literal, Protocol

import numpy as np

from camgeo._version import __version__
from camgeo.cam.cam import Disc, Drive
from camgeo.check.disc import (
    check_standstill,
    check_transmission_angle,
    transmission_angle_extremes,
    transmission_angle_limit,
)
from camgeo.check.finding import Finding, forbidding
from camgeo.check.judge import motion_findings, worst
from camgeo.check.machine import linkage_findings
from camgeo.design.design import Design
from camgeo.design.value_table import (
    Columns,
    bare,
    effect_column,
    quantities_of_disc,
    quantities_of_drive,
)
from camgeo.errors import (
    CamgeoError,
    EffectError,
    GeometryError,
    SceneError,
    ToleranceError,
    UnknownNameError,
    VersionError,
)
from camgeo.geometry.pieces import turn_enclosed
from camgeo.geometry.together import Member, Together, alike, one_curve, one_motion, several
from camgeo.lazy import Ledger
from camgeo.numeric.arrays import ONE, FloatArray, IntArray, Quantity, merged
from camgeo.numeric.extremes import BOTH, BOTTOMS, TOPS, Extremes, piecewise_extremes_of_many
from camgeo.scene.scene import Scene
from camgeo.scene.values import Source, document, document_of_tree, with_edits
from camgeo.studies.sweep.family import Family, Point
from camgeo.units import counted, shortened

NOWHERE: Final = Path("/camgeo-sweep-has-no-folder")
"""Folder of the scenes of a sweep, which does not exist. A worker has the contents of the files
that scenes name, and must not read another file of its own computer under the same name."""

FOLLOWER: Final = "follower."
"""Prefix of the keys of the follower."""

MOST_BEGUN: Final = 64
"""Number of scenes that are kept for others to share their plan, so that memory stays bounded."""

MOST_TOGETHER: Final = 64
"""Number of designs that are computed at once: with 256, each would cost only 2 to 6 % less."""

LISTED: Final = "; "
"""Separates the reasons of one row."""


@dataclass(frozen=True, slots=True)
class DesignRow:
    """The answers of one design of a family.

    Attributes
    ----------
    point : the values that make the design.
    values : the answers in the order of the questions; None where there is no answer.
    units : the units of the answers; empty where there is none.
    reason : why an answer is missing; empty if none is, or if that is no failure, as for a finding
        that does not arise for this design.
    """

    point: Point
    values: tuple[float | str | None, ...]
    units: tuple[str, ...]
    reason: str = ""

    @property
    def failed(self) -> bool:
        """Whether a question has no answer."""
        return bool(self.reason)


@dataclass(frozen=True, slots=True)
class Versions:
    """What decides the bits of a row: the versions of camgeo, numpy and Python."""

    camgeo: str
    numpy: str
    python: str

    @classmethod
    def here(cls) -> Versions:
        """The versions of this process."""
        return cls(__version__, np.__version__, platform.python_version())

    def require_here(self) -> None:
        """Raise VersionError, naming what differs, unless this process has the same."""
        here = self.here()
        for name in ("camgeo", "numpy", "python"):
            mine, theirs = getattr(here, name), getattr(self, name)
            if mine != theirs:
                label = name.capitalize() if name == "python" else name
                raise VersionError(
                    f"a worker has {label} {mine}, the sweep was started with {theirs}; rows of"
                    " both would not be comparable"
                )


@dataclass(frozen=True)
class Work:
    """All that a worker needs, wherever it runs; it can be pickled.

    Attributes
    ----------
    text : TOML text of the scene from which the family starts.
    contents : names and contents of the files that designs name.
    keys : the keys that vary.
    questions : what is asked of each design.
    versions : the versions with which the rows have to be computed.
    """

    text: str
    contents: tuple[tuple[str, bytes], ...]
    keys: tuple[str, ...]
    questions: tuple[Question, ...]
    versions: Versions

    @classmethod
    def for_family(cls, family: Family, questions: Iterable[Question]) -> Work:
        """The work on a family, for processes with the versions of this one."""
        contents = tuple(sorted(family.contents().items()))
        text = family.scene.to_toml()
        return cls(text, contents, family.keys, tuple(questions), Versions.here())

    def __getstate__(self) -> dict[str, Any]:
        """The fields alone: whoever receives the work builds the scene from them."""
        return {attribute.name: getattr(self, attribute.name) for attribute in fields(self)}

    @cached_property
    def source(self) -> Source:
        """From where scenes get the contents of their files."""
        folder = NOWHERE.resolve() if self.contents else None
        return Source("", folder, self.text).having(dict(self.contents))

    @cached_property
    def base(self) -> Scene:
        """The scene from which the family starts; VersionError in a process of other versions."""
        self.versions.require_here()
        return Scene.from_document(document(self.text.encode()), self.source)

    @cached_property
    def _begun(self) -> dict[Hashable, Scene]:
        """A scene for each of the latest combinations of values outside the follower.

        Whatever does not depend on the follower, above all the motion plan, is taken over from it
        by all designs with these values.
        """
        return {}

    def design_scene(self, point: Point) -> Scene:
        """The scene of a design; SceneError with all its faults if it is wrong."""
        edits = dict(zip(self.keys, point, strict=True))
        follower_edits = {key: value for key, value in edits.items() if key.startswith(FOLLOWER)}
        others = tuple(
            (type(value), value) for key, value in edits.items() if key not in follower_edits
        )
        earlier = self._begun.get(others)
        start, edits = (self.base, edits) if earlier is None else (earlier, follower_edits)
        tree = with_edits(start.stated.scene.exact, edits)
        document = document_of_tree(tree, earlier=start.stated.scene)
        scene = Scene.from_document(document, self.source, start)
        if earlier is None:
            while len(self._begun) >= MOST_BEGUN:
                self._begun.pop(next(iter(self._begun)))
            self._begun[others] = scene
        return scene

    def rows(self, points: Sequence[Point], ledger: Ledger | None = None) -> list[DesignRow]:
        """The rows of designs, each with the bits that it has alone; with the reason if its scene
        is wrong.

        Questions that can be answered for many designs at once are.
        """
        base = self.base
        assert base is not None  # errors of the base are raised here, not reported for each design
        row_by_number: dict[int, DesignRow] = {}
        designs: dict[int, Design] = {}
        for number, point in enumerate(points):
            try:
                scene = self.design_scene(point)
                designs[number] = Design(scene) if ledger is None else Design(scene, ledger)
            except MemoryError:
                raise  # which is not the design's fault
            except Exception as error:
                row_by_number[number] = self.nothing(point, failure_reason(error))
        answers = self._together(designs)
        for number in [*designs]:
            design = designs.pop(number)  # frees the memory of all that it has computed
            readings = [
                answers.get((number, question.word)) or read(design, question)
                for question in self.questions
            ]
            row_by_number[number] = self.answers(design, points[number], readings)
        return [row_by_number[number] for number in range(len(points))]

    def nothing(self, point: Point, reason: str) -> DesignRow:
        """The row of a design without any answers, for a `reason`."""
        count = len(self.questions)
        return DesignRow(point, (None,) * count, ("",) * count, reason)

    def _together(self, designs: Mapping[int, Design]) -> dict[tuple[int, str], DesignReading]:
        """The readings that are computed for many designs at once, by number and question."""
        words = [question for question in self.questions if question.group in TOGETHER]
        groups: dict[Hashable, list[int]] = {}
        for number, design in sorted(designs.items(), key=_linkage) if words else ():
            groups.setdefault(alike_designs(design), []).append(number)
        return {
            (number, question.word): reading
            for numbers in groups.values()
            for question in words
            for number, reading in zip(
                numbers,
                read_together([designs[member] for member in numbers], question),
                strict=True,
            )
        }

    def answers(self, design: Design, point: Point, readings: Sequence[DesignReading]) -> DesignRow:
        """The row of a design from its `readings`, one for each question."""
        reasons: dict[str, list[str]] = {}
        for question, reading in zip(self.questions, readings, strict=True):
            if reading.reason:
                reasons.setdefault(reading.reason, []).append(question.word)
        stated = [f"{', '.join(words)}: {reason}" for reason, words in reasons.items()]
        return DesignRow(
            point,
            tuple(reading.value for reading in readings),
            tuple(reading.unit for reading in readings),
            LISTED.join(stated),
        )


def _linkage(item: tuple[int, Design]) -> int:
    """Sort key by which designs with the same linkage follow each other.

    They share their motion, of which the plan keeps only the last one.
    """
    return id(item[1].scene.linkage)


def compute_rows(work: Work, points: Iterable[Point]) -> tuple[DesignRow, ...]:
    """The rows of several designs, as a worker computes them."""
    known, rest = _known(work), iter(points)
    rows: list[DesignRow] = []
    while some := tuple(islice(rest, MOST_TOGETHER)):
        rows += known.rows(some)
    return tuple(rows)


def compute_timed_rows(work: Work, points: Iterable[Point]) -> tuple[tuple[DesignRow, ...], float]:
    """The rows of several designs, and the seconds that they took."""
    start = time.perf_counter()
    return compute_rows(work, points), time.perf_counter() - start


@lru_cache(maxsize=1)
def _known(work: Work) -> Work:
    """The first of equal copies of the work, which has built its scene already."""
    return work


# -- engine ---------------------------------------------------------------------------------------
# Engines compute the rows of a family: where, and how many at a time.
#
# An engine has a name and `rows`; it is registered in `ENGINES` by the path of its class, which is
# imported when it is requested. It neither writes the store nor decides what is computed: it takes
# points from the iterator as it can use them, and returns rows in any order. If its generator is
# closed, it ends what it has started. A row depends on its design alone, so all engines return the
# same rows.


CHUNK: Final = 1.0
"""Seconds that a chunk of designs should take: far more than the 6 ms that it costs to hand one
over, and no more than a run may lose when it is stopped."""

MOST_IN_CHUNK: Final = 1000

GROWTH: Final = 8
"""Largest growth from one chunk to the next, as the first designs may not be typical."""

AHEAD: Final = 2
"""Chunks handed out for each worker: while one is computed, the next one is waiting already."""

DIED: Final = "the process that computed it died, {times}: killed, or out of memory"


Chunks = Generator[tuple[DesignRow, ...], None, None]
"""Rows in chunks, as they are finished; closing it ends the work."""


class Engine(Protocol):
    """Computes rows, in this process or elsewhere."""

    @property
    def name(self) -> str: ...

    def rows(self, work: Work, points: Iterator[Point]) -> Chunks:
        """The rows of all points, in any order, in chunks as they are finished.

        The chunk of a worker that dies is computed again. The row of a design that keeps ending its
        worker says so. Raises VersionError if a worker has other versions.
        """
        ...

    def held(self) -> AbstractContextManager[None]:
        """Within this context, the workers of one call of `rows` stay for the next one."""
        ...


class Pace:
    """Determines how many designs make a chunk of about a second, from the times of earlier chunks.

    Parameters
    ----------
    workers : number of workers; the last designs are shared out evenly, if their number is known.
    """

    def __init__(self, workers: int = 1) -> None:
        self._size = 1
        self._workers = workers

    def take(self, points: Iterator[Point]) -> tuple[Point, ...]:
        """The points of the next chunk; none if there are none left."""
        # The hint is exact for a list iterator, and the default is never the smaller number.
        share = -(-length_hint(points, MOST_IN_CHUNK * self._workers) // self._workers)
        return tuple(islice(points, min(self._size, max(share, 1))))

    def note(self, count: int, seconds: float, least: float = 0.0) -> None:
        """Note that a chunk of `count` designs took `seconds`.

        The next chunks are to take at least `least` seconds.
        """
        fitting = int(max(CHUNK, least) * count / max(seconds, 1e-9))
        self._size = max(1, min(fitting, GROWTH * self._size, MOST_IN_CHUNK))


class Loop:
    """Computes designs in this process, one chunk after the other."""

    name = "loop"

    def __init__(self, _where: int | str = 1) -> None:
        pass

    def rows(self, work: Work, points: Iterator[Point]) -> Chunks:
        """See `Engine.rows`."""
        pace = Pace()
        while chunk := pace.take(points):
            chunk_rows, seconds = compute_timed_rows(work, chunk)
            pace.note(len(chunk), seconds)
            yield chunk_rows

    def held(self) -> AbstractContextManager[None]:
        """See `Engine.held`: there is no other process."""
        return nullcontext()


ENGINES: Final = {
    "loop": "camgeo.studies.sweep.rows:Loop",
    "pool": "camgeo.studies.sweep.pool:Pool",
    "cluster": "camgeo.studies.sweep.cluster:Cluster",
}
"""Paths of the classes of engines, by their names. Each class takes one argument: the pool the
number of its processes, the cluster the address of its scheduler."""


def engine_of(name: str, where: int | str = 1) -> Engine:
    """The engine `name`; `where` is the number of workers or the address of the scheduler.

    Raises UnknownNameError if there is no such engine, GeometryError for an invalid number or
    address.
    """
    if name not in ENGINES:
        raise UnknownNameError("engine", name, ENGINES)
    engine: Engine = pkgutil.resolve_name(ENGINES[name])(where)
    return engine


def dead(work: Work, point: Point, times: int) -> DesignRow:
    """The row of a design that ended its process `times` times."""
    return work.nothing(point, DIED.format(times=counted(times, "time")))


# -- reading --------------------------------------------------------------------------------------
# The answers of a design to questions. Nothing else is computed.


LONGEST_REASON: Final = 400
"""Largest number of characters of a reason; a scene with many faults would have more."""


class NoValueError(Exception):
    """A design has no answer; the message is the reason, empty if no answer was to be expected."""


@dataclass(frozen=True, slots=True)
class DesignReading:
    """The answer of a design to a question: a number in `unit`, or a word.

    `value` is None if there is no answer; `reason` says why, unless none was to be expected.
    """

    value: float | str | None
    unit: str = ""
    reason: str = ""


def read(design: Design, question: Question) -> DesignReading:
    """The answer of a design to a question. Every error except MemoryError becomes a reason."""
    try:
        reading = ANSWERS[question.group](design, question)
    except NoValueError as none:
        return DesignReading(None, reason=in_a_line(str(none)))
    except MemoryError:
        raise  # which is not the design's fault
    except Exception as error:
        return DesignReading(None, reason=failure_reason(error))
    return _finite_reading(reading)


def _finite_reading(reading: DesignReading) -> DesignReading:
    """The reading if it is finite; else one without a value, and with the reason."""
    if isinstance(reading.value, float):
        if not math.isfinite(reading.value):
            return DesignReading(None, reading.unit, reading.reason or "is infinite")
        return DesignReading(
            reading.value + 0.0, reading.unit, in_a_line(reading.reason)
        )  # no -0.0
    return reading


def read_together(designs: Sequence[Design], question: Question) -> list[DesignReading]:
    """The answer of each design, with the same bits as by `read`; designs that are alike at once.

    Where that fails, some design has no answer: halves are tried, down to a single design.
    """
    if len(designs) == 1:
        return [read(designs[0], question)]
    try:
        readings = TOGETHER[question.group](designs, question)
    except MemoryError:
        raise  # which is not the designs' fault
    except Exception:
        half = len(designs) // 2
        return read_together(designs[:half], question) + read_together(designs[half:], question)
    return [_finite_reading(reading) for reading in readings]


def alike_designs(design: Design) -> Hashable:
    """A key that is equal for designs that may be computed together.

    These differ in numbers of follower and linkage only, and in what none of the questions that are
    answered `TOGETHER` depends on.
    """
    scene = design.scene
    drive = id(scene.plan), scene.speed, id(scene.speed_curve)
    units = scene.unit, scene.lift_unit
    disc = scene.rotation, scene.contact, scene.side_clearance
    bodies = (None if body is None else alike(body) for body in (scene.linkage, scene.follower))
    return drive, units, disc, *bodies


def failure_reason(error: Exception) -> str:
    """Why a design is impossible or has no answer, in one line."""
    if isinstance(error, SceneError):
        return in_a_line("; ".join(str(fault) for fault in error.faults))
    if isinstance(error, CamgeoError):
        return in_a_line(str(error))
    return in_a_line(f"internal error: {type(error).__name__}: {error}")


def in_a_line(text: str) -> str:
    """The text in one line, shortened to `LONGEST_REASON`."""
    return shortened(" ".join(text.split()), LONGEST_REASON)


# Findings -----------------------------------------------------------------------------------------


def _finding_reading(
    findings: Iterable[Finding], name: str, why: Callable[[], str] = str
) -> DesignReading:
    """The value of the first finding `name`; NoValueError with the reason `why` without one."""
    for finding in findings:
        if hyphened(finding.name) == name:
            value = finding.value
            return DesignReading(None if value is None else float(value), finding.unit)
    raise NoValueError(why())


def _refused(findings: Iterable[Finding]) -> str:
    """The sentences of findings that rule out the disc; empty if there are none."""
    return "; ".join(finding.sentence for finding in forbidding(findings))


def _angle(design: Design, question: Question) -> DesignReading:
    """The transmission angle alone, without the other findings on the disc."""
    cam, limits = design.cam, design.scene.limits
    if not cam.follower.has_pitch_curve:  # an undercut flat face has no transmission angle
        return _disc(design, question)
    findings = linkage_findings(cam.drive, limits)
    if not forbidding(findings):
        curve = cam.disc.pitch_curve
        findings = check_standstill(curve)
        if not forbidding(findings):
            finding = check_transmission_angle(curve, transmission_angle_limit(cam, limits))
            return _finding_reading([finding], question.name)
    raise NoValueError(_refused(findings))


def _angles(designs: Sequence[Design], question: Question) -> list[DesignReading]:
    """The transmission angles of designs that are alike: what they need is computed at once."""
    if designs[0].cam.follower.has_pitch_curve:
        curves = [design.cam.disc.pitch_curve for design in designs]
        turn_enclosed.settle(curves)
        transmission_angle_extremes.settle(curves)
    return [read(design, question) for design in designs]


def _linkage_reading(design: Design, question: Question) -> DesignReading:
    scene = design.scene
    findings = linkage_findings(design.drive, scene.limits)
    return _finding_reading(
        findings, question.name, lambda: "" if findings else "the scene has no [linkage]"
    )


def _motion(design: Design, question: Question) -> DesignReading:
    return _finding_reading(motion_findings(design.drive), question.name)


def _disc(design: Design, question: Question) -> DesignReading:
    return _finding_reading(design.findings, question.name, lambda: _refused(design.findings))


def _part(design: Design, question: Question) -> DesignReading:
    from camgeo.design.judged_part import PartBody, part_findings
    from camgeo.part.mass import Solid, largest_diameter

    scene = design.scene
    if question.name == DIAMETER:
        return DesignReading(largest_diameter(design.disc.drawn.part)[0], "mm")
    if scene.part is None:
        raise NoValueError("the scene has no [part]")
    if question.name == "mass":
        mass = PartBody(Solid.from_part(design.disc.drawn.part), scene.part.density).mass
        if mass is None:
            raise NoValueError("the scene states neither material nor density of the part")
        return DesignReading(mass, "kg")
    return _finding_reading(
        part_findings(design.disc), question.name, lambda: _refused(design.findings)
    )


def _verdict(design: Design, _: Question) -> DesignReading:
    return DesignReading(worst(all_findings(design)))


def _machining(design: Design, _: Question) -> DesignReading:
    from camgeo.design.machining import machining_time  # which few sweeps need

    if forbidding(design.findings):
        raise NoValueError(_refused(design.findings))
    return DesignReading(machining_time(design.discs), "s")


def all_findings(design: Design, *, machining: bool = False) -> list[Finding]:
    """All findings on cam, effects and part that can be computed; with `machining` also those on
    the milling programs.
    """
    from camgeo.design.judged_part import part_findings
    from camgeo.design.product import with_pair

    findings = list(design.findings)
    if not any(finding.severity == "invalid" for finding in findings):
        for name in design.scene.effects:
            findings += design.effects.findings(name)
    if design.scene.follower is not None and not forbidding(design.findings):
        for disc in with_pair(design.discs):
            findings += part_findings(disc)
        if machining and design.scene.milling is not None:
            from camgeo.design.machining import plan_machining

            findings += plan_machining(design.discs).findings
    return findings


# Columns ------------------------------------------------------------------------------------------


def _curves(design: Design, question: Question) -> DesignReading:
    return _curve_readings([design], question)[0]


def _curve_readings(designs: Sequence[Design], question: Question) -> list[DesignReading]:
    """The extremes of a column for designs that are alike."""
    first = designs[0]
    scene = first.scene
    of_drive = partial(quantities_of_drive, lift_unit=scene.lift_unit, unit=scene.unit)
    for place, (heading, quantity) in enumerate(of_drive(first.drive)):
        if hyphened(bare(heading)) == question.name:
            # Designs that differ in the follower only share the drive, and so the answer.
            if all(design.drive.motion is first.drive.motion for design in designs):
                return [_extreme(first, question, heading, quantity)] * len(designs)
            drives = [design.drive for design in designs]
            by_drive = _nth(of_drive, place)
            all_extremes = _extremes_by_design(designs, question, drives, drives_together, by_drive)
            return [_read(extremes, question, heading) for extremes in all_extremes]
    if scene.follower is not None:
        of_disc = partial(quantities_of_disc, unit=scene.unit)
        for place, (heading, _) in enumerate(of_disc(first.cam.disc)):
            if hyphened(bare(heading)) == question.name:
                discs = [design.cam.disc for design in designs]
                by_disc = _nth(of_disc, place)
                all_extremes = _extremes_by_design(
                    designs, question, discs, discs_together, by_disc
                )
                return [_read(extremes, question, heading) for extremes in all_extremes]
    raise NoValueError(f'has no column "{question.name}"')


def _nth(columns: Callable[[Member], Columns], place: int) -> Callable[[Member], Quantity]:
    """The function that returns the quantity of the column at `place`."""
    return lambda member: columns(member)[place][1]


def drives_together(drives: Sequence[Drive]) -> Together[Drive]:
    """Drives that differ only in numbers of their linkages, as one drive with arrays."""

    def joined(some: tuple[Drive, ...], which: IntArray, times: int) -> Drive:
        one = replace(some[0], ledger=Ledger())
        # A quantity that is computed once is an entry of the object's dictionary, which it may be
        # given in advance.
        vars(one)["motion"] = one_motion([drive.motion for drive in some], which, times)
        return one

    return Together(tuple(drives), joined)


def discs_together(discs: Sequence[Disc]) -> Together[Disc]:
    """Discs that differ only in numbers of followers and linkages, as one disc with arrays.

    Only the curves of that disc can be used.
    """

    def joined(some: tuple[Disc, ...], which: IntArray, times: int) -> Disc:
        follower = several([disc.follower for disc in some], which)
        one = replace(some[0], follower=follower, ledger=Ledger())
        vars(one)["pitch_curve"] = one_curve([disc.pitch_curve for disc in some], which, times)
        return one

    return Together(tuple(discs), joined)


def _extremes_by_design(
    designs: Sequence[Design],
    question: Question,
    members: Sequence[Member],
    together: Callable[[Sequence[Member]], Together[Member]],
    quantity: Callable[[Member], Quantity],
) -> list[Extremes]:
    """The extremes of a quantity for `members`, the drives or discs of designs that are alike.

    They are computed at once for those whose motion is smooth between the same angles.
    """
    groups: dict[bytes, list[int]] = {}
    for number, design in enumerate(designs):
        groups.setdefault(design.drive.smooth_angles.tobytes(), []).append(number)
    extremes: dict[int, Extremes] = {}
    for numbers in groups.values():
        edges = designs[numbers[0]].drive.smooth_angles
        some = together([members[number] for number in numbers])
        with np.errstate(all="ignore"):  # a value that is not finite has a reason
            group_extremes = piecewise_extremes_of_many(
                some, quantity, edges, EXTREMES[question.how][0]
            )
        extremes |= zip(numbers, group_extremes, strict=True)
    return [extremes[number] for number in range(len(designs))]


def _effects(design: Design, question: Question) -> DesignReading:
    """The value of a finding of an effect, or the extreme of its column."""
    why = ""
    for name in question.effects:
        try:
            result = design.effect(name)
        except EffectError as error:
            why = why or error.message
            for finding in design.effects.findings(name):
                if hyphened(finding.name) == question.name and finding.value is not None:
                    return DesignReading(float(finding.value), finding.unit, error.message)
            continue
        if question.how == "value":
            for finding in result.findings:
                if hyphened(finding.name) == question.name:
                    return _finding_reading([finding], question.name)
            continue
        for column in result.columns:
            if hyphened(column.name) == question.name:
                heading, quantity = effect_column(design.scene.unit, column)
                return _extreme(design, question, heading, quantity, column.borders)
    if not why and question.how != "value":
        why = f'has no column "{question.name}"'
    raise NoValueError(why)


def _extreme(
    design: Design,
    question: Question,
    heading: str,
    quantity: Quantity,
    borders: FloatArray | None = None,
) -> DesignReading:
    """The extreme of a column of one design; the column may have further `borders` [rad]."""
    edges = design.drive.smooth_angles
    if borders is not None and len(borders):
        edges = merged(np.concatenate((edges, borders)))
    with np.errstate(all="ignore"):  # a value that is not finite has a reason
        (extremes,) = piecewise_extremes_of_many(ONE, quantity, edges, EXTREMES[question.how][0])
    return _read(extremes, question, heading)


def _read(extremes: Extremes, question: Question, heading: str) -> DesignReading:
    """The extreme that a question asks for, in the unit in brackets at the end of `heading`."""
    unit = heading.rpartition(" [")[2].removesuffix("]") if heading.endswith("]") else ""
    return DesignReading(EXTREMES[question.how][1](extremes), unit)


EXTREMES: Final[dict[str, tuple[tuple[float, ...], Callable[[Extremes], float]]]] = {
    "min": (BOTTOMS, lambda found: found.lowest.value),
    "max": (TOPS, lambda found: found.highest.value),
    "peak": (BOTH, lambda found: found.magnitude),
}
"""By the prefix of a column's name the turning points that are refined, and the extreme that is
asked for. A transmission angle has a kink at 90 degrees, which no grid resolves, and who asks for
its least value need not know where.
"""

ANSWERS: Final[dict[Group, Callable[[Design, Question], DesignReading]]] = {
    "angle": _angle,
    "linkage": _linkage_reading,
    "motion": _motion,
    "part": _part,
    "disc": _disc,
    "verdict": _verdict,
    "machining": _machining,
    "curves": _curves,
    "effects": _effects,
}

TOGETHER: Final[dict[Group, Callable[[Sequence[Design], Question], list[DesignReading]]]] = {
    "angle": _angles,
    "curves": _curve_readings,
}
"""Questions that are answered for many designs at once, if these are alike."""


# -- asked ----------------------------------------------------------------------------------------
# Questions to each design of a family, by the names of findings and of value-table columns.
#
# A bare name asks for the value of a finding. `min:`, `max:` and `peak:` (the largest magnitude)
# before the name of a column ask for its extremes over the revolution. Names are written with
# hyphens or spaces. A name is looked up once, in the scene from which the family starts, so that
# only what answers it is computed for each design.


Group = Literal[
    "angle", "linkage", "motion", "part", "disc", "verdict", "machining", "curves", "effects"
]
"""What is computed: the transmission angle, the linkage, the motion, the part, all findings on the
disc, the worst severity of all findings, the milling programs, columns of motion and cam, or
effects.
"""

VERDICT: Final = "verdict"
"""Question for the worst severity of all findings on cam, effects and part, which is a word."""

DIAMETER: Final = "largest-diameter"

MACHINING_TIME: Final = "machining-time"
"""Question for the running time of the milling programs of all discs."""

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
"""Names of findings by their group. Other findings on the disc are looked up in the scene."""

POLES: Final = ("r_K",)
"""Columns that are infinite somewhere and therefore have no extremes."""

MOST: Final = 100
"""Largest number of questions at once."""


@dataclass(frozen=True, slots=True)
class Question:
    """A question to each design: for one quantity.

    Attributes
    ----------
    word : heading of its column of answers, as `peak:contact-force`.
    name : name of the finding or the column, with hyphens.
    how : "value" for a finding, or one of the `EXTREMES` of a column.
    group : what has to be computed for the answer.
    effects : for the group "effects", those that may have the answer.
    """

    word: str
    name: str
    how: str
    group: Group
    effects: tuple[str, ...] = ()


def parse_questions(design: Design, words: Iterable[str]) -> tuple[Question, ...]:
    """The questions that `words` ask of designs like this one, without repetition.

    Raises
    ------
    GeometryError
        If there are no words or too many, if one asks for something without a single value, or for
        the machining time where the scene states no milling.
    UnknownNameError
        For a name that no finding or column has, with the nearest one.
    """
    questions = {
        question.word: question for question in (_parse_question(design, word) for word in words)
    }
    if not questions:
        raise GeometryError("names nothing: state what to ask of each design", "sweep.ask")
    if len(questions) > MOST:
        message = f"{counted(len(questions), 'name')} are more than {MOST}"
        raise GeometryError(message, "sweep.ask")
    return tuple(questions.values())


def _parse_question(design: Design, word: str) -> Question:
    prefix, colon, rest = word.partition(":")
    if colon and prefix.strip() in EXTREMES:
        return _parse_extreme(design, prefix.strip(), hyphened(rest))
    word = hyphened(word)
    name = ALSO.get(word, word)
    for group, names in BY_GROUP.items():
        if name in names:
            if group == "machining" and not design.scene.states_milling:
                message = f"is not stated: {MACHINING_TIME} needs a milling program"
                raise GeometryError(message, "tool")
            return Question(word, name, "value", group)
    seen, silent = _names(
        design, lambda name: (each.name for each in design.effects.findings(name))
    )
    effect = next((candidate for candidate, names in seen.items() if name in names), None)
    if effect is not None:
        return Question(word, name, "value", "effects", (effect,))
    judged = [hyphened(finding.name) for finding in design.findings]
    if name in judged:
        return Question(word, name, "value", "disc")
    effect_columns = _columns(design)[0].values()
    if name in [*_curve_names(design), *(column for names in effect_columns for column in names)]:
        message = f'is a column over the cam angle: ask for "peak:{name}", "max:{name}" or'
        message += f' "min:{name}"'
        raise GeometryError(message, "sweep.ask", f'"{word}"')
    if silent:  # effects without an answer here may have this finding in another design
        return Question(word, name, "value", "effects", silent)
    known = [name for names in BY_GROUP.values() for name in names]
    there = [*known, *ALSO, *(finding for names in seen.values() for finding in names), *judged]
    raise UnknownNameError("finding", name, dict.fromkeys(there))


def _parse_extreme(design: Design, how: str, name: str) -> Question:
    """The question for an extreme of a column, of the motion and cam or of an effect.

    `how` is one of peak, max and min. Raises GeometryError for a column that has none, and
    UnknownNameError for a name that no column has.
    """
    word = canonical(f"{how}:{name}")
    if name in (hyphened(pole) for pole in POLES):
        message = "is infinite where the curve is straight, and has no extremes; ask for kappa"
        raise GeometryError(message, "sweep.ask", f'"{word}"')
    curves = _curve_names(design)
    if name in curves:
        return Question(word, name, how, "curves")
    seen, silent = _columns(design)
    effect = next((candidate for candidate, names in seen.items() if name in names), None)
    if effect is not None or silent:
        return Question(word, name, how, "effects", silent if effect is None else (effect,))
    there = [*curves, *(column for names in seen.values() for column in names)]
    raise UnknownNameError("column", name, dict.fromkeys(there))


def canonical(word: str) -> str:
    """A question as it heads its column of answers: without superfluous spaces, with hyphens."""
    prefix, colon, rest = word.partition(":")
    if colon and prefix.strip() in EXTREMES:
        return f"{prefix.strip()}:{hyphened(rest)}"
    return hyphened(word)


def hyphened(name: str) -> str:
    """The name with hyphens in place of spaces."""
    return "-".join(name.split())


def _curve_names(design: Design) -> list[str]:
    from camgeo.design.value_table import quantities

    scene = design.scene
    cam = None if scene.follower is None else design.cam
    columns = quantities(design.drive, scene.lift_unit, cam, scene.unit)
    return [hyphened(bare(heading)) for heading, _ in columns if bare(heading) not in POLES]


Names = tuple[dict[str, list[str]], tuple[str, ...]]
"""Names of findings or columns by effect, and the effects that have no answer."""


def _columns(design: Design) -> Names:
    return _names(design, lambda name: (column.name for column in design.effect(name).columns))


def _names(design: Design, names: Callable[[str], Iterator[str]]) -> Names:
    names_by_effect: dict[str, list[str]] = {}
    silent = []
    for effect in _with_needed(design):
        try:
            design.effect(effect)
            names_by_effect[effect] = [hyphened(name) for name in names(effect)]
        except (EffectError, GeometryError, ToleranceError):
            silent.append(effect)
    return names_by_effect, tuple(silent)


def _with_needed(design: Design) -> Sequence[str]:
    """The effects that the scene names, then those that they need."""
    effects = list(design.scene.effects)
    for name in effects:
        effects += [needed for needed in design.effects.inputs(name) if needed not in effects]
    return effects
