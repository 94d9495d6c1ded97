"""Switching effects on and off, with initial data that suit the machine."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from decimal import Decimal
from typing import Any, Final

from camgeo.designing.given import Given, refusal
from camgeo.designing.snapping import is_number, rounded
from camgeo.effects.effect import Effect
from camgeo.effects.registry import effect_names, find_effect
from camgeo.errors import Fault, SceneError, UnknownNameError
from camgeo.scene.document import document_of_tree
from camgeo.scene.keys import Path, path_of, value_at
from camgeo.scene.schema import EFFECTS
from camgeo.scene.tree import Tree, edited
from camgeo.scene.valid_values import ValidValues
from camgeo.units import MM_PER

SPEED: Final = 60
"""Of a cam that has none [rev/min]."""

Table = dict[str, Any]

WIRE: Final[Mapping[str, Any]] = {
    "diameter": "0.08", "coil_diameter": "0.6", "active_coils": 6, "free_length": "2",
}  # fmt: skip
"""Of a helical spring."""

EXAMPLES: Final[Mapping[str, tuple[Table, ...]]] = {
    "inertia": (
        {"mass": 1, "moment_of_inertia": Decimal("0.002"), "roller_mass": Decimal("0.1")},
        {"output_moment": Decimal("0.02"), "moment_of_inertia": Decimal("0.002")},
        {"mass": 1, "roller_mass": Decimal("0.1")},
        {"mass": 1, "moment_of_inertia": Decimal("0.002")},
        {"mass": 1},
        {"moment_of_inertia": Decimal("0.002"), "roller_mass": Decimal("0.1")},
        {"moment_of_inertia": Decimal("0.002")},
    ),
    "load": ({"constant": 100},),
    "spring": (
        {"stiffness": 5, "preload": 200},
        {"kind": "torsion", "torsional_stiffness": 20, "preload_torque": 10},
        {"preload": 200, "wire": WIRE},
        {"preload": 200, "wire": WIRE, "anchor": None, "attachment": None},
    ),
    "friction": (
        {"guide": Decimal("0.1"), "guide_length": "1.8", "guide_overhang": "1.2"},
        {"guide": Decimal("0.1")},
        {"pivot": Decimal("0.1"), "pivot_diameter": "0.4"},
        {"face": Decimal("0.1")},
        {"slider": 5},
    ),
    "roller-spin": ({"moment_of_inertia": Decimal("0.00001"), "traction": Decimal("0.05")},),
    "speed-fluctuation": (
        {"moment_of_inertia": Decimal("0.1"), "no_load_speed": None, "stall_torque": 200},
    ),
    "camshaft-windup": (
        {"stiffness": 10_000, "moment_of_inertia": Decimal("0.01"), "damping": Decimal("0.04")},
    ),
    "contact-pressure": ({}, {"width": "0.2"}),
    "vibration": (
        {"natural_frequency": 100, "damping": Decimal("0.04")},
        {"torsional_stiffness": 10_000, "damping": Decimal("0.04")},
        {"stiffness": 1000, "damping": Decimal("0.04")},
    ),
}
"""Initial tables, of which the first one that suits the machine is taken: lengths as texts, in base
radii; None for a speed somewhat above that of the cam, and for an end of a spring on a rocker.
Effects without an entry start empty."""

BESIDE: Final = {"anchor": 1.5, "attachment": 0.0}
"""Ends of a spring on a rocker, see `_end`."""

FASTER: Final = Decimal("1.05")
"""No-load speed of a motor, in speeds of the cam."""

THICK: Final = Decimal("0.2")
"""Thickness of a part without one, in base radii."""


def switched(given: Given, asked: Any) -> tuple[Tree, str]:
    """The tree with an effect switched on or off, and a label.

    `asked` has its `name`, and whether it is to be `on`. What an effect needs is switched on with
    it, and what needs it is switched off with it. SceneError if `asked` lacks one of these or the
    machine cannot have the effect; UnknownNameError if there is no such effect.
    """
    name = asked.get("name") if isinstance(asked, Mapping) else None
    if not isinstance(name, str) or not isinstance(asked.get("on"), bool):
        raise refusal("an effect has a name, and is switched on or off")
    if name not in effect_names():
        raise UnknownNameError("effect", name[:60], effect_names())
    title = name.replace("-", " ")
    effects = given.tree.get(EFFECTS)
    if asked["on"]:
        if isinstance(effects, dict) and name in effects:
            raise refusal("is on", f"{EFFECTS}.{name}")
        return _on(given, name), f"{title} on"
    if not isinstance(effects, dict) or name not in effects:
        raise refusal("is off", f"{EFFECTS}.{name}")
    return _off(given, name), f"{title} off"


def _on(given: Given, name: str) -> Tree:
    tree = given.tree
    if not isinstance(tree.get(EFFECTS, {}), dict):
        raise refusal("is no table", EFFECTS)
    wanted = []
    for need in _needs(tree, find_effect(name)):
        if need.startswith(f"{EFFECTS}."):
            wanted.append(need.partition(".")[2])
        else:
            tree = edited(tree, {need: _value(tree, need)})
    unmet: list[Fault] = []
    for made in _with(given, tree, (*wanted, name)):
        fault = given.unmet(_alone(made, name), name)
        if fault is None:
            return made
        unmet.append(fault)
    raise SceneError(unmet[:1])


def _alone(tree: Tree, name: str) -> Tree:
    """The tree with no other effects than those without which there is no `name`: with them all it
    may take long to compute.
    """
    required, waiting = {name}, [name]
    while waiting:
        effect = find_effect(waiting.pop())
        keys = (path_of(key) or () for keys in effect.keys for key in keys)
        needs = {*effect.needs, *(str(path[1]) for path in keys if path[:1] == (EFFECTS,))}
        waiting += needs - required
        required |= needs
    own = {each: table for each, table in tree[EFFECTS].items() if each in required}
    return {**tree, EFFECTS: own}


def _with(given: Given, tree: Tree, names: tuple[str, ...]) -> Iterator[Tree]:
    """The trees with examples of all these effects, see `_fitting`; SceneError if the machine
    cannot have one of them.
    """
    if not names:
        yield tree
        return
    fitting = list(_fitting(given, tree, names[0]))
    if not fitting:
        tried = _with_table(tree, names[0], EXAMPLES.get(names[0], ({},))[0])
        raise SceneError([each for each in given.faults(tried) if _is_of(each.key, names[0])])
    for each in fitting:
        yield from _with(given, each, names[1:])


def suiting(given: Given, tree: Tree, name: str) -> Tree | None:
    """The tree with the first of the fitting examples of an effect; None if there is none."""
    return next(_fitting(given, tree, name), None)


def _fitting(given: Given, tree: Tree, name: str) -> Iterator[Tree]:
    """The tree with each example of an effect that leaves nothing wrong with it, but for what was
    wrong before.
    """
    for example in EXAMPLES.get(name, ({},)):
        made = _with_table(tree, name, example)
        if not any(_is_of(fault.key, name) for fault in given.new_faults(made)):
            yield made


def _is_of(key: str, name: str) -> bool:
    """Whether a key is of the table of that effect."""
    return (path_of(key) or ())[:2] == (EFFECTS, name)


def _needs(tree: Tree, effect: Effect) -> Iterator[str]:
    """The keys that a scene lacks for an effect, in the order in which to state them."""
    seen: set[str] = set()
    waiting = [effect]
    lacking: list[str] = []
    while waiting:
        each = waiting.pop()
        seen.add(each.name)
        for keys in each.keys:
            if any(value_at(tree, path_of(key) or ()) is not None for key in keys):
                continue
            first = next((key for key in keys if key not in lacking), None)
            if first is None or set(keys) & set(lacking) or first == f"{EFFECTS}.{effect.name}":
                continue
            lacking.insert(0, first)
            if first.startswith(f"{EFFECTS}."):
                waiting.append(find_effect(first.partition(".")[2]))
        waiting += [find_effect(name) for name in each.needs if name not in seen]
    yield from lacking


def _value(tree: Tree, key: str) -> Any:
    """A value for a key that an effect needs."""
    return rounded(base_radius(tree) * THICK) if key == "part.thickness" else SPEED


def _with_table(tree: Tree, name: str, example: Table) -> Tree:
    made = {key: _initial(tree, key, value) for key, value in example.items()}
    return {**tree, EFFECTS: {**tree.get(EFFECTS, {}), name: made}}


def _initial(tree: Tree, key: str, value: Any) -> Any:
    """What an example states for a key, in the scene's unit."""
    if isinstance(value, Mapping):
        return {inner: _initial(tree, inner, each) for inner, each in value.items()}
    if isinstance(value, str) and key != "kind":
        return rounded(Decimal(value) * base_radius(tree))
    if value is not None:
        return value
    if key in BESIDE:
        return _end(tree, BESIDE[key])
    speed = value_at(tree, ("cam", "speed"))
    return rounded(Decimal(speed if is_number(speed) else SPEED) * FASTER)


