"""A job of the designer, and how it is sent between processes."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Final, Self

from camgeo.errors import CamgeoError

LARGEST: Final = 16_000_000
"""Most bytes of a job as JSON: more than the largest scene and any change of it."""


class JobError(CamgeoError, ValueError):
    """A job that cannot be done: an unknown kind, or wrong arguments."""


@dataclass(frozen=True, slots=True)
class Job:
    """What the designer asks of a scene.

    Attributes
    ----------
    kind : one of `camgeo.designing.work.WORK`.
    text : of the scene, TOML.
    file : path that messages name; empty for a scene that is in no file yet.
    folder : that contains the files named by the scene; empty if there is none.
    arguments : of that kind of job, JSON data.
    """

    kind: str
    text: str = ""
    file: str = ""
    folder: str = ""
    arguments: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in ("kind", "text", "file", "folder"):
            if not isinstance(getattr(self, name), str):
                raise JobError(f"{name} of a job must be text")
        if not isinstance(self.arguments, Mapping):
            raise JobError("arguments of a job must be a table")

    def to_json(self) -> bytes:
        """The job as JSON.

        Raises
        ------
        JobError
            If its arguments are not JSON data, or if it is larger than `LARGEST`.
        """
        try:
            text = json.dumps(asdict(self), allow_nan=False).encode()
        except (TypeError, ValueError, RecursionError) as error:
            raise JobError(f"arguments of a job must be JSON data: {error}") from error
        if len(text) > LARGEST:
            raise JobError(f"is larger than {LARGEST:,} bytes, too large for a job")
        return text

    @classmethod
    def from_json(cls, text: bytes) -> Self:
        """The job in a JSON text; JobError if there is none."""
        try:
            found = json.loads(text)
        except (ValueError, RecursionError) as error:
            raise JobError(f"a job must be JSON: {error}") from error
        if not isinstance(found, dict) or not found.keys() <= set(cls.__slots__):
            raise JobError("a job must be a table of kind, text, file, folder and arguments")
        if "kind" not in found:
            raise JobError("a job must have a kind")
        return cls(**found)
