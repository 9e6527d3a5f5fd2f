"""What follows from the state of a world, laid out by kernels in the arenas that they are given.

Three entries, each with an arena of its own: what follows from topology; what follows from what hands hold as well; and
the room of a step, which grows with what steps ask for. After a change of topology all three are called, in this order.
"""

from sandbox.physics.arena import (
    Arena,
    begin,
    give_back,
    is_full,
    mark,
    new_flags,
    new_float_rows,
    new_floats,
    new_slots,
    new_tuple,
)
from sandbox.physics.collision.broad_phase import Boxes, Candidates, Pairs, new_grid
from sandbox.physics.collision.outline import new_colliders, new_outline
from sandbox.physics.collision.surfaces import has_belts
from sandbox.physics.collision.types import KeptContacts, new_contacts
from sandbox.physics.constraints import TRIANGLE
from sandbox.physics.integrate import Flight
from sandbox.physics.jit import Bundle, inner_kernel, kernel, set_field, unpack
from sandbox.physics.joints.hands import label_bodies, new_grips
from sandbox.physics.joints.joint_rows import joints_by_mass, new_joints
from sandbox.physics.joints.joint_set import SpringForces, lay_out_joints, new_motor_sides, new_spring_forces
from sandbox.physics.marks import GRAB_COUNT, LAW_HOOKE
from sandbox.physics.pipeline.block import (
    GRAB_PARTICLE,
    GRAB_SPRING,
    HAS_BELTS,
    HAS_CONTACTS,
    HAS_HOOKE,
    HAS_RINGS,
    Coefficients,
    WorldBlock,
)
from sandbox.physics.pipeline.collide import (
    CONTACTS,
    COUPLED,
    CROSSED,
    ENTRIES,
    KEPT,
    OVERLAPPING,
    PAIRS,
    TERRAIN_PAIRS,
    Collisions,
    update_terrain_aabbs,
)
from sandbox.physics.settings import DIRECT, ITERATIVE, SINGLE_PASS, SOLVER
from sandbox.physics.solvers.contact.gauss_seidel import ContactConstraints, ContactOrder, new_active_set
from sandbox.physics.solvers.direct.islands import COLUMNS, NUMBERS, lay_out_islands, use_diagonal_delassus
from sandbox.physics.solvers.direct.layout import lay_out_system
from sandbox.physics.solvers.iterative import new_held_springs, new_iteration
from sandbox.physics.solvers.single_pass import new_explicit_pass
from sandbox.physics.untangling.jellies import new_inversions
from sandbox.physics.untangling.overlaps import Overlaps
from sandbox.physics.untangling.triangle_clamp import lay_out_world_triangles
from sandbox.physics.water.displacers import new_water

# Places in `demand`: those of the counts of collisions, then numbers and columns of blocks of bodies.
BLOCK_NUMBERS, BLOCK_COLUMNS, DEMANDS = COUPLED, COUPLED + 1, COUPLED + 2
# What there is room for at least; and how much more than was asked for there is then.
LEAST_ROOM = 64
MORE_ROOM = 2


@kernel
def derive_topology(pointer: Bundle[WorldBlock], arena: Arena) -> None:
    """Lay out all arrays that depend on the topology of a world, and its solver."""
    world = unpack(pointer)
    begin(arena)
    state = world.state
    plan = world.plan
    plan[HAS_CONTACTS] = plan[HAS_HOOKE] = plan[HAS_RINGS] = 0
    plan[HAS_BELTS] = 1 if has_belts(state) else 0
    for p in range(state.collides.shape[0]):
        if state.collides[p] != 0:
            plan[HAS_CONTACTS] = 1
    for s in range(state.law.shape[0]):
        if state.spring_active[s] and state.law[s] == LAW_HOOKE:
            plan[HAS_HOOKE] = 1
    for k in range(state.constraint_corners.shape[0]):
        if state.constraint_corners[k] > TRIANGLE:
            plan[HAS_RINGS] = 1
    particles, springs, constraints = state.owner.shape[0], state.law.shape[0], state.constraint_kind.shape[0]
    set_field(world, "start", new_float_rows(arena, particles, 2))
    set_field(world, "start_length", new_floats(arena, springs))
    set_field(world, "shortest", new_floats(arena, GRAB_COUNT))
    set_field(world, "flight", new_tuple(Flight, arena, particles=particles))
    set_field(world, "coefficients", new_tuple(Coefficients, arena, springs=springs, constraints=constraints))
    set_field(world, "forces", new_spring_forces(state, world.drives, arena))
    set_field(world, "sides", new_motor_sides(state, world.wheels, arena))
    label = new_slots(arena, state.owner.shape[0])
    set_field(world, "body_label", label)
    scratch = mark(arena)
    joins, free = new_flags(arena, state.law.shape[0]), new_flags(arena, state.owner.shape[0])
    if not is_full(arena):
        label_bodies(state, joins, free, label)
        give_back(arena, scratch)
    lay_out_world_triangles(state, arena, world.triangles)
    set_field(world, "water", new_water(state, world.water, arena))
    set_field(world.collisions, "outline", new_outline(state, arena))
    set_field(world.collisions, "triangles", world.triangles.of_world)
    if not is_full(arena):
        _lay_out_solver(world, arena)


