"""What `camgeo verify` finds: files compared with the exact curves of their scene."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, ClassVar

from camgeo.answers.answer import BROKEN, CRASHED, FINE, Answer
from camgeo.design import Design
from camgeo.scene.identity import hashes_of
from camgeo.scene.load import load_scene
from camgeo.verifying.verification import Verdict
from camgeo.verifying.verify import Against, Wanted, scene_file, verify_files


@dataclass(frozen=True, slots=True)
class Verification(Answer):
    """Files, and the verdicts on them.

    Attributes
    ----------
    paths : of the files.
    verdicts : one per file, in the same order.
    """

    command: ClassVar[str] = "verify"

    paths: tuple[Path, ...]
    verdicts: tuple[Verdict, ...]

    @property
    def passed(self) -> bool:
        """Whether all files pass."""
        return all(verdict.passed for verdict in self.verdicts)

    @property
    def records(self) -> tuple[Mapping[str, Any], ...]:
        """The verdicts as a verification.json holds them."""
        return tuple(verdict.record() for verdict in self.verdicts)

    @property
    def exit_code(self) -> int:
        """0 if all files pass, 1 if one does not, CRASHED after an error in camgeo itself."""
        if any(verdict.crashed for verdict in self.verdicts):
            return CRASHED
        return FINE if self.passed else BROKEN


def verify(
    paths: tuple[Path, ...], wanted: Wanted | None = None, *, scene: str | Path | None = None
) -> Verification:
    """Read files back, and compare them with a scene.

    Parameters
    ----------
    paths : of the files.
    wanted : the requirements; None for those stated by the files and their scene.
    scene : path of the scene; None for the one whose hash the files name, looked for in their
        folder, the one above and the present one.

    Raises
    ------
    SceneError
        If none of the files can be compared: they are of a format that cannot be read, or their
        scene is not found or wrong.
    """
    return Verification(paths, verify_files(paths, _scenes(scene), wanted or Wanted()))


def _scenes(named: str | Path | None) -> Callable[[Path, str], Against]:
    """A function that finds the scene of a file; each scene is read once."""

    @cache
    def load(path: Path) -> Against:
        design = Design(load_scene(path))
        scene = design.scene
        return Against(design.discs, scene.output.tolerance, scene.made_before)

    def find(folder: Path, sha256: str) -> Against:
        if named is not None:
            return load(Path(named))
        return load(scene_file((folder, folder / "..", Path()), sha256, hashes_of))

    return find
