"""A tick as one kernel: its phases on one screen. Their order is part of the replay contract."""

from sandbox.physics.arena import Arena, begin, is_full, new_slots
from sandbox.physics.arrays import Slots
from sandbox.physics.breaking import yield_and_break
from sandbox.physics.collision.surfaces import load_belts
from sandbox.physics.driving import drive_springs
from sandbox.physics.integrate import begin_flight, integrate_positions, integrate_velocities, label_all_joined
from sandbox.physics.jit import Bundle, inner_kernel, kernel, unpack
from sandbox.physics.joints.joint_set import prepare_joints, store_joint_impulses
from sandbox.physics.marks import GRAB_COUNT
from sandbox.physics.pipeline.block import (
    BROKEN,
    CHECKED,
    COUNT,
    DONE,
    GRAB_PARTICLE,
    GRAB_SPRING,
    HAS_BELTS,
    HAS_CONTACTS,
    HAS_HOOKE,
    HAS_RINGS,
    MAY_FLY,
    TICK,
    WorldBlock,
)
from sandbox.physics.pipeline.collide import (
    CONTACTS,
    COUPLED,
    KEPT,
    clamp,
    coupled_contacts,
    detect,
    mark_pushed,
    prepare_contacts,
    separate_overlaps,
    solve_free,
    sort_by_solver,
    store_impulses,
)
from sandbox.physics.ramps import begin_ramps, end_ramps
from sandbox.physics.sanitise import contain, contain_motion, keep_motion
from sandbox.physics.settings import (
    DIRECT,
    DRAG,
    IS_AUTO,
    ITERATIONS,
    ITERATIVE,
    SINGLE_PASS,
    SOLVER,
    SUBSTEP_COUNT,
    TICK_RATE,
    WARM_START,
)
from sandbox.physics.solvers import HIGHEST_ITERATED
from sandbox.physics.solvers.contact.free_constraints import small_steps
from sandbox.physics.solvers.contact.gauss_seidel import order_by_label
from sandbox.physics.solvers.direct.islands import find_body_islands
from sandbox.physics.solvers.direct.rigid_turn import end_turns
from sandbox.physics.solvers.direct.solve import solve as solve_direct
from sandbox.physics.solvers.inputs import Inputs
from sandbox.physics.solvers.iterative import solve as solve_iterative
from sandbox.physics.solvers.single_pass import apply_explicit
from sandbox.physics.solvers.single_pass import solve as solve_single_pass
from sandbox.physics.substeps import choose_substeps, drag_factor_of, kept_by, limit_rings, turn_into_substep
from sandbox.physics.untangling.triangle_clamp import clamp_world
from sandbox.physics.water.bound import bound_lift
from sandbox.physics.water.push import give_mass_back, push_by_water, slow_spins
from sandbox.physics.ways import begin_step, begin_ways, end_step, follow_hits, note_velocities, take_back_cut

# What a tick says at its end. It has changed nothing where something that it begins with is not sound, and goes on
# where it was, once there is more room. Something that it has moved is not sound; springs broke.
FINISHED, UNSOUND, NO_ROOM, LOST, BROKE = range(5)


@kernel
def tick(pointer: Bundle[WorldBlock]) -> int:
    """Advance a world by one tick of 1 / tick_rate seconds; FINISHED, or a code for what the caller has to do."""
    world = unpack(pointer)
    state, start, collisions, joints = world.state, world.start, world.collisions, world.joints
    progress, solver, touches = world.progress, world.choices[SOLVER], world.plan[HAS_CONTACTS] != 0
    ways, follows = world.ways, world.ways.particle.shape[0] > 0
    if progress[COUNT] == 0:
        if progress[CHECKED] == 0 and _contain(world, UNSOUND, progress[:0]) > 0:
            return UNSOUND
        _begin_tick(world)
    h = 1.0 / (world.choices[TICK_RATE] * progress[COUNT])
    while progress[DONE] < progress[COUNT]:
        integrate_velocities(state, world.numbers, start, h)
        # How much earlier than in h v' what nothing joins moves on: see free_contacts.py.
        early = 0.5 * (h - h / small_steps(h)) if touches else 0.0
        if world.water.pool.shape[0] > 0:
            push_by_water(
                world.water, state, start, world.body_label, world.numbers, collisions.kept, collisions.counts[KEPT],
                early, solver == DIRECT, h,
            )  # fmt: skip
        inputs = _inputs(world)
        has_joints = prepare_joints(joints, state, inputs.stiffness, inputs.damping, h)
        if not _find_contacts(world, touches, has_joints, h):
            give_mass_back(world.water, state)
            for p in range(world.start.shape[0]):
                world.state.velocity[p, 0] = world.start[p, 0]
                world.state.velocity[p, 1] = world.start[p, 1]
            return NO_ROOM
        # Behind the last step that is made again with more room, where velocities alone are taken back.
        slow_spins(world.water, state, h)
        if follows:
            begin_step(ways, 1.0 * progress[DONE] / progress[COUNT])
        if touches:
            separate_overlaps(state, start, collisions)
            prepare_contacts(state, start, collisions, h)
            solve_free(state, start, collisions, world.ways, h)
        _solve(world, inputs, has_joints, h)
        _begin_flight(world, touches, h)
        store_joint_impulses(joints, state, h)
        if touches:
            _end_contacts(world, follows, h)
        if world.triangles.of_world.constraint.shape[0] > 0:
            clamp_world(world.triangles, solver == DIRECT, h)
        if world.water.pool.shape[0] > 0:
            give_mass_back(world.water, state)
            bound_lift(world.water, state, start, world.body_label, world.numbers, early, h)
        integrate_positions(state, h)
        if solver == DIRECT:
            end_turns(world.system, state, h)
        if follows:
            end_step(ways, state.position, h)
        progress[DONE] += 1
    _end_tick(world)
    if _contain(world, LOST, progress[:0]) > 0:
        return LOST
    keep_motion(state, world.good)
    return BROKE if _find_broken(world) > 0 else FINISHED


