"""The tables of the effects in a scene: what each states, and what must be so beyond its schema.

The parser of a table raises GeometryError with the key in it. It is called when a scene is entered,
so nothing here computes.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np

from camgeo.dynamics.effects.effect import DataFile, Quantity, build_data
from camgeo.dynamics.effects.results import HelicalSpring
from camgeo.errors import GeometryError
from camgeo.kinematics.plan import in_turn
from camgeo.kinematics.tables import ANGLE, TwoColumns
from camgeo.numeric.arrays import FloatArray, Side, frozen
from camgeo.numeric.checked import CheckedFields, Floats
from camgeo.numeric.columns import NumberColumn
from camgeo.part.materials import USUAL, Material, find_material, table_density
from camgeo.units import RPM

if TYPE_CHECKING:
    from camgeo.dynamics.oscillator.train import Stage
    from camgeo.kinematics.mechanism.linkage import Linkage

Values = Mapping[str, Any]
"""Values by key, in the units of `camgeo.dynamics.effects.effect`."""


def _require(table: Values, key: str, what: str) -> None:
    if table.get(key) is None:
        raise GeometryError(f"is missing: {what}", key=key)


def _require_positive(table: Values, key: str, message: str) -> None:
    if not table[key] > 0.0:
        raise GeometryError(message, key=key, value=f"{table[key]:g}")


def _require_partner(table: Values, key: str, other: str, message: str) -> None:
    """Raise GeometryError if the table has `key` without `other`."""
    if key in table and other not in table:
        raise GeometryError(message, key=key)


# -- inertia --------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class MassProperties:
    """Masses [t], moments of inertia [t mm^2] and centres of mass [mm].

    Attributes
    ----------
    mass : of the translating member that has the demanded motion.
    moment_of_inertia : of the rocker about its pivot, including the crank of a linkage, without the
        roller.
    roller_mass : at the centre of the roller.
    rocker_mass : without the roller, for its weight and static unbalance.
    rocker_centre : centre of mass of the rocker at cam angle 0, relative to the cam axis; None for
        the pivot.
    coupler_mass : of the coupler of a linkage.
    coupler_centre : of its mass on the line between its joints, 0 at the crank, 1 at the far pin.
    coupler_moment : about its centre of mass; None for that of a slender rod.
    output_moment : about its shaft, of the lever of a four-bar linkage or of a crank driven by a
        slider.
    """

    mass: float = 0.0
    moment_of_inertia: float = 0.0
    roller_mass: float = 0.0
    rocker_mass: float = 0.0
    rocker_centre: complex | None = None
    coupler_mass: float = 0.0
    coupler_centre: float = 0.5
    coupler_moment: float | None = None
    output_moment: float = 0.0

    def far(self, linkage: Linkage) -> float:
        """Inertia of the member with the demanded motion: [t], or [t mm^2] if it turns."""
        return {"mm": self.mass, "rad": self.output_moment}[linkage.unit]

    def turning(self, linkage: Linkage) -> float:
        """Moment of inertia of the coupler about its centre of mass [t mm^2]; by default m l^2/12,
        that of a slender rod.

        (Tables of mass properties, e.g. in the appendix of Norton, "Design of Machinery".)
        """
        moment = self.coupler_moment
        return self.coupler_mass * linkage.coupler**2 / 12.0 if moment is None else moment

    def beyond(self, linkage: Linkage | None) -> bool:
        """Whether anything beyond the rocker, behind the linkage, has mass."""
        if linkage is None:
            return False
        return bool(self.far(linkage) or self.coupler_mass or self.coupler_moment)


def parse_inertia(table: Values) -> MassProperties:
    """The masses; a centre or moment needs the mass of its body."""
    for key, mass in (
        ("rocker_centre", "rocker_mass"),
        ("coupler_centre", "coupler_mass"),
        ("coupler_moment", "coupler_mass"),
    ):
        _require_partner(table, key, mass, f"needs {mass}, which is missing")
    if "rocker_centre" in table:
        table = {**table, "rocker_centre": complex(*table["rocker_centre"])}
    return MassProperties(**table)


# -- load -----------------------------------------------------------------------------------------
# Loads over the cam angle: one value, one value per segment, or linear interpolation in a table.


LOADS: Final = ("constant", "segments", "file")
"""Keys, one of which states the load."""

LOAD_COLUMN: Final = NumberColumn(
    "load", ("f", "force", "load", "m", "t", "torque"), ("n", "nm", "n m"), "N or Nm"
)


@dataclass(frozen=True, slots=True, eq=False)
class LoadProfile:
    """A load over the cam angle, in the unit of the scene.

    Attributes
    ----------
    values : (n,) the load; at a border the side decides.
    borders : (k,) cam angles [rad] in [0, 2 pi) where the load may jump or have a kink.
    unit : "N" or "N m" if the heading of a file states it, else empty.
    """

    values: Quantity
    borders: FloatArray = field(default_factory=lambda: np.empty(0))
    unit: str = ""


def parse_load(table: Values) -> LoadProfile | Sequence[float]:
    """The load over the cam angle; if it is given by segments, one value [N or N m] for each of
    non-zero length.

    Exactly one of the keys must be given, and a file must have the format in the schema, with
    angles that ascend from 0 to 360 degrees.
    """
    stated = [key for key in LOADS if key in table]
    if len(stated) != 1:
        words = " and ".join(stated) if stated else "none"
        raise GeometryError(
            f"exactly one of {', '.join(LOADS)} is needed, and the scene gives {words}",
            key=stated[1] if stated else "",
        )
    if "segments" in table:
        segments: Sequence[float] = table["segments"]
        return segments
    if "constant" in table:
        constant = table["constant"]
        return LoadProfile(lambda phi, _side: np.full(len(phi), constant))
    try:
        return read_load_table(table["file"])
    except GeometryError as error:
        raise GeometryError(error.message, "file", error.value) from error


def read_load_table(file: DataFile) -> LoadProfile:
    """Linear interpolation between the rows of `file`: cam angle [degrees] and load.

    If the last load differs from the first one, the load jumps at cam angle 0.

    See `camgeo.numeric.columns` for the format; a heading may name the columns "phi", "angle" or
    "cam angle" [deg], and "F", "force", "load", "M", "T" or "torque" [N or Nm].

    Raises
    ------
    GeometryError
        With file and line, if a row does not have this format, or the angles do not ascend from 0
        to 360 degrees.
    """
    rows = TwoColumns.read(file.data, file.name, (ANGLE, LOAD_COLUMN))
    angles = rows.turn_radians(rows.first)
    unit = {"n": "N", "nm": "N m", "n m": "N m"}.get(rows.unit.lower(), "")

    def values(phi: FloatArray, side: Side) -> FloatArray:
        return np.interp(in_turn(phi, side), angles, rows.second)

    return LoadProfile(values, frozen(angles[:-1], np.float64), unit)


# -- spring ---------------------------------------------------------------------------------------


SpringKind = Literal["compression", "extension", "torsion"]

ENDS: Final = ("anchor", "attachment")

LINEAR: Final = ("stiffness", "preload")

TORSIONAL: Final = ("torsional_stiffness", "preload_torque")

WIRE: Final = "wire"
"""The table of the wire, which states the stiffness in other words."""

INACTIVE: Final = 2.0
"""Coils at squared ends that do not deflect, one at each."""

STEEL: Final = {"shear_modulus": 79300.0, "density": 7.85e-9}
"""Shear modulus [MPa] and density [t/mm^3] of spring steel."""


@dataclass(frozen=True, slots=True)
class SpringData:
    """The data of the spring.

    Attributes
    ----------
    kind : see `SpringKind`.
    stiffness : k [N/mm], or [N mm/rad] for a torsion spring.
    preload : P at cam angle 0 [N], or [N mm].
    anchor, attachment : the ends of a spring on a rocker at cam angle 0, relative to the cam axis
        [mm].
    helical : the helical spring that has this stiffness; None if the scene states it itself.
    """

    kind: SpringKind
    stiffness: float
    preload: float
    anchor: complex | None = None
    attachment: complex | None = None
    helical: HelicalSpring | None = None


def parse_spring(table: Values) -> SpringData:
    """The spring, which needs the keys for its kind, and only these, or a wire of which it can be
    wound.
    """
    kind: SpringKind = table.get("kind", "compression")
    article = f"{'an' if kind == 'extension' else 'a'} {kind} spring"
    helical = None
    if WIRE in table:
        helical = _helical_spring(kind, table)
        table = {**table, "stiffness": helical.stiffness}
    needed, foreign = (TORSIONAL, (*LINEAR, *ENDS)) if kind == "torsion" else (LINEAR, TORSIONAL)
    for key in needed:
        _require(table, key, f"{article} needs {' and '.join(needed)}")
    for key in foreign:
        if key in table:
            raise GeometryError(
                f"does not belong to {article}, which has {' and '.join(needed)}", key=key
            )
    for end, other in (ENDS, ENDS[::-1]):
        if end in table:
            _require(table, other, f"{end} is only one end of the spring")
    anchor, attachment = (complex(*table[key]) if key in table else None for key in ENDS)
    return SpringData(
        kind, float(table[needed[0]]), float(table[needed[1]]), anchor, attachment, helical
    )


def _helical_spring(kind: SpringKind, table: Values) -> HelicalSpring:
    """The spring of the table of its wire; raises GeometryError as `parse_spring` does."""
    if kind != "compression":
        raise GeometryError("is for compression springs", key=WIRE)
    if "stiffness" in table:
        raise GeometryError("follows from wire: give only one of them", key="stiffness")
    wire = table[WIRE]
    active = wire["active_coils"]
    spring = HelicalSpring(
        wire=wire["diameter"],
        coil=wire["coil_diameter"],
        active=active,
        total=wire.get("total_coils", active + INACTIVE),
        free_length=wire["free_length"],
        shear_modulus=wire.get("shear_modulus", STEEL["shear_modulus"]),
        density=wire.get("density", STEEL["density"]),
        seats=wire.get("seats", "flat"),
        strength=wire.get("strength"),
    )
    for key, value, fits, allowed in (
        (
            "coil_diameter",
            spring.coil,
            spring.coil > spring.wire,
            f"above {spring.wire:g} mm, that of the wire",
        ),
        (
            "total_coils",
            spring.total,
            spring.total >= active,
            f"at least {active:g}, the active coils",
        ),
        (
            "free_length",
            spring.free_length,
            spring.free_length > spring.solid_length,
            f"above {spring.solid_length:g} mm, the length with all coils touching",
        ),
    ):
        if not fits:
            raise GeometryError(f"must be {allowed}", key=f"{WIRE}.{key}", value=f"{value:g}")
    return spring


# -- friction -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class FrictionCoefficients:
    """Coefficients of friction and the lengths they need; 0 means no friction.

    Attributes
    ----------
    guide : coefficient in the guide of a translating follower.
    guide_length : b, bearing length between the ends of the guide [mm]; None for no tilting.
    guide_overhang : a_0, from the roller centre outwards to the near end at cam angle 0 [mm].
    guide_viscous : of that guide, or of the slider of a linkage [N s/mm].
    pivot : coefficient in the bearing of a rocker.
    pivot_diameter : of that bearing [mm].
    pivot_viscous : of that bearing [N mm s/rad].
    slider : Coulomb friction of the slider of a linkage [N].
    roller_pin : coefficient in the bearing of the roller.
    roller_pin_diameter : of that bearing [mm].
    rolling : lever arm of rolling friction between roller and cam [mm].
    face : coefficient between a flat face and the cam.
    guide_offset : of the axis of the guide from the cam axis, to the right looking along the guide
        away from the cam [mm]; for a flat-faced follower, whose motion does not depend on it.
    """

    guide: float = 0.0
    guide_length: float | None = None
    guide_overhang: float = 0.0
    guide_viscous: float = 0.0
    pivot: float = 0.0
    pivot_diameter: float = 0.0
    pivot_viscous: float = 0.0
    slider: float = 0.0
    roller_pin: float = 0.0
    roller_pin_diameter: float = 0.0
    rolling: float = 0.0
    face: float = 0.0
    guide_offset: float = 0.0


def parse_friction(table: Values) -> FrictionCoefficients:
    """The coefficients, some of which need the diameter of a bearing or the length of a guide."""
    for coefficient in ("pivot", "roller_pin"):
        if table.get(coefficient):
            needs = f"{coefficient} needs the diameter of its bearing"
            _require(table, f"{coefficient}_diameter", needs)
    for key, what in (("guide_overhang", "overhang"), ("guide_offset", "offset")):
        if key in table:
            needs = f"the {what} of a guide has an effect only with its length"
            _require(table, "guide_length", needs)
    return FrictionCoefficients(**table)


# -- reactions ------------------------------------------------------------------------------------


def parse_reactions(table: Values) -> tuple[float, float] | None:
    """Places of both bearings of the camshaft along its axis, which must be two, from the middle
    plane of the disc [mm]; None if they are not stated.
    """
    if "bearings" not in table:
        return None
    first, second = table["bearings"]
    if first == second:
        raise GeometryError(
            "must be at two places", key="bearings", value=f"[{first:g}, {second:g}]"
        )
    return first, second


# -- speed fluctuation ----------------------------------------------------------------------------


N_MM: Final = 1e3
"""Factor from N m to N mm."""

SPEED_COLUMN: Final = NumberColumn(
    "speed", ("n", "speed"), ("rev/min", "rpm", "1/min", "min-1", "min^-1", "r/min")
)
TORQUE_COLUMN: Final = NumberColumn("torque", ("m", "t", "torque"), ("n m", "nm", "n*m"))

MOTOR_LINE: Final = ("stall_torque", "no_load_speed")
"""Keys of a motor whose torque falls along a straight line."""


@dataclass(frozen=True, slots=True, eq=False)
class Motor(CheckedFields):
    """Torque on the camshaft over its speed.

    It is linear between rows, and the first and last lines are extrapolated.

    Attributes
    ----------
    speeds : (k,) [rad/s], k >= 2, ascending.
    torques : (k,) [N mm], descending.
    """

    speeds: Floats
    torques: Floats

    def torque(self, omega: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Torque [N mm] and its derivative [N mm s] at the speeds `omega` (...) [rad/s]."""
        row = np.clip(np.searchsorted(self.speeds, omega, "right") - 1, 0, len(self.speeds) - 2)
        slope = (np.diff(self.torques) / np.diff(self.speeds))[row]
        return self.torques[row] + slope * (omega - self.speeds[row]), slope

    @property
    def no_load_speed(self) -> float:
        """Speed [rad/s] at which the torque is 0; 0 if it is never positive."""
        if self.torques[-1] > 0.0:
            slope = (self.torques[-1] - self.torques[-2]) / (self.speeds[-1] - self.speeds[-2])
            return float(self.speeds[-1] - self.torques[-1] / slope)
        if self.torques[0] <= 0.0:
            slope = (self.torques[1] - self.torques[0]) / (self.speeds[1] - self.speeds[0])
            return max(float(self.speeds[0] - self.torques[0] / slope), 0.0)
        return float(np.interp(0.0, self.torques[::-1], self.speeds[::-1]))


