"""What jobs leave for those that follow: the last design, for scenes that are edits of it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from camgeo.app.designing.children import Job, JobError
from camgeo.design.design import Design
from camgeo.errors import CamgeoError
from camgeo.scene.scene import Scene, parse_scene
from camgeo.scene.values import Document, Source, data_of, document, document_of_tree, edited


class Recent:
    """The design of the last scene that was valid, unless it names files, which may change."""

    def __init__(self) -> None:
        self._of: tuple[str, str, str] = ("", "", "")
        self._design: Design | None = None
        self._kept: dict[str, tuple[tuple[Any, ...], Any]] = {}

    def kept(self, name: str, of: tuple[Any, ...], make: Callable[[], Any]) -> Any:
        """What `make` makes `of` equal texts and the same objects, if it was the last one so named.

        Nobody must change it.
        """
        known = self._kept.get(name)
        if known is None or not all(map(_same, known[0], of)):
            known = self._kept[name] = of, make()
        return known[1]

    def last(self, name: str) -> Any:
        """What was made last under a name, see `kept`; None if nothing was."""
        known = self._kept.get(name)
        return None if known is None else known[1]

    def design(self, job: Job) -> Design:
        """The design of a job's scene; SceneError if it is not valid."""
        place = job.text, job.file, job.folder
        if self._design is not None and place == self._of:
            return self._design
        return self._kept_of(job, self._made(job))

    def restate(self, job: Job, error: CamgeoError) -> None:
        """Put the lengths of an error into the unit of the job's scene, if that is the last one."""
        if self._design is not None and (job.text, job.file, job.folder) == self._of:
            self._design.scene.restate(error)

    def made(self, job: Job, scene: Scene) -> None:
        """Take note of the scene of a job: an edit of the last one, which shares with that what it
        leaves as it was.
        """
        if self._design is not None and (job.file, job.folder) == self._of[1:]:
            self._kept_of(job, self._sharing(scene, self._design))

    def _kept_of(self, job: Job, design: Design) -> Design:
        self._of = job.text, job.file, job.folder
        self._design = None if design.scene.files else design
        return design

    def _sharing(self, scene: Scene, earlier: Design) -> Design:
        """The design of a scene that is an edit; with the drive of the earlier one if it moves as
        that does.
        """
        made = Design(scene)
        if _moves_alike(scene, earlier.scene):
            made.__dict__["drive"] = earlier.drive
        return made

    def _made(self, job: Job) -> Design:
        """The design; what the edit leaves as it was is that of the last one."""
        earlier = self._design
        if earlier is None or (job.file, job.folder) != self._of[1:]:
            return Design(parse_scene(job.text, job.file, job.folder or None))
        found = self.document(job)
        source = Source.of(job.file, job.folder or None, job.text)
        scene = Scene.of(_grafted(found, earlier.scene), source, earlier.scene)
        return self._sharing(scene, earlier)

    def document(self, job: Job) -> Document:
        """The values of a job's text, right or wrong; SceneError if it is not TOML."""
        return document(data_of(job.text))

    def edited(self, job: Job, edits: Mapping[str, Any]) -> Scene:
        """The scene of a job, which may have faults, with other values; SceneError if it has some
        then.
        """
        found = document_of_tree(edited(self.document(job).exact, edits))
        return Scene.of(found, Source.of(job.file, job.folder or None, job.text))


def _same(one: Any, other: Any) -> bool:
    return one is other or (isinstance(one, str) and one == other)


def _grafted(found: Document, earlier: Scene) -> Document:
    """The document with those tables of the `earlier` scene that are equal to its own: what is
    built of a table is built again only if it is another one.
    """
    then = earlier.stated.scene.exact
    # What Python prints tells 1 from true, and 1.0 from 1.00.
    exact: dict[str, Any] = {
        key: then[key] if key in then and repr(then[key]) == repr(value) else value
        for key, value in found.exact.items()
    }
    return replace(found, exact=exact)


def _moves_alike(scene: Scene, other: Scene) -> bool:
    """Whether the drives of two scenes are the same."""
    return (
        scene.plan is other.plan
        and scene.linkage is other.linkage
        and scene.lift_unit == other.lift_unit
        and scene.speed == other.speed
        and scene.speed_curve is other.speed_curve
    )


# -- arguments ------------------------------------------------------------------------------------
# The arguments of jobs, checked at their door.


class Arguments:
    """The arguments of a job; each method raises JobError unless the argument is as it must be."""

    def __init__(self, job: Job) -> None:
        self._given = job.arguments

    def flag(self, name: str, *, otherwise: bool) -> bool:
        """True or false; `otherwise` if it is not given."""
        value = self._given.get(name, otherwise)
        if not isinstance(value, bool):
            raise self._wrong(name, "true or false")
        return value

    def number(self, name: str) -> float | None:
        """A finite number; None if it is not given."""
        value = self._given.get(name)
        return None if value is None else self._finite(name, value)

    def pair(self, name: str) -> tuple[float, float] | None:
        """Two finite numbers; None if it is not given."""
        value = self._given.get(name)
        if value is None:
            return None
        if not isinstance(value, list | tuple) or len(value) != 2 or None in value:
            raise self._wrong(name, "two numbers")
        low, high = (self._finite(name, each) for each in value)
        return low, high

    def index(self, name: str) -> int:
        """The position of something in a list, from 0."""
        value = self._given.get(name)
        if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 2**31:
            raise self._wrong(name, "a position from 0")
        return value

    def texts(self, name: str) -> tuple[str, ...] | None:
        """A list of texts; None if it is not given."""
        value = self._given.get(name)
        if value is None:
            return None
        if not isinstance(value, list | tuple) or not all(isinstance(each, str) for each in value):
            raise self._wrong(name, "a list of texts")
        return tuple(value)

    def _finite(self, name: str, value: Any) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise self._wrong(name, "a number")
        if not abs(value) <= sys.float_info.max:
            raise self._wrong(name, "a finite number")
        return float(value)

    def _wrong(self, name: str, allowed: str) -> JobError:
        return JobError(f"{name} must be {allowed}")