@inner_kernel
def _end_contacts(world: WorldBlock, follows: bool, h: float) -> None:
    # Store what contacts did, and cut what would go through terrain; ways follow both.
    state, collisions = world.state, world.collisions
    if follows:
        follow_hits(
            world.ways, collisions.contacts, collisions.counts[COUPLED], collisions.colliders,
            collisions.outline.solid_of, state, world.start, world.body_label, h,
        )  # fmt: skip
        note_velocities(world.ways, state.velocity)
    store_impulses(collisions)
    clamp(state, collisions, h)
    if follows:
        take_back_cut(world.ways, state.velocity)


@kernel
def take_back(pointer: Bundle[WorldBlock], arena: Arena, code: int) -> int:
    """Take back the values that a tick reported as UNSOUND or LOST; their number; columns and slots in the arena."""
    world = unpack(pointer)
    begin(arena)
    found = new_slots(arena, 2 * _contain(world, code, world.progress[:0]))
    if is_full(arena):
        return 0
    count = _contain(world, code, found)
    if code == LOST:
        keep_motion(world.state, world.good)
    return count


@inner_kernel
def _contain(world: WorldBlock, code: int, found: Slots) -> int:
    kept, count = world.collisions.kept, world.collisions.counts[KEPT]
    if code == LOST:
        return contain_motion(world.state, world.good, world.ranges, found, 0)
    return contain(world.state, world.good, world.ranges, kept.impulse[:count], kept.impact[:count], found)


@kernel
def find_broken(pointer: Bundle[WorldBlock]) -> int:
    """Let springs yield and find those that break, at the end of a tick in which something was lost; how many."""
    return _find_broken(unpack(pointer))


@inner_kernel
def _find_broken(world: WorldBlock) -> int:
    world.progress[BROKEN] = yield_and_break(world.state, world.good, world.limits)
    return world.progress[BROKEN]


@inner_kernel
def _begin_tick(world: WorldBlock) -> None:
    # Begin ramps, drive springs, choose the substeps, and bring Cs, Cd and kept impulses to those.
    state, choices, progress, drives = world.state, world.choices, world.progress, world.drives
    begin_ramps(state, world.numbers, choices[SOLVER])
    if drives.muscle.shape[0] + drives.hydraulic.shape[0] > 0:
        for s in range(state.rest_length.shape[0]):
            world.start_length[s] = state.rest_length[s]
        drive_springs(state, world.good, drives, progress[TICK] + 1, choices[SOLVER], choices[TICK_RATE])
    count = choices[SUBSTEP_COUNT]
    if count == 0:
        count = choose_substeps(state, world.plan[GRAB_SPRING], choices[TICK_RATE], world.shortest)
    progress[COUNT] = count
    progress[DONE] = 0
    factor, into = _drag_factor(world), world.coefficients
    turns = count > 1 or factor != 1.0
    if turns or world.plan[HAS_RINGS] != 0:
        limit_rings(state, into.constraint_stiffness, into.constraint_damping)
    if turns:
        for s in range(state.stiffness.shape[0]):
            into.stiffness[s] = state.stiffness[s]
            into.damping[s] = state.damping[s]
        keeps = kept_by(choices[SOLVER], choices[IS_AUTO])
        highest = HIGHEST_ITERATED if choices[SOLVER] == ITERATIVE else 1.0
        turn_into_substep(into.stiffness, into.damping, state.lowest_mode, count, keeps, highest, factor)
        turn_into_substep(
            into.constraint_stiffness, into.constraint_damping, state.constraint_lowest_mode, count, keeps, highest,
            factor,
        )  # fmt: skip
    if choices[IS_AUTO] != 0 and count > 1:
        # What a solver keeps is an impulse of one substep: exact, as their number is a power of two.
        _scale_impulses(world, 1.0 / count)
    kept = world.collisions.kept
    for c in range(world.collisions.counts[KEPT]):
        kept.impact[c] = 0.0
    if world.ways.particle.shape[0] > 0:
        begin_ways(world.ways, state, choices[TICK_RATE])


@inner_kernel
def _drag_factor(world: WorldBlock) -> float:
    # That of a whole tick where ticks choose their parts: the energy of a spring does not depend on the parts.
    choices = world.choices
    parts = 1 if choices[IS_AUTO] != 0 else world.progress[COUNT]
    return drag_factor_of(world.numbers[DRAG], choices[TICK_RATE], parts)


