"""The declaration of a file format, and the options that a scene states for it."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from typing import TYPE_CHECKING, Any, Final, Generic, Protocol, TypeVar

from camgeo.errors import CamgeoError, UnknownNameError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from camgeo.geometry.contour.contour import Effort


SMALLEST_TOLERANCE: Final = 1e-7
LARGEST_TOLERANCE: Final = 1.0
"""Tolerances [mm] allowed for files: below, rounding of their decimals would exceed them;
above, contours no longer resemble the cam."""

Spec = TypeVar("Spec")
"""The options of a format, a frozen dataclass."""


class Values(Protocol):
    """The values of a scene, as needs and rules see them; paths are keys and positions from 0."""

    def valid(self, *path: str | int) -> bool:
        """Whether nothing is wrong at `path`, around it or in it."""

    def lacks(self, *path: str | int) -> bool:
        """Whether the scene neither names the key nor has a misspelt one meant to be it."""

    def get(self, *path: str | int) -> Any:
        """Value in the scene's unit; None if it is absent or not valid."""

    def exact(self, *path: str | int) -> Decimal | None:
        """Number exactly as written; None if it is absent or not valid."""

    @property
    def flat(self) -> bool:
        """Whether the follower has a flat face."""

    @property
    def slides(self) -> bool:
        """Whether the follower is a translating one."""


Rule = Callable[[Values], Iterator[tuple[str, str]]]
"""Keys of the format's table, each with what is wrong with it and what is allowed; an empty key
stands for the format, in which the scene cannot be written. What is wrong is a fault of the scene;
what a format lacks is found by a check, and refused by whoever makes the file."""


@dataclass(frozen=True, slots=True, eq=False)
class Format(Generic[Spec]):
    """The declaration of a file format.

    Attributes
    ----------
    name : in scenes and on the command line, and of its writer's entry point.
    suffix : of the file, behind the name of the disc, e.g. ".dxf".
    parse : makes the options of the converted table `[output.NAME]`, or of an empty one; raises
        GeometryError with the key. Lengths come in mm, numbers with `x-exact` as they are written.
    schema : JSON Schema of the table, `no_keys` for a format without options. Each number names its
        `x-unit`; lengths refer to ``#/$defs/length`` or ``#/$defs/coordinate`` of the scene's.
    needs : keys without which a scene cannot be written in the format, e.g. "part.thickness".
    rules : what schema and needs cannot state.
    choose_suffix : gives the suffix that a scene's options ask for, where it is not always
        `suffix`.
    """

    name: str
    suffix: str
    parse: Callable[[Mapping[str, Any]], Spec]
    schema: Mapping[str, Any] = field(default_factory=lambda: no_keys("No options."))
    needs: tuple[str, ...] = ()
    rules: tuple[Rule, ...] = ()
    choose_suffix: Callable[[Spec], str] | None = None

    def ending(self, options: Options) -> str:
        """The suffix of the file that a scene with these options gets."""
        return self.suffix if self.choose_suffix is None else self.choose_suffix(options[self])

    def lacking(self, values: Values) -> list[str]:
        """Why a scene cannot be written in the format, a sentence each; empty if it can."""
        paths = {key: tuple(key.split(".")) for key in self.needs}
        missing = [
            f"needs {_spelled(key)}"
            for key, path in paths.items()
            if values.lacks(*path) and values.valid(*path)
        ]
        return missing + [
            message for rule in self.rules for key, message in rule(values) if not key
        ]

    def broken(self, values: Values) -> list[tuple[str, str]]:
        """Keys of the table, each with what is wrong with it beyond its schema."""
        return [(key, message) for rule in self.rules for key, message in rule(values) if key]


def groove_has_a_depth(values: Values) -> Iterator[tuple[str, str]]:
    """The depth of a groove is given, which every format of solid bodies needs."""
    if values.get("follower", "contact") == "groove" and values.lacks("part", "groove_depth"):
        yield "", "needs [part] groove_depth, for the cam is a groove"


def no_keys(description: str) -> dict[str, Any]:
    """The schema of a table without keys."""
    empty: dict[str, Any] = {"type": "object", "additionalProperties": False, "properties": {}}
    return {"description": description, **empty}


def no_options(_: Mapping[str, Any]) -> None:
    """The options of a format that has none."""


@dataclass(frozen=True, slots=True)
class Options:
    """The options of all formats: ``options[FORMAT]`` are those of the format `FORMAT`.

    Attributes
    ----------
    by_format : options by the names of the formats for which the scene has a table.
    """

    by_format: Mapping[str, Any] = field(default_factory=dict)

    def __getitem__(self, form: Format[Spec]) -> Spec:
        """The options in the scene, or the defaults if it has none."""
        if form.name not in self.by_format:
            return form.parse({})
        spec: Spec = self.by_format[form.name]
        return spec


@dataclass(frozen=True, slots=True)
class OutputSpec:
    """`[output]`: what is written, and how exactly.

    Attributes
    ----------
    formats : names of the writers, in the order of the scene.
    tolerance : largest deviation of any written contour from the exact curve [mm].
    fit : how hard fits try, see `camgeo.geometry.contour.contour.Effort`.
    options : of the formats, see `camgeo.scene.formats.format.Options`.
    accuracy_ripple : whether the survey of accuracy includes the ripple of the acceleration.
    """

    formats: tuple[str, ...] = ("dxf",)
    tolerance: float = 0.001
    fit: Effort = "fewest"
    options: Options = field(default_factory=Options)
    accuracy_ripple: bool = False


