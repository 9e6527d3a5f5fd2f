"""MaterialsPage: the level's materials, where they are used, and the coefficients of the chosen one."""

import math
from collections import Counter
from collections.abc import Callable
from functools import partial
from typing import Any

import pygame

from sandbox.app.base.sentences import sentence
from sandbox.app.contracts.application import Editing
from sandbox.app.draw.material_colours import material_colours
from sandbox.app.edit.side.form import GAP, ROW, Form
from sandbox.app.edit.side.list_head import HeadButton, ListHead
from sandbox.app.edit.side.side_page import SidePage
from sandbox.app.panel.readings import number
from sandbox.app.widgets.boxes import Scrub
from sandbox.app.widgets.field import Field
from sandbox.app.widgets.rows import Row
from sandbox.app.widgets.slider import Slider, SliderState
from sandbox.app.widgets.widget import Widget
from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.materials import add_material, assign, delete_material, rename_material, set_material
from sandbox.editor.panel.field_info import FieldInfo, fields_of
from sandbox.editor.panel.level_properties import look_properties
from sandbox.editor.panel.property import Property, Section
from sandbox.editor.panel.typed import line_text, number_text, read_line, read_number
from sandbox.editor.pick import items_of_material
from sandbox.level.document.model import HookeMaterial, Level, Material, MaterialDef, NissenMaterial
from sandbox.level.format.limits import DEFAULT_MATERIAL
from sandbox.level.format.quantities import replaced
from sandbox.physics.equation import coefficients_from_frequency, frequency_from_coefficients

# Part of the page that the list takes.
LIST_PART = 0.3
FIELD_WIDTH = 96.0
SHORT = {"stiffness": "Cs  stiffness", "damping": "Cd  damping", "k": "k  stiffness", "c": "c  damping"}
# What they look like has a form of its own.
LIMITS = tuple(name for name in MaterialDef.model_fields if name != "look")
LAWS = (
    ("nissen", "Impulse", "The impulse-based spring: Cs and Cd, the same behaviour for every mass"),
    ("hooke", "Hooke", "The classic spring, F = -k x - c u, for comparison: it explodes where k or c is too large"),
)


