"""The replay file, version 1: JSON Lines, each line sealed by a chain of hashes over everything before it.

    {"format": "spring-sandbox/replay", "version": 1, "physics_version": ..., "level": {...}, ..., "chain": "..."}
    {"tick": 12, "gesture": 3, "command": {...}, "chain": "..."}       applied at tick 12, before its step
    {"tick": 13, "hash": "...", "arrays": {...}, "chain": "..."}       the state after 13 steps, for every tick from 0
    {"tick": 60, "state": {...}, "settings": {...}, "chain": "..."}    every bit of it, every 60 ticks; also "joined",
                                                                       where bodies joined the level while it ran
    {"end": true, "tick": 600, "hash": "...", "chain": "..."}

chain = blake2b over the previous line's chain and this line's bytes up to its own chain.
"""

import base64
import binascii
import hashlib
import json
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from sandbox.level.build.build_world import build_world
from sandbox.level.build.joining import Joiners
from sandbox.level.format.files import level_data
from sandbox.level.format.model import Level
from sandbox.physics.changing.equipment import Equipment
from sandbox.physics.constraints import AREA
from sandbox.physics.snapshot import Snapshot, canonical_bytes
from sandbox.physics.state import BY_STORED, COLUMNS, FAMILIES, Column, Family
from sandbox.physics.terrain import NO_TERRAIN
from sandbox.physics.world import GRAB_COUNT, GRAB_MATERIAL, World, WorldSettings
from sandbox.session.commands.adding import name_slots_to

FORMAT = "spring-sandbox/replay"
VERSION = 1
STATE_TICKS = 60
# The longest line [bytes] and the largest array [bytes] that a reader accepts; ten times what the level limits allow.
LINE_LIMIT = 256 * 2**20
# The longest first line [bytes]: a level of 8 MiB with every number written out and every character escaped.
HEADER_LIMIT = 64 * 2**20
ARRAY_LIMIT = 64 * 2**20

_CHAIN_MARK = b', "chain": "'
_CHAIN_DIGITS = 32


def seal(values: dict[str, Any], previous: str) -> tuple[bytes, str]:
    """A line's bytes, newline included, and its chain."""
    body = json.dumps(values, allow_nan=False, ensure_ascii=True)[:-1].encode()
    chain = _chain(body, previous)
    return body + _CHAIN_MARK + chain.encode() + b'"}\n', chain


def unseal(line: bytes, previous: str) -> str | None:
    """The chain of a line, or None where a byte of it, or of anything before it, has changed."""
    body, mark, tail = line.rpartition(_CHAIN_MARK)
    chain = _chain(body, previous)
    return chain if mark and tail == chain.encode() + b'"}\n' else None