def _motor(table: Values) -> Motor:
    """The motor of the table, a straight line or a file, but not both."""
    stated = [key for key in MOTOR_LINE if key in table]
    if "file" in table:
        if stated:
            raise GeometryError(
                "contradicts file, which also gives the torque of the motor", key=stated[0]
            )
        return read_motor(table["file"])
    for key in MOTOR_LINE:
        _require(table, key, "the motor needs stall_torque and no_load_speed, or a file")
    _require_positive(
        table,
        "stall_torque",
        "the torque of the motor must fall to 0 at no_load_speed; allowed: above 0 N m",
    )
    return Motor(
        np.array([0.0, table["no_load_speed"]]),
        np.array([table["stall_torque"], 0.0]),
    )


def read_motor(file: DataFile) -> Motor:
    """The motor of a CSV file: speed [rev/min] and torque [N m].

    See `camgeo.numeric.columns` for the format; a heading may name the columns "n" or "speed",
    and "M", "T" or "torque". GeometryError with file and line if the curve does not fall.
    """
    try:
        table = TwoColumns.read(file.data, file.name, (SPEED_COLUMN, TORQUE_COLUMN))
        table.check_ascending(table.first, "speed")
        if table.first[0] < 0.0:
            raise table.fault(0, table.first, "a speed below 0 rev/min")
        rises = np.flatnonzero(np.diff(table.second) >= 0.0)
        if len(rises):
            row = int(rises[0]) + 1
            previous = float(table.second[row - 1])
            message = f"the previous torque is {previous!r}; the torque must decrease"
            raise table.fault(row, table.second, message)
    except GeometryError as error:
        raise GeometryError(error.message, "file", error.value) from error
    return Motor(RPM * table.first, N_MM * table.second)


