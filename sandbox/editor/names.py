"""Names: free ids, and references to particles as they are written."""

from sandbox.level.model import Level


def free_id(level: Level, base: str) -> str:
    raise NotImplementedError
