"""Golden files: where named things of a run are at some times, and what checks measure, each within a tolerance.

A recording is equal in every bit or it is not; a golden file holds through a change that moves nothing far. It is text
of a few lines, to be read in a review.
"""

import codecs
import json
import math
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from sandbox.level.document.model import Level
from sandbox.level.format.level_error import suggestion
from sandbox.level.format.quantities import Name, Point
from sandbox.level.format.writing import write_file
from sandbox.level.reading.files import load_level, read_bytes
from sandbox.level.reading.parse import json_value
from sandbox.physics.world import World
from sandbox.session.check_run import run_checks
from sandbox.session.commands import CommandError
from sandbox.session.commands.faults import plain_fault
from sandbox.session.commands.records import ScriptLine
from sandbox.session.replay import is_recording
from sandbox.session.replay.reader import read_replay, read_script
from sandbox.session.replay.rerecord import Renames, owner_of, renamed_name, renamed_record
from sandbox.session.session import Session

SUFFIX = ".golden.json"
FORMAT = "spring-sandbox/golden"
# A run is no longer [s], and a file has no more times or things.
LONGEST, MOST = 600.0, 1_000
# Digits that are kept beyond those of a tolerance.
FINER = 2

Tolerance = Annotated[float, Field(gt=0.0, le=1e6)]


class GoldenFile(BaseModel):
    """A golden file.

    level: its file as seen from this one, or a shipped level's name; commands: a script or a recording whose commands
    are given. at: times [s]; places: by a particle's name or a body's id (its centre of mass) the point [m] at each of
    them, none where they are to be recorded; within: how far [m] it may lie from there. values: by names of the level's
    checks what these measure, null where that is to be recorded; values_within: by which share it may differ.
    """

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    format: Literal["spring-sandbox/golden"]
    version: Literal[1] = 1
    level: Name
    commands: Name | None = None
    at: Annotated[tuple[Annotated[float, Field(ge=0.0, le=LONGEST)], ...], Field(max_length=MOST)] = ()
    within: Tolerance = 0.01
    places: Annotated[dict[Name, tuple[Point, ...]], Field(max_length=MOST)] = {}
    values_within: Tolerance = 0.02
    values: Annotated[dict[Name, float | None], Field(max_length=MOST)] = {}


class GoldenError(ValueError):
    """A golden file that cannot be used; faults: one line each; missing: a name that its level has not, or ""."""

    def __init__(self, *faults: str, missing: str = "") -> None:
        super().__init__("\n".join(faults))
        self.faults = list(faults)
        self.missing = missing


@dataclass(frozen=True)
class Golden:
    """A golden file with the level and the commands that it names."""

    path: Path
    file: GoldenFile
    level: Level
    script: tuple[ScriptLine, ...] = ()

    def measured(self, level: Level | None = None) -> GoldenFile:
        """Run it, on its level or another; the same file with what came. Raises GoldenError."""
        level = level or self.level
        faults = dict(self._unknown_checks(level))
        if faults:
            raise GoldenError(*faults.values(), missing=next(iter(faults)))
        numbers = {result.check.name: result.value for result in run_checks(level)} if self.file.values else {}
        endless = [name for name in self.file.values if not math.isfinite(numbers[name])]
        if endless:
            raise GoldenError(*(f"{self.path}: values: what {name!r} measures is no finite number" for name in endless))
        changed = {"places": self._places(level), "values": {name: numbers[name] for name in self.file.values}}
        return self.file.model_copy(update=changed)

    def carried_over(self, renames: Renames) -> "Golden":
        """The same with other names of bodies, loose particles and checks, as far as the level lacks the old ones."""
        level, script = self.level, self.script
        known = {body.id for body in level.bodies} | {each.id for each in level.particles}
        known |= {check.name for check in level.checks}
        apt = {old: new for old, new in renames.items() if old not in known}
        # A script is edited by hand: what it names is told.
        if self.file.commands and is_recording(Path(self.file.commands)):
            script = tuple(replace(line, record=renamed_record(line.record, apt)) for line in script)
        places = {renamed_name(name, apt): points for name, points in self.file.places.items()}
        values = {apt.get(name, name): value for name, value in self.file.values.items()}
        return replace(self, file=self.file.model_copy(update={"places": places, "values": values}), script=script)

    def _unknown_checks(self, level: Level) -> Iterator[tuple[str, str]]:
        names = [check.name for check in level.checks]
        for name in self.file.values:
            if name not in names:
                yield name, f"{self.path}: values: the level has no check {name!r}{suggestion(name, names)}"

    def _places(self, level: Level) -> dict[str, tuple[Point, ...]]:
        session, found = Session(level, script=self.script), {}
        where = {name: _finder(session.world, name, str(self.path)) for name in self.file.places}
        rate = level.settings.tick_rate
        try:
            for seconds in sorted(set(self.file.at)):
                while session.tick < round(seconds * rate):
                    session.advance()
                found[seconds] = {name: _point(session.world, *slots) for name, slots in where.items()}
        except CommandError as error:
            raise GoldenError(*(f"{self.path}: commands: {fault}" for fault in error.faults)) from None
        return {name: tuple(found[seconds][name] for seconds in self.file.at) for name in where}


