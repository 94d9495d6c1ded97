"""All effects: which machines they are for, their declarations, and which of them need which."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

from camgeo.dynamics.effects import tables
from camgeo.dynamics.effects.effect import (
    SPEED,
    Effect,
    EffectTable,
    Key,
    Kind,
    MachineTraits,
    Only,
    Refinement,
)
from camgeo.dynamics.effects.results import (
    ACTING,
    CAMSHAFT_WINDUP,
    CONTACT_FORCE,
    DRIVE_TORQUE,
    FINDERS,
    FRICTION,
    GRAVITY,
    INERTIA,
    LIFT_OFF,
    LOAD,
    SPEED_FLUCTUATION,
    SPRING,
    VIBRATION,
    Turning,
)
from camgeo.dynamics.state.state import Train
from camgeo.errors import CycleError, UnknownNameError
from camgeo.record import stored_schema

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint


# -- machines -------------------------------------------------------------------------------------


ROCKING: Final = Kind(
    "lift", ("mm",), "is for rockers, and this follower is translating", "Rockers only."
)
ROLLERS: Final = Kind("touching", ("face",), "is for roller followers", "Roller followers only.")
ROUND: Final = Kind(
    "edged", (True,), "is for rollers: the follower has a knife edge", "Not with a knife edge."
)
FLATS: Final = Kind(
    "touching", ("roller",), "is for flat-faced followers", "Flat-faced followers only."
)
ONE_DISC: Final = Kind(
    "paired",
    (True,),
    "supports a single disc, and a conjugate pair, [follower.return], has two",
    "Not with a conjugate pair.",
    "return",
)
ONE_ROLLER: Final = Kind(
    "paired",
    (True,),
    "supports a single roller, and a conjugate pair, [follower.return], has two",
    "Not with a conjugate pair.",
    "return",
)
DRIVING_SLIDER: Final = Kind(
    "far",
    ("", "lever", "crank"),
    "is for a slider that drives a rocker, and the scene has no such linkage",
    "Only with a slider that drives a rocker.",
)
STRAIGHT: Final = Kind(
    "straight",
    (False,),
    DRIVING_SLIDER.message,
    "Translating followers, or sliders that drive rockers, only.",
)
GUIDED: Final = Kind(
    "lift",
    ("rad",),
    "is for translating followers, and this follower is a rocker",
    "Translating followers only.",
)
LINKED: Final = Kind(
    "far", ("",), "is for linkages, and the scene has no [linkage]", "Only with a linkage."
)
TURNING: Final = Kind(
    "far",
    ("", "slider"),
    "is for the lever of a four-bar linkage, or a crank driven by a slider",
    "Only with the lever of a four-bar linkage, or a crank driven by a slider.",
)
PLAYED: Final = Kind(
    "yoked",
    (True,),
    "is not for a yoke, [follower.yoke], whose play follows from its breadth",
    "Not with a yoke.",
    "yoke",
)
ANGLES: Final = Kind(
    "demanded",
    ("mm",),
    "is for a demanded motion that is an angle, and here it is a length",
    "Only where the demanded motion is an angle.",
)
LENGTHS: Final = Kind(
    "demanded",
    ("rad",),
    "is for a demanded motion that is a length, and here it is an angle",
    "Only where the demanded motion is a length.",
)


def tilts(machine: MachineTraits, table: EffectTable) -> Iterator[tuple[str, str]]:
    """The `Rule` that a flat-faced follower with guide friction needs the length of the guide."""
    checked = {"guide_overhang", "guide_offset"} & table.values.keys()  # its parser asks for it
    rubs = machine.touching in ROLLERS.others and table.values.get("guide")
    if rubs and table.lacks("guide_length") and not checked:
        reason = (
            "is missing: the cam presses a flat face away from the axis of its guide, so the"
            " follower tilts, and friction depends on the length of the guide"
        )
        yield "guide_length", reason


# -- declarations ---------------------------------------------------------------------------------


ELASTIC: Final = Refinement("vibration", "a rigid follower", followed=True)
STATED_SPEED: Final = Refinement("speed-fluctuation", "the speed that the scene gives")
STIFF_SHAFT: Final = Refinement("camshaft-windup", "a camshaft that does not twist")

AT_SPEED: Final = (STATED_SPEED, STIFF_SHAFT)
"""Effects that find how the cam turns."""

ROLLER_KEYS: Final = ("roller_pin", "roller_pin_diameter", "rolling")
"""Keys of the friction of a roller."""


def _module_fields(name: str, module: str = "") -> dict[str, Any]:
    """The fields of a declaration that follow from the `name` of an effect of camgeo: its code is
    in the module of that name, or in `module`, and its schema beside it.
    """
    stem = name.replace("-", "_")
    return {
        "name": str(name),  # no `Key`, which is not for JSON
        "compute": f"camgeo.dynamics.effects.{module or stem}:compute",
        "schema": stored_schema(__file__, stem),
    }


DECLARED: Final = {
    effect.name: effect
    for effect in (
        Effect(
            **_module_fields("kinematics"),
            title="motion in time",
            keys=(SPEED,),
            of_drive=True,
            premise="motion",
            regardless=("turn-time",),
            refined_by=AT_SPEED,
        ),
        Effect(
            **_module_fields(INERTIA),
            title="inertia force",
            parse=tables.parse_inertia,
            rules=(
                Only(ROCKING, "moment_of_inertia", "rocker_mass", "rocker_centre"),
                Only(ROLLERS, "roller_mass"),
                Only(LINKED, "coupler_mass", "coupler_centre", "coupler_moment"),
                Only(TURNING, "output_moment"),
                Only(STRAIGHT, "mass"),
            ),
            keys=(SPEED,),
            tabled=True,
            premise="motion",
            regardless=("reduced-mass", "reduced-moment-of-inertia"),
            refined_by=(Refinement("vibration", "a rigid follower"), *AT_SPEED),
        ),
        Effect(
            **_module_fields(GRAVITY),
            title="weights",
            needs=(INERTIA,),
            keys=((f"effects.{INERTIA}",),),
            premise="motion",
            regardless=("weight",),
        ),
        Effect(
            **_module_fields(LOAD),
            title="process load",
            parse=tables.parse_load,
            tabled=True,
            premise="motion",
        ),
        Effect(
            **_module_fields(SPRING),
            title="force of the spring that closes the contact",
            parse=tables.parse_spring,
            tabled=True,
            premise="motion",
        ),
        Effect(
            **_module_fields("spring-surge"),
            title="surge of the helical spring",
            needs=(SPRING,),
            keys=(SPEED, ("effects.spring",)),
            numerical=True,
            premise="motion",
            refined_by=AT_SPEED,
        ),
        Effect(
            **_module_fields(FRICTION),
            title="friction in guide, pivot, slider, roller and face",
            parse=tables.parse_friction,
            rules=(
                Only(ONE_ROLLER, "guide_length", "guide_overhang"),
                Only(GUIDED, "guide", "guide_length", "guide_overhang", "guide_offset"),
                Only(ROCKING, "pivot", "pivot_diameter", "pivot_viscous"),
                Only(ROLLERS, *ROLLER_KEYS),
                Only(ROUND, *ROLLER_KEYS),
                Only(FLATS, "face", "guide_offset"),
                tilts,
                Only(DRIVING_SLIDER, "slider"),
                Only(STRAIGHT, "guide_viscous"),
            ),
            tabled=True,
        ),
        Effect(
            **_module_fields(CONTACT_FORCE),
            title="force between cam and follower along their common normal",
            uses=(*ACTING, FRICTION, VIBRATION),
            keys=(tuple(f"effects.{name}" for name in ACTING),),
            refined_by=(ELASTIC, *AT_SPEED),
        ),
        Effect(
            **_module_fields("reactions"),
            title="forces in guide, pivot, pins and camshaft bearings",
            parse=tables.parse_reactions,
            rules=(Only(ONE_DISC, "bearings"),),
            needs=(CONTACT_FORCE,),
            uses=(INERTIA, GRAVITY, SPRING),
            numerical=True,
            refined_by=(ELASTIC, *AT_SPEED),
        ),
        Effect(
            **_module_fields("roller-spin"),
            title="spin of the roller, and where it skids",
            rules=(Only(ONE_ROLLER), Only(ROLLERS), Only(ROUND)),
            needs=(CONTACT_FORCE,),
            keys=(SPEED,),
            tabled=True,
            refined_by=(ELASTIC, *AT_SPEED),
        ),
        Effect(
            **_module_fields(LIFT_OFF, "lift_off.result"),
            title="where the follower leaves its flank, from which speed, and what prevents it",
            rules=(Only(PLAYED, "backlash"), Only(ROLLERS, "backlash")),
            needs=(CONTACT_FORCE,),
            uses=(INERTIA, SPRING),
            numerical=True,
            premise="motion",
            refined_by=(
                replace(ELASTIC, caution="an elastic one may leave the cam at a lower speed"),
                *AT_SPEED,
            ),
        ),
        Effect(
            **_module_fields(DRIVE_TORQUE),
            title="torque on the camshaft",
            needs=(CONTACT_FORCE,),
            numerical=True,
            refined_by=(ELASTIC, *AT_SPEED),
        ),
        Effect(
            **_module_fields("power-balance"),
            title="power of the camshaft, what takes it, and the efficiency",
            needs=(CONTACT_FORCE, DRIVE_TORQUE),
            keys=(SPEED,),
            numerical=True,
            refined_by=(ELASTIC, *AT_SPEED),
        ),
        Effect(
            **_module_fields(SPEED_FLUCTUATION),
            title="speed of the motor-driven cam",
            parse=tables.parse_speed_fluctuation,
            needs=(DRIVE_TORQUE,),
            tabled=True,
            numerical=True,
            refined_by=(ELASTIC,),
        ),
        Effect(
            **_module_fields(CAMSHAFT_WINDUP),
            title="torsion of the camshaft",
            parse=tables.parse_camshaft_windup,
            needs=(DRIVE_TORQUE,),
            keys=(("cam.speed",),),
            tabled=True,
            numerical=True,
            refined_by=(ELASTIC,),
        ),
        Effect(
            **_module_fields("contact-pressure"),
            title="pressure between cam and follower",
            parse=tables.parse_contact_pressure,
            rules=(Only(ROLLERS, *tables.OF_ROLLER), Only(FLATS, *tables.OF_FACE)),
            needs=(CONTACT_FORCE,),
            numerical=True,
            refined_by=(ELASTIC, *AT_SPEED),
        ),
        Effect(
            **_module_fields(VIBRATION),
            title="vibration of the follower train",
            parse=tables.parse_vibration,
            rules=(
                Only(LENGTHS, "stiffness", "limit", "masses"),
                Only(ANGLES, "torsional_stiffness", "limit_angle", "moments"),
            ),
            uses=(INERTIA, LOAD),
            keys=(SPEED,),
            tabled=True,
            numerical=True,
            regardless=("natural-frequency", "time-constant", "settling"),
            refined_by=AT_SPEED,
        ),
        Effect(
            **_module_fields("shock-spectrum"),
            title="shock spectrum of the moves",
            of_plan=True,
            refined_by=(
                Refinement("vibration", "a train that is at rest when a move begins"),
                *AT_SPEED,
            ),
        ),
        Effect(
            **_module_fields("balance"),
            title="balance of the disc",
            parse=tables.parse_balance,
            rules=(Only(ONE_DISC),),
            keys=(("part.thickness",),),
            numerical=True,
            premise="disc",
            refined_by=AT_SPEED,
        ),
    )
}
"""The effects of camgeo by name, each after those that it needs."""

EFFECTS: Final[tuple[str, ...]] = tuple(DECLARED)

GROUP: Final = "camgeo.effects"
"""Group of the entry points of effects from other distributions, named like the effect."""


def find_effect(name: str) -> Effect:
    """The declaration of the effect `name`; the code that computes the effect is not imported.

    Raises
    ------
    UnknownNameError
        If there is no such effect.
    TypeError
        If the object that another distribution registers is not an `Effect` of this name.
    """
    if name in DECLARED:
        return DECLARED[name]
    entry = _foreign().get(name)
    if entry is None:
        raise UnknownNameError("effect", name, effect_names())
    effect: Any = entry.load()
    if not isinstance(effect, Effect) or effect.name != name:
        raise TypeError(f"the object registered as effect {name!r} is not an effect of that name")
    return effect


def effect_names() -> tuple[str, ...]:
    """Names of all effects, those of camgeo first; imports none of them."""
    return (*EFFECTS, *sorted(_foreign()))


def _foreign() -> dict[str, EntryPoint]:
    from importlib.metadata import entry_points  # few scenes name a foreign effect

    return {entry.name: entry for entry in entry_points(group=GROUP) if entry.name not in EFFECTS}


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
        """The catalogue with another table of the effect `name`."""
        return Catalogue({**self.tables, name: table}, self._find, self._output)

    @property
    def finder(self) -> Key[Turning] | None:
        """The effect of the scene that finds how the cam turns; None if it names none."""
        return next((key for key in FINDERS if key in self.tables), None)

    def rigid(self) -> Catalogue:
        """The same catalogue, with effects that take the train as rigid."""
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
        self.dependencies(name)
        return self.received(name)

    def received(self, name: str) -> tuple[str, ...]:
        """The `inputs` of the effect `name`, where it is known that no effect needs itself."""
        effect = self.effect(name)
        used = [other for other in effect.uses if other in self.tables]
        if self._output == "rigid":
            better = self._better(effect)
            used = [other for other in used if other not in better]
        return (*effect.needs, *(other for other in used if other not in effect.needs))

    def follows_train(self, name: str) -> bool:
        """Whether the effect `name` takes an elastic train of the scene into account."""
        return self._output == "elastic" and bool(self._better(self.effect(name)))

    def _better(self, effect: Effect) -> set[str]:
        """The effects of the scene that `effect` follows unless its state is a simpler one."""
        return {
            refinement.effect
            for refinement in effect.refined_by
            if refinement.followed and refinement.effect in self.tables
        }

    def dependencies(self, name: str, way: tuple[str, ...] = ()) -> set[str]:
        """The effects that the effect `name` is computed from, directly or not; `way` leads to it.

        CycleError if an effect needs itself, with the path of the cycle.
        """
        if name in way:
            raise CycleError((*way[way.index(name) :], name))
        inputs = self.received(name)
        return set(inputs).union(*(self.dependencies(other, (*way, name)) for other in inputs))

    def declares_speed(self, name: str) -> bool:
        """Whether the effect `name` declares that its figures depend on the speed of the cam."""
        return any(refinement.effect in FINDERS for refinement in self.effect(name).refined_by)

    def depends_on_speed(self, name: str) -> bool:
        """Whether the effect `name` depends on the speed of the cam: all do, but the effect that
        finds it and, of what this is found from, those that declare no such thing.
        """
        if name == self.finder:
            return False
        behind = set() if self.finder is None else self.dependencies(self.finder)
        if self.declares_speed(name) or name not in behind:
            return True
        return any(self.depends_on_speed(other) for other in self.inputs(name))
