"""Why a command gives no answer, in words."""

from __future__ import annotations

from camgeo.answers.refusal import Refusal


def text(answer: Refusal) -> str:
    """The faults, all at once."""
    return f"camgeo: {answer.message}"
