"""The effects of one design: each is computed once, on demand, together with what it needs.

Where the scene names `speed-fluctuation` or `camshaft-windup`, all effects that depend on the speed
of the cam are computed for the speed that this one finds. What this is found from, the forces on
the follower as functions of speed and acceleration, holds for any speed, and is computed for the
one that the scene gives. An elastic train acts back on it (`camgeo.dynamics.effects.feedback`).
"""

from __future__ import annotations

import pkgutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, Final, overload

import numpy as np

from camgeo.check.finding import (
    FINDINGS,
    STATED,
    Finding,
    Findings,
    LazyFindings,
    findings_in_unit,
    folded,
)
from camgeo.dynamics.effects.contact import FLANKS, INNER, holds_both_ways, side_names
from camgeo.dynamics.effects.effect import (
    TOLERANCE,
    Answer,
    Bound,
    Column,
    Effect,
    EffectTable,
    Key,
    MachineTraits,
    Request,
    Result,
    Results,
    Subject,
)
from camgeo.dynamics.effects.registry import Catalogue, find_effect
from camgeo.dynamics.effects.results import (
    CONTACT_FORCE,
    FINDERS,
    LIFT_OFF,
    SPEED_FLUCTUATION,
    SPRING,
    VIBRATION,
    Elastic,
    Flying,
    LostContact,
    Touching,
)
from camgeo.dynamics.effects.wording import at_angle, at_angles, over_ranges
from camgeo.dynamics.state.state import Speed, Used
from camgeo.errors import EffectError, GeometryError, ToleranceError
from camgeo.kinematics.time_course import ConstantSpeed, TimeCourse, period
from camgeo.lazy import Ledger
from camgeo.numeric.arrays import SHARE, FloatArray
from camgeo.record import clipped
from camgeo.units import RPM, TURN, in_unit, listed

if TYPE_CHECKING:
    from camgeo.cam.cam import Disc
    from camgeo.dynamics.state.written import Contours
    from camgeo.geometry.contour.contour import Form
    from camgeo.geometry.outline.replay import Replay


FOUND_SUFFIX: Final = " at the found speed"
ROUGH_SUFFIX: Final = " at the found speed, roughly"
"""Added in the ledger to the names of effects that are computed for the speed that is found."""

RIGID_SUFFIX: Final = " of a rigid train"
"""Added to the name of an effect that finds a speed for a rigid train, where no other effect uses
this speed."""

HOLDING: Final = "camgeo.dynamics.effects.lift_off.flank:holding"
"""Imported only where a follower leaves its flank."""

FED_BACK: Final = "camgeo.dynamics.effects.feedback:FeedbackNodes"
"""Imported only where an elastic train acts back on the speed."""


