"""What rooms below the application and the editor call them in annotations.

A checker of types sees the classes themselves; a program that runs imports nothing of the rooms above.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sandbox.app.edit.edit_screen import EditScreen as Editing
    from sandbox.app.window.app import App as Application
else:
    Application = Editing = object

__all__ = ("Application", "Editing")
