"""What rooms below the application, its screens and the panel of a run call them in annotations.

A checker of types sees the classes themselves; a program that runs imports nothing of the rooms above.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sandbox.app.edit.edit_screen import EditScreen as Editing
    from sandbox.app.panel.panel import Panel as RunPanel
    from sandbox.app.play.play_screen import PlayScreen as Playing
    from sandbox.app.window.app import App as Application
else:
    Application = Editing = Playing = RunPanel = object

__all__ = ("Application", "Editing", "Playing", "RunPanel")