class Effects:
    """The effects of `subject`, by name.

    Parameters
    ----------
    subject : the design.
    tables : the table of each effect that the scene names, in internal units.
    ledger : records what was computed.
    find : returns the effect with a given name.
    speed : of the cam, for which effects that depend on it are computed; None for the found one if
        the scene names what finds it.
    """

    def __init__(
        self,
        subject: Subject,
        tables: Mapping[str, Mapping[str, Any]],
        ledger: Ledger,
        find: Callable[[str], Effect] = find_effect,
        speed: Speed | None = None,
    ) -> None:
        self.subject = subject
        self.tables = tables
        self.ledger = ledger
        self.catalogue = Catalogue(tables, find, subject.output)
        self._finder = None if speed == "stated" else self.catalogue.finder
        self._whole: dict[str, Any] = {}
        self._judged: dict[str, Any] = {}

    def __repr__(self) -> str:
        return clipped(f"Effects({', '.join(map(repr, self.names))})")

    @property
    def names(self) -> tuple[str, ...]:
        """The effects that the scene names, in its order."""
        return tuple(self.tables)

    def effect(self, name: str) -> Effect:
        """The declaration of the effect `name`; UnknownNameError if there is none."""
        return self.catalogue.effect(name)

    def inputs(self, name: str) -> tuple[str, ...]:
        """See `Catalogue.inputs`."""
        return self.catalogue.inputs(name)

    @overload
    def result(self, name: Key[Answer]) -> Answer: ...

    @overload
    def result(self, name: str) -> Any: ...

    def result(self, name: str) -> Any:
        """The result of the effect `name`, whether or not the scene names it.

        Its findings begin with those that say what the others do not hold for, see
        `camgeo.dynamics.effects.graph`; they are made when they are looked at.

        Raises
        ------
        UnknownNameError
            If there is no such effect.
        CycleError
            If it needs itself.
        GeometryError
            With the key of the scene, if data are missing.
        EffectError
            If there is no answer for this design.
        """
        with self.ledger.lock:  # another thread may be computing it
            if name not in self._whole:
                self._whole[name] = self._with_premises(name, self._computed(name))
            return self._whole[name]

    def _computed(self, name: str) -> Any:
        """The result of the effect `name` as it computes it; raises as `result`."""
        return self._nodes(name).result(name)

    def _with_premises(self, name: str, result: Any) -> Any:
        """The `result` of the effect `name` with all its findings."""
        if not isinstance(result, Result):
            return result

        def qualify_findings() -> Findings:
            known, entry = self._judged, FINDINGS + node_name(name)
            with self.ledger.lock:  # another thread may have set it meanwhile
                if entry not in known:
                    with self.ledger.entry(entry, known):
                        known[entry] = Findings(self._qualified(name, result))
                findings: Findings = known[entry]
                return findings

        whole, errors = LazyFindings(qualify_findings), result.errors
        if isinstance(errors, InheritedErrors):
            force = partial(self._computed, CONTACT_FORCE)
            # Findings on premises state the contact force, and are as accurate as that.
            errors = replace(errors, premises=whole, force=force)
        return replace(result, findings=whole, errors=errors)

    def course(self, name: str) -> TimeCourse | None:
        """How the cam turns in the state of the effect `name`; None if its speed is not known.

        Raises EffectError if it is neither found nor given.
        """
        return self._nodes(name).subject.state.course

    def _nodes(self, name: str) -> Nodes:
        """The nodes that compute the effect `name`.

        Raises
        ------
        EffectError
            If its speed is neither found nor given.
        """
        if self._finder is None and name in FINDERS and self.catalogue.follows_train(name):
            return self._rigid_nodes
        if self._finder is None or not self.catalogue.depends_on_speed(name):
            return self._stated_nodes
        return self._solved_nodes

    @cached_property
    def _stated_nodes(self) -> Nodes:
        """The nodes of effects that do not depend on a speed that is found."""
        feeds = self._finder is not None and self.catalogue.follows_train(self._finder)
        kind: type[Nodes] = pkgutil.resolve_name(FED_BACK) if feeds else Nodes
        return kind(self._stated_subject, self.catalogue, self.ledger)

    @cached_property
    def _rigid_nodes(self) -> Nodes:
        """The nodes of an effect that finds a speed which no other effect uses; the train is
        rigid.
        """
        return Nodes(self._stated_subject, self.catalogue.rigid(), self.ledger.named(RIGID_SUFFIX))

    @property
    def _stated_subject(self) -> Subject:
        """The design at the speed of the scene. If the scene states only a motor, it turns at a
        speed near the one to be found, for effects that do not depend on it.
        """
        if self._finder is None or self.subject.state.course is not None:
            return self.subject
        data = self.effect(SPEED_FLUCTUATION).parse(self.tables[SPEED_FLUCTUATION])
        first = data.first_speed
        return self.subject if first is None else self.subject.turning(ConstantSpeed(first))

    @cached_property
    def _solved_nodes(self) -> Nodes:
        """The effects at the found speed; if there is none, at that of the scene."""
        stated, finder = self._stated_nodes, self._finder
        assert finder is not None  # what finds it
        try:
            turning = stated.result(finder)
        except EffectError as error:
            if self.subject.state.course is not None:
                return Nodes(self.subject, self.catalogue, self.ledger)
            raise EffectError(
                f"the scene states no speed of the cam, and none was found: {error.message}",
                finding="no-speed",
                cam_angle=error.cam_angle,
            ) from error
        rough = Nodes(
            self.subject.turning(turning.rough_course), self.catalogue,
            self.ledger.named(ROUGH_SUFFIX), base=stated,
        )  # fmt: skip
        return Nodes(
            self.subject.turning(turning.course), self.catalogue,
            self.ledger.named(FOUND_SUFFIX), base=stated, rough=rough,
        )  # fmt: skip

    def findings(self, name: str) -> tuple[Finding, ...]:
        """The findings of the effect `name`; a "broken" one that says why if there is no answer."""
        try:
            return tuple(self.result(name).findings)
        except GeometryError as error:
            if error.key:
                raise
            sentence = in_unit(f"not computed: {error.message}", self.subject.unit)
            return (Finding(name, "broken", sentence),)
        except EffectError as error:
            refusal = Finding(
                name=error.finding or name,
                severity="broken",
                sentence=error.message,
                value=error.value,
                limit=error.limit,
                unit=error.unit,
                cam_angle=error.cam_angle,
                cam_range=error.cam_range,
            )
            trimmed = trimming(self.effect(name), self.subject)
            return findings_in_unit(self.subject.unit, (*trimmed, refusal))

    def _qualified(self, name: str, result: Any) -> tuple[Finding, ...]:
        """The findings of the result of `name`, after those that say what they do not hold for."""
        effect, subject, findings = self.effect(name), self.subject, result.findings
        touching, in_contact = isinstance(result, Touching), effect.premise == "contact"
        # None if it is not known where the follower leaves the cam.
        lost = result.lost_contact if touching else self._lost_contact(name)
        at_speed_of_scene = not touching or name == CONTACT_FORCE
        flies = lost or (lost is not None and in_contact)
        flights = self._flight_ranges() if flies and at_speed_of_scene else ()
        if all(finding.value is None for finding in findings):  # there is nothing to qualify
            return findings_in_unit(subject.unit, folded(findings))
        broken, crossed = list[Finding](), list[Finding]()
        if in_contact and lost and holds_both_ways(subject):
            broken.append(_other_side_finding(lost, subject))
        elif in_contact and lost:
            holding = self._holding if at_speed_of_scene else ""
            broken.append(_lost_contact_finding(lost, subject, flights, holding))
        elif in_contact and flights:
            crossed.append(_clearance_finding(subject, flights))
        trimmed, uneven = (
            tuple(trimming(effect, subject)),
            tuple(_breadth_findings(effect, subject)),
        )
        if broken or uneven or (trimmed and not _follows(effect, subject)):
            findings = [_downgraded(finding, effect) for finding in findings]
        is_solved = self._nodes(name).has_solved_speed
        named = [other for other in self.names if not (is_solved and other in FINDERS)]
        stated = [*self._speed_findings(name, findings), *broken, *crossed, *trimmed, *uneven]
        stated += written_findings(effect, subject)
        stated += (ELASTIC_TRAIN,) if self._is_elastic(effect) else ()
        stated += _simplified(effect, named, follows=self._follows(effect))
        return findings_in_unit(subject.unit, folded((*stated, *findings)))

    def _follows(self, effect: Effect) -> bool:
        """Whether `effect` takes an elastic train of the scene into account."""
        return self.catalogue.follows_train(effect.name) and (
            self._finder is not None or effect.name not in FINDERS
        )

    def _is_elastic(self, effect: Effect) -> bool:
        """Whether the figures of `effect` are for an elastic train that has mass."""
        if not self._follows(effect):
            return False
        if effect.name in FINDERS:
            return self._computed(effect.name).feedback is not None
        return self._computed(CONTACT_FORCE).behind is not None

    def _speed_findings(self, name: str, findings: Sequence[Finding]) -> Iterator[Finding]:
        """For which speed the figures of the effect `name` are, if that is the found one."""
        nodes = self._nodes(name)
        if not nodes.has_solved_speed or not self.catalogue.declares_speed(name):
            return
        course = nodes.subject.course
        if course is not None and any(finding.value is not None for finding in findings):
            mean = TURN / period(course) / RPM
            sentence = (
                f"these figures are for the speed that {self._finder} determines, {mean:.6g}"
                " rev/min on average"
            )
            yield Finding("found-speed", "ok", sentence)

    def _flight_ranges(self) -> tuple[tuple[float, float], ...]:
        """The ranges [rad] over which the follower flies, if the scene names what computes them."""
        if LIFT_OFF not in self.tables:
            return ()
        try:
            result: Flying = self._computed(LIFT_OFF)
        except (EffectError, GeometryError):  # which its own findings report
            return ()
        return result.flight_ranges

    @cached_property
    def _holding(self) -> str:
        """Which spring would hold a follower that leaves its only flank; empty without a spring."""
        if SPRING not in self.tables or holds_both_ways(self.subject):
            return ""
        try:
            least = None
            if LIFT_OFF in self.tables:
                closed: Any = self.result(LIFT_OFF)
                least = closed.preload, closed.stiffness
            subject, results = self._nodes(CONTACT_FORCE).subject, (CONTACT_FORCE, SPRING)
            text: str = pkgutil.resolve_name(HOLDING)(subject, *map(self.result, results), least)
            return text
        except (EffectError, GeometryError):  # which their own findings report
            return ""

    def _lost_contact(self, name: str) -> LostContact | None:
        """Where contact is lost; None if the effect `name` can do without contact, if neither it
        nor an effect of the scene needs the contact force, or if there is no contact force.
        """
        if self.effect(name).premise != "contact":
            return None
        requested = {name, *self.names}
        if CONTACT_FORCE not in requested.union(*map(self.catalogue.dependencies, requested)):
            return None
        try:
            lost: LostContact = self._computed(CONTACT_FORCE).lost_contact
        except (EffectError, GeometryError):  # which its own findings report
            return None
        return lost

    def recomputed(self, name: str, tolerance: float | None = None) -> Nodes:
        """Effects of the same design in which only `name` is computed again.

        A numerical effect is computed to `tolerance`; None keeps the tolerance of the scene. The
        results that it needs are reused, and are computed now if they have not been yet.
        """
        nodes, catalogue = self._nodes(name), self.catalogue
        if tolerance is not None:
            table = {**self.tables.get(name, {}), "tolerance": tolerance}
            catalogue = catalogue.with_table(name, table)
        self.inputs(name)
        known = {key: nodes.result(key) for key in nodes.catalogue.received(name)}
        return type(nodes)(nodes.subject, catalogue, Ledger(), known)


