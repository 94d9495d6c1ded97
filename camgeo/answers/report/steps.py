"""The next step for each finding: what a designer can do about it, and with which command."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

from camgeo.check.cures.cure import Cure
from camgeo.check.finding import RETURN, Finding, Severity

SIZE: Final = "camgeo size looks for the smallest cam that keeps this limit"
LAWS: Final = "camgeo laws compares the laws that fit"

BY_NAME: Final[Mapping[str, str]] = {
    "transmission-angle": f"Enlarge the base radius or lengthen the move; {SIZE}.",
    "radius-ratio": f"Take a smaller roller, a larger base radius or a longer move; {SIZE}.",
    "undercut": f"Take a smaller roller, a larger base radius or a longer move; {SIZE}.",
    "cusp": f"Take a smaller roller, a larger base radius or a longer move; {SIZE}.",
    "outline": f"Take a smaller roller, a larger base radius or a longer move; {SIZE}.",
    "lost-stroke": (
        "Decide whether the machine can do without the lost stroke; else cure the undercut."
    ),
    "lobe": "Decide whether the part without the lobe is meant; else cure the undercut.",
    "dead-centre": "Change crank, coupler or stroke until the linkage stays clear of it.",
    "linkage-branch": "Change crank, coupler or stroke until the linkage stays on its branch.",
    "linkage-transmission-angle": "Lengthen the coupler, or shorten the stroke or swing.",
    "linkage-back-angle": "Lengthen the crank that the rocker turns, or shorten the stroke.",
    "roller-over-axis": "Enlarge the base radius or shorten the stroke.",
    "face-over-axis": "Enlarge the base radius or shorten the stroke.",
    "standstill": "Move the pivot, or change the arm, away from this position.",
    "joints": f"Let both segments meet with the same velocity and acceleration; {LAWS}.",
    "shock": f"Take a law that begins and ends without a jump of velocity; {LAWS}.",
    "jerk": f"Take a law without jumps of acceleration; {LAWS}.",
    "overshoot": f"Lengthen the move or choose another law; {LAWS}.",
    "closure": "Let the last segment end where the first one begins.",
    "tangent-closure": "Let the motion end with the velocity with which it begins.",
    "convexity": f"Enlarge the base radius: a flat face needs a convex cam; {SIZE}.",
    "face-length": "Make the face longer, or state none to have it as long as needed.",
    "form-closure": "Change the return follower until both keep contact, or add a spring.",
    "closing-error": "Change the return follower, or allow the play that the sentence states.",
    "lift-off": "Strengthen the spring, or lower the speed or the moving mass.",
    "contact-force": "Lower the speed, the moving mass or the spring's preload.",
    "contact-pressure": "Widen the contact, enlarge the roller, or take another material.",
    "roller-life": "Take a larger roller, or lower the contact force.",
    "drive-torque": "Lower the load or the speed, or lengthen the move.",
    "largest-diameter": "Take a smaller base radius, or a blank that holds the disc.",
    "mass": "Take a lighter material, lightening holes, or a larger limit.",
}
"""What helps, by the name of a finding or its beginning."""

OTHERWISE: Final[Mapping[Severity, str]] = {
    "ok": "",
    "warning": "Decide whether it matters here: nothing is refused because of it.",
    "broken": (
        "Change what the sentence names until its limit is kept; or state another limit in the"
        " scene, if this one is not meant."
    ),
    "no-disc": "Change the scene until such a disc exists: no file is made before.",
    "invalid": "Change the scene: it describes no mechanism that can be made.",
}

FAULTS: Final[Mapping[str, str]] = {
    "undercut": "undercut",
    "cusp": "undercut",
    "outline": "undercut",
    "convexity": "convexity",
    "radius-ratio": "radius ratio",
    "transmission-angle": "transmission angle",
}
"""The fault that cures remove, by the beginning of the name of the finding."""


def next_step(finding: Finding, cures: Sequence[Cure]) -> str:
    """What to do about it; empty if nothing is to be done.

    The cheapest of the `cures` that works, if there is one.
    """
    if finding.severity == "ok":
        return ""
    about = finding.name.removeprefix(f"{RETURN}: ")
    faults = [fault for name, fault in FAULTS.items() if about.startswith(name)]
    works = [cure.sentence for cure in cures if cure.works and cure.fault in faults]
    if works:
        return f"{works[0][:1].upper()}{works[0][1:]}; camgeo check tells what else cures it."
    found = [name for name in BY_NAME if about.startswith(name)]
    return BY_NAME[max(found, key=len)] if found else OTHERWISE[finding.severity]
