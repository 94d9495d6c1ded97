"""A design: a scene with its cams, their findings, and the files to manufacture them from.

Lazy: nothing is computed before it is needed, and each quantity at most once. Stages that only
files need are imported only then, so that a check takes no longer than its computations.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cache
from itertools import chain
from typing import TYPE_CHECKING, Any, Final

from camgeo.cam.cam import Cam, Drive
from camgeo.check.finding import RETURN, Findings, LazyFindings, forbidding
from camgeo.check.judge import Judgement, TrialFindings
from camgeo.errors import Fault, SceneError
from camgeo.lazy import Ledger, built
from camgeo.record import Displayed, Pickled, brief, notebook

if TYPE_CHECKING:
    import pathlib
    from collections.abc import Mapping, Sequence

    from camgeo.design.product import Product
    from camgeo.design.value_table import TabulatedCam
    from camgeo.design.writing import Report
    from camgeo.dynamics.effects.effect import Column
    from camgeo.dynamics.effects.graph import Effects
    from camgeo.dynamics.state.written import Writing
    from camgeo.scene.scene import Scene


COMMON_KEYS: Final = ("law", "span", "to")
"""Keys of a move in the scene that do not depend on its law."""

SECOND_FLANKS: Final = ("outer", "return", "opposite")
"""Flanks of a scene that are the second side of a follower that is held both ways."""


@dataclass(frozen=True)
class Design(Pickled, Displayed):
    """A scene with all quantities that follow from it, computed on demand.

    Errors of the mechanism are raised as `GeometryError` when a quantity is accessed. Any number of
    threads may use a design; pickles and copies hold the scene, and compute everything again.

    Attributes
    ----------
    scene : the specification of the design.
    ledger : records what was computed and how long it took; its `progress` and `cancelled` follow
        or end a long computation.
    """

    scene: Scene
    ledger: Ledger = field(default_factory=Ledger, repr=False, compare=False)

    def __repr__(self) -> str:
        follower = self.scene.follower
        kind = "no follower" if follower is None else follower.kind
        return f"Design({brief(self.name)}, {kind})"

    @property
    def name(self) -> str:
        """Name of the design, the stem of its files."""
        return self.scene.name

    @built
    def drive(self) -> Drive:
        """The drive of the follower: motion plan, linkage and speed."""
        scene = self.scene
        unit = scene.lift_unit if scene.linkage is None else scene.linkage.unit
        return Drive(scene.plan, scene.linkage, unit, scene.speed, scene.speed_curve, self.ledger)

    @built
    def cams(self) -> tuple[Cam, ...]:
        """The cam; for a conjugate pair the main and the return cam, with the same drive.

        Raises SceneError with key "follower" if the scene has none.
        """
        scene = self.scene
        if scene.follower is None:
            fault = Fault("follower", "", "is missing: a disc needs it")
            raise SceneError([fault], scene.source.file)
        main = Cam(
            self.drive, scene.follower, scene.rotation, scene.contact, scene.side_clearance,
            scene.yoke, ledger=self.ledger,
        )  # fmt: skip
        if scene.returning is None:
            return (main,)
        shared = self.ledger.named(f" of the {RETURN} disc")
        other = Cam(
            self.drive, scene.returning, scene.rotation, scene.contact, mount=scene.mount,
            ledger=shared,
        )  # fmt: skip
        return (main, other)

    @property
    def cam(self) -> Cam:
        """The cam; for a conjugate pair the main one."""
        return self.cams[0]

    # Checks -----------------------------------------------------------------------------------

    @built
    def judgement(self) -> Judgement:
        """The findings of the checks; without a follower only those on the motion."""
        scene = self.scene
        cams = self.cams if scene.follower is not None else ()
        tolerance = scene.output.tolerance
        return Judgement(
            self.drive, cams, scene.limits, tolerance, scene.unit, self.ledger, self._try_values
        )

    def _try_values(self, cams: tuple[Cam, ...], values: Mapping[str, Any]) -> TrialFindings:
        """The findings on the scene with other `values` by key, and those on its parts that break a
        limit.

        If the values make these `cams`, all that has been computed of them is shared.
        """
        other = Design(self.scene.with_values(self.edits(values)))
        if other.cams == cams:
            other.__dict__.update(drive=cams[0].drive, cams=cams)

        # Looking at a part fits contours, so it waits until somebody asks.
        @cache
        def broken_parts() -> Findings:
            from camgeo.design.judged_part import broken_findings  # few designs need a cure

            discs = () if forbidding(other.findings) else other.discs
            return Findings(chain.from_iterable(map(broken_findings, discs)))

        return other.findings, LazyFindings(broken_parts)

    def edits(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """The edits that give the scene other `values` by key: these values, and None for the
        parameters of each law that is replaced, which another law does not have.
        """
        gone: dict[str, None] = {}
        for key in values:
            segment, _, last = key.rpartition(".")
            if last == "law":
                number = int(segment.removeprefix("motion[").removesuffix("]")) - 1
                move = self.scene.values["motion"][number]
                gone |= {f"{segment}.{name}": None for name in move if name not in COMMON_KEYS}
        return {**gone, **values}

    @property
    def findings(self) -> Findings:
        """The findings of the checks, both good and bad, the worst first.

        For a conjugate pair this includes findings on the return disc, and on both together.
        """
        return self.judgement.findings

    def with_output(self, values: Mapping[str, Any]) -> Design:
        """The design with other `values` of [output], by key, on which no finding depends.

        It shares drive, cams and judgement, with all that they have computed.
        """
        edits = {f"output.{key}": value for key, value in values.items()}
        other = Design(self.scene.with_values(edits))
        other.__dict__.update(drive=self.drive, cams=self.cams, judgement=self.judgement)
        return other

    # Effects ----------------------------------------------------------------------------------

    @built
    def effects(self) -> Effects:
        """The effects that the scene calls for, each computed on first use."""
        from camgeo.dynamics.effects.effect import Subject  # few scenes name an effect
        from camgeo.dynamics.effects.graph import Effects
        from camgeo.dynamics.state.state import FIRST, SECOND

        scene = self.scene
        # A trimmed disc is meant to move the follower.
        model = scene.model or ("outline" if scene.limits.undercut == "trim" else "demanded")
        moved = Subject(self.drive, scene.lift_unit, scene.unit, scene.part, model, scene.train)
        subject = moved
        if scene.follower is not None:
            main, *others = self.discs
            returning = None
            for disc in others:  # no outline alone moves a follower between two discs
                returning = replace(moved, model="demanded", disc=disc.drawn)
            subject = replace(moved, disc=main.drawn, returning=returning)
            if scene.yoke is not None:
                from camgeo.dynamics.effects.contact import (
                    with_both_yoke_sides,  # few scenes have one
                )

                subject = with_both_yoke_sides(subject)
        if model == "written":
            subject = subject.with_written_contours(
                self.writing, SECOND if scene.flank in SECOND_FLANKS else FIRST
            )
        return Effects(subject, scene.effects, self.ledger, speed=scene.state_speed)

    @property
    def writing(self) -> Writing:
        """How contours are written, for the effects of written contours: as in the drawing, or in
        the form that [state] names.
        """
        from camgeo.dynamics.state.written import Writing
        from camgeo.scene.formats.dxf import FORMAT

        output = self.scene.output
        form = self.scene.contour or output.options[FORMAT].form
        return Writing(form, output.tolerance, output.fit)

    def effect(self, name: str) -> Any:
        """The result of the effect `name`, see `camgeo.dynamics.effects.effect.Result`.

        Raises UnknownNameError if there is no such effect, GeometryError with the scene's key if
        its data are missing, EffectError if it has no answer for this design.
        """
        with self.scene.restating():
            return self.effects.result(name)

    # Pictures ---------------------------------------------------------------------------------

    def plot(self, *names: str) -> Any:
        """The plots of those `names` as a figure of matplotlib; by default all plots of the design.

        The names are those of `camgeo plot`. Raises SceneError if one of them is no plot, or if the
        scene lacks what it shows.
        """
        return notebook("plot")(self, names)

    def view(self) -> Any:
        """A notebook widget of the mechanism, which can be turned, with its diagrams.

        Its `angle` is the cam angle in degrees, and can be read and set. Raises CamgeoError if
        anywidget is not installed.
        """
        return notebook("viewer")(self)

    # Files ------------------------------------------------------------------------------------

    @built
    def discs(self) -> tuple[Product, ...]:
        """The finished discs, the main one first."""
        from camgeo.design.product import Product  # a check needs none

        pieces: list[Product] = []
        for cam in reversed(self.cams):  # as the main disc refers to the other one
            others = tuple(pieces)
            columns = self._columns if cam is self.cam else tuple
            piece = Product(self.scene, cam, self.judgement, others, columns, cam.ledger)
            if others and self.scene.part is not None and self.scene.part.pair is not None:
                piece = replace(piece, pair=replace(piece, is_pair=True))
            pieces.insert(0, piece)
        return tuple(pieces)

    @property
    def disc(self) -> Product:
        """The finished disc; for a conjugate pair the main one."""
        return self.discs[0]

    @property
    def tabulated(self) -> TabulatedCam:
        """The cam as value tables list it; for a scene without follower only its motion."""
        if self.scene.follower is not None:
            return self.disc.tabulated
        from camgeo.design.value_table import TabulatedCam

        return TabulatedCam(self.drive, self.scene, None, self._columns, self.ledger)

    def _columns(self) -> tuple[Column, ...]:
        """The effects over the cam angle; effects without an answer are left out."""
        from camgeo.errors import EffectError

        columns: list[Column] = []
        for name in self.scene.effects:
            try:
                columns += self.effect(name).columns
            except EffectError:  # which the findings report
                continue
        return tuple(columns)

    def write(
        self,
        folder: str | pathlib.Path,
        formats: Sequence[str] | None = None,
        *,
        tolerance: float | None = None,
        force: bool = False,
    ) -> Report:
        """Write the files and their certificate into `folder`, all of them or none.

        For a conjugate pair, those of both discs.

        Parameters
        ----------
        folder : created if it does not exist.
        formats : names of writers, or None for those of the scene.
        tolerance : largest deviation [mm] of any contour from the exact curve, or None for the
            scene's.
        force : overwrite files that exist and differ.

        Raises
        ------
        SceneError
            If a format does not exist, or the scene lacks what it needs.
        UndercutError
            If the cam or its return disc has no outline.
        ToleranceError
            If the tolerance cannot be reached.
        OutputError
            If a file cannot be written; nothing is left behind.
        """
        from camgeo.design.writing import write_files

        output = self.scene.output
        with self.scene.restating():
            return write_files(
                self.discs,
                folder,
                output.formats if formats is None else tuple(formats),
                output.tolerance if tolerance is None else tolerance,
                force=force,
            )
