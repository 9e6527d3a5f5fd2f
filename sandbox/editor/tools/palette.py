"""The palette: all tools of the editor, in the order that a person sees them in."""

from sandbox.editor.kinds.table import BODY_TOOLS
from sandbox.editor.tools.drawing_particles import PARTICLE, PIN, SPRING
from sandbox.editor.tools.drawing_terrain import GROUND, LINE, WALLS
from sandbox.editor.tools.selecting import LASSO, SELECT

TOOLS = {tool.name: tool for tool in (SELECT, LASSO, PARTICLE, SPRING, *BODY_TOOLS, PIN, GROUND, LINE, WALLS)}