# -- nodes ----------------------------------------------------------------------------------------
# Results of effects for one state of motion: each is computed once, with what it needs.


TRAIN_ERROR_SUFFIX: Final = " with the train off by its error"
"""Added to the names of effects that are computed for error estimates alone."""


def node_name(name: str) -> str:
    """Name of the effect `name` in the ledger."""
    return f"effects.{name}"


def _place(name: str, key: str | None) -> str:
    """The full key in the scene for a `key` of the table of the effect `name`, or for the table."""
    return ".".join(filter(None, (node_name(name), key)))


class Nodes:
    """The effects of `subject` in one state.

    Parameters
    ----------
    subject : the design, which turns as in that state.
    catalogue : of its effects.
    ledger : records what was computed.
    known : results that are known already.
    base : has the results that do not depend on the speed, if these are for the found speed.
    rough : the same for the found speed known less accurately, from which errors follow.
    """

    def __init__(
        self,
        subject: Subject,
        catalogue: Catalogue,
        ledger: Ledger,
        known: Mapping[str, Any] | None = None,
        *,
        base: Nodes | None = None,
        rough: Nodes | None = None,
    ) -> None:
        self.subject = subject
        self.catalogue = catalogue
        self.ledger = ledger
        self._base = base
        self._rough = rough
        self._near: dict[str, Any] = {}
        self._results: dict[str, Any] = dict(known or {})

    @property
    def has_solved_speed(self) -> bool:
        """Whether they are for the speed that is found."""
        return self._base is not None

    def result(self, name: str) -> Any:
        """The result of the effect `name`; raises as
        `camgeo.dynamics.effects.graph.Effects.result`.
        """
        with self.ledger.lock:  # another thread may be computing it
            if self._base is not None and not self.catalogue.depends_on_speed(name):
                return self._base.result(name)
            if name not in self._results:
                self.catalogue.inputs(name)
                with self.ledger.entry(node_name(name), self._results):
                    self._results[name] = self._compute(name)
            return self._results[name]

    def result_near(self, name: str, near: Any) -> Any:
        """The result of the effect `name`, which is known to be `near` another; raises as
        `result`.
        """
        self._near[name] = near
        return self.result(name)

    def _compute(self, name: str) -> Any:
        effect, tables = self.catalogue.effect(name), self.catalogue.tables
        if effect.tabled and name not in tables:
            raise GeometryError(
                f"is missing: without it there is no {effect.title}", key=node_name(name)
            )
        if self.subject.disc is None and not effect.of_drive:
            raise GeometryError("needs [follower]", key="follower")
        received = {}
        for key in self.catalogue.received(name):  # a loop, which takes no frame on the stack
            received[key] = self.result(key)
        table = tables.get(name, {})
        tolerance = float(table.get("tolerance", TOLERANCE))
        if name in tables and effect.rules:
            self._refuse_misfits(effect, table)
        try:
            data = effect.parse(table)
        except GeometryError as error:
            raise GeometryError(error.message, _place(name, error.key), error.value) from error
        compute = pkgutil.resolve_name(effect.compute)
        near = self._near.get(name)
        return self._stated(
            name, compute(Request(self.subject, data, Results(received), tolerance, near))
        )

    def _refuse_misfits(self, effect: Effect, table: Mapping[str, Any]) -> None:
        """Raise GeometryError with the key if the effect or one of its keys does not fit."""
        machine = describe_machine(self.subject)
        for key, message in (
            fault for rule in effect.rules for fault in rule(machine, EffectTable(table))
        ):
            raise GeometryError(message, _place(effect.name, key))

    def _stated(self, name: str, result: Any) -> Any:
        """The `result` of the effect `name` with its state, and with what the errors of a found
        speed and of an elastic train add to those of its figures.
        """
        if not isinstance(result, Result):
            return result
        state, rough = self.subject.state, self._rough
        is_solved = self._base is not None or name in FINDERS
        speed: Speed = "found" if is_solved else "stated"
        known = is_solved or state.course is not None
        used = Used(state.model, speed if known else None, state.sense)
        result = replace(result, state=used)
        others: list[Callable[[], Result]] = []
        if self._follows(name):
            others += [partial(self._with_train, number, name, result) for number in range(2)]
        if rough is not None and state.course is not None:
            jumps = state.course.jumps
            columns = tuple(_also_jumping(column, jumps) for column in result.columns)
            result = replace(result, columns=columns)
            others.append(partial(rough.result_near, name, result))
        return replace(result, errors=InheritedErrors(result, others)) if others else result

    def _follows(self, name: str) -> bool:
        """Whether the effect `name` was computed here from the force of an elastic train."""
        train = self._results.get(VIBRATION)
        if train is None or train.behind is None or name in FINDERS:
            return False  # they state the errors of the speeds that they find themselves
        return VIBRATION in self.catalogue.dependencies(name)

    def _with_train(self, number: int, name: str, near: Any) -> Any:
        """The result of the effect `name` with one of the `_perturbed_nodes`; `near` is that
        with the train itself.
        """
        return self._perturbed_nodes[number].result_near(name, near)

    @cached_property
    def _perturbed_nodes(self) -> tuple[Nodes, ...]:
        """The nodes with trains that are off by the error of their force, see
        `camgeo.dynamics.effects.forces.ElasticTrain.perturbed_trains`.
        """
        train, contact = self.result(VIBRATION), self.result(CONTACT_FORCE)
        return tuple(
            WithTrain(self, replace(train, behind=perturbed))
            for perturbed in train.behind.perturbed_trains(contact.demand)
        )


