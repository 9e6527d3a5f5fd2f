"""Filter: the groups that things collide by, and which springs are edges that others collide with; no kernel."""

# The group of terrain, and the bits of every group.
TERRAIN_GROUP = 1
ALL_GROUPS = (1 << 62) - 1
# Kinds of edge of a spring: none, a line with two sides, an outline with what is solid on its left, or right.
NO_EDGE, LINE, SOLID_LEFT, SOLID_RIGHT = 0, 1, 2, 3
