"""Taking things out of a level, and taking bodies apart."""

from dataclasses import replace

from sandbox.editor.document import Document, EditError, checked
from sandbox.editor.edits.grouping import taken_groups
from sandbox.editor.edits.materials import without_lost_groups
from sandbox.editor.edits.names import free_ids, owner_of, rewired, taken_ids, with_springs_followed
from sandbox.editor.items import PARTS, Item, chosen_bodies, marks, picked
from sandbox.editor.scene import make_scene
from sandbox.level.document.model import ParticleDef, SpringDef
from sandbox.level.format.limits import BODY_RADIUS, COORDINATE_LIMIT
from sandbox.level.format.quantities import replaced
from sandbox.level.kinds.bodies import expansion
from sandbox.level.kinds.expansion import Expansion
from sandbox.level.kinds.geometry import Points, distances

# A rest length is taken as placed where both differ by no more than this share: above rounding, below what is seen.
SAME_LENGTH = 1e-12


def delete(document: Document) -> Document:
    """Delete what is selected, with the springs, welds, checks and rules that hang on it."""
    level, selection = document.level, document.selection
    if not selection:
        return document
    kept = {kind: [k for k, is_gone in enumerate(marks(level, selection, kind)) if not is_gone] for kind in PARTS}
    level = with_springs_followed(replaced(level, **picked(level, kept)), level.rules, kept["spring"])
    gone = {item.key for item in selection if item.kind != "spring"}
    if gone:
        level, _ = rewired(level, lambda reference: None if owner_of(reference) in gone else reference)
    return Document(without_lost_groups(level))


def break_apart(document: Document) -> Document:
    """Make loose particles and springs of every selected body, each a group, and select them. Raises EditError.

    They fall and swing as the body did; its motor, its areas and its angles are gone.
    """
    level = document.level
    bodies = chosen_bodies(level, document.selection)
    if not bodies:
        raise EditError("select a body to break apart")
    scene = make_scene(level)
    taken, groups = taken_ids(level), taken_groups(level)
    particles, springs = list(level.particles), list(level.springs)
    names: dict[str, str] = {}
    for body in bodies:
        group = body.group if body.group is not None else free_ids(groups, [body.id])[0]
        made = expansion(body)
        # An id holds no dot, so "deck.20" becomes "deck 20"; of a very long name less is left.
        ids = free_ids(taken, [f"{body.id[:240]} {index}" for index in range(len(made.mass))])
        names |= {f"{body.id}.{index}": name for index, name in enumerate(ids)}
        names |= {f"{body.id}.{part}": ids[index] for part, index in made.named_particles.items()}
        first = scene.slot(f"{body.id}.0")
        particle = ParticleDef(
            id="-",
            radius=BODY_RADIUS if body.particle_radius is None else body.particle_radius,
            gravity_scale=body.gravity_scale,
            friction=body.friction,
            restitution=body.restitution,
            collides=body.collides,
            collision_group=body.collision_group,
            group=group,
        )
        particles += _loose(made, scene.position[first : first + len(ids)], ids, particle)
        springs += _loose_springs(
            made, ids, SpringDef(a="-", b="-", material=body.material, group=group, drive=body.drive)
        )
    gone = {body.id for body in bodies}
    kept = tuple(body for body in level.bodies if body.id not in gone)
    apart = replaced(level, bodies=kept, particles=tuple(particles), springs=tuple(springs))
    apart, _ = rewired(apart, lambda reference: names.get(reference, None if reference in gone else reference))
    selection = {Item("particle", part.id) for part in particles[len(level.particles) :]}
    selection |= {Item("spring", index) for index in range(len(level.springs), len(springs))}
    return replace(document, level=checked(apart), selection=frozenset(selection))


def _loose(made: Expansion, places: Points, ids: list[str], like: ParticleDef) -> list[ParticleDef]:
    rows = zip(ids, places.tolist(), made.velocity.tolist(), made.mass.tolist(), made.pinned.tolist(), strict=True)
    return [
        replaced(like, id=name, position=(x, y), velocity=tuple(velocity), mass=mass, pinned=pinned)
        for name, (x, y), velocity, mass, pinned in rows
    ]


def _loose_springs(made: Expansion, ids: list[str], like: SpringDef) -> list[SpringDef]:
    """Springs of a body as loose ones, of a given rest length where they do not start at theirs."""
    placed = distances(made.position, made.pairs)
    lengths = [
        None if abs(rest - now) <= SAME_LENGTH * now else rest
        for rest, now in zip(made.rest_length.tolist(), placed.tolist(), strict=True)
    ]
    if any(rest is not None and rest > COORDINATE_LIMIT for rest in lengths):
        raise EditError("a spring is too long to keep its rest length by itself")
    rows = zip(made.pairs.tolist(), lengths, strict=True)
    return [replaced(like, a=ids[a], b=ids[b], rest_length=rest) for (a, b), rest in rows]