class WithTrain(Nodes):
    """The effects of `nodes` with another elastic `train`."""

    def __init__(self, nodes: Nodes, train: Elastic) -> None:
        ledger = nodes.ledger.named(TRAIN_ERROR_SUFFIX)
        super().__init__(nodes.subject, nodes.catalogue, ledger, {VIBRATION: train})
        self._nodes = nodes

    def result(self, name: str) -> Any:
        """The result of the effect `name`, which is that of `nodes` unless it depends on the
        train.
        """
        if name != VIBRATION and VIBRATION not in self.catalogue.dependencies(name):
            return self._nodes.result(name)
        return super().result(name)


def _also_jumping(column: Column, places: FloatArray) -> Column:
    """The column, which may jump at `places` (k,) [rad], too."""
    if not len(places):
        return column
    return replace(column, borders=np.unique(np.concatenate((column.borders, places))))


# -- premises -------------------------------------------------------------------------------------
# What the figures of an effect rely on, and where a design does not provide it.
#
# Four things are checked for every effect, whatever it computes: that the follower touches the cam
# (`camgeo.dynamics.effects.contact.lost_contact`), also one that is held both ways and crosses its
# clearance (`camgeo.dynamics.effects.results.Leaving`), which alone makes no figure less than "ok";
# that the disc makes the motion of the state, which a trimmed one does not if that is the demanded
# motion; that a yoke fits its cam; and that no other effect of the scene has a better model
# (`Effect.refined_by`). Each that fails gives one finding. While one of the first three fails, no
# figure of the effect is "ok". Where the state is the motion of a trimmed disc, or of the contour
# as it is written, that is reported too, and where the train behind the follower is elastic.


