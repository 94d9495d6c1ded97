"""How objects are displayed, pickled and copied, and the schemas stored with their modules.

The engine draws nothing. A notebook requests the picture or the HTML of an object through the
methods that IPython defines; only then is the renderer looked up among the entry points.
"""

from __future__ import annotations

import json
import pathlib
from collections.abc import Callable, Collection, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from types import MappingProxyType
from typing import Any, Final, TypeVar, cast

from camgeo._version import __version__
from camgeo.errors import VersionError
from camgeo.units import counted

GROUP: Final = "camgeo.notebook"
"""Entry points for notebooks: `display`, a callable that returns the renderings of an object by
media type; `plot` and `viewer`, see `plot` and `view` of `camgeo.design.design.Design`."""

LONGEST: Final = 300
"""Most characters of the description of an object: three lines of a terminal."""

WORDS: Final = 60
"""Most characters of a text in such a description."""


def notebook(name: str) -> Callable[..., Any]:
    """The entry point of that name for notebooks, loaded."""
    from importlib.metadata import entry_points  # slow, and few objects are displayed

    (entry,) = entry_points(group=GROUP, name=name)
    loaded: Callable[..., Any] = entry.load()
    return loaded


def clipped(line: str) -> str:
    """The description of an object, cut to `LONGEST` characters."""
    return line if len(line) <= LONGEST else f"{line[: LONGEST - 2]}…)"


def brief(value: object) -> str:
    """A short description of a value: an object by its class, an array by its shape, a collection
    by its length.

    Control characters of texts are escaped, so that none reaches a terminal.
    """
    if isinstance(value, Enum):
        return brief(value.value)
    if isinstance(value, str):
        return repr(value if len(value) <= WORDS else f"{value[: WORDS - 1]}…")
    if isinstance(value, float | complex):
        return f"{value:.6g}"
    if value is None or isinstance(value, int):
        return repr(value)
    name, shape = type(value).__name__, getattr(value, "shape", None)
    if isinstance(shape, tuple):
        return f"{name}{shape}"
    if isinstance(value, Collection) and isinstance(value, Displayed):
        return repr(value)
    if isinstance(value, Collection):
        return f"<{counted(len(value), 'byte' if isinstance(value, bytes) else 'item')}>"
    return f"{name}(…)" if is_dataclass(value) or callable(value) else brief(str(value))


class Brief:
    """Base of a dataclass whose `repr` is one short line, however much data it has.

    A class that defines its own `__repr__` keeps that.
    """

    __slots__ = ()

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        # `dataclass` replaces an inherited `__repr__`, but not one in the namespace of the class.
        cls.__repr__ = cls.__repr__  # type: ignore[method-assign]  # an inherited one is pinned

    def __repr__(self) -> str:
        names = (field.name for field in fields(self) if field.repr)  # type: ignore[arg-type]  # its subclasses are dataclasses
        values = ", ".join(f"{name}={brief(getattr(self, name))}" for name in names)
        return clipped(f"{type(self).__name__}({values})")


class Displayed(Brief):
    """Base of objects that a notebook displays as HTML or as a picture.

    If an error of camgeo prevents that, the error is displayed; nothing is raised.
    """

    __slots__ = ()

    def _repr_mimebundle_(
        self, include: object = None, exclude: object = None
    ) -> Mapping[str, str | bytes]:
        """All renderings at once, by media type, so that a picture is drawn only once."""
        renderings: Mapping[str, str | bytes] = notebook("display")(self)
        return renderings

    def _repr_html_(self) -> str | None:
        """The rendering for front ends that display HTML; every text in it is escaped."""
        return cast("str | None", self._repr_mimebundle_().get("text/html"))

    def _repr_png_(self) -> bytes | None:
        """The picture, for front ends without HTML; None if there is none."""
        return cast("bytes | None", self._repr_mimebundle_().get("image/png"))


# -- pickled --------------------------------------------------------------------------------------
# Data that are pickled and copied as the values from which they were created, and nothing else.
#
# Computed results, ledgers and caches are left out; the objects are created again with all their
# checks, and have read-only arrays as before.


Instance = TypeVar("Instance")


class Pickled(Brief):
    """Base of a dataclass whose pickles and copies are recreated from its fields.

    A pickle names its class and the version of camgeo; another version raises VersionError.
    """

    __slots__ = ()

    def __reduce__(self) -> tuple[Any, ...]:
        names = (field.name for field in fields(self) if field.init)  # type: ignore[arg-type]  # its subclasses are dataclasses
        return pickled(type(self), **{name: _plain(getattr(self, name)) for name in names})


def pickled(make: Callable[..., Any], **values: Any) -> tuple[Any, ...]:
    """The result of `__reduce__` for objects that `make` creates from `values`."""
    return _again, (make, __version__, values)


def _plain(value: Any) -> Any:
    """A value as it can be pickled: a read-only mapping as a dict, which its owner wraps again."""
    return dict(value) if isinstance(value, MappingProxyType) else value


def _again(make: Callable[..., Instance], version: str, values: dict[str, Any]) -> Instance:
    if version != __version__:
        name = getattr(make, "__name__", "object")
        raise VersionError(
            f"a {name} pickled by camgeo {version} cannot be read by camgeo {__version__};"
            " create it again from its scene"
        )
    return make(**values)


# -- declared -------------------------------------------------------------------------------------
# The JSON Schema of a declaration, stored next to its module, and the values it allows, in words.


TYPES: Final = {
    "array": "a list in square brackets",
    "boolean": "true or false, without quotes",
    "integer": "a whole number",
    "number": "a number",
    "object": "a table",
    "string": "text in quotes",
}


def stored_schema(file: str, name: str = "") -> dict[str, Any]:
    """The JSON Schema `name` in the folder of the module `file`, by default that with its stem."""
    path = pathlib.Path(file)
    schema: dict[str, Any] = json.loads(path.with_name(f"{name or path.stem}.json").read_bytes())
    return schema


def allowed(node: Mapping[str, Any]) -> str:
    """The values that a node of a schema allows, in words: "must be ..."."""
    if "x-allowed" in node:
        return str(node["x-allowed"])
    if "enum" in node:
        return "must be one of " + ", ".join(f'"{item}"' for item in node["enum"])
    text = "must be " + TYPES[node["type"]]
    lowest = node.get("minimum", node.get("exclusiveMinimum"))
    highest = node.get("maximum", node.get("exclusiveMaximum"))
    if lowest is not None and highest is not None:
        above = " above" if "exclusiveMinimum" in node else " from"
        below = " to" if "maximum" in node else " and below"
        text += f"{above} {lowest:g}{below} {highest:g}"
    elif lowest is not None:
        text += f", {'above' if 'exclusiveMinimum' in node else 'at least'} {lowest:g}"
    elif highest is not None:
        text += f", {'at most' if 'maximum' in node else 'below'} {highest:g}"
    unit = node.get("x-unit")
    return f"{text} ({unit})" if unit else text
