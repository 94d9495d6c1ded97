"""A scene: the values that specify a cam, and the engine's objects built from them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from camgeo.displayed import brief
from camgeo.errors import CamgeoError, Fault, GeometryError, SceneError
from camgeo.pickled import pickled
from camgeo.scene.document import Document, Source, document, document_of, document_of_tree
from camgeo.scene.door import enter
from camgeo.scene.keys import path_of
from camgeo.scene.schema import MILLING
from camgeo.scene.tree import Tree, edited, read_only

if TYPE_CHECKING:
    from camgeo.cam.breadth import Yoke
    from camgeo.cam.contact import Contact
    from camgeo.check.limits import Limits
    from camgeo.contour.contour import Form
    from camgeo.formats.drawing import DrawingSpec
    from camgeo.formats.format import Format, OutputSpec
    from camgeo.mechanism.conjugate import Mount
    from camgeo.mechanism.follower import Follower
    from camgeo.mechanism.linkage_protocol import Linkage
    from camgeo.motion.plan import MotionPlan
    from camgeo.motion.time_course import SpeedCurve
    from camgeo.part.spec import PartSpec
    from camgeo.printing.spec import PrintSpec
    from camgeo.scene.valid_values import ValidValues
    from camgeo.state.state import Carrier, Model, Speed, Train
    from camgeo.toolpath.milling import MillingSpec
    from camgeo.units import LengthUnit, LiftUnit


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Scene:
    """One scene; lengths in mm, angles in rad, unless said otherwise.

    Its values decide all else: no attribute can be replaced by itself, only by `with_values`.
    Scenes with the same content are equal, whatever file they come from.

    Attributes
    ----------
    source : where the values came from, and what is in the files that they name.
    stated : the valid values, as the scene's own rules see them.
    files : names of the files with data, each with the SHA-256 of its bytes.
    name : of the design, the stem of its files.
    unit : of length in the scene file; drawings, programs and tables are written in it.
    rotation : sense in which the disc turns, +1 counter-clockwise, -1 clockwise.
    speed : of the disc, positive [rad/s], the mean one if it varies; None if the scene gives none.
    speed_curve : how the speed varies over the turn; None if it does not.
    plan : the motion; of the far end of a linkage if there is one, else of the follower.
    lift_unit : of the follower's own motion, "mm" or "rad".
    follower : what touches the disc; None if the scene has none, and so no disc.
    linkage : between motion and follower; None if the motion is the follower's own.
    mount : how the second roller of a conjugate pair is fixed to the first; None if there is none.
    returning : the second roller, on the return disc of a conjugate pair; None if there is none.
    yoke : the other side of the follower on a cam of constant breadth; None if there is none.
    contact : the flank on which the roller runs.
    side_clearance : groove's width less the roller's diameter [mm]; 0 without groove.
    limits : with which the design is compared.
    part : the disc as a body; None if the scene has no `[part]`.
    drawing : what the sheet states; the defaults if the scene has no `[drawing]`.
    model : whose motion the effects are computed for; None for the default of its `limits`.
    contour : form of the contour that the model "written" is of; None for that of the drawing.
    flank : side on which a follower that is held both ways runs for the model "written"; None for
        the main one.
    train : whether the forces are those of the elastic train, where the scene has one.
    effects : the table of each effect that the scene names, in its order, numbers in the units
        of `camgeo.effects.effect`.
    output : what is written.
    printing : how bodies are compensated for printing; None if the scene has no `[print]`.
    milling : tools, blank, holding and operations; None if the scene says nothing on milling, or
        lacks keys of its tables.
    """

    source: Source
    stated: ValidValues
    files: tuple[tuple[str, str], ...]
    name: str
    unit: LengthUnit
    rotation: int
    speed: float | None
    speed_curve: SpeedCurve | None
    plan: MotionPlan
    lift_unit: LiftUnit
    follower: Follower | None
    linkage: Linkage | None
    mount: Mount | None
    returning: Follower | None
    yoke: Yoke | None
    contact: Contact
    side_clearance: float
    limits: Limits
    part: PartSpec | None
    drawing: DrawingSpec
    effects: Mapping[str, Mapping[str, Any]]
    output: OutputSpec
    milling: MillingSpec | None
    printing: PrintSpec | None
    model: Model | None
    contour: Form | None
    flank: Carrier | None
    train: Train
    state_speed: Speed | None

    def __init__(self, values: Mapping[str, Any], *, folder: str | Path | None = None) -> None:
        """A scene from its tables, nested as in TOML; a float is the number that Python prints.

        `folder` holds the files that the scene names.

        Raises
        ------
        SceneError
            With all its faults.
        """
        _fill(self, enter(document_of(values), Source.of("", folder)))

    @classmethod
    def from_text(cls, data: bytes, file: str = "", folder: str | Path | None = None) -> Self:
        """A scene from its TOML in UTF-8; `file` is the path it came from, for messages too.

        `folder` holds the files that the scene names, if it is not that of `file`. Raises
        SceneError with all its faults.
        """
        try:
            found = document(data)
        except SceneError as error:
            raise SceneError(error.faults, file) from error
        return cls.of(found, Source.of(file, folder, data.decode()))

    @classmethod
    def of(cls, found: Document, source: Source, earlier: Scene | None = None) -> Self:
        """A scene from its document, perhaps an edit of an earlier scene."""
        made = cls.__new__(cls)
        _fill(made, enter(found, source, None if earlier is None else vars(earlier)))
        return made

    @cached_property
    def values(self) -> Mapping[str, Any]:
        """The values as they are stated, nested as in TOML; decimal numbers are Decimals."""
        values: Mapping[str, Any] = read_only(self._tree)
        return values

    @property
    def _tree(self) -> Tree:
        return self.stated.scene.exact

    @property
    def states_milling(self) -> bool:
        """Whether it says anything on milling, perhaps not all that a program needs."""
        return self.milling is not None or any(map(self.stated.has, MILLING))

    def lacking(self, formats: Iterable[Format[Any]]) -> tuple[Fault, ...]:
        """Why the scene cannot be written in `formats`, at the place that names each."""
        named: list[str] = self.stated.get("output", "formats") or []
        return tuple(
            self.stated.scene.fault(("output", "formats", named.index(form.name)), message)
            if form.name in named
            else Fault("format", form.name, message)
            for form in formats
            for message in form.lacking(self.stated)
        )

    @cached_property
    def identity(self) -> str:
        """SHA-256 of all that the scene states, hexadecimal, see `camgeo.scene.identity`."""
        from camgeo.scene.identity import identity_of  # a check needs no hash

        return identity_of(self._tree, self._digest)

    @cached_property
    def made(self) -> str:
        """SHA-256 of all that decides the bytes of files, hexadecimal, as it stands in them."""
        from camgeo.scene.identity import made_of

        return made_of(self._tree, self._digest)

    def _digest(self, name: str) -> str:
        import hashlib  # its import costs as much as a small check

        return hashlib.sha256(self.source.contents[name]).hexdigest()

    @cached_property
    def made_before(self) -> str:
        """Hash of the text, in files of earlier versions instead of `made`; empty without text."""
        from camgeo.scene.identity import hash_of  # only files of earlier versions ask

        found = self._of_text
        return "" if found is None else hash_of(self.source.text.encode(), found)

    @property
    def _of_text(self) -> Document | None:
        """The document of the text; None if the values were edited, or came from no text."""
        text = self.source.text
        found = document(text.encode()) if text else None
        return None if found is None or found.exact != self._tree else found

    def with_values(self, edits: Mapping[str, Any]) -> Scene:
        """The scene with other values at some keys, None to remove a key.

        Keys are spelled as in messages: "follower.base_radius", "motion[2].law" (or motion.2.law),
        positions counted from 1. What does not depend on the edit is shared: the plan with a new
        roller, plan, follower and linkage with another output. Files are not read again.

        Raises
        ------
        SceneError
            With all faults that the edit would cause.
        """
        found = document_of_tree(edited(self._tree, edits), earlier=self.stated.scene)
        return Scene.of(found, self.source, self)

    def restate(self, error: CamgeoError) -> None:
        """Put an error's lengths into the unit of the scene, and the number of a key as the scene
        states it. Faults of a scene are in its unit, those of a call in mm, as its options are.
        """
        if not isinstance(error, SceneError):
            error.restate(self.unit)
        if isinstance(error, GeometryError) and error.value[:1].isdigit():
            fault = self.stated.scene.fault(path_of(error.key) or (), "")
            error.value = fault.value or error.value

    @contextmanager
    def restating(self) -> Iterator[None]:
        """Restate the errors that are raised within."""
        try:
            yield
        except CamgeoError as error:
            self.restate(error)
            raise

    def to_toml(self) -> str:
        """The scene as TOML, with the comments and the order of the text that it came from.

        Keys added by an edit follow those that were set before them in their table.
        """
        if self._of_text is not None:
            return self.source.text
        from camgeo.scene.toml import written_into

        return written_into(self.source.text, self._tree)

    def __repr__(self) -> str:
        file = f", file={brief(self.source.file)}" if self.source.file else ""
        return f"Scene({brief(self.name)}{file})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Scene) and self.identity == other.identity

    def __hash__(self) -> int:
        return hash(self.identity)

    def __reduce__(self) -> tuple[Any, ...]:
        source = self.source
        folder = None if source.folder is None else str(source.folder)
        contents = dict(source.contents)
        return pickled(
            scene, tree=self._tree, file=source.file, folder=folder, text=source.text,
            contents=contents,
        )  # fmt: skip


def _fill(made: Scene, attributes: Mapping[str, Any]) -> None:
    """Set the attributes of a new scene, which is frozen."""
    for name, value in attributes.items():
        object.__setattr__(made, name, value)


def scene(
    tree: Tree, file: str, folder: str | None, text: str, contents: Mapping[str, bytes]
) -> Scene:
    """The scene from its pickled state; no file is read."""
    source = Source(file, None if folder is None else Path(folder), text).having(contents)
    return Scene.of(document_of_tree(tree), source)