Range = tuple[float, float]
"""Cam angles [rad]; past cam angle 0 the end is below the start, or beyond a turn."""

ELASTIC_TRAIN: Final = Finding(
    "elastic-train",
    "ok",
    "these figures are for the elastic train of the effect vibration, in the steady state",
)

SLACK: Final = 1e-9
"""Cam angles [rad] this close are equal but for rounding."""


def _downgraded(finding: Finding, effect: Effect) -> Finding:
    """A figure that relies on a premise which is not true; it is not "ok"."""
    if finding.severity != "ok" or finding.value is None or finding.name in effect.regardless:
        return finding
    return replace(finding, severity="warning")


def _lost_contact_finding(
    lost: LostContact, subject: Subject, flown: Sequence[Range], holding: str
) -> Finding:
    """The finding that the follower leaves the cam, though the figures are for one that does
    not.
    """
    ranges = [(stretch.start, stretch.end) for stretch in lost.ranges]
    touching = subject.cam.follower.touching
    places = [over_ranges(ranges)] if ranges else []
    if lost.leaps:
        places.append(f"{at_angles(lost.leaps)}, where the velocity jumps away from it")
    low = lost.lowest
    flight = (
        f", and flies {over_ranges([_wrap_range(stretch) for stretch in flown])}" if flown else ""
    )
    force = "" if low is None else f": contact force {low.value:.6g} N {at_angle(low.place)}"
    return Finding(
        name="contact-lost",
        severity="broken",
        sentence=(
            f"the {touching} leaves the cam {listed(places)}{force}{flight}; these figures are for"
            f" a {touching} that stays on it{holding and f'; {holding}'}"
        ),
        value=None if low is None else low.value,
        limit=0.0,
        unit="N",
        cam_angle=lost.leaps[0] if low is None else low.place,
        cam_range=_only(ranges),
    )


def _other_side_finding(lost: LostContact, subject: Subject) -> Finding:
    """The warning that the other side carries than the one whose written contour makes the
    motion.
    """
    sense, low = subject.state.sense, lost.lowest
    names, noun = side_names(subject)
    ranges = [(stretch.start, stretch.end) for stretch in lost.ranges]
    places = [over_ranges(ranges)] if ranges else []
    if lost.leaps:
        places.append(f"{at_angles(lost.leaps)}, where the velocity jumps away from this one")
    force = "" if low is None else f", with up to {-low.value:.6g} N {at_angle(low.place)}"
    return Finding(
        name="other-side",
        severity="warning",
        sentence=(
            f"the {names[-sense]} {noun} carries {listed(places)}{force}; these figures are for the"
            f' motion on the {names[sense]} one, and flank = "{names[-sense]}" in [state] gives'
            " those of the other"
        ),
        value=None if low is None else -low.value,
        limit=0.0,
        unit="N",
        cam_angle=lost.leaps[0] if low is None else low.place,
        cam_range=_only(ranges),
    )


