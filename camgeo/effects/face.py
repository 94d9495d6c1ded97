"""What a flat face adds to the contact: how it slides on the cam, and whether there is a cam.

With the names of `camgeo.mechanism.face`: the cam goes round with sigma, the follower with Omega =
nu', the rate of its own direction, both counter-clockwise per unit of cam speed. The contact lies
h n from the cam axis, and f n from the pivot of a rocker, beside what lies along the face. Along
the face, in the sense t = Z'/|Z'| in which the contact runs along the outline, the material of the
face goes past that of the cam with

    g = h - sigma f Omega,

since a point of the cam has -h there along t, and one of the face -sigma f Omega (velocities of
rigid bodies). In a guide g = h: the rate at which the contact wanders along the face
is no sliding. A face that slides so is pressed on the cam by the whole normal force, in rests too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from camgeo.errors import EffectError

if TYPE_CHECKING:
    from camgeo.effects.effect import Subject
    from camgeo.motion.motion import Side
    from camgeo.numeric.arrays import FloatArray


def sliding(subject: Subject, phi: FloatArray, side: Side) -> FloatArray:
    """(n,) g [mm/rad] of the face on the cam at `phi` (n,) [rad], see the module.

    Per unit of cam speed: times omega it is in mm/s. For flat-faced followers.
    """
    jet = subject.cam.drive.motion.jet(phi, side)
    return subject.cam.follower.sliding(jet, subject.cam.rotation)


def require_convex(subject: Subject, what: str) -> None:
    """Raise EffectError that there is no `what`, if a flat face cannot touch the cam all round."""
    if subject.cam.follower.has_pitch_curve:
        return
    from camgeo.check.face import check_convexity  # few cams have a flat face

    for found in check_convexity(subject.cam.disc.pitch_curve):
        if found.severity == "no-disc":
            raise EffectError(
                f"there is no {what}: {found.sentence}",
                value=found.value,
                limit=found.limit,
                unit=found.unit,
                cam_angle=found.cam_angle,
            )
