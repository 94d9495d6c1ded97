"""Effects made up for tests. Declarations name the function that computes them, which is here."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any, Final

from camgeo.dynamics.effects.effect import Effect, Request

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
    options = {"schema": {"type": "object"}, "premise": "disc"} | options
    return Effect(name, title or name, f"{__name__}:{function}", **options)
