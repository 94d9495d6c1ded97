"""Where the linkage of a design lies in the drawing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from camgeo.effects.effect import Subject
    from camgeo.mechanism.linkage_protocol import Linkage


def shaft_and_turn(subject: Subject, linkage: Linkage) -> tuple[complex, complex]:
    """Position [mm] of the crank's shaft, and the direction of the linkage's own x axis.

    The linkage is defined in its own frame, about the pivot of a rocker. On a carriage its pin is
    assumed to be at the roller's centre, and the guide of the pin to be that of the follower.
    """
    follower = subject.cam.follower
    if follower.pivot is not None:
        return follower.pivot, 1.0 + 0.0j
    still, one = np.zeros((2, 1)), np.array([[1.0], [0.0]])
    pin, ahead = linkage.joints(still[0])[0], linkage.joint_rates(still[0], still, one)[0]
    turn = complex(follower.way / ahead[0, 0])
    return follower.start_arm - turn * complex(pin[0]), turn
