"""Values with a meaning of their own in state arrays."""

# An energy bank that the direct solver begins anew at its next step: something outside changed the body.
BANK_UNOPENED = -1.0
# One of a body that goes on, but has nothing any more.
BANK_EMPTIED = -2.0

# The last is of a grab's spring while it holds: it pulls at nothing, its hand does (joints/hands.py).
LAW_NISSEN, LAW_HOOKE, LAW_HAND = LAWS = range(3)

# How many particles can be held at once. A grab is a pinned cursor particle and one spring, in slots reserved when
# the world is built, so that grabbing never moves another slot.
GRAB_COUNT = 10
# The material index of a grab's spring: of no material, so that no slider reaches it.
GRAB_MATERIAL = -1
# Cs and Cd of a grab's spring, which nothing reads; hashes hold them.
GRAB_STIFFNESS, GRAB_DAMPING = 0.2, 0.3
# The material index of a constraint with Cs and Cd of its own, which no slider reaches.
OWN_MATERIAL = -1
# The longest ramp [ticks].
LONGEST_RAMP = 1_000_000
# How far out anything may be put [m], either way, and what it may weigh [kg]: beyond, doubles lose the digits that a
# spring's length needs.
FARTHEST_PLACE = 1e6
LEAST_MASS, MOST_MASS = 1e-9, 1e9
# What a world holds at most, which levels and cuts keep to: memory and time of a tick grow with them.
MOST_PARTICLES, MOST_SPRINGS = 100_000, 400_000


# The group of terrain, and the bits of every group.
TERRAIN_GROUP = 1
ALL_GROUPS = (1 << 62) - 1
# Kinds of edge of a spring: none, a line with two sides, an outline with what is solid on its left, or right.
NO_EDGE, LINE, SOLID_LEFT, SOLID_RIGHT = EDGES = range(4)
# What a contact touched = its number * KINDS + its kind. TIP: a corner of terrain on an edge of a body; its number =
# vertex * TIP_SHIFT + number of the spring. INSIDE: a disc that has come into a solid body through that edge, and goes
# out there.
DISC, EDGE, TERRAIN, TIP, INSIDE = 0, 1, 2, 3, 4
KINDS = 5
TIP_SHIFT = 0x100000000
