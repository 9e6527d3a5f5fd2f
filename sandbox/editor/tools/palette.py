"""The palette: all tools of the editor, in the order that a person sees them in."""

from sandbox.editor.kinds.table import BODY_TOOLS
from sandbox.editor.tools.drawing_axle import AXLE
from sandbox.editor.tools.drawing_chassis import CHASSIS
from sandbox.editor.tools.drawing_hangers import HANGERS
from sandbox.editor.tools.drawing_part import PART
from sandbox.editor.tools.drawing_particles import PARTICLE, PIN, SPRING
from sandbox.editor.tools.drawing_terrain import GROUND, LINE, WALLS, WATER
from sandbox.editor.tools.drawing_tool import EditorTool
from sandbox.editor.tools.drawing_wave import WAVE
from sandbox.editor.tools.drawing_zone import ZONE

SELECT = EditorTool("select", "V", "Select and move")
LASSO = EditorTool("lasso", "L", "Select by a lasso")

# The tools by the groups that a person sees, in their order.
TOOL_GROUPS = {
    "Select": (SELECT, LASSO),
    "Points": (PARTICLE, SPRING, PIN),
    "Bodies": BODY_TOOLS,
    "Machines": (PART, CHASSIS, AXLE, HANGERS, WAVE),
    "Ground": (GROUND, LINE, WALLS, WATER, ZONE),
}
TOOLS = {tool.name: tool for tools in TOOL_GROUPS.values() for tool in tools}
