"""Runs for pages and links: commands with kits in place of definitions of bodies, and without what was undone."""

from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from sandbox.app.draw.scene import joined_scene
from sandbox.level.assembly.build_world import LevelWorld, build_world
from sandbox.level.assembly.joining import Joiners
from sandbox.level.assembly.kit_files import written
from sandbox.level.document.model import Level
from sandbox.level.format.level_error import LevelError
from sandbox.level.plan.actuators import driving_keys
from sandbox.physics.snapshot import state_hash
from sandbox.physics.step import step
from sandbox.session.actions import RuleActions
from sandbox.session.commands import CommandError, Redo, SetColour, Undo, apply
from sandbox.session.commands.records import ScriptLine, from_record, script_of
from sandbox.session.replay.format import TICK_DIGITS
from sandbox.session.replay.link import fragment_of, level_record
from sandbox.session.replay.recording import Replay, ReplayError
from sandbox.session.session import Session

_ADD = "add_body"
# Of what is drawn: fields that hold slots of particles, and of springs, at any depth.
_PARTICLES = frozenset(("triangles", "loops", "knots", "hub", "inner", "outer", "spokes", "slot"))
_SPRINGS = frozenset(("spring", "needs"))


class RunForPages(NamedTuple):
    """A script as pages carry it out, the hash of each tick, and the world at the end."""

    script: tuple[ScriptLine, ...]
    hashes: list[str]
    world: LevelWorld


def is_for_pages(line: ScriptLine) -> bool:
    """Whether pages carry out a command as it is."""
    return line.record["type"] not in (Undo.type, Redo.type, SetColour.type) and not _is_defined(line.record)


def _is_defined(record: Mapping[str, Any]) -> bool:
    return record["type"] == _ADD and "kit" not in record


def tick_hash(world: LevelWorld) -> str:
    """The hash of a state that a page compares its tick with."""
    return state_hash(world)[:TICK_DIGITS]


def run_for_pages(
    level: Level, script: Sequence[ScriptLine], ticks: int, hash_of: Callable[[LevelWorld], str] = tick_hash
) -> Generator[float, None, RunForPages]:
    """A run as pages play it, a slice of the work at a time: each gives the part that is done, 0..1.

    Raises CommandError, with the number of the line.
    """
    begun = 0.0

    def part(tick: int) -> float:
        return begun + (1.0 - begun) * tick / max(ticks, 1)

    if any(line.record["type"] in (Undo.type, Redo.type) for line in script):
        # It is run twice.
        begun = 0.5
        script = yield from _without_undone(level, script, ticks)
    world, made = build_world(level), list[ScriptLine]()
    paints = [line.record for line in script if line.record["type"] == SetColour.type]
    hashes, actions = [hash_of(world)], RuleActions(level, world)

    def stepped(tick: int) -> Iterator[int]:
        while world.tick < tick:
            actions.act(world)
            step(world)
            hashes.append(hash_of(world))
            yield world.tick

    for line in script:
        yield from map(part, stepped(line.tick))
        if line.record in paints:
            continue
        try:
            made.append(replace(line, record=carried_out(level, world, line.record, paints)))
        except CommandError as error:
            raise CommandError(f"line {line.line}: {error}") from None
    yield from map(part, stepped(ticks))
    return RunForPages(tuple(made), hashes, world)


def _without_undone(
    level: Level, script: Sequence[ScriptLine], ticks: int
) -> Generator[float, None, tuple[ScriptLine, ...]]:
    session = Session(level, script)
    while session.tick < ticks:
        session.advance()
        yield 0.5 * session.tick / ticks
    session.apply_pending()
    return script_of([entry for entry in session.history.timeline if entry.in_effect], session.world)


def carried_out(
    level: Level, world: LevelWorld, record: dict[str, Any], paints: Sequence[dict[str, Any]] = ()
) -> dict[str, Any]:
    """Carry out a command; its record, with a kit in place of definitions. Raises CommandError.

    paints: the commands that paint later; pages show what joins in its last colour.
    """
    before, kit = {"particle": world.particle_count, "spring": world.spring_count}, None
    command = from_record(record, world)
    if _is_defined(record):
        definition = {name: value for name, value in vars(command).items() if value is not None}
        try:
            kit = Joiners(world, definition).kit(world)
        except LevelError as error:
            raise CommandError(str(error)) from None
    apply(world, command)
    if kit is None:
        return record
    for paint in paints:
        if str(paint["particle"]).partition(".")[0] in world.joined[-1].names:
            apply(world, from_record(paint, world))
    keys = {key: [list(each) for each in parts] for key, parts in driving_keys(kit.level).items()}
    look = _in_own_slots(joined_scene(level, world, before), before)
    for join in look.get("joins", ()):
        # The springs say where they end.
        del join["ends"]
    return {"type": _ADD, "kit": written(kit, keys, look)}


def _in_own_slots(things: Any, first: Mapping[str, int], name: str = "") -> Any:
    """What is drawn, in slots that count from the first particle and spring of a kit on."""
    if isinstance(things, dict):
        found = {key: _in_own_slots(value, first, key) for key, value in things.items()}
        if isinstance(things.get("slots"), list):
            found["slots"] = [[slot - first["particle"], count] for slot, count in things["slots"]]
        return found
    if isinstance(things, list):
        return [_in_own_slots(value, first, name) for value in things]
    if isinstance(things, int) and not isinstance(things, bool) and name in (*_PARTICLES, *_SPRINGS):
        return things - first["spring" if name in _SPRINGS else "particle"]
    return things


def link_to(replay: Replay, site: str, at: int) -> Generator[float, None, str]:
    """A link to a recorded run on a site, which its page shows from a tick on; each slice gives the part done, 0..1.

    site: the address of the folder that `write_site` wrote; "": the fragment alone. What was undone is left out.
    Raises ReplayError.
    """
    if not all(map(is_for_pages, replay.script)):
        try:
            run = yield from run_for_pages(replay.level, replay.script, replay.ticks, lambda _: "")
        except CommandError as error:
            raise ReplayError(f"{replay.source}: {error}") from None
        replay = replace(replay, script=run.script)
    return f"{page_address(replay.level, site)}#{fragment_of(replay, at)}"


def page_address(level: Level, site: str) -> str:
    """The address of a level's page on a site, where it is a shipped level; else that of the site."""
    site, name = site.partition("#")[0], level_record(level)["level"]
    return f"{site.rstrip('/')}/levels/{name}.html" if site and isinstance(name, str) else site