class MaterialsPage(SidePage):
    """Materials as swatches; below, what the chosen one is made of."""

    follows_selection = True

    def __init__(self, screen: Editing, place: pygame.Rect, container: Any) -> None:
        self._screen, self._ui = screen, screen.ui
        self.chosen: str = _of_selection(screen.document)
        self.fields: dict[str, Field] = {}
        self.sliders: dict[str, Slider] = {}
        self._made_for: tuple[object, ...] = ()
        self._shown: tuple[object, ...] = ()
        self._slid: tuple[str, float] | None = None
        self._uses: tuple[object, object, Counter[str], Counter[str]] | None = None
        self._y = 0.0
        buttons = (
            HeadButton("Assign to selection", "Assign", self._assign, "Give this material to the selection"),
            HeadButton("Select users", "Select", self._select, "Select everything of this material"),
            HeadButton("Add", "Add", self._add, "Add a material like this one"),
            HeadButton("Delete", "Delete", self._delete, "Delete this material if nothing uses it"),
        )
        self._head = ListHead(self._ui, place, LIST_PART, 2, buttons, self._choose, container)
        self.list, self.buttons, self.area = self._head.list, self._head.buttons, self._head.area
        self._inside = place.width / self._ui.scale - 12.0
        self._holder = Widget(self._ui, pygame.Rect(0, 0, 0, 0), self._head.area.content)
        self.look: Form | None = None

    # Making the editor of a material.

    def _remake(self, material: Material) -> None:
        self._drop()
        ui, content, self._y = self._ui, self._holder, self._head.top
        if self.chosen != DEFAULT_MATERIAL:
            self._add_field("name", "Name", self._rename, "What levels and files call it.", width=self._inside - 108.0)
        self._label("Law")
        place = ui.rect(108, self._y, self._inside - 108, ROW)
        self.law = ui.choice(place, LAWS, self._choose_law, content)
        self._y += ROW + GAP + 4
        for name, about in fields_of(type(material)).items():
            if name in SHORT:
                self._add_coefficient(name, about)
        if isinstance(material, NissenMaterial):
            self._add_field(
                "frequency", "Frequency [Hz]", self._type_frequency, "How fast a spring of this material swings."
            )
            self._add_field("ratio", "Damping ratio", self._type_ratio, "At 1 it comes to rest without swinging.")
        ui.label(ui.rect(0, self._y + 6, self._inside, ROW - 4), "BREAKS AND YIELDS", content, "heading")
        self._y += ROW + 4
        for name in LIMITS:
            self._add_limit(name, fields_of(type(material))[name])
        self._holder.resize((self.area.content.place.width, self._ui.px(self._y)))
        self.look = Form(self._screen, self.area, above=self._y + 6)

    def _label(self, text: str, tip: str = "") -> None:
        label = self._ui.label(self._ui.rect(0, self._y, self._inside, ROW), text, self._holder, "muted")
        if tip:
            label.tip = tip

    def _add_field(
        self, name: str, label: str, commit: Callable[[str], bool], tip: str, width: float = FIELD_WIDTH
    ) -> None:
        ui = self._ui
        if label:
            self._label(label, tip)
        place = ui.rect(self._inside - width, self._y, width, ROW)
        self.fields[name] = ui.field(place, "", commit, self._holder, 600)
        self.fields[name].tip = tip
        self._y += ROW + GAP

    def _add_coefficient(self, name: str, about: FieldInfo) -> None:
        unit = f" [{about.unit}]" if name in ("k", "c") else ""
        self._add_field(name, SHORT[name] + unit, partial(self._type_coefficient, name), about.tooltip)
        if name in ("k", "c"):
            return
        place = self._ui.rect(-4, self._y - 4, self._inside + 8, ROW)
        slide = partial(self._slide, name)
        self.sliders[name] = Slider(self._ui, place, slide, self._end_slide, self._holder)
        self._y += ROW - 2

    def _add_limit(self, name: str, about: FieldInfo) -> None:
        turn, done = partial(self._scrub_limit, name), self._screen.history.end_merge
        place = self._ui.rect(0, self._y, self._inside - FIELD_WIDTH - GAP, ROW)
        scrub = Scrub(self._ui, place, about.title, turn, done, self._holder)
        scrub.tip = f"{about.tooltip} Drag to change it."
        self._add_field(name, "", partial(self._type_limit, name), about.tooltip)
        if about.empty:
            self.fields[name].hint = f"({about.empty})"
            self.fields[name].typed = ""

    def _drop(self) -> None:
        if self._ui.focus in self.fields.values():
            self._ui.blur()
        self._holder.clear()
        self.fields, self.sliders = {}, {}
        if self.look is not None:
            self.look.close()
            self.look = None

    # Showing.

    def refresh(self) -> None:
        """Show the materials as they are now."""
        self._take_slide()
        level = self._screen.document.level
        fresh = (level.materials, level.bodies, level.springs, level.settings.tick_rate, self.chosen)
        if all(new is old for new, old in zip(fresh, self._shown, strict=False)) and self._shown:
            return
        self._shown = fresh
        materials = _materials(level)
        if self.chosen not in materials:
            self.chosen = next(iter(materials))
        names, colours = list(materials), material_colours(level.materials)
        rows = [Row(name, self._reading(level, name, materials[name]), colours[name]) for name in names]
        self.list.show_rows(rows, names.index(self.chosen), reveal=True)
        material = materials[self.chosen]
        made_for = (type(material), self.chosen == DEFAULT_MATERIAL)
        if made_for != self._made_for:
            self._made_for = made_for
            self._remake(material)
        self._show(level, material)

    def _show(self, level: Level, material: Material) -> None:
        is_default = self.chosen == DEFAULT_MATERIAL
        if not is_default:
            self.fields["name"].show(line_text(self.chosen))
        self.buttons["Delete"].is_enabled = not is_default
        self.law.show("hooke" if isinstance(material, HookeMaterial) else "nissen")
        for name in self.fields.keys() & type(material).model_fields.keys():
            value = getattr(material, name)
            self.fields[name].show("" if value is None else number_text(value))
        if self.look is not None:
            self.look.show([Section("Look", tuple(look_properties(self.chosen, material)))])
        for name, slider in self.sliders.items():
            slider.show_state(SliderState(getattr(material, name)))
        if isinstance(material, NissenMaterial):
            reading = frequency_from_coefficients(material.stiffness, material.damping, 1.0 / level.settings.tick_rate)
            for name, value in zip(("frequency", "ratio"), reading, strict=True):
                self.fields[name].show(number(value))

    def _used(self, level: Level) -> tuple[Counter[str], Counter[str]]:
        """How many bodies and loose springs are of each material, counted again only where these have changed."""
        uses = self._uses
        if uses is None or uses[0] is not level.bodies or uses[1] is not level.springs:
            of_bodies = Counter(body.material for body in level.bodies)
            of_springs = Counter(spring.material for spring in level.springs)
            uses = self._uses = (level.bodies, level.springs, of_bodies, of_springs)
        return uses[2], uses[3]

    def _reading(self, level: Level, name: str, material: Material) -> str:
        bodies, springs = self._used(level)
        uses = [
            f"{number:,} {one if number == 1 else many}"
            for number, one, many in ((bodies[name], "body", "bodies"), (springs[name], "spring", "springs"))
            if number
        ]
        if isinstance(material, HookeMaterial):
            values = f"k {number_text(material.k)}, c {number_text(material.c)}"
        else:
            values = f"Cs {number_text(material.stiffness)}, Cd {number_text(material.damping)}"
        return f"{values} · {', '.join(uses) or 'not used'}"

    # Changing.

    @property
    def _material(self) -> Material:
        return _materials(self._screen.document.level)[self.chosen]

    def _choose(self, index: int) -> None:
        self.chosen = self.list.rows[index].text

    def _edit(self, label: str, change: Callable[[Document], Document], merge: str | None = None) -> bool:
        # Whatever was typed is shown again as the document has it.
        self._shown = ()
        return self._screen.edit(f"{self.chosen}: {label}", change, merge)

    def _put(self, label: str, material: Material, merge: str | None = None) -> bool:
        name = self.chosen
        return self._edit(label, lambda document: set_material(document, name, material), merge)

    def _slide(self, name: str, value: float) -> None:
        # The mouse moves more often than a large level can be changed.
        self._slid = (name, value)

    def _take_slide(self) -> None:
        if self._slid is not None:
            (name, value), self._slid = self._slid, None
            key = f"{self.chosen} {name}"
            self._put(SHORT[name][:2], replaced(self._material, **{name: value}), merge=key)

    def _end_slide(self) -> None:
        self._take_slide()
        self._screen.history.end_merge()

    def _choose_law(self, law: str) -> None:
        is_hooke = isinstance(self._material, HookeMaterial)
        if (law == "hooke") != is_hooke:
            limits = {name: getattr(self._material, name) for name in MaterialDef.model_fields}
            self._put("law", HookeMaterial(law="hooke", **limits) if law == "hooke" else NissenMaterial(**limits))

    def _number(self, label: str, text: str) -> float | None:
        try:
            return read_number(label, text)
        except EditError as error:
            self._screen.say(sentence(error))
            return None

    def _type_coefficient(self, name: str, text: str) -> bool:
        value = self._number(SHORT[name].split()[0], text)
        return value is not None and self._put(SHORT[name][:2].strip(), replaced(self._material, **{name: value}))

    def _type_limit(self, name: str, text: str) -> bool:
        about = fields_of(type(self._material))[name]
        is_empty = about.optional and not text.strip()
        value = None if is_empty else self._number(about.title, text)
        if value is None and not is_empty:
            return False
        return self._put(about.title.lower(), replaced(self._material, **{name: value}))

    def _scrub_limit(self, name: str, steps: int) -> None:
        about = fields_of(type(self._material))[name]
        value = Property(name, about, getattr(self._material, name)).stepped(steps)
        if value is not None:
            changed = replaced(self._material, **{name: value})
            self._put(about.title.lower(), changed, merge=f"{self.chosen} {name}")

    def _type_frequency(self, text: str) -> bool:
        frequency, material = self._number("Frequency", text), self._material
        if frequency is None or not isinstance(material, NissenMaterial):
            return False
        ratio = self._now(material)[1]
        if not math.isfinite(ratio):
            self._screen.say("There was no damping ratio, so it is 1 now.")
            ratio = 1.0
        return self._put_frequency(frequency, ratio)

    def _type_ratio(self, text: str) -> bool:
        ratio, material = self._number("Damping ratio", text), self._material
        if ratio is None or not isinstance(material, NissenMaterial):
            return False
        frequency = self._now(material)[0]
        if not math.isfinite(frequency):
            self._screen.say("There is no frequency to keep: type the frequency first.")
            return False
        return self._put_frequency(frequency, ratio)

    def _tick_time(self) -> float:
        return 1.0 / self._screen.document.level.settings.tick_rate

    def _now(self, material: NissenMaterial) -> tuple[float, float]:
        return frequency_from_coefficients(material.stiffness, material.damping, self._tick_time())

    def _put_frequency(self, frequency: float, ratio: float) -> bool:
        try:
            stiffness, damping = coefficients_from_frequency(frequency, ratio, self._tick_time())
        except ValueError as error:
            self._screen.say(sentence(error))
            return False
        return self._put("frequency", replaced(self._material, stiffness=stiffness, damping=damping))

    def _rename(self, text: str) -> bool:
        old, new = self.chosen, read_line(text)
        if not self._edit("rename", lambda document: rename_material(document, old, new)):
            return False
        self.chosen = new
        return True

    def _add(self) -> None:
        taken, material = _materials(self._screen.document.level), self._material
        name = next(f"material {k}" for k in range(1, len(taken) + 2) if f"material {k}" not in taken)
        if self._screen.edit("Add a material", lambda document: add_material(document, name, material)):
            self.chosen = name
            self.refresh()
            self._ui.focus_on(self.fields["name"])

    def _delete(self) -> None:
        name = self.chosen
        self._edit("delete", lambda document: delete_material(document, name))

    def _assign(self) -> None:
        name = self.chosen
        self._edit("assign", lambda document: assign(document, name))

    def _select(self) -> None:
        self._screen.select(items_of_material(self._screen.document.level, self.chosen))


def _materials(level: Level) -> dict[str, Material]:
    """Every material that something in the level can be of."""
    return {DEFAULT_MATERIAL: NissenMaterial(), **level.materials}


def _of_selection(document: Document) -> str:
    """The material of what is selected first, else the first of the level's own."""
    level = document.level
    chosen = next((item for item in document.selection if item.kind in ("body", "spring")), None)
    if chosen is not None:
        if chosen.kind == "spring":
            return level.springs[int(chosen.key)].material
        return next(body.material for body in level.bodies if body.id == chosen.key)
    return next(iter(level.materials), DEFAULT_MATERIAL)