@dataclass(frozen=True, slots=True)
class MotorDrive:
    """The motor and what it drives.

    Attributes
    ----------
    moment_of_inertia : J of everything that turns with the camshaft [t mm^2], above 0.
    motor : its torque over speed.
    limit : allowed speed fluctuation; None for no limit.
    """

    moment_of_inertia: float
    motor: Motor
    limit: float | None

    @property
    def first_speed(self) -> float | None:
        """A speed [rad/s] near that of the cam: that of the motor alone; None if it never turns."""
        return self.motor.no_load_speed or None


def parse_speed_fluctuation(table: Values) -> MotorDrive:
    """The motor, and the inertia that it drives, which cannot be 0."""
    key = "moment_of_inertia"
    _require(table, key, "the moment of inertia of everything that turns with the camshaft")
    _require_positive(
        table,
        key,
        "without inertia there is no equation of motion for the speed; allowed: above 0",
    )
    return MotorDrive(table[key], _motor(table), table.get("limit"))


# -- wind-up of the camshaft ----------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class ElasticShaft:
    """The camshaft between its drive and the cam.

    Attributes
    ----------
    stiffness : k [N mm/rad], above 0.
    moment_of_inertia : J of what turns with the cam [t mm^2], above 0.
    damping : D, the ratio to critical damping, in [0, 1).
    limit : largest wind-up allowed [rad]; None for no limit.
    """

    stiffness: float
    moment_of_inertia: float
    damping: float = 0.0
    limit: float | None = None

    @property
    def natural_frequency(self) -> float:
        """sqrt(k / J) [rad/s]: of the cam without its follower on the shaft."""
        return math.sqrt(self.stiffness / self.moment_of_inertia)

    @property
    def viscosity(self) -> float:
        """c = 2 D sqrt(k J) [N mm s]."""
        return 2.0 * self.damping * math.sqrt(self.stiffness * self.moment_of_inertia)


