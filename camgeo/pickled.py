"""Data that are pickled and copied as the values they were created from, and nothing else.

Computed results, ledgers and caches are left out; the objects are created again through their own
checks, and have read-only arrays as before.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from types import MappingProxyType
from typing import Any, TypeVar

from camgeo._version import __version__
from camgeo.displayed import Brief
from camgeo.errors import VersionError

Made = TypeVar("Made")


class Pickled(Brief):
    """Base of a dataclass whose pickles and copies are recreated from its fields.

    A pickle names its class and the version of camgeo; another version raises VersionError.
    """

    __slots__ = ()

    def __reduce__(self) -> tuple[Any, ...]:
        names = (each.name for each in fields(self) if each.init)  # type: ignore[arg-type]  # its subclasses are dataclasses
        return pickled(type(self), **{name: _plain(getattr(self, name)) for name in names})


def pickled(make: Callable[..., Any], **given: Any) -> tuple[Any, ...]:
    """The result of `__reduce__` for objects that `make` creates from `given`."""
    return _again, (make, __version__, given)


def _plain(value: Any) -> Any:
    """A read-only mapping as one that can be pickled; its owner makes it read-only again."""
    return dict(value) if isinstance(value, MappingProxyType) else value


def _again(make: Callable[..., Made], version: str, given: dict[str, Any]) -> Made:
    if version != __version__:
        name = getattr(make, "__name__", "object")
        raise VersionError(
            f"a {name} pickled by camgeo {version} cannot be read by camgeo {__version__};"
            " create it again from its scene"
        )
    return make(**given)
