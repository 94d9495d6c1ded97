"""All effects by name, and their declarations."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final

from camgeo.dynamics.effects.effect import Effect, Key
from camgeo.dynamics.effects.results import FINDERS, Turning
from camgeo.dynamics.state.state import Train
from camgeo.errors import CycleError, UnknownNameError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint


GROUP: Final = "camgeo.effects"
"""Group of the entry points of effects from other distributions, named like the effect."""

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
        module = importlib.import_module(f"camgeo.dynamics.effects.{name.replace('-', '_')}")
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


# -- catalogue ------------------------------------------------------------------------------------
# Which effects a scene names, how they are declared, and which of them need which.


class Catalogue:
    """The effects of a scene, by name.

    Parameters
    ----------
    tables : the table of each effect that the scene names, in internal units.
    find : returns the effect with a given name.
    output : whether effects take the elastic train of another one into account.
    """

    def __init__(
        self, tables: Mapping[str, Mapping[str, Any]], find: Callable[[str], Effect], output: Train
    ) -> None:
        self.tables = tables
        self._find = find
        self._output = output
        self._known: dict[str, Effect] = {}

    def with_table(self, name: str, table: Mapping[str, Any]) -> Catalogue:
        """The same with another table of the effect `name`."""
        return Catalogue({**self.tables, name: table}, self._find, self._output)

    @property
    def finder(self) -> Key[Turning] | None:
        """The effect of the scene that finds how the cam turns; None if it names none."""
        return next((each for each in FINDERS if each in self.tables), None)

    def rigid(self) -> Catalogue:
        """The same, with effects that take the train as rigid."""
        return Catalogue(self.tables, self._find, "rigid")

    def effect(self, name: str) -> Effect:
        """The declaration of the effect `name`; UnknownNameError if there is none."""
        if name not in self._known:
            self._known[name] = self._find(name)
        return self._known[name]

    def inputs(self, name: str) -> tuple[str, ...]:
        """The effects whose results `name` receives: those it needs, and used ones in the scene.

        Raises
        ------
        CycleError
            If an effect needs itself, with the path of the cycle.
        """
        self._walk(name, ())
        return self.received(name)

    def received(self, name: str) -> tuple[str, ...]:
        """As `inputs`, for effects of which it is known that none needs itself."""
        effect = self.effect(name)
        used = [each for each in effect.uses if each in self.tables]
        if self._output == "rigid":
            better = self._better(effect)
            used = [each for each in used if each not in better]
        return (*effect.needs, *(each for each in used if each not in effect.needs))

    def followed(self, name: str) -> bool:
        """Whether the effect `name` takes an elastic train of the scene into account."""
        return self._output == "elastic" and bool(self._better(self.effect(name)))

    def _better(self, effect: Effect) -> set[str]:
        """The effects of the scene that `effect` follows unless its state is a simpler one."""
        return {each.by for each in effect.refined_by if each.followed and each.by in self.tables}

    def _walk(self, name: str, way: tuple[str, ...]) -> None:
        if name in way:
            raise CycleError((*way[way.index(name) :], name))
        for each in self.received(name):
            self._walk(each, (*way, name))

    def behind(self, name: str) -> set[str]:
        """The effects that the effect `name` is computed from, directly or not."""
        inputs = self.inputs(name)
        return set(inputs).union(*(self.behind(each) for each in inputs))

    def of_given_speed(self, name: str) -> bool:
        """Whether the effect `name` declares that its figures depend on the speed of the cam."""
        return any(each.by in FINDERS for each in self.effect(name).refined_by)

    def moved(self, name: str) -> bool:
        """Whether the effect `name` depends on the speed of the cam: all do, but the effect that
        finds it and, of what this is found from, those that declare no such thing.
        """
        if name == self.finder:
            return False
        behind = set() if self.finder is None else self.behind(self.finder)
        if self.of_given_speed(name) or name not in behind:
            return True
        return any(self.moved(each) for each in self.inputs(name))
