"""Lines about springs that break in a run."""

from sandbox.physics.world import World

# Of more springs that break in one tick the message says how many they are, not their names.
MOST_NAMED = 3


def break_lines(world: World) -> list[str]:
    """One line about the springs that broke in the last tick, or none."""
    broken = world.broken.tolist()
    if not broken:
        return []
    if len(broken) > MOST_NAMED:
        return [f"tick {world.tick}: {len(broken)} springs broke"]
    names = [world.spring_names[slot] for slot in broken]
    listed = names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]
    return [f"tick {world.tick}: {listed} broke"]
