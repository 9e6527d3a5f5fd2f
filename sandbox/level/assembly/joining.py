"""Adds bodies to a running world: reads definitions of the level format, checks and builds them."""

import functools
import itertools
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from sandbox.level.assembly.build_world import LevelWorld, build_world
from sandbox.level.assembly.kit_files import read
from sandbox.level.assembly.kits import Kit, KitNames, columns_of, join, packed_for
from sandbox.level.document.model import Level, Material, NissenMaterial
from sandbox.level.format.level_error import Fault, LevelError, shown, suggestion
from sandbox.level.format.limits import DEFAULT_MATERIAL, DEFINITION_LIMIT, FORMAT, VERSION
from sandbox.level.plan.actuators import actuators
from sandbox.level.plan.surfaces import DEFAULT_GROUP, TERRAIN_NAME, free_wheels, group_bits
from sandbox.level.reading.parse import parse_level
from sandbox.physics.commands.command import ADD_BODY, PROGRAM
from sandbox.physics.kits.joining import KitError, check_kit
from sandbox.physics.marks import ALL_GROUPS

SOURCE = "add_body"
# Definitions that are kept once checked: undoing and redoing add the same ones again.
KEPT = 64


class Joiners:
    """The bodies of a definition, checked and built, before they join a world.

    definition: `body`, and optionally `others`, `springs`, `welds` and `materials`, as in a level file. Springs and
    welds join these bodies, by their ids in the definition; `passes`: see AddBody. Raises LevelError with every fault.
    """

    def __init__(self, world: LevelWorld, definition: Mapping[str, Any]) -> None:
        self.definition = dict(definition)
        base, bodies = world.level, [definition["body"], *(definition.get("others") or ())]
        bodies = [_identified(body, number) for number, body in enumerate(bodies)]
        self._said, plain = zip(*(_without_groups(body) for body in bodies), strict=True)
        self._bits = group_bits(base)
        faults = list(itertools.chain.from_iterable(map(self._group_faults, range(len(bodies)))))
        if faults:
            raise LevelError(SOURCE, faults)
        data = {
            "format": FORMAT,
            "version": VERSION,
            "name": SOURCE,
            "settings": base.settings.model_dump(mode="json"),
            "contacts": _contacts(base),
            "zones": _zones(base, plain),
            "materials": _materials(world, definition, bodies),
            "bodies": plain,
            "springs": definition.get("springs") or [],
            "welds": definition.get("welds") or [],
        }
        try:
            text = json.dumps(data, allow_nan=False)
        except (TypeError, ValueError, RecursionError):
            raise LevelError(SOURCE, [("", "holds something that JSON cannot say")]) from None
        if len(text) > DEFINITION_LIMIT:
            raise LevelError(SOURCE, [("", f"is longer than {DEFINITION_LIMIT:,} bytes; make it smaller or coarser")])
        self.level = _parsed(text)
        faults = list(_material_faults(world, self.level, definition.get("materials") or {}))
        if faults:
            raise LevelError(SOURCE, faults)
        self.built = build_world(self.level)
        self.particles, self.springs = self.built.grab_particle, self.built.grab_spring

    def _group_faults(self, index: int) -> Iterator[Fault]:
        said, path = self._said[index], "body" if index == 0 else f"others.{index - 1}"
        group = said.get("collision_group")
        if group == TERRAIN_NAME:
            yield f"{path}.collision_group", f"{shown(group)} is the group of terrain alone"
        for number, name in enumerate(said.get("collides", ())):
            if name not in self._bits and name not in self._own_groups:
                place = f"{path}.collides.{number}"
                yield place, f"the level has no group {shown(name)}" + suggestion(name, self._bits)

    def kit(self, world: LevelWorld) -> Kit:
        """The bodies as rows, for a world of the groups that this one has. Raises LevelError."""
        built, level = self.built, self.level
        number = {body.id: index for index, body in enumerate(level.bodies)}
        names, bits = self._names(number), self._bits | self._own_bits(world)
        # Pieces of a body that lacks springs have owners of their own.
        body_of = np.array([body for body, _ in names.particles])
        group, collides = np.zeros((2, self.particles), np.int64)
        usual, others, passed = self._usual_groups(world, bits)
        for index, said in enumerate(self._said):
            mine = body_of == index
            group[mine] = bits[said["collision_group"]] if "collision_group" in said else usual
            named = sum(bits[name] for name in dict.fromkeys(said["collides"])) if "collides" in said else None
            more = others if DEFAULT_GROUP in said.get("collides", ()) else 0
            collides[mine] = (built.collides[: self.particles][mine] if named is None else named | more) & ~passed
        touches = level.has_contacts
        columns = columns_of(
            built, {"group": group, "collides": collides * touches}, free_wheels(level) if touches else []
        )  # fmt: skip
        return Kit(
            len(level.bodies),
            columns,
            names,
            tuple((number[name], rows) for name, rows in zip(built.area_names, built.area_constraints, strict=True)),
            tuple((number[form.name], form) for form in built.forms),
            level,
            self.definition,
        )

    def _names(self, number: Mapping[str, int]) -> KitNames:
        """Names of the level's rows; number: of each body by its id."""

        def split(name: str, mark: str) -> tuple[int, str]:
            body, _, text = name.partition(mark)
            return number.get(body, -1), text

        built = self.built
        return KitNames(
            tuple(split(name, ".") for name in built.particle_names[: self.particles]),
            tuple(split(name, ":") for name in built.spring_names[: self.springs]),
            tuple((*split(name, "."), slot) for name, slot in built.particle_naming.second if slot < self.particles),
            tuple(number.get(each.name, -1 - each.owner) for each in actuators(self.level)),
        )

    @property
    def _own_groups(self) -> list[str]:
        """Collision groups of these bodies that the level does not have."""
        named = dict.fromkeys(said.get("collision_group") for said in self._said)
        return [name for name in named if name is not None and name not in self._bits]

    def _own_bits(self, world: LevelWorld) -> dict[str, int]:
        """Bits for new groups, which nothing in the world has yet. Raises LevelError if there are too many."""
        first = max(int(world.group.max(initial=1)), *self._bits.values()).bit_length()
        found = {name: 1 << number for number, name in enumerate(self._own_groups, first)}
        if any(bit > ALL_GROUPS for bit in found.values()):
            raise LevelError(SOURCE, [("", "there are too many collision groups")])
        return found

    def _usual_groups(self, world: LevelWorld, bits: Mapping[str, int]) -> tuple[int, int, int]:
        """Bits: the group of bodies that name none, those that go with the default group, and those that are passed."""
        usual, passes = bits[DEFAULT_GROUP], self.definition.get("passes")
        if passes is None:
            return usual, 0, 0
        used = int(np.bitwise_or.reduce(world.group[world.particle_active], initial=0)) | sum(bits.values())
        touching = world.particle_active & (world.collides & usual != 0)
        free = int(np.bitwise_and.reduce(world.collides[touching], initial=ALL_GROUPS)) & ~used
        passed = int(np.bitwise_or.reduce(world.group[list(passes)], initial=0))
        return free & -free or usual, ALL_GROUPS & ~sum(bits.values()), passed

    def check_room(self, world: LevelWorld) -> None:
        """Raise LevelError if the bodies could not join a world."""
        try:
            check_kit(world, packed_for(world, self.kit(world)), PROGRAM, ADD_BODY)
        except KitError as error:
            raise LevelError(SOURCE, [("", str(error))]) from None

    def join(self, world: LevelWorld, giver: int = PROGRAM) -> None:
        """Add the bodies to a world at its present tick. If there is no room, raises LevelError and changes nothing."""
        try:
            join(world, self.kit(world), giver)
        except KitError as error:
            raise LevelError(SOURCE, [("", str(error))]) from None


