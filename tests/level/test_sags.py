"""What is said of how far a body sags is what one sees: numbers of the panel beside plain runs of shipped levels."""

import numpy as np
import pytest

from sandbox.level.format.quantities import replaced
from sandbox.level.reading.files import load_level, shipped_levels
from sandbox.physics.actuators import unlimited
from sandbox.physics.analysis.stance import Support, slots_of
from sandbox.physics.analysis.standing import LEAN, StandingRun
from sandbox.physics.analysis.subjects import Meters, subjects_of
from sandbox.physics.jit import COMPILED
from sandbox.physics.step import step
from sandbox.physics.terrain import Chain, make_terrain
from sandbox.session.commands import SetCoefficients, SetFirmness
from sandbox.session.session import Session

pytestmark = pytest.mark.skipif(not COMPILED, reason="interpreted kernels take minutes")

# The sag that is asked for, and ticks that a body has to come to rest.
ASKED, TICKS = 0.08, 1_500
# Ticks that are looked at, and the share of its length by which a body has rolled away from where it stood.
LOOKED_AT, ROLLS = 180, 0.02
# Of each level so many bodies that differ.
MOST = 3


def kinds(session):
    """Subjects of a level that are not alike, the largest first, with their meters."""
    meters, found = Meters(), {}
    for subject in sorted(subjects_of(session.world).values(), key=lambda each: -len(each.body.springs)):
        found.setdefault(meters.of(session.world, subject), subject)
    return [(subject, meter) for meter, subject in found.items()][:MOST]


def set_to(session, subject, firmness, meter):
    if subject.slot is not None:
        session.submit(SetFirmness(subject.slot, sag=firmness.sag, hz=firmness.hz, ratio=firmness.ratio))
    else:
        stiffness, damping, _ = meter.springs_of(firmness)
        material = int(session.world.material[subject.body.springs[0]])
        session.submit(SetCoefficients(stiffness=stiffness, damping=damping, material=material))
    session.apply_pending()


def fitted(first, now, mass):
    """Places (n, 2) about a hub, turned back to where they were first."""
    along = complex(mass @ np.sum(first * now, axis=1), mass @ (first[:, 0] * now[:, 1] - first[:, 1] * now[:, 0]))
    turned = (now[:, 0] + 1j * now[:, 1]) * along.conjugate() / abs(along)
    return np.stack([turned.real, turned.imag], axis=1)


def seen(session, subject, stance):
    """How far a body has sagged in the level's own world, alone, without wind, once it rests."""
    world, slots = session.world, slots_of(session.world, subject.body)
    settings = world.settings
    strength = float(np.hypot(*settings.gravity)) or 9.81
    kept = np.zeros(world.spring_count, np.bool_)
    kept[subject.body.springs] = True
    held = np.zeros(world.particle_count, np.bool_)
    held[slots[stance.held]] = True
    world.change("spring_active", world.spring_active & kept)
    own = np.zeros(world.particle_count, np.bool_)
    own[slots] = True
    world.change("particle_active", world.particle_active & own)
    of_body = np.zeros(world.constraint_count, np.bool_)
    of_body[subject.body.constraints] = True
    world.change("constraint_active", world.constraint_active & of_body)
    world.change("inverse_mass", np.where(held, 0.0, world.inverse_mass))
    world.actuators = type(world.actuators)()
    stands = stance.support is Support.FLOOR
    points = stance.points - (0.0, stance.points[:, 1].min() - float(world.radius[slots].max()))
    lean = LEAN if stance.support is Support.ARM else 0.0
    far = 50.0 * float(np.ptp(points))
    if stands:
        world.terrain = make_terrain([Chain([[-far, 0.0], [far, 0.0]], friction=0.5)])
    elif stance.support is not Support.ENDS:
        world.change("collides", 0)
    if stance.support is Support.ENDS:
        alone = StandingRun(stance, settings).world
        points, world.terrain = alone.position.copy(), alone.terrain
    world.limits = unlimited(len(world.material_names))
    world.change("position", points, slots)
    world.change("velocity", 0.0)
    world.settings = type(settings)(**{**vars(settings), "gravity": (lean * strength, -strength), "wind": (0.0, 0.0)})
    drops = []
    for _ in range(TICKS):
        step(world)
        now = world.position[slots]
        # A round body rolls on at last, to where it is flatter or less flat.
        if stands and len(drops) > LOOKED_AT and abs(now[:, 0].mean() - points[:, 0].mean()) > ROLLS * stance.length:
            break
        if stance.support is Support.HUB:
            hub = points[stance.held][0]
            now = fitted(points - hub, now - hub, world.mass[slots]) + hub
        down = points[:, 1] - now[:, 1]
        if stands:
            drops.append(np.ptp(points[:, 1]) - np.ptp(now[:, 1]))
        else:
            drops.append(down.max() - (down[stance.rests].mean() if stance.rests.any() else 0.0))
    return float(np.mean(drops[-LOOKED_AT:])) / stance.length


@pytest.mark.whole_world
@pytest.mark.parametrize("name", [path.stem for path in shipped_levels()])
def test_a_body_sags_in_its_level_by_what_was_set(name):
    # Whatever hands may do.
    level = replaced(load_level(name), hands=None)
    for number in range(len(kinds(Session(level)))):
        session = Session(level)
        subject, meter = kinds(session)[number]
        if name == "walker":
            # It stands on legs that are not its own.
            continue
        meter.firmness(ASKED)
        while meter.is_busy:
            meter.advance(1.0)
        is_known, firmness = meter.firmness(ASKED)
        assert is_known
        if firmness is None:
            continue
        said = meter.sag(meter.springs_of(firmness))
        while said is None:
            meter.advance(1.0)
            said = meter.sag(meter.springs_of(firmness))
        if said != pytest.approx(ASKED, rel=0.05):
            # The panel says that it is another: a column has buckled.
            continue
        set_to(session, subject, firmness, meter)
        found = seen(session, subject, meter.stance)
        assert found == pytest.approx(said, rel=0.1, abs=2e-3), (subject.name, meter.stance.support)
