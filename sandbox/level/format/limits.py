"""Limits of the level format, each with its unit. A file beyond a limit is refused, never clamped."""

from typing import Final

from sandbox.physics.marks import FARTHEST_PLACE, LEAST_MASS, MOST_MASS, MOST_PARTICLES, MOST_SPRINGS
from sandbox.physics.meshing.fitting import LEAST_SPACING
from sandbox.physics.settings import DEFAULT_SOLVER as DEFAULT_SOLVER
from sandbox.physics.settings import SUBSTEPS as SUBSTEPS

# Reading a hostile file costs time and memory in proportion to these.
FILE_LIMIT = 8 * 1024 * 1024  # [bytes]
DEFINITION_LIMIT = 1_000_000  # [bytes] of bodies that join a running level: a line of a recording holds no more
DEPTH_LIMIT = 32  # lists and objects inside each other
CONTAINER_LIMIT = 1_000_000  # lists and objects in one file; a full mesh with velocities, pose and welds has 800,000
TEXT_LIMIT = 256  # [characters] of any string
TAG_LIMIT = 100
MATERIAL_LIMIT = 1_000
CHECK_LIMIT = 1_000
FAULT_LIMIT = 50  # lines that one refusal prints

# After expansion; memory and time of a tick grow with them.
PARTICLE_LIMIT = MOST_PARTICLES
SPRING_LIMIT = MOST_SPRINGS
# Work of filling polygons in one level: corners in all, and per polygon grid rows x (columns + corners).
CORNER_LIMIT = 4_096
POLYGON_WORK_LIMIT = 4_000_000
TERRAIN_LIMIT = 1_000  # pieces of terrain; their corners count as those of polygons
ZONE_LIMIT = 1_000  # zones; their corners count as those of terrain
RULE_LIMIT = 1_000  # rules, and counters
QUESTION_LIMIT = 1_000  # questions of a rule, and of one that asks others
ACTION_LIMIT = 100  # actions of a rule
COLLISION_GROUP_LIMIT = 60  # groups that bodies collide by: bits of a whole number

COORDINATE_LIMIT = FARTHEST_PLACE  # [m]
SPEED_LIMIT = 1e9  # [m/s]
GRAVITY_LIMIT = 1e6  # [m/s^2]
MASS_RANGE = (LEAST_MASS, MOST_MASS)  # [kg]
SPACING_RANGE = (LEAST_SPACING, 1e6)  # [m]
ANGLE_LIMIT = 1e6  # [rad]
GRAVITY_SCALE_LIMIT = 1e3  # times gravity, either way
DRAG_LIMIT = 1e6  # [1/s]
WATER_DENSITY_LIMIT = 1e6  # [kg/m^2]
WATER_DRAG_LIMIT = 1e3  # coefficient of fast drag, and [m/s] of slow drag
STRAIN_LIMIT = 1e3  # strain beyond which a material may be said to break
YIELD_RANGE = (1e-6, 0.5)  # strain; a spring that yields at half its length keeps the rest of it
YIELD_SHARE_LIMIT = 0.9  # of its length that a spring may yield by; it never yields to nothing
AMPLITUDE_LIMIT = 0.9  # of its length that a muscle may swing by, for the same reason
PERIOD_RANGE = (2, 1_000_000)  # ticks of a muscle's wave
TURN_LIMIT = 1e4  # [rad/s] of a motor
TORQUE_LIMIT = 1e12  # [N m]
RATE_LIMIT = 1e6  # [m/s] of a hydraulic
FORCE_LIMIT = 1e15  # [N] of a muscle or hydraulic
MOTOR_LIMIT = 100  # motors of a level; what each does to every other is found in every step
LIMITED_LIMIT = 2000  # springs of limited force; what each does to others of its body is found in every step
LIMITED_WORK_LIMIT = 20_000_000  # those, times particles: 320 MB, where all are of one body
HOOKE_LIMIT = 1e15  # [N/m], [N s/m]
SAG_LIMIT = 0.4  # of a body's height; beyond it a jelly lies on its folded triangles
FREQUENCY_RANGE = (0.01, 1_000.0)  # [Hz] of a body's slowest wobble
RATIO_LIMIT = 10.0  # damping ratio of that wobble
FRICTION_LIMIT = 100.0  # beyond it nothing slides that did not before
BELT_LIMIT = 1_000.0  # [m/s]: what runs faster throws things out of every view
INFLATION_LIMIT = 100.0  # multiple of a ring's own area
SECONDS_LIMIT = 3_600.0  # [s] of run that an acceptance check may ask for

FORMAT: Final = "spring-sandbox/level"
VERSION = 4
DEFAULT_MATERIAL = "default"
BODY_RADIUS = 0.05  # [m] of the drawn disc of a body's particles


def most_limited(particles: int) -> int:
    """How many springs of limited force a level of so many particles may have."""
    return min(LIMITED_LIMIT, LIMITED_WORK_LIMIT // max(1, particles))
