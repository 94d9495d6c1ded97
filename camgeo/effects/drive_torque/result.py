"""Drive torque: what the camshaft has to be given to move the follower against its forces.

T dphi is the work of the contact force on the follower and of the friction at the contact
(principle of virtual work; Norton, Cam Design and Manufacturing Handbook, chapters on dynamics of
force- and form-closed systems). T is positive where the cam has to be driven in its own sense of
rotation, negative where the follower drives it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

import numpy as np

from camgeo.effects.drive_torque import Spec
from camgeo.effects.drive_torque.findings import findings
from camgeo.effects.drive_torque.law import TorqueLaw
from camgeo.effects.drive_torque.summary import summary
from camgeo.effects.drive_torque.torque import DriveTorque
from camgeo.effects.effect import Column, Request, Subject
from camgeo.effects.force import all_borders
from camgeo.effects.results import CONTACT_FORCE
from camgeo.effects.results import DriveTorque as Asked
from camgeo.errors import GeometryError
from camgeo.numeric.arrays import FloatArray, frozen, merged
from camgeo.numeric.peaks import grid_of
from camgeo.numeric.roots import roots_on_grid

N_M: Final = 1e-3
"""N m in an N mm."""


def compute(request: Request[Spec]) -> Asked:
    """Torque, its integrals over a turn to the tolerance, and the flywheel if one is sought.

    Raises
    ------
    GeometryError
        If a flywheel is sought and the scene gives no speed.
    EffectError
        "jamming", if friction does not let the contact force drive the follower; and if the
        tolerance cannot be reached.
    """
    subject, spec = request.subject, request.spec
    course = subject.cam.drive.time_course
    if spec.fluctuation is not None and course is None:
        raise GeometryError(
            "a flywheel needs the speed of the cam, [cam] speed or speed_curve",
            key="effects.drive-torque.fluctuation",
        )
    contact = request.results[CONTACT_FORCE]
    law = TorqueLaw(subject, contact)
    bare = DriveTorque(law, course, frozen(contact.edges, np.float64), _static_edges(law))
    found = summary(bare, spec.fluctuation, request.tolerance)
    return replace(
        bare,
        findings=findings(bare, found, spec.limit, spec.fluctuation),
        columns=_columns(bare, subject, spec.limit),
        error=found.error,
    )


def _static_edges(law: TorqueLaw) -> FloatArray:
    """Where the formula of the static part changes; with friction also where its R changes sign."""
    contact = law.contact
    base = merged(
        np.concatenate((law.subject.cam.drive.smooth_angles, all_borders(contact.forces)))
    )
    if contact.friction is None:
        return frozen(base, np.float64)
    roots = roots_on_grid(lambda phi: contact.required(phi, "right")[0], grid_of(base))
    return frozen(merged(np.concatenate((base, roots))), np.float64)


def _columns(result: DriveTorque, subject: Subject, limit: float | None) -> tuple[Column, ...]:
    borders = all_borders(result.law.contact.forces)
    most = None if limit is None else N_M * limit

    def column(name: str, values: Any, limit: float | None = None) -> Column:
        return Column(name, "N m", lambda phi, side: N_M * values(phi, side), limit, borders)

    total = column("drive torque", result.torque, most)
    if subject.cam.drive.time_course is None:
        return (total,)
    return (
        total,
        column("static drive torque", result.static),
        column("dynamic drive torque", result.dynamic),
    )
