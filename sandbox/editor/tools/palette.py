"""The palette: all tools of the editor, in the order that a person sees them in."""

from sandbox.editor.kinds.table import BODY_TOOLS
from sandbox.editor.tools.drawing_axle import AXLE
from sandbox.editor.tools.drawing_chassis import CHASSIS
from sandbox.editor.tools.drawing_hangers import HANGERS
from sandbox.editor.tools.drawing_part import PART
from sandbox.editor.tools.drawing_particles import PARTICLE, PIN, SPRING
from sandbox.editor.tools.drawing_terrain import GROUND, LINE, WALLS
from sandbox.editor.tools.drawing_wave import WAVE
from sandbox.editor.tools.selecting import LASSO, SELECT

_ALL = (SELECT, LASSO, PARTICLE, SPRING, *BODY_TOOLS, HANGERS, CHASSIS, AXLE, PART, PIN, WAVE, GROUND, LINE, WALLS)
TOOLS = {tool.name: tool for tool in _ALL}
