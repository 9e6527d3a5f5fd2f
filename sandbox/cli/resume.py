"""`sandbox resume`."""

from dataclasses import dataclass

from sandbox.cli.base.command import Subcommand, argument, length_in_seconds, length_in_ticks
from sandbox.cli.base.inputs import EXIT_OK, Refused, recording_of
from sandbox.terminal import Progress, interrupted_between_ticks


@dataclass(frozen=True, kw_only=True)
class ResumeOptions:
    """Options of `resume`: the recording, and its new length."""

    file: str = argument(str, "FILE")
    seconds: float | None = length_in_seconds(" in all; default: up to where it was cut off")
    ticks: int | None = length_in_ticks()


def resume_file(options: ResumeOptions) -> int:
    """Make a recording whole. Raises Refused."""
    from sandbox.session.commands import CommandError
    from sandbox.session.replay.recording import ReplayError
    from sandbox.session.replay.rerecord import resume

    try:
        whole = recording_of(options.file)
    except Refused:
        replay = recording_of(options.file, partial=True)
    else:
        raise Refused(f"{options.file}: is whole, {whole.ticks} ticks: there is nothing to resume")
    rate = replay.level.settings.tick_rate
    ticks = options.ticks or (replay.ticks if options.seconds is None else round(options.seconds * rate))
    if ticks < replay.ticks:
        raise Refused(f"{options.file}: has {replay.ticks} ticks already; --seconds and --ticks are of the whole run")
    try:
        with interrupted_between_ticks() as look_up, Progress(ticks) as bar:

            def show(tick: int) -> None:
                bar.update(tick - bar.done)
                look_up()

            resume(replay, ticks, show)
    except (CommandError, ReplayError) as error:
        raise Refused(*error.faults) from None
    print(f"{options.file}: whole, {ticks} ticks, {ticks - replay.ticks} of them new")
    return EXIT_OK


COMMAND = Subcommand("resume", "go on with a recording that was cut off, and make it whole", ResumeOptions, resume_file)
