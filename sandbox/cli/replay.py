"""`sandbox replay`."""

import json
from collections import deque
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sandbox.cli.command import Subcommand
from sandbox.cli.inputs import EXIT_FAILED, EXIT_OK, EXIT_REFUSED, Refused, level_of, recording_of
from sandbox.cli.options import arguments, flag, option
from sandbox.cli.pages import PAGE, write_report
from sandbox.terminal import Progress, count, tell

if TYPE_CHECKING:
    from sandbox.level.document.model import Level
    from sandbox.physics.world import World
    from sandbox.session.replay.divergence import Divergence
    from sandbox.session.replay.verify import Comparison


@dataclass(frozen=True, kw_only=True)
class ReplayOptions:
    """Which recordings to verify, on what, and how to tell it."""

    files: list[str] = arguments(str, "FILE")
    json: bool = flag("print one JSON object a file")
    partial: bool = flag("verify what there is of a recording that is cut off")
    report: Path | None = option(Path, metavar="OUT.html", help="where it diverges, play both side by side")
    to_end: bool = flag("where it diverges, go on to the end: how far apart, and does it heal or grow?")
    against: str | None = option(str, metavar="LEVEL", help="run their commands on this level, not on the recorded one")
    rollback: int | None = option(
        count, metavar="N", help="at every tick also go back N ticks, by a snapshot, and compare when there again"
    )


def verify_files(options: ReplayOptions) -> int:
    """Verify recordings, one after another. Raises Refused."""
    worst = EXIT_OK
    level = level_of(options.against) if options.against else None
    if options.report and (len(options.files) > 1 or options.report.suffix.lower() != PAGE):
        raise Refused("--report: is of one recording, into a file whose name ends in .html")
    for name in options.files:
        code, outcome = _verify(name, options, level)
        worst = max(worst, code)
        if options.json:
            print(json.dumps(outcome))
        elif code == EXIT_REFUSED:
            tell(outcome["faults"])
        else:
            print(f"{name}: {outcome['text']}")
    return worst


def _verify(name: str, options: ReplayOptions, level: "Level | None") -> tuple[int, dict[str, Any]]:
    from sandbox.session.outcome import outcome, outcome_data, outcome_text
    from sandbox.session.replay.recording import ReplayError
    from sandbox.session.replay.rollback import roll_back
    from sandbox.session.replay.verify import compare

    try:
        replay = recording_of(name, options.partial)
        worlds: deque[World] = deque(maxlen=1)
        with Progress(replay.ticks) as bar:
            found = compare(
                replay, level=level, on_tick=worlds.append, progress=lambda done, total: bar.update(done - bar.done)
            )
        if found is None and options.rollback:
            with Progress(replay.ticks) as bar:
                again = roll_back(replay, options.rollback, level, lambda done, total: bar.update(done - bar.done))
            if again.found is not None:
                return EXIT_FAILED, _told(
                    name, again.found, f"rolled back {options.rollback} ticks, diverged at {again.found}"
                )
    except (Refused, ReplayError) as error:
        return EXIT_REFUSED, {"file": name, "result": "refused", "faults": list(error.faults)}
    if found is None:
        cut = " (cut off: verified as far as it goes)" if replay.end_hash is None else ""
        played = level or replay.level
        ended, rate = outcome(played, worlds[0]) if worlds else None, played.settings.tick_rate
        said = "" if ended is None else f", {outcome_text(ended, rate)}"
        data = {"outcome": outcome_data(ended, rate)} if played.rules else {}
        at_end = "" if replay.compared == "every tick" else " at its end"
        back = f", and again from {options.rollback} ticks before each" if options.rollback else ""
        text = f"equal{at_end}, {replay.ticks} ticks{back}{cut}{said}"
        return EXIT_OK, {"file": name, "result": "equal", "ticks": replay.ticks, "text": text, **data}
    text = f"diverged at {found.divergence}"
    if options.to_end:
        found = _to_the_end(found)
        text = "\n  ".join([text, *found.edits, *([*found.apart.told(), found.apart.verdict()] if found.apart else [])])
    if options.report is not None:
        write_report(found, options.report)
    apart = {"apart": {**asdict(found.apart), "verdict": found.apart.verdict()}} if found.apart else {}
    return EXIT_FAILED, _told(name, found.divergence, text, **apart)


def _told(name: str, found: "Divergence", text: str, **more: Any) -> dict[str, Any]:
    """A difference for programs, with a text that tells it."""
    from sandbox.session.probe import finite

    details: dict[str, Any] = finite({**asdict(found), "text": text, **more})
    return {"file": name, "result": "diverged", **details}


def _to_the_end(found: "Comparison") -> "Comparison":
    from sandbox.session.replay.verify import to_the_end

    with Progress(found.replay.ticks) as bar:
        return to_the_end(found, lambda done, total: bar.update(done - bar.done))


COMMAND = Subcommand("replay", "run recordings again and compare every bit", ReplayOptions, verify_files)