def join_definition(world: LevelWorld, definition: Mapping[str, Any], giver: int = PROGRAM) -> None:
    """Add bodies as level files define them, or a kit. Raises LevelError and Refused, and changes nothing then."""
    if "kit" not in definition:
        Joiners(world, definition).join(world, giver)
        return
    try:
        join(world, read(definition["kit"]), giver)
    except KitError as error:
        raise LevelError(SOURCE, [("kit", str(error))]) from None


def _identified(body: Any, number: int) -> Any:
    return {"id": f"body {number}", **body} if isinstance(body, dict) else body


def _without_groups(body: Any) -> tuple[dict[str, Any], Any]:
    """The collision groups that a body names, which belong to the level that it joins, and the body without them."""
    if not isinstance(body, dict):
        return {}, body
    said = {}
    if isinstance(body.get("collision_group"), str):
        said["collision_group"] = body["collision_group"]
    collides = body.get("collides")
    if isinstance(collides, list | tuple) and all(isinstance(name, str) for name in collides):
        said["collides"] = list(collides)
    return said, {key: value for key, value in body.items() if key not in said}


def _contacts(level: Level) -> dict[str, Any] | None:
    """The contacts of a level; None if nothing touches."""
    if not level.has_contacts:
        return None
    return {} if level.contacts is None else level.contacts.model_dump(mode="json")


def _zones(level: Level, bodies: Sequence[Any]) -> list[dict[str, Any]]:
    """Some water if there is any in a level, so that bodies that join it get what water drags."""
    taken = [body.get("id") for body in bodies if isinstance(body, dict)]
    name = next(name for number in itertools.count() if (name := f"water {number}") not in taken)
    return [{"id": name, "box": [0.0, 0.0, 1.0, 1.0], "water": {}}] if level.has_water else []


def _known_material(world: LevelWorld, name: str) -> Material | None:
    """The material of a world with that name."""
    found = world.materials.get(name)
    return NissenMaterial() if found is None and name == DEFAULT_MATERIAL else found


def _materials(world: LevelWorld, definition: Mapping[str, Any], bodies: list[Any]) -> Any:
    """The materials of a definition, and those of the world that its bodies and springs name."""
    own = definition.get("materials")
    if own is not None and not isinstance(own, dict):
        return own
    users = [item for item in (*bodies, *(definition.get("springs") or ())) if isinstance(item, dict)]
    names = dict.fromkeys([DEFAULT_MATERIAL, *(str(item["material"]) for item in users if "material" in item)])
    found = {name: _known_material(world, name) for name in names}
    known = {name: each.model_dump(mode="json") for name, each in found.items() if each is not None}
    return known | (own or {})


def _material_faults(world: LevelWorld, level: Level, own: Mapping[str, Any]) -> Iterator[Fault]:
    for name in own:
        known = _known_material(world, name)
        if known is not None and known != level.materials[name]:
            yield f"materials.{name}", "is another material here; leave it out, or give it another name"


@functools.lru_cache(maxsize=KEPT)
def _parsed(text: str) -> Level:
    """A level of the bodies of a definition. Raises LevelError, with places in the definition."""
    try:
        return parse_level(text.encode(), SOURCE)
    except LevelError as error:
        lines = [line.removeprefix(f"{SOURCE}: ") for line in error.faults]
        raise LevelError(SOURCE, [("", _in_definition(line)) for line in lines]) from None


def _in_definition(fault: str) -> str:
    """A fault of that level as a fault of the definition."""
    fault = re.sub(r"^bodies\.(\d+)", lambda found: "body" if found[1] == "0" else f"others.{int(found[1]) - 1}", fault)
    return fault.replace("bodies: ", "body: ", 1) if fault.startswith("bodies: ") else fault
