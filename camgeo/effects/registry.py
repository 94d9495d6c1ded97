"""The effects there are, by name; each is imported when it is asked for and not before."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any, Final

from camgeo.effects.effect import GROUP, Effect

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

EFFECTS: Final = (
    "kinematics",
    "inertia",
    "gravity",
    "load",
    "spring",
    "friction",
    "contact-force",
    "lift-off",
    "drive-torque",
    "speed-fluctuation",
    "contact-pressure",
    "vibration",
    "shock-spectrum",
    "balance",
)
"""Effects of camgeo; each has the module or package of its name, whose `EFFECT` it is."""


def find_effect(name: str) -> Effect:
    """The effect `name`; its module is imported now.

    Raises
    ------
    KeyError
        If there is none.
    TypeError
        If what another distribution registers under this name is no `Effect` of this name.
    """
    if name in EFFECTS:
        module = importlib.import_module(f"camgeo.effects.{name.replace('-', '_')}")
        effect: Any = module.EFFECT
    else:
        effect = _foreign()[name].load()
    if not isinstance(effect, Effect) or effect.name != name:
        raise TypeError(f"what is registered as the effect {name!r} is no effect of that name")
    return effect


def effect_names() -> tuple[str, ...]:
    """Names of all effects, those of camgeo first; nothing is imported."""
    return (*EFFECTS, *sorted(_foreign()))


def foreign_names() -> tuple[str, ...]:
    """Names of the effects of other distributions."""
    return tuple(sorted(_foreign()))


def _foreign() -> dict[str, EntryPoint]:
    from importlib.metadata import entry_points  # few scenes name an effect

    return {each.name: each for each in entry_points(group=GROUP) if each.name not in EFFECTS}
