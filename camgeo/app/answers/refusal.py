"""The error that a command ends with, as an answer."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from camgeo.app.answers.answer import BROKEN, WRONG, Answer, Key, error_faults
from camgeo.errors import CamgeoError, Fault, UndercutError, UnsafeError


@dataclass(frozen=True, slots=True)
class Refusal(Answer):
    """An error that ended a command.

    Attributes
    ----------
    error : name of its class.
    message : the complete text.
    file : the file that is wrong; empty if none is.
    faults : what is wrong.
    exit_code : how the command ends.
    """

    error: str
    message: str
    file: str
    faults: tuple[Fault, ...]
    exit_code: int = WRONG


def refusal(error: CamgeoError) -> Refusal:
    """The answer for an error; exit code 1 for a cam without an outline and for a program that must
    not be run, else 2.
    """
    name, message = type(error).__name__, str(error)
    if isinstance(error, UndercutError | UnsafeError):
        message = f"{error.message}; nothing was written"
        return Refusal(name, message, "", (Fault("", "", message),), BROKEN)
    return Refusal(name, message, getattr(error, "file", ""), error_faults(error))


# -- document -------------------------------------------------------------------------------------
# The keys of its JSON document.


DOCUMENT: Final = Key(
    "Why a command gives no answer, with `--json`; it exits with 2, or with 1 if the cam has no"
    " outline to write or its program must not be run.",
    {
        "error": "Name of the error: SceneError, GeometryError, ...",
        "message": "The whole message.",
        "file": "The file that is wrong; empty if no file is.",
        "faults": Key(
            "What is wrong, all at once.",
            {
                "key": (
                    "Path of the key or option, e.g. motion[2].span; empty for the file as a whole."
                ),
                "value": "The given value as written; empty if there was none.",
                "message": "What is wrong, and what is allowed.",
                "hint": "A suggestion, or empty.",
                "line": "Line in the file, counted from 1; null where it is not known.",
            },
        ),
    },
    type=Refusal,
)


# -- rendering ------------------------------------------------------------------------------------
# Why a command gives no answer, in words.


def text(answer: Refusal) -> str:
    """The message of the error, behind the name of the program."""
    return f"camgeo: {answer.message}"