def parse_camshaft_windup(table: Values) -> ElasticShaft:
    """The shaft, whose stiffness and moment of inertia cannot be 0."""
    for key, words in (
        ("stiffness", "the torsional stiffness of the camshaft"),
        ("moment_of_inertia", "the moment of inertia of what turns with the cam"),
    ):
        _require(table, key, words)
        _require_positive(table, key, f"{words} cannot be 0; allowed: above 0")
    return build_data(ElasticShaft, table)


# -- contact pressure -----------------------------------------------------------------------------


RollingElement = Literal["roller", "ball"]
"""What rolls in the bearing of the roller."""

HARDENED: Final = "steel-hardened"

OF_FACE: Final = ("face_material", "face_modulus", "face_poisson")
OF_ROLLER: Final = (
    "roller_material", "roller_modulus", "roller_poisson", "rating", "bearing", "life",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class PressureRequirements:
    """Materials, width and limits of the contact.

    Attributes
    ----------
    cam, mate : materials of the cam, and of the roller or face.
    limit : largest pressure allowed [MPa].
    safety : required safety against this limit.
    width : of the contact [mm]; None for that of the part.
    rating : dynamic load rating of the roller bearing [N]; None to compute no life.
    bearing : kind of that bearing.
    life : required life of the bearing [s]; None for no requirement.
    """

    cam: Material
    mate: Material
    limit: float
    safety: float = 1.0
    width: float | None = None
    rating: float | None = None
    bearing: RollingElement = "roller"
    life: float | None = None

    @property
    def modulus(self) -> float:
        """Contact modulus E* [MPa], see `camgeo.dynamics.effects.contact_pressure`."""
        return 1.0 / (self.cam.compliance + self.mate.compliance)

    @property
    def allowed(self) -> float:
        """Largest pressure with the required safety [MPa]."""
        return self.limit / self.safety


def parse_contact_pressure(table: Values) -> PressureRequirements:
    """What is required of the contact, which has a roller or a face.

    A material that has no generally accepted limit of the pressure needs one in the table, a life
    the rating of the bearing.
    """
    who = "face" if any(key in table for key in OF_FACE) else "roller"
    both = [key for key in OF_ROLLER if key in table] if who == "face" else []
    if both:
        raise GeometryError(
            "is a key of a roller, and cannot be combined with those of a face", key=both[0]
        )
    cam, mate = (_material(body, table) for body in ("cam", who))
    if table.get("rating") is not None:
        _require_positive(table, "rating", "the load rating must be above 0 N")
    _require_partner(
        table, "life", "rating", "needs the load rating of the roller bearing, `rating`"
    )
    limit = table["limit"] if "limit" in table else _common_limit(cam, mate)
    return build_data(PressureRequirements, {**table, "cam": cam, "mate": mate, "limit": limit})


def _material(who: str, table: Values) -> Material:
    key = f"{who}_material"
    material = find_material(table.get(key, HARDENED), key)
    return replace(
        material,
        modulus=table.get(f"{who}_modulus", material.modulus),
        poisson=table.get(f"{who}_poisson", material.poisson),
    )


def _common_limit(cam: Material, mate: Material) -> float:
    """The smaller limit of the two materials [MPa]."""
    limits = []
    for material in (cam, mate):
        if material.pressure is None:
            raise GeometryError(
                f"is missing: there is no generally accepted limit of the pressure for"
                f" {material.name}",
                key="limit",
            )
        limits.append(material.pressure)
    return min(limits)


# -- vibration ------------------------------------------------------------------------------------


TRAINS: Final = ("natural_frequency", "stiffness", "torsional_stiffness", "masses", "moments")
"""Keys, one of which says what the train is."""


@dataclass(frozen=True, slots=True)
class Second:
    """A second mass on a spring and a damper on the first one.

    Attributes
    ----------
    natural_frequency : with the first mass held fixed [rad/s].
    mass_ratio : to the first mass, above 0.
    damping : damping ratio, in [0, 1).
    """

    natural_frequency: float
    mass_ratio: float
    damping: float = 0.0


@dataclass(frozen=True, slots=True)
class TrainData:
    """The elastic train.

    Attributes
    ----------
    natural_frequency : of the first mass without the second [rad/s]; None if a stiffness gives it.
    stiffness : at the member with the demanded motion [N/mm].
    torsional_stiffness : the same for a rotation [N mm/rad].
    damping : damping ratio.
    limit : largest allowed error of the demanded motion [mm].
    limit_angle : the same for a rotation [rad].
    second : a second mass, or None.
    stages : masses [t or t mm^2], springs and dampers from the cam outwards; empty if the keys
        above give the train.
    output : number of the mass among them that is the output, from 1; None for the last.
    """

    natural_frequency: float | None = None
    stiffness: float | None = None
    torsional_stiffness: float | None = None
    damping: float = 0.0
    limit: float | None = None
    limit_angle: float | None = None
    second: Second | None = None
    stages: tuple[Stage, ...] = ()
    output: int | None = None


def parse_vibration(table: Values) -> TrainData:
    """The train, which exactly one key gives."""
    stated = [key for key in TRAINS if table.get(key) is not None]
    if not stated:
        raise GeometryError(
            "is missing, and so are stiffness, torsional_stiffness, masses and moments: one of"
            " them is needed",
            key="natural_frequency",
        )
    if len(stated) > 1:
        raise GeometryError(
            f"cannot be combined with {stated[0]}: give only one of them", key=stated[1]
        )
    kind = stated[0]
    if kind in ("masses", "moments"):
        return _listed(table, kind)
    _require_positive(table, kind, "must be above 0, or nothing would move the follower")
    if "output" in table:
        raise GeometryError(
            "needs masses or moments, of one of which it is the number", key="output"
        )
    second = build_data(Second, table["second"]) if "second" in table else None
    return build_data(TrainData, {**table, "second": second})


def _listed(table: Values, kind: str) -> TrainData:
    """The train given mass by mass."""
    from camgeo.dynamics.oscillator.train import Stage  # few trains are

    for key in ("damping", "second"):
        if key in table:
            raise GeometryError(
                f"cannot be combined with {kind}: each mass has its own damping", key=key
            )
    mass, stiffness, viscous = (
        ("moment", "torsional_stiffness", "viscous_torque")
        if kind == "moments"
        else ("mass", "stiffness", "viscous")
    )
    stages = []
    for number, row in enumerate(table[kind], 1):
        for key in (mass, stiffness):
            if not row[key] > 0.0:
                raise GeometryError(f"{key} of number {number} must be above 0", key=kind)
        if "damping" in row and viscous in row:
            raise GeometryError(
                f"damping and {viscous} of number {number} both give its damper; allowed: one",
                key=kind,
            )
        ratio = 2.0 * row.get("damping", 0.0) * math.sqrt(row[stiffness] * row[mass])
        stages.append(
            Stage(
                row[mass],
                row[stiffness],
                row.get(viscous, ratio),
                row.get(f"ground_{stiffness}", 0.0),
                row.get(f"ground_{viscous}", 0.0),
            )
        )
    output = table.get("output")
    if output is not None and output > len(stages):
        raise GeometryError(
            f"is the number of one of the {kind}; allowed: 1 to {len(stages)}",
            key="output",
            value=str(output),
        )
    limits = {key: table[key] for key in ("limit", "limit_angle") if key in table}
    return TrainData(stages=tuple(stages), output=output, **limits)


# -- balance --------------------------------------------------------------------------------------


LARGEST_HOLE: Final = 0.25
"""Largest diameter of a balancing hole as a share of its distance from the axis, by default."""


@dataclass(frozen=True, slots=True)
class BalanceRequirements:
    """Density of the disc, and what is required of its balance.

    Attributes
    ----------
    density : of the disc [t/mm^3].
    counterweight_radius : distance of the counterweight's centre of mass from the cam axis [mm];
        None for no counterweight.
    holes : distance of balancing holes from the cam axis, and the largest diameter allowed [mm];
        None for no holes.
    grade : balance quality grade G [mm/s]; None for no requirement.
    """

    density: float
    counterweight_radius: float | None = None
    holes: tuple[float, float] | None = None
    grade: float | None = None


def parse_balance(table: Values) -> BalanceRequirements:
    """The density of a known material, and means of balancing."""
    _require_partner(
        table,
        "hole_diameter",
        "hole_radius",
        "needs hole_radius, the distance of the holes from the cam axis",
    )
    values = {**table, "density": table_density({"material": USUAL, **table})}
    if "hole_radius" in table:
        radius = table["hole_radius"]
        values["holes"] = radius, table.get("hole_diameter", LARGEST_HOLE * radius)
    return build_data(BalanceRequirements, values)
