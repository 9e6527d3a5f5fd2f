"""MaterialsPage: the level's materials, where they are used, and the chosen one as a form."""

from collections import Counter
from typing import Any

import pygame

from sandbox.app.contracts.application import Editing
from sandbox.app.draw.looks import material_colours
from sandbox.app.edit.side.side_page import HeadButton, ListHead, SidePage
from sandbox.app.widgets.form import Form
from sandbox.app.widgets.rows import Row
from sandbox.editor.document import Document
from sandbox.editor.edits.materials import add_material, assign, delete_material
from sandbox.editor.panel.material_properties import material_sections, materials_of
from sandbox.editor.panel.typed import number_text
from sandbox.editor.pick import items_of_material
from sandbox.level.document.model import HookeMaterial, Level, Material
from sandbox.level.format.limits import DEFAULT_MATERIAL

# Part of the page that the list takes.
LIST_PART = 0.3


class MaterialsPage(SidePage):
    """Materials as swatches; below, the properties of the chosen one."""

    follows_selection = True

    def __init__(self, screen: Editing, place: pygame.Rect, container: Any) -> None:
        self._screen = screen
        self.chosen: str = _of_selection(screen.document)
        self._place = 0
        self._shown: tuple[object, ...] = ()
        self._uses: tuple[object, object, Counter[str], Counter[str]] | None = None
        buttons = (
            HeadButton("Assign to selection", "Assign", self._assign, "Give this material to the selection"),
            HeadButton("Select users", "Select", self._select, "Select everything of this material"),
            HeadButton("Add", "Add", self._add, "Add a material like this one"),
            HeadButton("Delete", "Delete", self._delete, "Delete this material if nothing uses it"),
        )
        head = ListHead(screen.ui, place, LIST_PART, 2, buttons, self._choose, container)
        self.list, self.buttons, self.area = head.list, head.buttons, head.area
        self.form = Form(screen, head.area, head.top)

    def refresh(self) -> None:
        """Show the materials as they are now."""
        level = self._screen.document.level
        fresh = (level.materials, level.bodies, level.springs, level.settings.tick_rate, self.chosen)
        if not self._shown or any(new is not old for new, old in zip(fresh, self._shown, strict=True)):
            materials = materials_of(level)
            names, colours = list(materials), material_colours(level.materials)
            if self.chosen not in materials:
                # It has another name now, in its place, or is gone.
                self.chosen = names[min(self._place, len(names) - 1)]
            self._shown, self._place = (*fresh[:-1], self.chosen), names.index(self.chosen)
            rows = [Row(name, self._reading(level, name, materials[name]), colours[name]) for name in names]
            self.list.show_rows(rows, self._place, reveal=True)
            self.buttons["Delete"].is_enabled = self.chosen != DEFAULT_MATERIAL
            self.form.show(material_sections(level, self.chosen))
        self.form.refresh()

    def _reading(self, level: Level, name: str, material: Material) -> str:
        """The coefficients of a material, and how many bodies and loose springs are of it."""
        if self._uses is None or self._uses[0] is not level.bodies or self._uses[1] is not level.springs:
            of_bodies = Counter(body.material for body in level.bodies)
            self._uses = level.bodies, level.springs, of_bodies, Counter(spring.material for spring in level.springs)
        uses = [
            f"{count[name]:,} {one if count[name] == 1 else many}"
            for count, one, many in ((self._uses[2], "body", "bodies"), (self._uses[3], "spring", "springs"))
            if count[name]
        ]
        if isinstance(material, HookeMaterial):
            values = f"k {number_text(material.k)}, c {number_text(material.c)}"
        else:
            values = f"Cs {number_text(material.stiffness)}, Cd {number_text(material.damping)}"
        return f"{values} · {', '.join(uses) or 'not used'}"

    def _choose(self, index: int) -> None:
        self.chosen = self.list.rows[index].text

    def _add(self) -> None:
        taken = materials_of(self._screen.document.level)
        name = next(f"material {k}" for k in range(1, len(taken) + 2) if f"material {k}" not in taken)
        like = taken[self.chosen]
        if self._screen.edit("Add a material", lambda document: add_material(document, name, like)):
            self.chosen = name
            self.refresh()
            self._screen.ui.focus_on(self.form.fields["name"][0])

    def _delete(self) -> None:
        name = self.chosen
        self._screen.edit(f"{name}: delete", lambda document: delete_material(document, name))

    def _assign(self) -> None:
        name = self.chosen
        self._screen.edit(f"{name}: assign", lambda document: assign(document, name))

    def _select(self) -> None:
        self._screen.select(items_of_material(self._screen.document.level, self.chosen))


def _of_selection(document: Document) -> str:
    """The material of what is selected first, else the first of the level's own."""
    level = document.level
    chosen = next((item for item in document.selection if item.kind in ("body", "spring")), None)
    if chosen is None:
        return next(iter(level.materials), DEFAULT_MATERIAL)
    if chosen.kind == "spring":
        return level.springs[int(chosen.key)].material
    return next(body.material for body in level.bodies if body.id == chosen.key)