def _chain(body: bytes, previous: str) -> str:
    return hashlib.blake2b(previous.encode() + body, digest_size=_CHAIN_DIGITS // 2).hexdigest()


def level_digest(data: dict[str, Any]) -> str:
    """sha256 of a level's JSON, keys sorted, without white space."""
    return hashlib.sha256(json.dumps(data, sort_keys=True, separators=(",", ":")).encode()).hexdigest()


def header(level: Level, physics_version: int, sandbox_version: str) -> dict[str, Any]:
    """The first line's values."""
    data = level_data(level)
    return {
        "format": FORMAT,
        "version": VERSION,
        "physics_version": physics_version,
        "sandbox_version": sandbox_version,
        "level_sha256": level_digest(data),
        "level": data,
    }


def encode_state(world: World) -> dict[str, Any]:
    """Every state array as base64 of zlib of its little-endian bytes, and the settings."""
    arrays = {
        column.stored: base64.b64encode(zlib.compress(canonical_bytes(getattr(world, column.name)), 6)).decode()
        for column in COLUMNS
    }
    joined = [
        {"particle": each.first_particle, "spring": each.first_spring, "definition": each.definition}
        for each in world.joined
    ]
    return {"state": arrays, "settings": asdict(world.settings)} | ({"joined": joined} if joined else {})


def _equipment(level: Level, joined: Sequence[Mapping[str, Any]], grabs: tuple[int, int]) -> Equipment:
    """The equipment of a level's world that bodies of a state line have joined; grabs: where hands have their slots.

    Raises ValueError.
    """
    world = build_world(level)
    world.grab_particle, world.grab_spring = grabs
    for each in joined:
        particles, springs = each["particle"] - world.particle_count, each["spring"] - world.spring_count
        if particles < 0 or springs < 0:
            raise ValueError("joined: bodies lie over each other")
        # What lies between them counts for its names alone.
        name_slots_to(world, each["particle"], each["spring"])
        world.append(Family.PARTICLE, particles)
        world.append(Family.SPRING, springs)
        Joiners(world, each["definition"]).join(world)
    return world.equipment


def decode_state(
    level: Level, tick: int, state: dict[str, str], settings: WorldSettings, joined: Sequence[Mapping[str, Any]]
) -> Snapshot:
    """The snapshot of a state line of a level's run; joined: what joined it until then. Raises ValueError, one line."""
    if set(state) != set(BY_STORED):
        raise ValueError(f"state: the arrays are {', '.join(BY_STORED)}")
    arrays = {name: _decode_array(BY_STORED[name], text) for name, text in state.items()}
    for family in Family:
        names = [column.stored for column in FAMILIES[family]]
        if len({len(arrays[name]) for name in names}) != 1:
            raise ValueError(f"state: {', '.join(names)} are not equally long")
    for name in ("particle_a", "particle_b", "corner_particle", "contact_particle"):
        if np.any((arrays[name] < 0) | (arrays[name] >= len(arrays["mass"]))):
            raise ValueError(f"state.{name}: names a particle that does not exist")
    ends = np.cumsum(arrays["element_corners"], dtype=np.int64)
    if np.any(arrays["element_corners"] < 3) or (int(ends[-1]) if len(ends) else 0) != len(arrays["corner_particle"]):
        raise ValueError("state.element_corners: do not add up to the corners that there are")
    if np.any(arrays["element_first"] != ends - arrays["element_corners"]):
        raise ValueError("state.element_first: corners do not lie one element after another")
    if not np.all((arrays["element_kind"] == AREA) | (arrays["element_corners"] == 3)):
        raise ValueError("state.element_kind: a bend has three corners")
    hands = np.flatnonzero(arrays["material"] == GRAB_MATERIAL)
    if len(hands) not in (0, GRAB_COUNT) or np.any(np.diff(hands) != 1):
        raise ValueError(f"state.material: there are {GRAB_COUNT} hands in a row, or none")
    grab_spring = int(hands[0]) if len(hands) else -1
    grab_particle = int(arrays["particle_a"][grab_spring]) if len(hands) else -1
    if len(hands) and grab_particle + GRAB_COUNT > len(arrays["mass"]):
        raise ValueError("state.particle_a: a hand has no particle of its own")
    if len(arrays["hand_force"]) != len(hands):
        raise ValueError("state.hand_force: there is one of each hand")
    return Snapshot(
        {BY_STORED[name].name: array for name, array in arrays.items()},
        settings=settings,
        tick=tick,
        grab_particle=grab_particle,
        grab_spring=grab_spring,
        terrain=NO_TERRAIN,
        equipment=_equipment(level, joined, (grab_particle, grab_spring)),
    )


def _decode_array(column: Column, text: str) -> Any:
    kind, name = np.dtype(column.dtype), column.stored
    try:
        inflater = zlib.decompressobj()
        data = inflater.decompress(base64.b64decode(text, validate=True), ARRAY_LIMIT)
    except (binascii.Error, zlib.error, ValueError) as error:
        raise ValueError(f"state.{name}: not base64 of zlib data: {error}") from None
    if not inflater.eof or len(data) % (kind.itemsize * column.width):
        raise ValueError(f"state.{name}: cut off, or longer than {ARRAY_LIMIT} bytes")
    array = np.frombuffer(data, dtype=kind.newbyteorder("<")).astype(kind)
    return array.reshape(-1, column.width) if column.width > 1 else array
