"""What a scene states on printing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any, Final

from camgeo.kinematics.mechanism.values import Length
from camgeo.numeric.checked import CheckedFields, instance_from_table, number, whole

LEAST_SHRINKAGE, MOST_SHRINKAGE = -10.0, 20.0
"""Of a length, in percent; printed parts of some materials grow."""

MOST_STEPS: Final = 20
"""Of an elephant's foot."""

Percent = Annotated[float, partial(number, least=LEAST_SHRINKAGE, most=MOST_SHRINKAGE, unit="%")]
Steps = Annotated[int, partial(whole, least=1, most=MOST_STEPS)]


@dataclass(frozen=True, slots=True)
class Foot(CheckedFields, path="print.elephant_foot."):
    """How the lowest layers are drawn in: the weight of the part and the hot bed squeeze them wide.

    Attributes
    ----------
    inset : by which every edge of the lowest face is drawn into the material, per side [mm].
    height : above the lowest face, from which on the part has its size [mm].
    steps : of equal height, each drawn in less by the same amount.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    inset: Length
    height: Length
    steps: Steps = 1

    @property
    def insets(self) -> tuple[float, ...]:
        """By which each step is drawn in [mm], from the lowest one upwards."""
        return tuple(self.inset * (self.steps - step) / self.steps for step in range(self.steps))


@dataclass(frozen=True, slots=True)
class Shrinkage(CheckedFields, path="print.shrinkage."):
    """How much smaller a printed part comes out than its file says.

    Attributes
    ----------
    xy, z : of a length in the plane of the disc and along the cam axis [%].

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    xy: Percent = 0.0
    z: Percent = 0.0

    @property
    def scale_xy(self) -> float:
        """By which the part in the file is larger in the plane of the disc."""
        return 1.0 / (1.0 - 0.01 * self.xy)

    @property
    def scale_z(self) -> float:
        """By which it is larger along the cam axis."""
        return 1.0 / (1.0 - 0.01 * self.z)


@dataclass(frozen=True, slots=True)
class PrintSpec(CheckedFields, path="print."):
    """`[print]`: how bodies are compensated, and with what they are printed.

    Attributes
    ----------
    bore_clearance : by which the bore is larger in diameter [mm]; None for not at all.
    key_clearance : by which the keyway is wider [mm], half of it per side; its bottom, and the flat
        of a bore for a D-shaft, lie half of it farther from the cam axis. None for not at all.
    elephant_foot : of the lowest layers; None for none.
    shrinkage : that the part in the file makes up for; None for none.
    nozzle : width of the lines that the nozzle lays down [mm]; None if it is not stated.

    Raises
    ------
    GeometryError
        With the key, if a value is invalid.
    """

    bore_clearance: Length | None = None
    key_clearance: Length | None = None
    elephant_foot: Foot | None = None
    shrinkage: Shrinkage | None = None
    nozzle: Length | None = None

    @property
    def scale_xy(self) -> float:
        """See `Shrinkage`; 1 without one."""
        return 1.0 if self.shrinkage is None else self.shrinkage.scale_xy

    @property
    def scale_z(self) -> float:
        """See `Shrinkage`; 1 without one."""
        return 1.0 if self.shrinkage is None else self.shrinkage.scale_z

    @property
    def compensates(self) -> bool:
        """Whether a printed body differs from the part."""
        return bool(self.facts)

    @property
    def facts(self) -> dict[str, int | float | str]:
        """The compensation as certificates state it; empty if there is none."""
        found: dict[str, int | float | str] = {}
        for name in ("bore_clearance", "key_clearance"):
            if getattr(self, name) is not None:
                found[f"{name}_mm"] = getattr(self, name)
        if self.elephant_foot is not None:
            foot = self.elephant_foot
            found |= {"foot_inset_mm": foot.inset, "foot_height_mm": foot.height}
            found["foot_steps"] = foot.steps
        if (self.scale_xy, self.scale_z) != (1.0, 1.0):
            found |= {"scale_xy": self.scale_xy, "scale_z": self.scale_z}
        return found

    @property
    def text(self) -> str:
        """The compensation in words, lengths in mm; empty if there is none."""
        return "; ".join(self._words())

    def _words(self) -> Iterator[str]:
        if self.bore_clearance is not None:
            side = 0.5 * self.bore_clearance
            yield f"bore {self.bore_clearance:g} mm larger in diameter, {side:g} mm per side"
        if self.key_clearance is not None:
            side = 0.5 * self.key_clearance
            yield f"keyway or flat with {self.key_clearance:g} mm clearance, {side:g} mm per side"
        if self.elephant_foot is not None:
            foot = self.elephant_foot
            steps = f" in {foot.steps} steps" if foot.steps > 1 else ""
            yield f"lowest {foot.height:g} mm drawn in by {foot.inset:g} mm per side{steps}"
        if (self.scale_xy, self.scale_z) != (1.0, 1.0):
            yield f"scaled by {self.scale_xy:.6g} in X and Y, {self.scale_z:.6g} in Z"


def print_of(table: Mapping[str, Any]) -> PrintSpec:
    """The specification of a converted table `[print]`, lengths in mm; raises GeometryError."""
    return instance_from_table(PrintSpec, table)