def read_golden(path: Path) -> Golden:
    """Read a golden file, its level and its commands. Raises GoldenError, LevelError and ReplayError."""
    data = read_bytes(path).removeprefix(codecs.BOM_UTF8)
    json_value(data, str(path))
    try:
        file = GoldenFile.model_validate_json(data)
    except ValidationError as error:
        raise GoldenError(f"{path}: {plain_fault(error)}") from None
    if not (file.places and file.at) and not file.values:
        raise GoldenError(f"{path}: holds nothing to compare: it has neither places at some times nor values")
    wrong = [name for name, points in file.places.items() if points and len(points) != len(file.at)]
    if wrong:
        lengths = {name: len(file.places[name]) for name in wrong}
        raise GoldenError(*(f"{path}: places.{name}: {lengths[name]} points, {len(file.at)} times" for name in wrong))
    beside = Path(os.path.normpath(path.parent / file.level))
    level = load_level(beside if beside.is_file() else file.level)
    return Golden(path, file, level, _script(path, file, level))


def _script(path: Path, file: GoldenFile, level: Level) -> tuple[ScriptLine, ...]:
    """The commands of a golden file, all of which its run carries out. Raises GoldenError and ReplayError."""
    if file.commands is None:
        return ()
    named = path.parent / file.commands
    script = read_replay(named).script if is_recording(named) else read_script(named)
    last = round(max(file.at, default=0.0) * level.settings.tick_rate)
    late = [line.tick for line in script if line.tick > last]
    if not script:
        raise GoldenError(f"{path}: commands: {file.commands} holds none")
    if not (file.places and file.at):
        raise GoldenError(f"{path}: commands: act on places, and there are none; values have the keys of their checks")
    if late:
        number = "1 is" if len(late) == 1 else f"{len(late):,} are"
        raise GoldenError(f"{path}: commands: {number} after the last place, at tick {last}; name a later time in `at`")
    return script


def _finder(world: World, name: str, source: str) -> tuple[list[int], list[float]]:
    """Slots of a particle or of a body's particles, and their masses. Raises GoldenError."""
    slots = [slot for slot, each in enumerate(world.particle_names) if each == name or each.startswith(f"{name}.")]
    try:
        slots = [world.particle_slot(name)]
    except KeyError:
        if not slots:
            names = [second for second, _ in world.particle_naming.second] + world.particle_names
            near = suggestion(name, names)
            fault = f"{source}: places: there is no particle or body {name!r}{near}"
            raise GoldenError(fault, missing=owner_of(name)) from None
    return slots, world.mass[slots].tolist()


def _point(world: World, slots: list[int], masses: list[float]) -> Point:
    total, places = math.fsum(masses), world.position[slots].tolist()
    x, y = (
        math.fsum(mass * place[axis] for mass, place in zip(masses, places, strict=True)) / total for axis in (0, 1)
    )
    return x, y


def differences(golden: GoldenFile, measured: GoldenFile) -> list[str]:
    """The values that are beyond their tolerance, or not recorded yet; a line each."""
    return [*_moved(golden, measured), *_changed(golden, measured)]


def _moved(golden: GoldenFile, measured: GoldenFile) -> Iterator[str]:
    for name, points in measured.places.items():
        recorded = golden.places[name]
        if golden.at and not recorded:
            yield f"{name}: no place is recorded yet"
        for seconds, (x, y), (u, v) in zip(golden.at, recorded, points, strict=False):
            apart = math.hypot(x - u, y - v)
            if not apart <= golden.within:
                said = f"at {seconds:g} s expected ({x:g}, {y:g}), got ({u:.6g}, {v:.6g})"
                yield f"{name}: {said}: {apart:.3g} m apart, allowed {golden.within:g}"


def _changed(golden: GoldenFile, measured: GoldenFile) -> Iterator[str]:
    allowed = golden.values_within
    for name, value in measured.values.items():
        recorded = golden.values[name]
        if recorded is None or value is None:
            yield f"{name}: no value is recorded yet"
        elif not abs(value - recorded) <= allowed * abs(recorded):
            apart = 100.0 * abs(value - recorded) / abs(recorded) if recorded else math.inf
            said = f"{name}: expected {recorded:g}, got {value:.6g}"
            yield f"{said}: {apart:.3g} % apart, allowed {100.0 * allowed:g} %"


def write_golden(path: Path, measured: GoldenFile) -> None:
    """Write a golden file, its numbers with a few digits more than the tolerance needs. Raises OSError."""
    digits = FINER - math.floor(math.log10(measured.within))
    places = {
        name: [[round(each, digits) for each in point] for point in points] for name, points in measured.places.items()
    }
    kept = max(FINER - math.floor(math.log10(measured.values_within)), 1)
    values = {name: float(f"{value:.{kept}g}") for name, value in measured.values.items() if value is not None}
    write_file(path, _text(measured.model_dump(exclude_unset=True) | {"places": places, "values": values}).encode())


def _text(data: Mapping[str, Any]) -> str:
    """JSON with a line for each thing, so that a review sees which one moved."""
    lines = []
    for key, value in data.items():
        if isinstance(value, dict):
            if value:
                inner = ",\n".join(f"    {json.dumps(name)}: {json.dumps(each)}" for name, each in value.items())
                lines.append(f"  {json.dumps(key)}: {{\n{inner}\n  }}")
        else:
            lines.append(f"  {json.dumps(key)}: {json.dumps(value)}")
    return "{\n" + ",\n".join(lines) + "\n}\n"