def _clearance_finding(subject: Subject, flown: Sequence[Range]) -> Finding:
    """The warning that a follower that is held both ways crosses its clearance."""
    who, where = "follower", "between its discs" if subject.paired else "of its yoke"
    if subject.returning is None:
        who, where = "roller", "between its flanks"
    ranges = [_wrap_range(stretch) for stretch in flown]
    return Finding(
        name="clearance-crossed",
        severity="warning",
        sentence=(
            f"the {who} crosses the clearance {where} {over_ranges(ranges)}; these figures are"
            f" for a {who} that always touches one side, without impacts"
        ),
        cam_range=_only(ranges),
    )


def _breadth_findings(effect: Effect, subject: Subject) -> Iterator[Finding]:
    """A warning if a yoke does not fit its cam. A constant play alters no force, and the effect
    `lift-off` reports it.
    """
    breadth = subject.cam.breadth if subject.returning is not None else None
    if breadth is None or not (effect.premise == "contact" or CONTACT_FORCE in effect.needs):
        return
    (least, _), (most, place) = breadth.range
    squeeze = -breadth.play(subject.cam.yoke_breadth)
    parts = []
    if breadth.variation > 0.0:
        parts.append(
            f"the cam is {least:.6g} to {most:.6g} mm wide, and these figures are for a cam that is"
            f" {breadth.best:.6g} mm wide everywhere"
        )
    if squeeze > 0.0:
        parts.append(
            f"the cam squeezes its yoke by up to {squeeze:.3g} mm, {at_angle(place)}, and no"
            " figure includes the resulting forces"
        )
    if parts:
        value = max(squeeze, breadth.variation)
        yield Finding(
            "yoke-breadth", "warning", "; ".join(parts), value, 0.0, "mm", cam_angle=place
        )


@dataclass(frozen=True, slots=True)
class _Trimmed:
    """A flank of which less than all is left.

    Attributes
    ----------
    dropped : ranges [rad] in which the disc does not make the demanded motion.
    replay : the motion that it makes.
    """

    dropped: tuple[Range, ...]
    replay: Replay

    @property
    def shocks(self) -> tuple[float, ...]:
        """Cam angles [rad] in these ranges at which velocity or lift jump."""
        jumps = [*self.replay.shocks.phi.tolist(), *self.replay.drops.phi.tolist()]
        return tuple(
            sorted(phi for phi in jumps if any(_inside(phi, stretch) for stretch in self.dropped))
        )

    def corners(self, *, included: bool) -> str:
        """What the motion does at the corners of the disc, and whether it is computed, as a
        clause.
        """
        if not self.shocks:
            where = "at both ends" if included else "at the corner of the disc there"
            computed = ", which is computed" if included else ", which is not computed"
            return f"{where} the acceleration jumps{computed}"
        if included:
            return f"the velocity jumps {at_angles(self.shocks)}"
        return f"velocity or lift jump {at_angles(self.shocks)}, and these shocks are not computed"


def _follows(effect: Effect, subject: Subject) -> bool:
    """Whether the figures of `effect` are for the motion that the trimmed disc makes."""
    return subject.state.model != "demanded" and not effect.of_plan


def trimming(effect: Effect, subject: Subject) -> Iterator[Finding]:
    """A warning for each trimmed flank: whose motion the figures are for, and between which cam
    angles the disc does not make the demanded one.
    """
    if effect.premise == "disc" or subject.disc is None:
        return
    factor, unit = STATED[subject.cam.lift_unit]
    for which, disc in _discs(subject):
        for name, _ in disc.flanks:
            trimmed = _trimmed(disc, name)
            if trimmed is None:
                continue
            loss = trimmed.replay.largest_loss
            flank, dropped = f"trimmed {which}{name} flank", over_ranges(trimmed.dropped)
            follows = _follows(effect, subject)
            whose = f"the demanded motion, which the {flank} does not make {dropped}"
            if follows:
                whose = (
                    f"the motion that the {flank} makes, which is not the demanded one {dropped}"
                )
            if follows and holds_both_ways(subject) and not _makes_motion(subject, disc, name):
                whose = (
                    f"the motion of the other side, where the {flank} has lost what would hold the"
                    f" follower on it {dropped}"
                )
                follows = False
            yield Finding(
                name="trimmed-motion",
                severity="warning",
                sentence=(
                    f"these figures are for {whose}: up to"
                    f" {factor * loss.value:.4g} {unit} of the lift is lost,"
                    f" {at_angle(loss.place)}; {trimmed.corners(included=follows)}"
                ),
                value=factor * loss.value,
                limit=0.0,
                unit=unit,
                cam_angle=loss.place,
                cam_range=_only(trimmed.dropped),
            )


def _makes_motion(subject: Subject, disc: Disc, flank: str) -> bool:
    """Whether the motion of the state is that of this flank, of a follower that is held both
    ways.
    """
    first = subject.state.sense == INNER
    if subject.returning is None:
        return (flank == FLANKS[INNER]) == first
    return (disc is subject.cam.disc) == first


