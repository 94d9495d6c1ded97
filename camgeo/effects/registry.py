"""All effects by name, and their declarations."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any, Final

from camgeo.effects.effect import GROUP, Effect
from camgeo.errors import UnknownNameError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

EFFECTS: Final[tuple[str, ...]] = (
    "kinematics",
    "inertia",
    "gravity",
    "load",
    "spring",
    "spring-surge",
    "friction",
    "contact-force",
    "reactions",
    "roller-spin",
    "lift-off",
    "drive-torque",
    "power-balance",
    "speed-fluctuation",
    "camshaft-windup",
    "contact-pressure",
    "vibration",
    "shock-spectrum",
    "balance",
)
"""Effects of camgeo; each is a package of the same name whose `EFFECT` declares it."""


def find_effect(name: str) -> Effect:
    """The declaration of the effect `name`; the code that computes the effect is not imported.

    Raises
    ------
    UnknownNameError
        If there is no such effect.
    TypeError
        If the object that another distribution registers is not an `Effect` of this name.
    """
    if name in EFFECTS:
        module = importlib.import_module(f"camgeo.effects.{name.replace('-', '_')}")
        effect: Any = module.EFFECT
    elif entry := _foreign().get(name):
        effect = entry.load()
    else:
        raise UnknownNameError("effect", name, effect_names())
    if not isinstance(effect, Effect) or effect.name != name:
        raise TypeError(f"the object registered as effect {name!r} is not an effect of that name")
    return effect


def effect_names() -> tuple[str, ...]:
    """Names of all effects, those of camgeo first; imports none of them."""
    return (*EFFECTS, *sorted(_foreign()))


def _foreign() -> dict[str, EntryPoint]:
    from importlib.metadata import entry_points  # few scenes name a foreign effect

    return {each.name: each for each in entry_points(group=GROUP) if each.name not in EFFECTS}
