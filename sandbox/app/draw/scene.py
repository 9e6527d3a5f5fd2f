"""Scene: what is drawn of a level, as plain data for a page that draws it by itself."""

import base64
import hashlib
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.app.draw.backdrop import BEVEL, SOIL_DEPTH, WIDE
from sandbox.app.draw.colours import CLOTH_STRIPE, THEMES, WOOD, Theme, mixed, outline_of
from sandbox.app.draw.looks import FIRM, SOFT_SKINS, Look, ground_look
from sandbox.app.draw.picture import view_of
from sandbox.app.draw.textures import BLACK, LIT_DOWN, LIT_UP, TILE, Tiles, ground_tones, laid, skin_look, woven
from sandbox.app.draw.things.belt_marks import BeltSide, body_belts, ground_belts
from sandbox.app.draw.things.drawables import CLOTH, CRATES, PANEL_OUT, WINDOW, WINDOW_IN
from sandbox.app.draw.things.faces import LEAST_KEPT, LEAST_OWN, spot_of
from sandbox.app.draw.things.level_slots import Actor, Ball, Join, LevelSlots, hull_of, joined_slots, level_slots_of
from sandbox.app.draw.things.members import CYLINDER
from sandbox.app.draw.things.soft import (
    CLOTH_TEXELS,
    CRUMB,
    CUT_OF_SIDE,
    FLAT,
    FOLD,
    FOLD_DEPTH,
    ROUNDING,
    USUAL_ROUNDING,
    Shape,
    shape_of,
)
from sandbox.app.draw.things.wheels import DrawnWheel, added_balls
from sandbox.app.draw.things.worn import round_of, worn_shape
from sandbox.app.draw.water import DrawnPool, Pools
from sandbox.level.document.model import Level
from sandbox.level.format.look import PALETTE
from sandbox.level.format.picture import Picture
from sandbox.physics.geometry.segment import signed_area
from sandbox.physics.marks import GRAB_COUNT
from sandbox.physics.snapshot import Snapshot, take
from sandbox.physics.world import World

# What a spring looks like that joined the world while it ran.
ADDED = Look("", "steel", 0)
# Lines of what people make in a page, and what sheets of that are like.
MADE_LINES, MADE_SHEET = ("steel", "rope"), Look("wood", "paint", WOOD)
# Digits of lengths [m]: a tenth of a millimetre.
DIGITS = 4
_NO_SPRINGS = np.zeros(0, np.int64), np.zeros((0, 2), np.int64), 1.0


def scene_of(level: Level, snapshot: Snapshot) -> dict[str, Any]:
    """All that a page draws of a level, as JSON takes it; colours are "#rrggbb", places and lengths in metres."""
    slots, ground = joined_slots(level_slots_of(level), snapshot.equipment.joined), _ground(level, snapshot)
    balls = _added(len(snapshot.mass), slots.particles, snapshot.grab_particle)
    return {
        "view": [round(float(value), DIGITS) for value in view_of(level, snapshot)],
        "theme": level.look.theme if level.look is not None else None,
        "themes": {name: _theme(theme) for name, theme in THEMES.items()},
        "palette": [_hex(colour) for colour in PALETTE.values()],
        "bodies": [_body(actor, snapshot) for actor in slots.actors],
        "joins": _joins(slots, snapshot),
        "balls": [_ball(ball) for ball in [*slots.balls, *added_balls(balls, snapshot)]],
        "pieces": {"own": LEAST_OWN, "kept": LEAST_KEPT, "crumb": CRUMB, "flat": _lighting(FLAT)},
        "ground": ground,
        "treads": [
            *_belts(ground_belts(snapshot.terrain), snapshot.terrain.vertex),
            *_belts(body_belts(snapshot)),
        ],
        "water": [_pool(box, pool) for box, pool in Pools(level).seen()],
        "pictures": _pictures(slots, ground),
        "worn": {
            _key_of(each): base64.b64encode(each.data or b"").decode()
            for each in (actor.look.picture for actor in slots.actors)
            if each is not None
        },
    }


def made_looks() -> dict[str, Any]:
    """What a page draws bodies with that were added to it: shapes of each skin without loops and colour, and colours.

    firm: Cs from which on a spring by itself is a bar.
    """
    shapes = {
        "jelly": Shape([], "jelly", 0, 1, keep=CUT_OF_SIDE, flushed=_NO_SPRINGS),
        "rubber": Shape([], "rubber", 0, 1, keep=CUT_OF_SIDE, flushed=_NO_SPRINGS),
        "plain": Shape([], "plain", 0, 1, keep=CUT_OF_SIDE),
        "wood": Shape([], "wood", 0, 0, rounds=1, keep=0.12, line=False),
    }
    return {
        "skins": {skin: _shape(shape) for skin, shape in shapes.items()},
        "palette": {name: _hex(colour) for name, colour in PALETTE.items()},
        "wood": _hex(WOOD),
        "firm": FIRM,
    }


