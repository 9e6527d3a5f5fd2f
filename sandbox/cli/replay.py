"""`sandbox replay`."""

import argparse
import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sandbox.cli.command import Commands, add_command
from sandbox.cli.inputs import EXIT_FAILED, EXIT_OK, EXIT_REFUSED, Refused, level_of, recording_of
from sandbox.cli.pages import PAGE, write_report
from sandbox.terminal import Progress, tell

if TYPE_CHECKING:
    from sandbox.level.document.model import Level


def add(commands: Commands) -> None:
    """The command."""
    parser = add_command(commands, "replay", verify_files, "run recordings again and compare every bit")
    parser.add_argument("files", nargs="+", metavar="FILE")
    parser.add_argument("--json", action="store_true", help="print one JSON object a file")
    parser.add_argument("--partial", action="store_true", help="verify what there is of a recording that is cut off")
    parser.add_argument("--report", type=Path, metavar="OUT.html", help="where it diverges, play both side by side")
    parser.add_argument("--against", metavar="LEVEL", help="run their commands on this level, not on the recorded one")


def verify_files(options: argparse.Namespace) -> int:
    """Verify recordings, one after another. Raises Refused."""
    worst = EXIT_OK
    level = level_of(options.against) if options.against else None
    if options.report and (len(options.files) > 1 or options.report.suffix.lower() != PAGE):
        raise Refused("--report: is of one recording, into a file whose name ends in .html")
    for name in options.files:
        code, outcome = _verify(name, options.partial, level, options.report)
        worst = max(worst, code)
        if options.json:
            print(json.dumps(outcome))
        elif code == EXIT_REFUSED:
            tell(outcome["faults"])
        else:
            print(f"{name}: {outcome['text']}")
    return worst


def _verify(name: str, partial: bool, level: "Level | None", report: Path | None) -> tuple[int, dict[str, Any]]:
    from sandbox.session.probe import finite
    from sandbox.session.replay.recording import ReplayError
    from sandbox.session.replay.verify import compare

    try:
        replay = recording_of(name, partial)
        with Progress(replay.ticks) as bar:
            found = compare(replay, level=level, progress=lambda done, total: bar.update(done - bar.done))
    except (Refused, ReplayError) as error:
        return EXIT_REFUSED, {"file": name, "result": "refused", "faults": list(error.faults)}
    if found is None:
        cut = " (cut off: verified as far as it goes)" if replay.end_hash is None else ""
        text = f"equal, {replay.ticks} ticks{cut}"
        return EXIT_OK, {"file": name, "result": "equal", "ticks": replay.ticks, "text": text}
    if report is not None:
        write_report(found, report)
    details = finite({**asdict(found.divergence), "text": f"diverged at {found.divergence}"})
    return EXIT_FAILED, {"file": name, "result": "diverged", **details}
