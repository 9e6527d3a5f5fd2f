"""About: what a page must know of a world beside its memory: places, names, codes and the table of state arrays."""

from typing import Any

from sandbox.level.assembly.level_world import LevelWorld
from sandbox.level.rules.action import ActionDef
from sandbox.level.rules.hands import words_of
from sandbox.page.growth import growth_of
from sandbox.physics.commands import command, command_table, permission
from sandbox.physics.constraints import AREA
from sandbox.physics.jit.library import read_manifest
from sandbox.physics.jit.making.platforms import WEB
from sandbox.physics.marks import GRAB_COUNT
from sandbox.physics.pipeline import block, collide, tick
from sandbox.physics.settings import SOLVER_NAMES
from sandbox.physics.state import COLUMNS, GUARDED, STATE_FIELDS, TOPOLOGY, Column, Family
from sandbox.session.actions import record_of, softening_of
from sandbox.session.commands.command import COMMAND_TYPES
from sandbox.session.commands.for_pages import table_of
from sandbox.session.commands.records import from_record

# Kernels that a page calls.
KERNELS = {path.rpartition(".")[2]: path for path in WEB.entries}
CODES = ("FINISHED", "UNSOUND", "NO_ROOM", "LOST", "BROKE")
PROGRESS = ("TICK", "MAY_FLY", "COUNT", "DONE", "BROKEN", "CHECKED")
# Arrays of a block beside its state that go on from tick to tick.
SETTING_ARRAYS = ("numbers", "choices")
CONTACT = "contact_"


def _equipment() -> list[str]:
    """Arrays that grow with what joins, but for what was found of them, which is found again."""
    return [path for path in growth_of() if not path.startswith("modes.")]


def is_done_by_pages(name: str) -> bool:
    """Whether pages carry out commands of that type."""
    return name in command_table.KINDS or name in ("add_particle", "add_spring", "add_body", "remove")


def about(world: LevelWorld, words: int) -> dict[str, Any]:
    """All that a page must know of a world whose block has so many words, as JSON takes it."""
    entries = read_manifest()["entries"]
    kept = [f"state.{name}" for name in STATE_FIELDS] + [f"good.{column.name}" for column in GUARDED]
    return {
        "kernels": {name: entries[path]["symbol"] for name, path in KERNELS.items()},
        "words": words,
        "codes": {name: getattr(tick, name) for name in CODES},
        "plan": {name: getattr(block, name) for name in ("GRAB_PARTICLE", "GRAB_SPRING")},
        "progress": {name: getattr(block, name) for name in PROGRESS} | {"KEPT": collide.KEPT},
        "kinds": {name: kind._asdict() for name, kind in command_table.KINDS.items()},
        "choices": command_table.CHOICES,
        "answers": command_table.ANSWERS,
        "givers": {name: getattr(permission, name) for name in ("HAND", "RULE", "PROGRAM")},
        "refusals": {"reasons": command.REASONS, "words": command_table.WORDS, "bad": command.BAD},
        "filled": {
            "doing": command.FORBIDDEN,
            "counted": command.EXHAUSTED,
            "thing": command.UNTOUCHABLE,
            "reach": command.BEYOND_REACH,
        },
        "denied": {
            "size": permission.DENIED,
            "reasons": {
                permission.NOT_ALLOWED: command.FORBIDDEN,
                permission.SPENT: command.EXHAUSTED,
                permission.UNTOUCHED: command.UNTOUCHABLE,
            },
        },
        "deeds": {name: words_of(name) for name in command_table.CODES},
        "codeOf": command_table.CODES,
        **table_of(set(filter(is_done_by_pages, COMMAND_TYPES)) - {"add_body"}),
        "rate": world.settings.tick_rate,
        "solvers": SOLVER_NAMES,
        "hands": {"particle": world.grab_particle, "spring": world.grab_spring, "count": GRAB_COUNT},
        "area": AREA,
        "columns": [_column(column) for column in COLUMNS],
        "topology": [*(f"state.{column.name}" for column in TOPOLOGY), "choices"],
        "kept": list(dict.fromkeys([*kept, *SETTING_ARRAYS, *_equipment()])),
        "names": {
            "particle": world.particle_names,
            "spring": world.spring_names,
            "material": world.material_names,
            "part": world.actuators.names,
            "key": world.rule_keys,
            "area": world.area_names,
            "form": [form.name for form in world.forms],
        },
        "rules": [[_action(action, world) for action in rule.then] for rule in world.level.rules],
        "second": {"particle": dict(world.particle_naming.second), "spring": dict(world.spring_naming.second)},
    }


def _action(action: ActionDef, world: LevelWorld) -> dict[str, Any]:
    """An action as a page does it: what it says, and a counter or a command with slots in place of names."""
    level, rate = world.level, world.settings.tick_rate
    counters = [counter.id for counter in level.counters]
    made: dict[str, Any] = action.model_dump(include={"win", "fail", "say", "sound"}, exclude_none=True)
    if action.stars is not None:
        stars = action.stars
        place = None if stars.counter is None else counters.index(stars.counter)
        made["stars"] = {"counter": place, "second": stars.second, "third": stars.third}
    if action.count is not None:
        made |= {"count": counters.index(action.count), "by": action.by}
    record = record_of(action, world, rate)
    if record is not None:
        made["commands"] = [{"type": record["type"], **vars(from_record(record, world))}]
    elif action.sag is not None:
        made["commands"] = [{"type": "soften", **softening_of(action, level, world)}]
    return made | ({"isCheckpoint": True} if action.checkpoint else {})


def array_path(column: Column) -> str:
    """Where in a block the array of a line of the table of state is."""
    if column.family is Family.CONTACT:
        return f"collisions.kept.{column.name.removeprefix(CONTACT)}"
    return f"state.{column.name}"


def _column(column: Column) -> dict[str, Any]:
    return {
        "stored": column.stored,
        "path": array_path(column),
        "width": column.width,
        "family": column.family.name.lower(),
        "isContact": column.family is Family.CONTACT,
        "isSparse": column.sparse,
        "usual": float(column.usual),
    }