def joined_scene(level: Level, world: World, before: Mapping[str, int]) -> dict[str, Any]:
    """What is drawn of what joined a world, whose rows were these before: bodies, joins and balls, as in `scene_of`."""
    snapshot = take(world)
    slots = joined_slots(level_slots_of(level), world.joined)
    balls = added_balls(_added(len(snapshot.mass), slots.particles, snapshot.grab_particle), snapshot)
    particle, spring = before["particle"], before["spring"]
    found = {
        "bodies": [
            _body(actor, snapshot) for actor in slots.actors if len(actor.slots) and actor.slots[-1] >= particle
        ],
        "joins": [join for join in _joins(slots, snapshot) if join["spring"] >= spring],
        "balls": [_ball(ball) for ball in [*slots.balls, *balls] if ball.slot >= particle],
    }
    return {name: things for name, things in found.items() if things}


def _joins(slots: LevelSlots, snapshot: Snapshot) -> list[dict[str, Any]]:
    joins = [*slots.joins, *_added_springs(slots, snapshot)]
    return [{"spring": join.spring, "ends": list(join.ends), **_look(join.look)} for join in joins]


def _ball(ball: Ball) -> dict[str, Any]:
    return {"slot": ball.slot, "kind": ball.kind, "colour": None if ball.colour is None else _hex(ball.colour)}


def _pool(box: tuple[float, ...], pool: DrawnPool) -> dict[str, Any]:
    """Water: the part of its box that is seen [m], its flow [m/s], and its colours in each theme."""
    names = ("near", "deep", "foam")
    tones = {
        name: dict(zip(names, map(_colours, map(tuple, pool.tones(theme))), strict=True))
        for name, theme in THEMES.items()
    }
    return {"box": [round(value, DIGITS) for value in box], "flow": list(pool.flow), "tones": tones}


def _added(count: int, own: NDArray[np.int64], first_hand: int) -> NDArray[np.int64]:
    """Slots that joined the world while it ran, other than the level's own and those of hands."""
    return np.setdiff1d(np.arange(count), [*own, *range(first_hand, first_hand + GRAB_COUNT)])


def _added_springs(slots: LevelSlots, snapshot: Snapshot) -> list[Join]:
    added = _added(len(snapshot.rest_length), slots.springs, snapshot.grab_spring)
    ends = np.stack([snapshot.particle_a, snapshot.particle_b], axis=1)[added].tolist()
    return [Join(spring, (a, b), ADDED) for spring, (a, b) in zip(added.tolist(), ends, strict=True)]


def _hex(colour: int) -> str:
    return f"#{colour:06x}"


def _theme(theme: Theme) -> dict[str, Any]:
    return {name: _colours(value) for name, value in asdict(theme).items()}


def _colours(value: Any) -> Any:
    if not isinstance(value, tuple):
        return value
    return [_colours(each) for each in value] if isinstance(value[0], tuple) else "#{:02x}{:02x}{:02x}".format(*value)


def _look(look: Look) -> dict[str, Any]:
    return {"skin": look.skin, "line": look.line, "colour": _hex(look.colour), "width": look.width}


