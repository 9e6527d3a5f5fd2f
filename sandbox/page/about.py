"""About: what a page must know of a world beside its memory: places, names, codes and the table of state arrays."""

from typing import Any, NamedTuple

from sandbox.physics.constraints import AREA
from sandbox.physics.jit.library import read_manifest
from sandbox.physics.pipeline import block, collide, tick
from sandbox.physics.settings import SOLVER_NAMES
from sandbox.physics.state import COLUMNS, GUARDED, STATE_FIELDS, TOPOLOGY, Family
from sandbox.physics.world import GRAB_COUNT, World

# Kernels that a page calls, by their names there, where the library has them.
KERNELS = {
    "tick": "sandbox.physics.pipeline.tick.tick",
    "derive": "sandbox.physics.pipeline.derive.derive",
    "command": "sandbox.physics.pipeline.command.command",
}
CODES = ("FINISHED", "UNSOUND", "NO_ROOM", "LOST", "BROKE")
PROGRESS = ("TICK", "MAY_FLY", "COUNT", "DONE", "BROKEN", "CHECKED")
# Arrays of a block beside its state that go on from tick to tick.
KEPT = ("collisions.counts", "numbers", "choices", "plan")
CONTACT = "contact_"


class Packing(NamedTuple):
    """How a command lies in two arrays: its kind, then its whole numbers; its floats. derives: it changes topology.

    A whole number that is left out is -1, a float NaN.
    """

    kind: int
    integers: tuple[str, ...]
    floats: tuple[str, ...]
    derives: bool


_FIELDS: dict[str, tuple[tuple[str, ...], tuple[str, ...], bool]] = {
    "grab": (("grab", "particle"), ("target", "strength", "radius"), True),
    "move_grab": (("grab",), ("target",), False),
    "release": (("grab",), (), True),
    "pin": (("particle",), (), True),
    "unpin": (("particle",), (), True),
    "cut_springs": (("springs",), (), True),
    "break_springs": (("springs",), (), True),
    "set_coefficients": (("material",), ("stiffness", "damping"), False),
    "set_drive": (("part",), ("value",), False),
    "push": ((), ("position", "radius", "impulse", "outward"), False),
    "set_gravity": ((), ("gravity",), False),
    "set_air": ((), ("wind", "drag"), False),
    "freeze": (("particle",), (), True),
}
COMMANDS = {name: Packing(kind, *fields) for kind, (name, fields) in enumerate(_FIELDS.items())}


def about(world: World, words: int) -> dict[str, Any]:
    """All that a page must know of a world whose block has so many words, as JSON takes it."""
    entries = read_manifest()["entries"]
    kept = [f"state.{name}" for name in STATE_FIELDS] + [f"good.{column.name}" for column in GUARDED]
    kept += [f"collisions.kept.{column.name.removeprefix(CONTACT)}" for column in COLUMNS if _is_contact(column)]
    return {
        "kernels": {name: entries[path]["symbol"] for name, path in KERNELS.items() if path in entries},
        "words": words,
        "codes": {name: getattr(tick, name) for name in CODES},
        "progress": {name: getattr(block, name) for name in PROGRESS} | {"KEPT": collide.KEPT},
        "commands": {name: packing._asdict() for name, packing in COMMANDS.items()},
        "solvers": SOLVER_NAMES,
        "hands": {"particle": world.grab_particle, "spring": world.grab_spring, "count": GRAB_COUNT},
        "area": AREA,
        "columns": [_column(column) for column in COLUMNS],
        "topology": [f"state.{column.name}" for column in TOPOLOGY],
        "kept": kept + list(KEPT),
        "names": {
            "particle": world.particle_names,
            "spring": world.spring_names,
            "material": world.material_names,
            "part": world.actuators.names,
        },
    }


def _is_contact(column: Any) -> bool:
    return bool(column.family is Family.CONTACT)


def _column(column: Any) -> dict[str, Any]:
    is_contact = _is_contact(column)
    path = f"collisions.kept.{column.name.removeprefix(CONTACT)}" if is_contact else f"state.{column.name}"
    return {
        "stored": column.stored,
        "path": path,
        "width": column.width,
        "isContact": is_contact,
        "isSparse": column.sparse,
        "usual": float(column.usual),
    }
