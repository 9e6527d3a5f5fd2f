"""Commands: all that a person or a script can do to a running world, as values and as the JSON objects of files.

`Session.submit(command)` queues one; `docs/commands.md` lists them as files have them.
"""

from sandbox.session import commands as _commands
from sandbox.session.commands import *  # noqa: F403
from sandbox.session.commands.records import ScriptLine, from_record, to_record
from sandbox.session.replay.reader import read_script

__all__ = ["ScriptLine", "from_record", "read_script", "to_record"]
__all__ += _commands.__all__
