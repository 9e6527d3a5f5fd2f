"""The tools in play, in the order of the strip and of the help page."""

from sandbox.tools.axle import AXLE
from sandbox.tools.click import DELETE, FREEZE, PIN
from sandbox.tools.cut import CUT
from sandbox.tools.drag import DRAG
from sandbox.tools.drawing import DRAWN
from sandbox.tools.dropping import DROPS
from sandbox.tools.pulling import PULLED
from sandbox.tools.push_wind import PUSH, WIND

_ALL = (DRAG, PIN, CUT, *DROPS, *DRAWN, *PULLED, AXLE, PUSH, WIND, DELETE, FREEZE)
PLAY_TOOLS = {tool.name: tool for tool in _ALL}