@kernel
def derive_hands(pointer: Bundle[WorldBlock], arena: Arena) -> None:
    """Lay out the joints of a world, which depend on held particles as well."""
    world = unpack(pointer)
    begin(arena)
    state, solver = world.state, world.choices[SOLVER]
    grips = new_grips(state, world.body_label, world.plan[GRAB_PARTICLE], world.plan[GRAB_SPRING], arena)
    # The direct solver alone has springs of limited force as rows; others clamp them where all springs are.
    forces = world.forces
    limited = forces.limited if solver == DIRECT else forces.limited[:0]
    if not is_full(arena):
        lay_out_joints(
            state, world.wheels, world.sides, SpringForces(forces.limit, limited, forces.unlimited), grips, arena,
            world.joints,
        )  # fmt: skip
    if is_full(arena):
        return
    rows = world.joints.rows
    if solver == SINGLE_PASS:
        set_field(world.explicit, "joints", joints_by_mass(rows, arena))
        set_field(world.explicit, "mass", new_floats(arena, rows.limit.shape[0]))
        set_field(world.explicit, "joint_impulse", new_floats(arena, rows.limit.shape[0]))
    elif solver == DIRECT:
        system = world.system
        joints = new_joints(
            rows, system.rows.particle, world.workspace.islands.row, system.bodies.row_start, arena
        )  # fmt: skip
        set_field(world.workspace.delassus, "joints", joints)
    else:
        set_field(world.workspace.delassus, "joints", joints_by_mass(rows, arena))
        springs = world.iteration.listed.shape[0]
        set_field(world.iteration, "held", new_held_springs(world.joints.hands, state, springs, arena))


@kernel
def make_room(pointer: Bundle[WorldBlock], arena: Arena) -> None:
    """Lay out the arrays that a step fills in, larger than any step has needed. Kept contacts are lost."""
    world = unpack(pointer)
    begin(arena)
    collisions, demand, particles = world.collisions, world.demand, world.state.owner.shape[0]
    for k in range(COUPLED):
        demand[k] = max(demand[k], collisions.counts[k])
    demand[ENTRIES] = max(demand[ENTRIES], particles)
    if world.choices[SOLVER] == DIRECT:
        asked = world.workspace.islands.counts
        demand[BLOCK_NUMBERS] = max(demand[BLOCK_NUMBERS], asked[NUMBERS])
        demand[BLOCK_COLUMNS] = max(demand[BLOCK_COLUMNS], asked[COLUMNS])
        set_field(world.workspace.delassus, "numbers", new_floats(arena, MORE_ROOM * demand[BLOCK_NUMBERS]))
        set_field(world.workspace.delassus, "columns", new_floats(arena, MORE_ROOM * demand[BLOCK_COLUMNS]))
    contacts = max(_room(world, CONTACTS), _room(world, KEPT))
    set_field(world.collisions, "kept", new_tuple(KeptContacts, arena, contacts=contacts))
    coupled = contacts if world.plan[HAS_CONTACTS] != 0 else 0
    active = new_active_set(coupled, particles, arena)
    terms = new_tuple(ContactConstraints, arena, contacts=coupled, particles=particles, active=active)
    set_field(world.workspace, "terms", terms)
    members = particles + world.system.bodies.lowest.shape[0]
    order = new_tuple(ContactOrder, arena, contacts=coupled, groups=max(coupled, members))
    set_field(world.workspace, "order", order)
    if coupled > 0:
        _lay_out_collisions(world, contacts, arena)
        if not is_full(arena):
            update_terrain_aabbs(world.collisions)


@inner_kernel
def _room(world: WorldBlock, k: int) -> int:
    return MORE_ROOM * world.demand[k] + LEAST_ROOM


@inner_kernel
def _lay_out_solver(world: WorldBlock, arena: Arena) -> None:
    # What the present solver needs, and no other.
    state, solver, forces, particles = world.state, world.choices[SOLVER], world.forces, world.state.owner.shape[0]
    if solver == DIRECT:
        lay_out_system(state, forces.unlimited, world.tuning, arena, world.system)
        if is_full(arena):
            return
        lay_out_islands(world.system, particles, arena, world.workspace)
    else:
        use_diagonal_delassus(particles, arena, world.workspace.delassus)
    if solver == ITERATIVE:
        set_field(world, "iteration", new_iteration(state, forces.limit, arena))
    # These take springs of Hooke's law apart, all others take all springs so.
    takes_apart = solver in (DIRECT, ITERATIVE)
    if not takes_apart or world.plan[HAS_HOOKE] != 0:
        explicit = new_explicit_pass(state, forces.limit, takes_apart, world.explicit, arena)
        set_field(world, "explicit", explicit)


@inner_kernel
def _lay_out_collisions(world: WorldBlock, contacts: int, arena: Arena) -> None:
    collisions, particles = world.collisions, world.state.owner.shape[0]
    outline, jellies = collisions.outline, collisions.triangles.jellies
    objects, shapes = particles + outline.dynamic[0], outline.solid_of.shape[0]
    crossings, overlapping = _room(world, CROSSED), _room(world, OVERLAPPING)
    boxes = new_tuple(Boxes, arena, particles=particles, objects=objects)
    pairs = new_tuple(Pairs, arena, particles=particles, room=_room(world, PAIRS))
    of_terrain = new_tuple(Pairs, arena, particles=particles, room=_room(world, TERRAIN_PAIRS))
    made = new_tuple(
        Collisions, arena, outline=outline, triangles=collisions.triangles, boxes=boxes,
        colliders=new_colliders(world.state.terrain, outline, overlapping, arena),
        grid=new_grid(objects, _room(world, ENTRIES), arena), candidates=Candidates(pairs, of_terrain, boxes.box),
        contacts=new_contacts(arena, contacts), kept=collisions.kept, inversions=new_inversions(jellies, arena),
        overlaps=new_tuple(Overlaps, arena, shapes=shapes, crossings=crossings, pairs=overlapping),
        counts=collisions.counts, particles=particles, rows=contacts, spans=outline.solid.shape[0], shapes=shapes,
    )  # fmt: skip
    set_field(world, "collisions", made)
