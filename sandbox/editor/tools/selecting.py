"""The tools that select, and move what is selected."""

from sandbox.editor.tools.editor_tool import EditorTool

SELECT = EditorTool("select", "V", "Select and move")
LASSO = EditorTool("lasso", "L", "Select by a lasso")
