"""About: what a page must know of a world beside its memory: places, names, codes and the table of state arrays."""

from typing import Any

from sandbox.physics import command
from sandbox.physics.constraints import AREA
from sandbox.physics.jit.library import read_manifest
from sandbox.physics.jit.making.platforms import WEB
from sandbox.physics.marks import GRAB_COUNT
from sandbox.physics.pipeline import block, collide, tick
from sandbox.physics.settings import SOLVER_NAMES
from sandbox.physics.state import COLUMNS, GUARDED, STATE_FIELDS, TOPOLOGY, Column, Family
from sandbox.physics.world import World
from sandbox.session.commands.command import COMMAND_TYPES
from sandbox.session.commands.for_pages import table_of

# Kernels that a page calls.
KERNELS = {path.rpartition(".")[2]: path for path in WEB.entries}
CODES = ("FINISHED", "UNSOUND", "NO_ROOM", "LOST", "BROKE")
PROGRESS = ("TICK", "MAY_FLY", "COUNT", "DONE", "BROKEN", "CHECKED")
# Arrays of a block beside its state that go on from tick to tick.
SETTING_ARRAYS = ("numbers", "choices")
CONTACT = "contact_"


def is_done_by_pages(name: str) -> bool:
    """Whether pages carry out commands of that type themselves; of others they are told what they change."""
    return name in command.KINDS


def about(world: World, words: int) -> dict[str, Any]:
    """All that a page must know of a world whose block has so many words, as JSON takes it."""
    entries = read_manifest()["entries"]
    kept = [f"state.{name}" for name in STATE_FIELDS] + [f"good.{column.name}" for column in GUARDED]
    return {
        "kernels": {name: entries[path]["symbol"] for name, path in KERNELS.items()},
        "words": words,
        "codes": {name: getattr(tick, name) for name in CODES},
        "progress": {name: getattr(block, name) for name in PROGRESS} | {"KEPT": collide.KEPT},
        "kinds": {name: kind._asdict() for name, kind in command.KINDS.items()},
        "badSlot": command.BAD_SLOT,
        **table_of(set(filter(is_done_by_pages, COMMAND_TYPES))),
        "solvers": SOLVER_NAMES,
        "hands": {"particle": world.grab_particle, "spring": world.grab_spring, "count": GRAB_COUNT},
        "area": AREA,
        "columns": [_column(column) for column in COLUMNS],
        "topology": [*(f"state.{column.name}" for column in TOPOLOGY), "choices"],
        "kept": kept + list(SETTING_ARRAYS),
        "names": {
            "particle": world.particle_names,
            "spring": world.spring_names,
            "material": world.material_names,
            "part": world.actuators.names,
        },
        "second": {"particle": dict(world.particle_naming.second), "spring": dict(world.spring_naming.second)},
    }


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