@inner_kernel
def _scale_impulses(world: WorldBlock, factor: float) -> None:
    state, kept = world.state, world.collisions.kept
    for s in range(state.tension.shape[0]):
        state.impulse[s, 0] *= factor
        state.impulse[s, 1] *= factor
        state.tension[s] *= factor
    for c in range(world.collisions.counts[KEPT]):
        kept.impulse[c, 0] *= factor
        kept.impulse[c, 1] *= factor
    for k in range(state.actuator_impulse.shape[0]):
        state.actuator_impulse[k] *= factor


@inner_kernel
def _inputs(world: WorldBlock) -> Inputs:
    # Where nothing turns them into others, Cs and Cd are those of the tick.
    state, into, progress = world.state, world.coefficients, world.progress
    factor = _drag_factor(world)
    turned = progress[COUNT] > 1 or factor != 1.0
    limited = turned or world.plan[HAS_RINGS] != 0
    driven = progress[DONE] == 0 and world.drives.muscle.shape[0] + world.drives.hydraulic.shape[0] > 0
    return Inputs(
        into.stiffness if turned else state.stiffness,
        into.damping if turned else state.damping,
        into.constraint_stiffness if limited else state.constraint_stiffness,
        into.constraint_damping if limited else state.constraint_damping,
        world.start,
        world.start_length if driven else state.rest_length,
        factor,
    )


@inner_kernel
def _find_contacts(world: WorldBlock, touches: bool, has_joints: bool, h: float) -> bool:
    # And the islands that they make with joints; whether there is room for all.
    collisions, state = world.collisions, world.state
    if touches and not detect(state, collisions, world.plan[GRAB_SPRING], world.progress[TICK], h):
        return False
    source, workspace, has_room = collisions.source[: collisions.counts[COUPLED]], world.workspace, True
    if world.choices[SOLVER] != DIRECT:
        order_by_label(source, collisions.islands.contact_label, workspace.order, collisions.islands.at)
    elif has_joints or collisions.counts[COUPLED] > 0:
        has_room = find_body_islands(collisions.contacts, source, state.inverse_mass, world.system, workspace)
    sort_by_solver(collisions)
    if world.plan[HAS_BELTS] != 0:
        load_belts(collisions.contacts, collisions.counts[CONTACTS], collisions.outline, state)
    return has_room


@inner_kernel
def _solve(world: WorldBlock, inputs: Inputs, has_joints: bool, h: float) -> None:
    # Bring velocities to the end of a substep by the solver that is set. Another solver is a branch here.
    state, solver, workspace, choices = world.state, world.choices[SOLVER], world.workspace, world.choices
    contacts = coupled_contacts(world.collisions)
    if solver == SINGLE_PASS:
        solve_single_pass(
            state, world.explicit, inputs, contacts, workspace.terms, workspace.order, workspace.delassus,
            choices[ITERATIONS], h,
        )  # fmt: skip
        return
    if world.plan[HAS_HOOKE] != 0:
        apply_explicit(state, inputs, world.explicit, False, h)
    count = world.progress[COUNT]
    if solver == ITERATIVE:
        solve_iterative(
            state, world.iteration, inputs, contacts, workspace.terms, workspace.order, workspace.delassus,
            choices[ITERATIONS], world.numbers[WARM_START], count > 1, h,
        )  # fmt: skip
    else:
        has_islands = has_joints or contacts.particle.shape[0] > 0
        auto_substeps = count if choices[IS_AUTO] != 0 else 0
        solve_direct(state, world.system, inputs, contacts, workspace, has_islands, auto_substeps, h)


@inner_kernel
def _begin_flight(world: WorldBlock, touches: bool, h: float) -> None:
    progress, state, flight = world.progress, world.state, world.flight
    if progress[MAY_FLY] == 0 or progress[DONE] > 0:
        return
    found = False
    for p in range(state.unmoved.shape[0]):
        found = found or state.unmoved[p]
    if found:
        label_all_joined(state, flight)
        alone = h
        if touches:
            mark_pushed(world.collisions, flight.label, flight.stays)
            alone = h / small_steps(h)
        for p in range(world.water.wet.shape[0]):
            # Lift acts in the first step as it does in all others: what floats would jump.
            if world.water.wet[p]:
                flight.stays[flight.label[p]] = True
        begin_flight(state, world.numbers, flight, alone, h)


@inner_kernel
def _end_tick(world: WorldBlock) -> None:
    # Bring kept impulses back to those of a tick, stop every cursor, and put the goals of ramps back.
    progress, velocity, first = world.progress, world.state.velocity, world.plan[GRAB_PARTICLE]
    if world.choices[IS_AUTO] != 0 and progress[COUNT] > 1:
        _scale_impulses(world, 1.0 * progress[COUNT])
    if first >= 0:
        for p in range(first, first + GRAB_COUNT):
            velocity[p, 0] = 0.0
            velocity[p, 1] = 0.0
    end_ramps(world.state, world.numbers)
