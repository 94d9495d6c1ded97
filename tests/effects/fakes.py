"""Effects made up for a test: a declaration names what computes it, so that stands here by name."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any, Final

from camgeo.effects.effect import Effect, Request

NUMBERS: Final = itertools.count()


def fake(
    name: str,
    compute: Callable[[Request[Any]], Any] = lambda request: request.data,
    *,
    title: str = "",
    **options: Any,
) -> Effect:
    """An effect that `compute` computes; its table may have any keys."""
    function = f"compute_{next(NUMBERS)}"
    globals()[function] = compute
    options = {"schema": {"type": "object"}} | options
    return Effect(name, title or name, f"{__name__}:{function}", **options)
