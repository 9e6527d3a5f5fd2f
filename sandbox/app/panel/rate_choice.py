"""Another tick rate for a run, which then starts over: at the same pace per second, or with the same Cs and Cd."""

from functools import partial

from sandbox.app.base.sentences import sentence
from sandbox.app.contracts.application import Application
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.dialogs import choose
from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.bake import keep_coefficients
from sandbox.editor.edits.fields import set_setting
from sandbox.editor.edits.retime import set_rate_in_pace
from sandbox.level.document.model import CHANGEABLE_SETTINGS, Level
from sandbox.physics.world import World


def level_at_rate(level: Level, world: World, rate: int, in_pace: bool) -> Level:
    """The level of a run at another tick rate, with the springs and the solver that its world has now.

    in_pace: Cs and Cd are worked out again so that springs move per second as they do. Raises EditError.
    """
    document = keep_coefficients(Document(level), world)
    for name in CHANGEABLE_SETTINGS:
        document = set_setting(document, name, getattr(world.settings, name))
    return (set_rate_in_pace(document, rate) if in_pace else set_setting(document, "tick_rate", rate)).level


def ask_for_pace(app: Application, playback: Playback, rate: int) -> None:
    """Ask whether behaviour per second or Cs and Cd are kept, and begin the run again so."""

    def begin(in_pace: bool) -> None:
        try:
            level = level_at_rate(playback.level, playback.session.world, rate, in_pace)
        except EditError as error:
            app.say(sentence(error), app.screen)
            return
        app.start(Playback(level))
        app.say(f"The run starts over at {rate} ticks a second; E edits the level with them.", app.screen)

    choices = [
        ("Keep the behaviour per second", partial(begin, True)), ("Keep Cs and Cd as they are", partial(begin, False)),
    ]  # fmt: skip
    about = "The run starts over. With more ticks a second, the same Cs and Cd make a stiffer spring."
    choose(app.ui, f"{rate} ticks a second", about, choices)