def _spelled(key: str) -> str:
    """A key as messages show it: "[part] thickness", "[linkage]"."""
    table, _, last = key.rpartition(".")
    return f"[{table}] {last}" if table else f"[{last}]"


# -- registry -------------------------------------------------------------------------------------
# The known formats, by name; each is imported only when it is requested.


GROUP: Final = "camgeo.writers"
"""Entry points of the writers of all formats; the name is the format's."""

FORMATS: Final = {
    "dxf": "dxf:FORMAT",
    "gcode": "gcode:FORMAT",
    "stl": "format:STL",
    "3mf": "threemf:FORMAT",
    "step": "step:FORMAT",
    "csv": "csv:FORMAT",
    "cut-svg": "format:CUT_SVG",
    "svg": "format:SVG",
    "png": "format:PNG",
    "asc": "format:ASC",
    "drawing": "drawing:FORMAT",
}
"""Formats of camgeo, each with its module and its name there."""

NO_FORMATS: Final = {
    "pdf": "PDFs are drawn by: camgeo plot SCENE -o FILE.pdf; a sheet by the format drawing",
}
"""Names that users may mistake for formats, each with a hint at how such a file is made."""


def find_format(name: str) -> Format[Any]:
    """The format `name`; its module, or that of a foreign writer, is imported now.

    Raises
    ------
    UnknownNameError
        If there is none.
    CamgeoError
        If another distribution registers something else than a writer under this name.
    """
    if name in FORMATS:
        module, _, constant = FORMATS[name].partition(":")
        declared: Format[Any] = getattr(
            importlib.import_module(f"camgeo.scene.formats.{module}"), constant
        )
        return declared
    entry = writer_entries().get(name)
    if entry is None:
        raise UnknownNameError("format", name, (*FORMATS, *foreign_names()))
    return load_format(entry)[1]


def load_format(entry: EntryPoint) -> tuple[Any, Format[Any]]:
    """The writer at an entry point, which is imported now, and its format; CamgeoError if it cannot
    be imported or is no writer of that format.
    """
    try:
        writer = entry.load()
    except Exception as error:  # whatever another distribution does wrong
        raise CamgeoError(
            f"the entry point {entry.value} of {GROUP} cannot be loaded: {error}"
        ) from error
    declaration: Any = getattr(writer, "format", None)
    if not isinstance(declaration, Format) or declaration.name != entry.name:
        raise CamgeoError(
            f"the entry point {entry.value} of {GROUP} is not a writer of format {entry.name!r}"
        )
    return writer, declaration


def foreign_names() -> tuple[str, ...]:
    """Names of the formats of other distributions, sorted."""
    return tuple(sorted(writer_entries().keys() - set(FORMATS)))


def writer_entries() -> dict[str, EntryPoint]:
    """The entry points of all writers, by the names of their formats."""
    from importlib.metadata import entry_points  # a check needs none

    return {entry.name: entry for entry in entry_points(group=GROUP)}


# -- plain ----------------------------------------------------------------------------------------
# The formats without options: bodies, pictures, cut drawings, and the point files of opticurv.


def is_a_rocker_behind_a_slider(values: Values) -> Iterator[tuple[str, str]]:
    """The points are those of a roller on a rocker behind a slider-crank."""
    if values.flat:
        yield "", "is for roller followers"
    elif not values.lacks("linkage") and (
        values.slides or values.get("linkage", "kind") == "four-bar"
    ):
        yield "", 'needs [linkage] kind = "slider-crank" and a rocker'


def _plain(
    name: str,
    suffix: str,
    description: str,
    also: tuple[str, ...] = (),
    rules: tuple[Rule, ...] = (),
    *,
    later: bool = False,
) -> Format[None]:
    """A format that needs a follower, and the keys of `also`; one that came `later` does not change
    the hashes of scenes.
    """
    schema = no_keys(f"{description}; it has no options.")
    if later:
        schema["x-added"] = True
    return Format(name, suffix, no_options, schema, ("follower", *also), rules)


SVG: Final = _plain("svg", ".svg", "The picture of the cam")
PNG: Final = _plain("png", ".png", "The picture of the cam")

CUT_SVG: Final = _plain(
    "cut-svg",
    ".cut.svg",
    "The part as a drawing at true size for laser cutters, in mm: closed contours of lines and arcs"
    " as hairlines, grouped by the layers of [output.dxf], those of CUT red and the others blue;"
    " UTF-8",
    later=True,
)

BODY: Final = (("part.thickness",), (groove_has_a_depth,))
"""The needs and rules of formats of solid bodies."""

STL: Final = _plain(
    "stl",
    ".stl",
    "The part as a body of triangles, in single precision, its header in ASCII",
    *BODY,
)

ASC: Final = _plain(
    "asc",
    "1.asc",
    "The point files of opticurv, at the step of the value table, in ASCII",
    ("linkage",),
    (is_a_rocker_behind_a_slider,),
)
"""The program appends a digit to the project's name; the second file has another digit."""