def _discs(subject: Subject) -> Iterator[tuple[str, Disc]]:
    """The discs, each with the words that distinguish it from the other one."""
    yield "", subject.cam.disc
    if subject.returning is not None and subject.paired:
        yield "return disc's ", subject.returning.cam.disc


def _trimmed(disc: Disc, flank: str) -> _Trimmed | None:
    """The lost part of a flank; None if nothing is lost, or if there is no disc, which the checks
    report.
    """
    try:
        outline = disc.outline(flank)
        return _Trimmed(outline.dropped, disc.replay(flank)) if outline.is_trimmed else None
    except GeometryError:
        return None


def _simplified(effect: Effect, named: Sequence[str], *, follows: bool) -> Iterator[Finding]:
    """A warning if other effects that the scene names have a better model that is not followed."""
    refinements = [
        refinement
        for refinement in effect.refined_by
        if refinement.effect in named and not (refinement.followed and follows)
    ]
    if not refinements:
        return
    others = listed([refinement.effect for refinement in refinements])
    model = (
        "has a more accurate model, which is"
        if len(refinements) == 1
        else "have more accurate models, which are"
    )
    sentence = (
        f"these figures assume {listed([refinement.assumption for refinement in refinements])};"
        f" {others} in the same scene {model} not taken into account here"
    )
    cautions = [refinement.caution for refinement in refinements if refinement.caution]
    yield Finding("simplified", "warning", "; ".join((sentence, *cautions)))


def _wrap_range(range_: Range) -> Range:
    """The range with both ends in [0, 2 pi)."""
    return range_[0] % TURN, range_[1] % TURN


def _inside(phi: float, range_: Range) -> bool:
    """Whether the cam angle `phi` lies in the range, its ends included but for rounding."""
    start, end = range_
    return (phi - start + SLACK) % TURN <= (end - start) % TURN + 2.0 * SLACK


def _only(ranges: Sequence[Range]) -> Range | None:
    """The range if there is one alone, its ends in [0, 2 pi]."""
    if len(ranges) != 1:
        return None
    start, end = ranges[0]
    return start % TURN, end if end == TURN else end % TURN


# -- as written -----------------------------------------------------------------------------------
# That figures are for the motion on the contour as it is written, and how it is written.


WORDS: Final[dict[Form, str]] = {
    "arcs": "lines and arcs",
    "polyline": "straight pieces",
    "spline": "cubic splines",
}
"""Forms of a contour, in words."""


def written_findings(effect: Effect, subject: Subject) -> Iterator[Finding]:
    """The findings that the figures are for the motion on the contour as it is written and, if
    there are two, on which one, and how far the other one is from it.
    """
    contours = subject.contours
    if contours is None or effect.premise == "disc" or effect.of_plan:
        return
    writing, held = contours.writing, holds_both_ways(subject)
    _, unit = STATED["mm"]
    whose = "the written contour makes"
    names, noun = side_names(subject)
    if held:
        whose = f"the written contour of the {names[contours.sense]} {noun} makes all round"
    yield Finding(
        name="written-motion",
        severity="ok",
        sentence=(
            f"these figures are for the motion that {whose},"
            f" {WORDS[writing.form]} within {writing.tolerance:g} {unit}"
        ),
        value=writing.tolerance,
        unit=unit,
    )
    if held:
        yield _other_contour_finding(subject, contours)


def _other_contour_finding(subject: Subject, contours: Contours) -> Finding:
    """The finding on the distance of the other written contour from the one that makes the
    motion.
    """
    names, noun = side_names(subject)
    carrying, other = (f"the {names[side]} {noun}" for side in (contours.sense, -contours.sense))
    try:
        play = contours.play
    except (GeometryError, ToleranceError) as error:
        return Finding(
            "other-contour", "warning", f"how far {other} is from {carrying} is not known: {error}"
        )
    factor, unit = STATED[subject.cam.lift_unit]
    low, high = (factor * extreme.value for extreme in (play.lowest, play.highest))
    who = "roller" if subject.returning is None else "follower"
    written = f"the written contours of {carrying} and {other} leave"
    if subject.cam.yoke is not None:
        written = f"between {carrying} and {other}, the written contour leaves"
    sentence = (
        f"{written} the {who} {low:.4g} to {high:.4g} {unit} of lift, least"
        f" {at_angle(play.lowest.place)}"
    )
    if low < 0.0:
        sentence += "; below 0 both squeeze it, which is not computed"
    return Finding(
        name="other-contour",
        severity="warning" if low < 0.0 else "ok",
        sentence=sentence,
        value=low,
        limit=0.0,
        unit=unit,
        cam_angle=play.lowest.place,
    )