def _body(actor: Actor, snapshot: Snapshot) -> dict[str, Any]:
    """A body: its look, slots of its particles, its first spring and how many it has, and what of it is filled."""
    look, there = actor.look, np.ones(len(actor.springs), dtype=np.bool_)
    radius = float(np.median(snapshot.radius[actor.slots]))
    made: dict[str, Any] = {
        "type": actor.body.type,
        **_look(look),
        "cell": round(actor.cell, DIGITS),
        "angle": round(actor.angle, DIGITS),
        "slots": _runs(actor.slots),
        "spring": int(actor.springs[0]) if len(actor.springs) else 0,
        "springs": len(actor.springs),
        "segments": actor.body.__dict__.get("segments"),
        "shapes": [],
        "needs": [],
    }
    if look.skin == "lattice":
        return made
    if look.picture is not None:
        made["picture"] = _key_of(look.picture)
    if actor.is_filled:
        triangles = actor.triangles()
        made["triangles"] = actor.slots[triangles].reshape(-1).tolist()
        made["keeps_area"] = actor.keeps_areas
        made["spacing"] = float(actor.body.__dict__.get("spacing", actor.cell))
        loops = [loop for piece in actor.filling(there).pieces for loop in piece.loops]
        whole = shape_of(actor, loops, there, radius) if look.picture is None else worn_shape(actor, loops, radius)
        made["shapes"] = [_shape(whole)]
        if len(triangles):
            place, face_radius = actor.spot(spot_of)
            made["spot"] = [round(float(value), DIGITS) for value in (*place, face_radius)]
            made["face"] = look.face and look.skin in SOFT_SKINS
    elif look.picture is not None and (around := round_of(actor, there)) is not None:
        made["shapes"], made["is_fan"] = [_shape(worn_shape(actor, around[1], radius))], True
        made["needs"] = _closed(actor)
    elif actor.body.type == "ring":
        made["shapes"], made["needs"] = [_shape(shape_of(actor, [actor.slots], there, radius))], _closed(actor)
        # Where something is, or will be, tied to it.
        tied = np.concatenate([snapshot.particle_a, snapshot.particle_b])[np.tile(snapshot.material >= 0, 2)]
        made["knots"] = [slot for slot in actor.slots.tolist() if np.count_nonzero(tied == slot) > 2]
    elif actor.body.type == "wheel" and look.skin:
        wheel = DrawnWheel(actor, there, radius)
        made["shapes"], made["wheel"], made["needs"] = [_shape(wheel.shape)], _wheel(wheel), _closed(actor)
    elif look.panel is not None and len(hull := hull_of(actor.made.form, actor.pairs)):
        window = [k for k in look.window if k < len(actor.slots)]
        made["shapes"] = [_shape(Shape([actor.slots[hull]], "rubber", look.panel, 0, extra=PANEL_OUT, keep=0.2))]
        if len(window) > 2:
            corners = actor.made.form[window]
            window = window[:: 1 if signed_area(corners, np.roll(corners, -1, axis=0)) > 0.0 else -1]
            pane = Shape([actor.slots[np.array(window)]], "window", WINDOW, 0, extra=WINDOW_IN, keep=0.2)
            made["shapes"].append(_shape(pane))
    return made


def _key_of(picture: Picture) -> str:
    """What a page calls a picture: two of one name may differ."""
    return hashlib.blake2b(picture.data or b"", digest_size=8).hexdigest()


def _closed(actor: Actor) -> list[int]:
    """The springs that a ring or a wheel has around it: without one of them it is not whole."""
    if actor.body.type == "ring":
        return actor.springs.tolist()
    count, numbers = int(actor.body.__dict__["segments"]), actor.made.numbers
    return actor.springs[(numbers >= count) & (numbers < 3 * count)].tolist()


def _shape(shape: Shape) -> dict[str, Any]:
    """A shape; its loops run as they do on the desktop, a hole against the outline."""
    return {
        "loops": [loop.tolist() for loop in shape.loops],
        "look": [_hex(shape.colour), _hex(shape.colour), *_lighting(shape.skin), 1],
        "line": _hex(outline_of(shape.colour)) if shape.line else None,
        "rounding": ROUNDING.get(shape.skin, USUAL_ROUNDING),
        "layer": shape.layer,
        "grown": round(shape.grown, DIGITS),
        "extra": shape.extra,
        "keep": round(shape.keep, DIGITS),
        "shows_strain": shape.flushed is not None,
    }


def _lighting(skin: str) -> list[Any]:
    """The strength of light, the colour and strength of shade, the gleam, and how much shows through inside."""
    look = skin_look(skin)
    return [round(LIT_UP * look.light, 2), _colours(look.shade), round(LIT_DOWN * look.dark, 2), look.gloss, look.clear]


def _wheel(wheel: DrawnWheel) -> dict[str, Any]:
    spokes = wheel.inner[wheel.spokes]
    loops = {"inner": wheel.inner.tolist(), "outer": wheel.outer.tolist(), "spokes": spokes.tolist()}
    return {"hub": int(wheel.hub), "radius": round(wheel.radius, DIGITS), "is_tyre": wheel.is_tyre, **loops}


