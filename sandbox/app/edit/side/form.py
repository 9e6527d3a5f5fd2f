"""Form: a scrolling page of properties, a row each, that shows their values and takes new ones."""

import re
from collections.abc import Sequence
from functools import partial
from typing import Any

import pygame

from sandbox.app.base.desktop import copied_text, copy_text
from sandbox.app.base.sentences import sentence
from sandbox.app.base.shortcuts import action_of, tip_of
from sandbox.app.contracts.application import Editing
from sandbox.app.draw.colours import MUTED
from sandbox.app.draw.material_colours import material_colours
from sandbox.app.draw.themes import rgb_of
from sandbox.app.play.drive_keys import code_of
from sandbox.app.widgets.boxes import CheckBox, FoldHeading, KeyBox, Scrub
from sandbox.app.widgets.dialogs import ask, choose
from sandbox.app.widgets.field import Field
from sandbox.app.widgets.picker import Picker
from sandbox.app.widgets.rows import Row
from sandbox.app.widgets.scroll import ScrollArea
from sandbox.app.widgets.texts import TextBlock, wrapped
from sandbox.app.widgets.widget import Widget
from sandbox.editor.document import EditError
from sandbox.editor.edits.collision_groups import collision_groups
from sandbox.editor.panel.extra_values import HOW_TO_ADD
from sandbox.editor.panel.property import MIXED, Property, Section
from sandbox.editor.panel.typed import EVERYTHING, NOTHING
from sandbox.level.document.model import ParticleDef
from sandbox.level.format.look import COLOUR_PATTERN, colour_of
from sandbox.level.kinds.body_def import BodyDef

# Sizes in layout units.
ROW = 28.0
GAP = 5.0
LABEL_WIDTH = 108.0
HEADING = 24.0
SECTION_GAP = 10.0
PICK_WIDTH = 44.0
NOTE_LINES = 3
NOTE_LINE = 15.0
# Characters of a line to type into; what is longer is copied and pasted as a whole.
TEXT_LENGTH = 600
# Choices of at most this many letters in all, and this many of them, stand side by side, others in a menu.
SIDE_BY_SIDE = 14
MOST_SIDE_BY_SIDE = 4
# What a pick is of, where its kind is no word for people.
PICKED = {"mover": "body or particle"}
SQUARED = {"m/s^2": "m/s²"}
# What the button of an object says while some have one, all or none.
OBJECT_TEXTS = {True: "Remove", False: "Add", MIXED: "Add to the others"}


# What a menu says of null, of a colour that is typed, and of a box that may be neither ticked nor not.
NONE, OTHER_COLOUR = "automatic", "Another colour..."
YES_NO = {"yes": True, "no": False}


def _choice_text(each: Property) -> str:
    """What a menu shows of a value."""
    if each.value is None:
        return each.about.empty or NONE
    if each.about.labels and each.value in each.about.choices:
        return each.about.labels[each.about.choices.index(each.value)]
    return next((text for text, value in YES_NO.items() if value is each.value), str(each.value))


def _kind_of(part: BodyDef | ParticleDef) -> str:
    return part.type if isinstance(part, BodyDef) else "particle"


def _listed(collides: Any) -> Sequence[str]:
    """The groups that are listed in a value of `collides`."""
    return collides if isinstance(collides, tuple) else ()