def _end(tree: Tree, beside: float) -> list[Decimal]:
    """An end of a spring on a rocker: so many base radii beside the middle between pivot and cam
    axis, on the side of the arm, from which the spring turns it towards the axis.
    """
    pivot = value_at(tree, ("follower", "pivot"))
    if not isinstance(pivot, list) or len(pivot) != 2 or not all(map(is_number, pivot)):
        return []
    at = complex(*map(float, pivot))
    side = 1j if value_at(tree, ("follower", "arm_side")) == "cw" else -1j
    found = 0.5 * at + beside * float(base_radius(tree)) * side * at / (abs(at) or 1.0)
    return [rounded(Decimal(each)) for each in (found.real, found.imag)]


def base_radius(tree: Tree) -> Decimal:
    """The base radius of a scene, in its unit; that of a usual cam if it has none."""
    radius = value_at(tree, ("follower", "base_radius"))
    if is_number(radius) and radius > 0:
        return Decimal(radius)
    unit = ValidValues(document_of_tree(tree)).unit
    return Decimal(50) / Decimal(str(MM_PER[unit]))


def _off(given: Given, name: str) -> Tree:
    """Without it, and without the effects that cannot do without it."""
    tree = given.tree

    def may(path: Path) -> bool:
        return path[0] == EFFECTS and len(path) == 2

    rest = {key: each for key, each in tree[EFFECTS].items() if key != name}
    made = given.without_misfits({**tree, EFFECTS: rest}, may)
    return made if made[EFFECTS] else {key: each for key, each in made.items() if key != EFFECTS}