def _pictures(slots: LevelSlots, ground: list[dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """Textures of lines by their kind or colour, of turf by theme, of sheets by skin and colour.

    Those of what people make are among them.
    """
    looks = [actor.look for actor in slots.actors] + [join.look for join in slots.joins]
    bars, names = Tiles(THEMES["dark"]), {*MADE_LINES, *(look.line for look in looks)}
    colours = {look.colour for look in looks if look.line == "paint"} | ({CYLINDER} if "piston" in names else set())
    names |= {"deck"} if any(actor.body.type == "bridge" for actor in slots.actors) else set()
    made = {name: bars.array[TILE[name]] for name in sorted(names & TILE.keys() - {"paint"})}
    for colour in sorted(colours):
        number = bars.bar(colour)
        made[_hex(colour)] = bars.array[number]
    for name, theme in THEMES.items() if any(each["kind"] == "soil" for each in ground) else ():
        made[f"turf {name}"] = Tiles(theme).array[TILE["turf"]]
    for look in [MADE_SHEET, *(actor.look for actor in slots.actors if actor.is_filled)]:
        if look.skin == CLOTH:
            made[f"{look.skin} {_hex(look.colour)}"] = _folded(woven(look.colour, CLOTH_STRIPE))
        elif look.skin in CRATES:
            made[f"{look.skin} {_hex(look.colour)}"] = laid(look.skin, look.colour) | 0xFF000000
    return {name: _picture(pixels) for name, pixels in made.items()}


def _folded(sheet: NDArray[np.int64]) -> NDArray[np.int64]:
    # A page has no shades of its own at the corners of a cell.
    turn = 2.0 * np.pi / (FOLD * CLOTH_TEXELS) * np.arange(sheet.shape[1])
    shade = 1.0 + 0.5 * FOLD_DEPTH * (np.sin(turn) - 1.0)
    red, green, blue = (((sheet >> shift & 255) * shade).astype(np.int64) << shift for shift in (16, 8, 0))
    return 0xFF000000 | red | green | blue


def _picture(pixels: NDArray[Any]) -> dict[str, Any]:
    """Pixels (h, w) 0xAARRGGBB, or one column of them where all are alike, as bytes red, green, blue and alpha."""
    columns = pixels[:, :1] if (pixels == pixels[:, :1]).all() else pixels
    channels = np.stack([columns >> shift & 255 for shift in (16, 8, 0, 24)], axis=-1).astype(np.uint8)
    return {"rows": len(columns), "bytes": base64.b64encode(channels.tobytes()).decode()}


def _runs(slots: NDArray[np.int64]) -> list[list[int]]:
    """Slots as runs of consecutive ones: the first of each, and how many."""
    begins = np.flatnonzero(np.diff(slots, prepend=-2) != 1)
    return [list(run) for run in zip(slots[begins].tolist(), np.diff(begins, append=len(slots)).tolist(), strict=True)]


def _ground(level: Level, snapshot: Snapshot) -> list[dict[str, Any]]:
    """The material of each chain of the terrain, or "line", and its points [m]; closed ones end where they begin."""
    terrain, made = snapshot.terrain, []
    left, _, right, _ = view_of(level, snapshot)
    extent = max(float(np.ptp(terrain.vertex[:, 0])) if len(terrain.vertex) else 0.0, right - left)
    for chain in np.unique(terrain.chain).tolist():
        edges = np.flatnonzero(terrain.chain == chain)
        corners, after = terrain.vertex[terrain.edge_a[edges]], terrain.vertex[terrain.edge_b[edges]]
        name = level.terrain[chain].id if chain < len(level.terrain) else ""
        is_solid = terrain.solid[edges[0]] and signed_area(corners, after) > 0.0
        kind = ground_look(level, name, bool(np.ptp(corners[:, 0]) > WIDE * extent)) if is_solid else "line"
        points = np.concatenate([corners[:1], after]).round(DIGITS).tolist()
        made.append({"kind": kind, "points": points, **(_solid(kind) if is_solid else {})})
    return made


def _belts(belts: list[BeltSide], vertex: NDArray[np.float64] | None = None) -> list[dict[str, Any]]:
    """Belts: their ways by points [m] of terrain, or by slots of particles."""
    made = []
    for belt in belts:
        way = [*belt.ends[:, 0].tolist(), int(belt.ends[-1, 1])]
        places = {"slots": way} if vertex is None else {"points": vertex[way].round(DIGITS).tolist()}
        made.append(
            {
                **places,
                "springs": belt.springs.tolist(),
                "arc": belt.arc.round(DIGITS).tolist(),
                **{name: getattr(belt, name) for name in ("speed", "closed", "side", "radius")},
            }
        )
    return made


def _solid(kind: str) -> dict[str, Any]:
    """How ground of a kind looks, in each theme."""
    is_earth, themes = kind in ("soil", "rock"), {}
    for name, theme in THEMES.items():
        tones = ground_tones(kind, theme)
        near, deep, line = map(_colours, (tones.near, tones.deep, mixed(tones.line, BLACK, 0.35)))
        look = [near, deep, tones.light, _colours(BLACK), tones.dark, 0, 0, tones.alpha]
        themes[name] = {"look": look, "line": line}
    grain = "earth" if is_earth else kind if kind == "wood" else None
    return {"rounding": SOIL_DEPTH if is_earth else BEVEL, "grain": grain, "themes": themes}