# -- inherited errors -----------------------------------------------------------------------------
# Results from others that are known to an error: the errors that all their figures inherit.
#
# A speed that `speed-fluctuation` or `camshaft-windup` finds is off by less than it differs from
# the one on cells twice as long (`camgeo.dynamics.effects.results.Turning`), and the force of an
# elastic train by no more than its error e, in either direction at each cam angle. So is what
# follows from them: an effect is computed again with the other speed, and with trains that are off
# by e (`camgeo.dynamics.effects.forces.ElasticTrain.perturbed_trains`), and of all its figures in
# one unit the largest difference is taken for each of them; those of several causes add up. That
# one figure hardly differs, by chance or because it depends on the speed where that is accurate,
# thus does not make it look exact. These computations wait until an error is asked for.


PLACE: Final = 2.0**-26
"""Error of a value at the place of an extreme that is not its own, as a share: such a place is
known to the root of a rounding."""

ANGLES: Final = 1024
"""Cam angles over a turn at which columns are compared."""

FORCE_FINDINGS: Final = ("contact-lost", "other-side")
"""Findings on premises that state a contact force."""

OFFSET: Final = 0.381966
"""Offset of the first of these angles from 0, as a fraction of their spacing: no jump is there."""


Figures = dict[str, tuple[str, FloatArray]]
"""The unit and the values of figures, by name."""


@dataclass(frozen=True, eq=False)
class InheritedErrors(Mapping[str, Bound]):
    """The errors of all figures of `result`, see `camgeo.dynamics.effects.effect.Result.errors`.

    Attributes
    ----------
    result : with errors that do not include the inherited ones.
    others : each gives the same result from others that are off; raises EffectError or
        GeometryError if there is none.
    premises : all findings with those on premises; `OF_FORCE` are as accurate as the contact force.
    force : gives the contact force.
    """

    result: Result
    others: Sequence[Callable[[], Result]]
    premises: Sequence[Finding] = ()
    force: Callable[[], Result] | None = None

    @cached_property
    def _bounds(self) -> dict[str, Bound]:
        """Error of each figure by its name: its own, and what the other results differ by."""
        figures = _figures(self.result)
        placed = {finding.name for finding in self.result.findings if finding.cam_angle is not None}
        moved: dict[str, float] = {}
        sizes: dict[str, float] = {}
        for unit, values in figures.values():
            sizes[unit] = max(sizes.get(unit, 0.0), float(np.max(np.abs(values))))
        for other in self.others:
            for unit, difference in _largest_differences(figures, other).items():
                # The causes are independent of each other, so their effects may add up.
                moved[unit] = moved.get(unit, 0.0) + difference
        bounds = dict(self.result.errors)
        for name, (unit, _) in figures.items():
            size = sizes[unit]
            known = bounds.get(name, Bound((PLACE if name in placed else SHARE) * size, size))
            bounds[name] = Bound(known.error + moved[unit], known.scale)
        return bounds

    def __getitem__(self, name: str) -> Bound:
        if self.force is not None and name in self._force_figures:
            return max(self.force().errors.values(), key=lambda bound: bound.error)
        return self._bounds[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    @property
    def _names(self) -> dict[str, None]:
        """The names of all figures, in order."""
        result = self.result
        valued = [finding.name for finding in result.findings if finding.value is not None]
        columns = [column.name for column in result.columns]
        return dict.fromkeys([*result.errors, *valued, *columns, *self._force_figures])

    @property
    def _force_figures(self) -> list[str]:
        return [finding.name for finding in self.premises if finding.name in FORCE_FINDINGS]


def _largest_differences(own: Figures, other: Callable[[], Result]) -> dict[str, float]:
    """The largest difference of the figures in each unit."""
    try:
        others = _figures(other())
    except (EffectError, GeometryError):
        others = {}
    differences: dict[str, float] = {}
    for name, (unit, values) in own.items():
        difference = float(
            np.max(np.abs(values))
        )  # nothing is known of a figure that the other has not
        if name in others and others[name][1].shape == values.shape:
            difference = float(np.max(np.abs(values - others[name][1])))
        differences[unit] = max(differences.get(unit, 0.0), difference)
    return differences


def _figures(result: Result) -> Figures:
    """The unit and the values of all figures: of findings, in order, and of columns."""
    phi: FloatArray = (np.arange(ANGLES, dtype=np.float64) + OFFSET) * (TURN / ANGLES)
    units: dict[str, str] = {}
    finding_values: dict[str, list[float]] = {}
    for finding in result.findings:
        if finding.value is not None:
            units.setdefault(finding.name, finding.unit)
            # Findings may share a name: their values are compared in order.
            finding_values.setdefault(finding.name, []).append(finding.value)
    figures = {name: (units[name], np.array(values)) for name, values in finding_values.items()}
    columns = {column.name: (column.unit, column.values(phi, "right")) for column in result.columns}
    return figures | columns


def describe_machine(subject: Subject) -> MachineTraits:
    """The properties of the machine that the rules of effects depend on."""
    follower, linkage = subject.cam.follower, subject.drive.linkage
    return MachineTraits(
        lift=follower.lift_unit,
        touching=follower.touching,
        edged=follower.has_edge,
        far="" if linkage is None else linkage.member,
        paired=subject.paired,
        yoked=subject.cam.yoke is not None,
    )
