"""Allowed: what hands may do in a level, by its tools and its panel, and what is said where they may not."""

from collections.abc import Callable, Sequence

from sandbox.app.base.sentences import listed
from sandbox.app.contracts.application import Playing
from sandbox.app.contracts.screen import Pixel
from sandbox.app.panel.panel import Panel, has_use
from sandbox.app.play.stage import CATALOGUE
from sandbox.app.play.toolbar import offered_parts
from sandbox.level.document.model import Level
from sandbox.level.rules.player_limits import MEANINGS
from sandbox.tools.play_tools import PLAY_TOOLS


class Allowed:
    """What hands may do on a screen; tools: names of those that are kept away; has_panel: whether that is of use."""

    def __init__(self, screen: Playing, level: Level) -> None:
        self._screen, self._level = screen, level
        self.has_panel = has_use(level)
        self.tools = refused_tools(level)

    @property
    def absent(self) -> set[str]:
        """Actions that need no button, as they could do nothing."""
        found = {"catalogue" if name == CATALOGUE else PLAY_TOOLS[name].action for name in self.tools}
        found |= set() if self.has_panel else {"panel"}
        return found if offered_parts(self.tools) else found | {"palette"}

    def if_any(self, action: str, do: Callable[[], object]) -> None:
        """Do something, or say what hands may do instead where its button is absent."""
        if action in self.absent:
            self._say()
        else:
            do()

    def refuses(self, pixel: Pixel) -> bool:
        """Whether the tool in use may do nothing to a thing at a pixel: a line says what may."""
        stage, panel = self._screen.stage, self._screen.panel
        particle = stage.at_pixel(pixel) if stage.tool_name in self.tools else None
        if particle is None:
            return False
        self._say()
        if isinstance(panel, Panel):
            panel.choose_particle(particle)
        return True

    def _say(self) -> None:
        self._screen.say(allowed_words(self._level, [name for name, _ in self._screen.keys.shown()]))


def refused_tools(level: Level) -> set[str]:
    """The names of tools that hands may not use in a level, that of the catalogue too."""
    if level.hands is None:
        return set()
    allows = level.hands.allows
    refused = {name for name, tool in PLAY_TOOLS.items() if not allows(tool.deed)}
    return refused if allows("add") else refused | {CATALOGUE}


# What hands may do in a level, said where a press would be refused.
_NOTHING_DONE, _DONE = "Hands do nothing here", "Here hands may {}"


def allowed_words(level: Level, keys: Sequence[str]) -> str:
    """What a level wants instead of what its hands may not do, in a sentence; keys: those that do something in it."""
    hands, typed = level.hands, [key.upper() if len(key) == 1 else key for key in keys]
    deeds = [meaning.words for deed, meaning in MEANINGS.items() if hands is not None and hands.allows(deed)]
    said = _DONE.format(listed(deeds, "or")) if deeds else _NOTHING_DONE
    press = f"{'key' if len(typed) == 1 else 'keys'} {listed(typed, 'and')}" if typed else ""
    return f"{said}; {press} {'does' if len(typed) == 1 else 'do'} the rest." if press else f"{said}."
