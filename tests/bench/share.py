"""What the last ten seconds of a run cost as GIF and as MP4 at 640x360: seconds of wall and processor time, megabytes.

Asked for: a GIF in 5 s and 4 MB, an MP4 in 3 s, on an idle machine of two cores; `share.py NAME ...` for some levels.
Processor time is that of this process alone: the encoder of MP4 runs beside it.
"""

import os
import sys
import tempfile
import time
from pathlib import Path

os.environ.setdefault("SDL_VIDEODRIVER", "dummy")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from sandbox.app.film.film import film_of_view
from sandbox.app.film.kinds import KINDS
from sandbox.app.share.export import Excerpt, Export
from sandbox.level.reading.files import load_level
from sandbox.session.session import Session

LEVELS = ("rope", "jelly_pile", "marble_mill", "suspension_bridge", "pinball", "wrecking_crane", "hourglass")
SECONDS, SIZE = 10.0, (640, 360)


def played(name: str) -> Session:
    """A run of a level after ten seconds."""
    level = load_level(name)
    session = Session(level)
    for _ in range(round(SECONDS * level.settings.tick_rate)):
        session.advance()
    return session


def cost(session: Session, kind: str, folder: Path) -> tuple[float, float, float]:
    """Wall time [s], processor time [s] and size [MB] of a film of a run."""
    wall, work = time.perf_counter(), time.process_time()
    film = film_of_view(session, SIZE, SECONDS)
    excerpt = Excerpt(kind, 0.0, film.seconds, KINDS[kind].usual_fps, SIZE, session.level.name)
    export = Export(film, excerpt, folder / f"film.{kind}")
    for _ in export.slices():
        pass
    return time.perf_counter() - wall, time.process_time() - work, export.path.stat().st_size / 1e6


def main(names: list[str]) -> None:
    """Print a line for each level, after one that is not counted."""
    with tempfile.TemporaryDirectory() as folder:
        cost(played("rope"), "gif", Path(folder))
        print(f"{'level':24}" + "".join(f"{kind:>6} wall  work    MB" for kind in ("gif", "mp4")))
        for name in names or LEVELS:
            session = played(name)
            costs = [figure for kind in ("gif", "mp4") for figure in cost(session, kind, Path(folder))]
            print(f"{name:24}" + "".join(f"{wall:11.2f}{work:6.2f}{size:6.2f}" for wall, work, size in zip(
                costs[::3], costs[1::3], costs[2::3], strict=True)), flush=True)  # fmt: skip


if __name__ == "__main__":
    main(sys.argv[1:])
