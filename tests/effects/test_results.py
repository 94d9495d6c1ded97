"""What effects use of each other: the type checker compares both sides."""

from __future__ import annotations

import pkgutil
from collections.abc import Callable
from typing import Any, TypeVar

import pytest

from camgeo.dynamics.effects.contact_force.result import compute as contact_force
from camgeo.dynamics.effects.drive_torque.result import compute as drive_torque
from camgeo.dynamics.effects.effect import Key, Request, Results
from camgeo.dynamics.effects.friction.result import compute as friction
from camgeo.dynamics.effects.gravity.result import compute as gravity
from camgeo.dynamics.effects.inertia.result import compute as inertia
from camgeo.dynamics.effects.load.result import compute as load
from camgeo.dynamics.effects.registry import EFFECTS, find_effect
from camgeo.dynamics.effects.results import (
    CONTACT_FORCE,
    DRIVE_TORQUE,
    FRICTION,
    GRAVITY,
    INERTIA,
    LOAD,
    SPRING,
    VIBRATION,
    Friction,
)
from camgeo.dynamics.effects.spring.result import compute as spring
from camgeo.dynamics.effects.vibration.result import compute as vibration

Answer = TypeVar("Answer")
Pair = tuple[str, Callable[..., Any]]


def pair(key: Key[Answer], compute: Callable[[Request[Any]], Answer]) -> Pair:
    """A key with what computes it; that the one gives the other is for the type checker."""
    return key, compute


PAIRS = (
    pair(INERTIA, inertia),
    pair(GRAVITY, gravity),
    pair(LOAD, load),
    pair(SPRING, spring),
    pair(FRICTION, friction),
    pair(CONTACT_FORCE, contact_force),
    pair(DRIVE_TORQUE, drive_torque),
    pair(VIBRATION, vibration),
)


@pytest.mark.parametrize(("key", "compute"), PAIRS)
def test_a_key_is_that_of_the_effect_whose_result_it_promises(
    key: str, compute: Callable[..., Any]
) -> None:
    effect = find_effect(key)
    assert effect.name is key
    assert pkgutil.resolve_name(effect.compute) is compute


def test_what_is_asked_for_has_a_key() -> None:
    effects = [find_effect(name) for name in EFFECTS]
    asked = {name for each in effects for name in (*each.needs, *each.uses)}
    assert asked == {key for key, _ in PAIRS}
    assert all(isinstance(name, Key) for name in asked)


def test_results_are_found_by_their_keys() -> None:
    given: Any = object()
    results = Results({"friction": given})
    found: Friction = results[FRICTION]
    assert found is given
    assert results.get(FRICTION) is given
    assert results.get(SPRING) is None
    with pytest.raises(KeyError):
        results[SPRING]