class Form:
    """Properties in a scrolled area, which is its owner's; the widgets are made again only when other fields are shown.

    above, below: what is left free there [layout units]. empty: what it says without properties.
    """

    def __init__(
        self, screen: Editing, area: ScrollArea, above: float = 0.0, below: float = 0.0, empty: str = ""
    ) -> None:
        self._screen, self._ui = screen, screen.ui
        self.area, self._above, self._below, self._empty = area, above, below, empty
        self.properties: dict[str, Property] = {}
        self.fields: dict[str, tuple[Field, ...]] = {}
        self.pickers: dict[str, Picker] = {}
        self.boxes: dict[str, dict[str, CheckBox]] = {}
        self.choices: dict[str, Any] = {}
        self.buttons: dict[str, Any] = {}
        self.removers: dict[str, Any] = {}
        self.keys: dict[str, KeyBox] = {}
        self.scrubs: dict[str, Scrub] = {}
        self._notes: dict[str, TextBlock] = {}
        self._holder = Widget(self._ui, pygame.Rect(0, 0, 0, 0), area.content)
        self._named: dict[str, Any] = {}
        self._structure: object = None
        self._sections: Sequence[Section] = ()
        self._is_stale = False
        self._y = 0.0

    def show(self, sections: Sequence[Section]) -> None:
        """Show properties."""
        self._sections = sections
        shown = [section for section in sections if not self.is_folded(section)]
        structure = [(s.title, [self._structure_of(p) for p in s.properties] if s in shown else None) for s in sections]
        self.properties = {each.field: each for section in shown for each in section.properties}
        if structure != self._structure:
            self._structure = structure
            self._remake(sections)
        self._is_stale = False
        for each in self.properties.values():
            self._show_value(each)

    def refresh(self) -> None:
        """Bring fields that were typed into to the values that they gave."""
        if self._is_stale:
            self._is_stale = False
            for each in list(self.properties.values()):
                self._show_value(each)

    def is_folded(self, section: Section) -> bool:
        """Whether a section shows its heading alone."""
        return self._screen.folds.get(section.title, section.is_rare)

    def _fold(self, section: Section) -> None:
        """Fold a section away, or open it; the editor goes on so."""
        self._ui.blur()
        self._screen.folds[section.title] = not self.is_folded(section)
        self.show(self._sections)
        self._ui.focus_on(self._named[f"fold {section.title}"])

    @property
    def end(self) -> float:
        """The lower end of the form [layout units]."""
        return self._y + 8.0

    def close(self) -> None:
        """Take what is being typed, and take the widgets away."""
        if self._ui.focus in [field for fields in self.fields.values() for field in fields]:
            self._ui.blur()
        self._holder.clear()
        self._named = {}

    # Making rows.

    def _structure_of(self, each: Property) -> tuple[object, ...]:
        about = each.about
        lines = self._lines(each) if not each.editable else 0
        removable = each.remove is not None
        return (
            each.field,
            removable,
            about.kind,
            about.title,
            about.unit,
            about.choices,
            about.empty,
            each.axes,
            lines,
            self._is_long(each),
        )

    def _is_long(self, each: Property) -> bool:
        return each.about.kind in ("list", "pairs", "outlines", "words") and len(each.texts[0]) > TEXT_LENGTH

    def _lines(self, each: Property) -> int:
        """How many lines a text takes that is only shown."""
        font = self._ui.font(11.0)
        return len(wrapped(each.texts[0], font, self._ui.px(self._inside - LABEL_WIDTH), NOTE_LINES))

    @property
    def _inside(self) -> float:
        return self.area.view.rect.width / self._ui.scale - 2.0

    def _remake(self, sections: Sequence[Section]) -> None:
        ui = self._ui
        focused = next((name for name, widget in self._named.items() if widget is ui.focus), "")
        self.close()
        self.fields, self.pickers, self.boxes, self.choices, self._notes = {}, {}, {}, {}, {}
        self.buttons, self.removers, self.keys, self.scrubs = {}, {}, {}, {}
        self._y = self._above
        if not sections and self._empty:
            place = ui.rect(0, self._y + 4, self._inside, 120)
            TextBlock(ui, place, self._empty, self._holder, 12.5)
        for number, section in enumerate(sections):
            self._y += SECTION_GAP if number else 0.0
            self._add_heading(section, is_first=number == 0)
            if self.is_folded(section):
                continue
            for each in section.properties:
                self._add(each)
        self._holder.resize((self.area.content.place.width, ui.px(self.end)))
        self.area.set_height(ui.px(self.end + self._below))
        if focused in self._named:
            ui.focus_on(self._named[focused])

    def _add_heading(self, section: Section, is_first: bool) -> None:
        """The name of what is shown, or a heading that folds what is below it."""
        ui = self._ui
        if not is_first:
            fold, place = partial(self._fold, section), self._rect(0, self._inside, HEADING - 4)
            heading = FoldHeading(ui, place, section.title, self.is_folded(section), fold, self._holder)
            self._keep(heading, f"fold {section.title}")
            self._y += HEADING
            return
        # What several selected things are may take two lines.
        for line in wrapped(section.title, ui.font(15, True), ui.px(self._inside), 2):
            ui.label(self._rect(0, self._inside, HEADING - 4), line, self._holder, "title")
            self._y += HEADING

    def _keep(self, widget: Any, name: str) -> Any:
        self._named[name] = widget
        return widget

    def _rect(self, x: float, width: float, height: float = ROW) -> pygame.Rect:
        return self._ui.rect(x, self._y, width, height)

    def _add(self, each: Property) -> None:
        about, ui = each.about, self._ui
        content = self._holder
        self._add_label(each)
        width = self._inside - LABEL_WIDTH
        if each.remove is not None:
            width -= ROW + GAP
            place, tip = self._rect(self._inside - ROW, ROW), f"Take {about.title} away"
            button = ui.button(place, "\u00d7", partial(self._remove, each.field), content, style="segment", tip=tip)
            self.removers[each.field] = self._keep(button, f"{each.field} remove")
        if not each.editable:
            height = max(ROW - 8, self._lines(each) * NOTE_LINE + 2)
            place = ui.rect(LABEL_WIDTH, self._y + 7, width, height)
            self._notes[each.field] = TextBlock(ui, place, "", content, 11.5)
            self._y += max(ROW, height + 8)
            return
        if about.kind == "point":
            half = (width - GAP) / 2
            self.fields[each.field] = (
                self._entry(each, LABEL_WIDTH, half, 0), self._entry(each, LABEL_WIDTH + half + GAP, half, 1),
            )  # fmt: skip
        elif about.kind == "flags" or (about.kind == "yes_no" and not about.optional):
            self._add_boxes(each, width)
        elif about.kind in ("choice", "material", "touches", "colour", "thing", "yes_no"):
            self._add_choice(each, width)
        elif about.kind == "part":
            press = partial(self._press_object, each.field)
            button = ui.button(self._rect(LABEL_WIDTH, width), "", press, content, style="segment", tip=about.tooltip)
            self.buttons[each.field] = self._keep(button, each.field)
        elif about.kind == "extras":
            press = partial(self._ask_for_entry, each.field)
            tip = about.tooltip
            button = ui.button(self._rect(LABEL_WIDTH, width), "Add\u2026", press, content, style="segment", tip=tip)
            self.buttons[each.field] = self._keep(button, each.field)
        elif about.kind == "key":
            self._add_key(each, width)
        elif self._is_long(each):
            place = self._rect(LABEL_WIDTH, width)
            text = f"{len(each.value):,} of them"
            button = ui.button(place, text, partial(self._offer_text, each.field), content, tip=about.tooltip)
            self._keep(button, each.field)
        else:
            room = PICK_WIDTH + GAP if about.pick else 0.0
            self.fields[each.field] = (self._entry(each, LABEL_WIDTH, width - room, 0),)
            if about.pick:
                self._add_pick(each)
        self._y += ROW + GAP

    def _add_pick(self, each: Property) -> None:
        """A button that lets the value be picked on the sheet."""
        pick = each.about.pick
        press = partial(self._screen.pick, pick, partial(self._set, each.field))
        place = self._rect(self._inside - PICK_WIDTH, PICK_WIDTH)
        tip = "Drag it on the sheet" if pick == "box" else f"Click the {PICKED.get(pick, pick)} on the sheet"
        button = self._ui.button(place, "Pick", press, self._holder, style="segment", tip=tip)
        self._keep(button, f"{each.field} pick")

    def _add_label(self, each: Property) -> None:
        about, place = each.about, self._rect(0, LABEL_WIDTH - 4)
        text = about.title + (f" [{SQUARED.get(about.unit, about.unit)}]" if about.unit else "")
        tip = about.tooltip
        if each.editable and about.kind in ("number", "integer"):
            scrub = Scrub(self._ui, place, text, partial(self._scrub, each.field), self._end_scrub, self._holder)
            scrub.tip = f"{tip} Drag to change it."
            self.scrubs[each.field] = scrub
            return
        self._ui.label(place, text, self._holder, "muted").tip = tip

    def _add_key(self, each: Property, width: float) -> None:
        box = KeyBox(self._ui, self._rect(LABEL_WIDTH, width), partial(self._press_key, each.field), self._holder)
        box.tip = f"{each.about.tooltip} Click here, then press it; Delete takes it away."
        self.keys[each.field] = self._keep(box, each.field)

    def _entry(self, each: Property, x: float, width: float, axis: int) -> Field:
        commit = partial(self._type, each.field, axis)
        field = self._ui.field(self._rect(x, width), "", commit, self._holder, TEXT_LENGTH)
        if each.about.empty:
            field.hint = f"({each.about.empty})"
            field.typed = ""
        axis_name = f"{each.axes[axis]}. " if each.about.kind == "point" else ""
        field.tip = axis_name + each.about.tooltip
        self._keep(field, f"{each.field} {axis}")
        return field

    def _add_boxes(self, each: Property, width: float) -> None:
        labels = each.about.choices or ("yes",)
        wide = width / max(len(labels), 2)
        self.boxes[each.field] = {}
        for number, label in enumerate(labels):
            place = self._rect(LABEL_WIDTH + number * wide, wide - GAP)
            box = CheckBox(self._ui, place, label, partial(self._tick, each.field, label), self._holder)
            self.boxes[each.field][label] = self._keep(box, f"{each.field} {label}")

    def _add_choice(self, each: Property, width: float) -> None:
        about, content = each.about, self._holder
        few = len(about.choices) in range(1, MOST_SIDE_BY_SIDE + 1) and not (about.optional or about.pick)
        if about.pick:
            width -= PICK_WIDTH + GAP
            self._add_pick(each)
        if few and sum(map(len, about.choices)) <= SIDE_BY_SIDE:
            options = [(value, value, about.tooltip) for value in about.choices]
            row = self._ui.choice(self._rect(LABEL_WIDTH, width), options, partial(self._choose, each.field), content)
            self.choices[each.field] = row
            for value, button in row.buttons.items():
                self._keep(button, f"{each.field} {value}")
            return
        picker = Picker(self._ui, self._rect(LABEL_WIDTH, width), partial(self._pick, each.field), content)
        picker.tip = about.tooltip
        self.pickers[each.field] = self._keep(picker, each.field)

    # Showing values.

    def _show_value(self, each: Property) -> None:
        name, is_mixed = each.field, each.value is MIXED
        if name in self._notes:
            self._notes[name].show_text(each.texts[0])
        for field, text in zip(self.fields.get(name, ()), each.texts, strict=False):
            field.show(text)
            # What is being typed stays; once it is done the value has to be shown.
            self._is_stale = self._is_stale or field.text != text
        for label, box in self.boxes.get(name, {}).items():
            state = each.value[label] if each.about.kind == "flags" else each.value
            box.show_state(state is True, state is MIXED)
        if each.about.kind == "part":
            self.buttons[name].show_text(OBJECT_TEXTS[each.value])
        if name in self.keys:
            self.keys[name].show_key(MIXED.value if is_mixed else each.value)
        if name in self.choices:
            self.choices[name].show("" if is_mixed else each.value)
        if name in self.pickers:
            rows = self._rows(each)
            mixed_row = Row(MIXED.value, colour=MUTED)
            text = each.texts[0] if each.about.kind == "touches" else _choice_text(each)
            other = Row(text, swatch=rgb_of(colour_of(text)) if text.startswith("#") else None)
            shown = mixed_row if is_mixed else next((row for row in rows if row.text == text), other)
            self.pickers[name].show_value(rows, shown)

    def _rows(self, each: Property) -> list[Row]:
        if each.about.kind == "touches":
            return [Row(EVERYTHING), Row(NOTHING), *(Row(name, self._toggle_of(each, name)) for name in self._groups)]
        about = each.about
        first = [Row(about.empty or NONE, colour=MUTED)] if about.optional else []
        if about.kind == "thing":
            level = self._screen.document.level
            return [*first, *(Row(body.id, _kind_of(body)) for body in level.bodies),
                    *(Row(particle.id, _kind_of(particle)) for particle in level.particles)]  # fmt: skip
        if about.kind != "material":
            if about.kind == "colour":
                palette = [Row(name, swatch=rgb_of(colour_of(name))) for name in about.choices]
                return [*first, *palette, Row(OTHER_COLOUR)]
            return first + [Row(text) for text in (YES_NO if about.kind == "yes_no" else about.labels or about.choices)]
        colours = material_colours(self._screen.document.level.materials)
        return [*first, *(Row(name, swatch=colour) for name, colour in colours.items())]

    @property
    def _groups(self) -> tuple[str, ...]:
        return collision_groups(self._screen.document.level)

    def _toggle_of(self, each: Property, group: str) -> str:
        """The words on a row of a collision group: what a click does there."""
        listed = _listed(each.value)
        if not listed:
            return "this group alone"
        return "touched: take it out" if group in listed else "touch this group too"

    # Changing values.

    def _press_object(self, name: str) -> None:
        each = self.properties[name]
        verb, wanted = ("Remove", False) if each.value is True else ("Add", True)
        self._screen.edit(f"{verb}: {each.about.title.lower()}", lambda document: each.set(document, wanted))

    def _press_key(self, name: str, key: str | None) -> None:
        if not self._set(name, key) or key is None:
            return
        action = action_of(code_of(key), 0, "play")
        if action is not None:
            self._screen.say(f"While this level is played, {key.upper()} drives; else it is: {tip_of(action, 'play')}.")

    def _scrub(self, name: str, steps: int) -> None:
        each = self.properties[name]
        value = each.stepped(steps)
        if value is not None:
            self._is_stale = True
            label = each.about.title
            self._screen.edit(label, lambda document: each.set(document, value), merge=f"scrub {name}")

    def _end_scrub(self) -> None:
        self._screen.history.end_merge()

    def _choose(self, name: str, value: str) -> None:
        self._set(name, value)

    def _set(self, name: str, value: Any) -> bool:
        each = self.properties.get(name)
        if each is None:
            return False
        self._is_stale = True
        remark = "" if each.remark is None else each.remark(self._screen.document, value)
        taken = self._screen.edit(each.about.title, lambda document: each.set(document, value))
        if taken and remark:
            self._screen.say(sentence(remark))
        return taken

    def _type(self, name: str, axis: int, text: str) -> bool:
        each = self.properties.get(name)
        if each is None:
            return False
        try:
            value = each.typed(text, axis)
        except EditError as error:
            self._screen.say(sentence(error))
            return False
        return self._set(name, value)

    def _tick(self, name: str, label: str, state: bool) -> None:
        self._set(name, {label: state} if self.properties[name].about.kind == "flags" else state)

    def _pick(self, name: str, index: int) -> None:
        text, each = self.pickers[name].rows[index].text, self.properties[name]
        if each.about.optional and index == 0:
            self._set(name, None)
        elif text == OTHER_COLOUR:
            self._ask_for_colour(name)
        elif each.about.kind == "yes_no":
            self._set(name, YES_NO[text])
        elif each.about.labels:
            self._set(name, each.about.choices[index - each.about.optional])
        elif each.about.kind != "touches":
            self._set(name, text)
        elif index < 2:
            self._set(name, text == EVERYTHING)
        else:
            kept = [group for group in _listed(each.value) if group != text]
            self._set(name, kept if len(kept) < len(_listed(each.value)) else [*kept, text])

    def _remove(self, name: str) -> None:
        each = self.properties[name]
        if each.remove is not None:
            self._screen.edit(f"Remove: {each.about.title}", each.remove)

    def _ask_for_entry(self, name: str) -> None:
        each = self.properties[name]

        def take(typed: str) -> str | None:
            try:
                document = each.set(self._screen.document, typed)
            except EditError as error:
                return sentence(error)
            self._screen.apply(f"Add: {typed.partition('=')[0].strip()}", document)
            return None

        ask(self._ui, each.about.title, HOW_TO_ADD, "", "Add", take)

    def _ask_for_colour(self, name: str) -> None:
        each = self.properties[name]

        def take(text: str) -> str | None:
            typed = text.strip()
            wanted = typed if typed.startswith("#") else f"#{typed}"
            if re.fullmatch(COLOUR_PATTERN, wanted) is None:
                return "A colour is # and six digits 0 to 9 or a to f: red, green, blue."
            self._set(name, wanted)
            return None

        before = each.value if isinstance(each.value, str) and each.value.startswith("#") else "#"
        ask(self._ui, each.about.title, "Red, green and blue, such as #F2557B", before, "Take it", take)

    def _offer_text(self, name: str) -> None:
        """Offer to copy a list that is too long to type as text, or to paste one in its place."""

        def put() -> None:
            if not copy_text(self.properties[name].texts[0]):
                self._screen.say("The system's clipboard cannot be used.")

        def take() -> None:
            self._type(name, 0, copied_text())

        title = self.properties[name].about.title
        choices = [("Copy as text", put), ("Paste in its place", take)]
        choose(self._ui, title, "This list is too long for one line.", choices)
