"""PropertyWidgets: what shows properties and changes them: lines to type into, menus, boxes, labels to drag."""

import os
import re
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Protocol

import pygame

from sandbox.app.base.desktop import copied_text, copy_text
from sandbox.app.base.sentences import sentence
from sandbox.app.base.shortcuts import action_of, tip_of
from sandbox.app.draw.colours import MUTED, unpacked
from sandbox.app.draw.looks import material_colours
from sandbox.app.widgets.boxes import KEYS, CheckBox, KeyBox, Scrub
from sandbox.app.widgets.button import Choice
from sandbox.app.widgets.dialogs import ask, choose
from sandbox.app.widgets.field import DASH, Field
from sandbox.app.widgets.picker import Picker
from sandbox.app.widgets.rows import Row
from sandbox.app.widgets.slider import Slider, SliderState
from sandbox.app.widgets.texts import TextBlock
from sandbox.app.widgets.ui import Ui
from sandbox.app.widgets.widget import Widget
from sandbox.editor.document import EditError
from sandbox.editor.edits.materials import collision_groups
from sandbox.editor.panel.extra_values import HOW_TO_ADD
from sandbox.editor.panel.field_info import Pick
from sandbox.editor.panel.property import MIXED, Property, Section
from sandbox.editor.panel.typed import EVERYTHING, NOTHING
from sandbox.level.document.model import ParticleDef
from sandbox.level.format.level_error import one_line
from sandbox.level.format.look import COLOUR_PATTERN, colour_of
from sandbox.level.format.picture import NoPicture, read_picture
from sandbox.level.kinds.body_def import BodyDef
from sandbox.level.reading.pictures import pictures_of

# Sizes in layout units.
ROW = 28.0
GAP = 5.0
PICK_WIDTH = 44.0
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
NONE, OTHER_COLOUR, OTHER_PICTURE = "automatic", "Another colour...", "Another file..."
YES_NO = {"yes": True, "no": False}


class PropertyOwner(Protocol):
    """Whose properties are shown: a screen that edits a level, a panel beside a run, a page with values of its own.

    folds: whether sections are folded away, by their titles, where the person said so.
    """

    ui: Ui
    folds: dict[str, bool]

    @property
    def document(self) -> Any:
        """What the properties are of, which their changes get: a document of the editor, a run."""
        ...

    @property
    def folder(self) -> Path | None:
        """The folder of the level's file, None: it has none."""
        return None

    def edit(self, label: str, change: Callable[[Any], Any], merge: str | None = None) -> bool:
        """Make a change; False, and a line for the person, where it cannot be made. merge: it goes on, by that name."""
        ...

    def end_merge(self) -> None:
        """Let the next change be a step of its own."""
        ...

    def say(self, text: str) -> None:
        """Show a line to the person."""
        ...

    def pick(self, kind: Pick, then: Callable[[Any], object]) -> None:
        """Let something be picked on a sheet, where there is one, and hand it on."""
        self.say("There is no sheet here to pick it on.")


class OwnValues(PropertyOwner):
    """The owner of properties whose changes keep their values themselves; a page of a screen has them."""

    def __init__(self, screen: PropertyOwner) -> None:
        self._screen, self.ui, self.folds = screen, screen.ui, {}

    @property
    def document(self) -> Any:
        """The screen's, of which menus tell."""
        return self._screen.document

    def edit(self, label: str, change: Callable[[Any], Any], merge: str | None = None) -> bool:
        """Make a change, or say why it cannot be made."""
        try:
            change(self.document)
        except EditError as error:
            self.say(sentence(error))
            return False
        return True

    def end_merge(self) -> None:
        """Do nothing: there are no steps."""

    def say(self, text: str) -> None:
        """Show a line to the person."""
        self._screen.say(text)


class PropertyWidgets:
    """Widgets of properties, by the names of their fields, in a holder; those who inherit it say where they stand.

    tall: the height of a row [layout units].
    """

    def __init__(self, owner: PropertyOwner, holder: Widget, tall: float = ROW) -> None:
        self._owner, self._ui, self._holder, self._tall = owner, owner.ui, holder, tall
        self.properties: dict[str, Property] = {}
        # What the slider of a property shows.
        self._slider_state: Callable[[Property], SliderState] = lambda each: SliderState(each.value)
        self._slid: tuple[str, float] | None = None
        self._is_stale = False
        self._structure: object = None
        self._sections: Sequence[Section] = ()
        self._y = 0.0
        self._forget()

    def _forget(self) -> None:
        self.fields: dict[str, tuple[Field, ...]] = {}
        self.pickers: dict[str, Picker] = {}
        self.boxes: dict[str, dict[str, CheckBox]] = {}
        self.choices: dict[str, Choice] = {}
        self.buttons: dict[str, Any] = {}
        self.removers: dict[str, Any] = {}
        self.keys: dict[str, KeyBox] = {}
        self.scrubs: dict[str, Scrub] = {}
        self.sliders: dict[str, Slider] = {}
        self._notes: dict[str, TextBlock] = {}
        self._named: dict[str, Any] = {}

    def show(self, sections: Sequence[Section]) -> None:
        """Show properties; their widgets are made again only where other fields are shown."""
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

    def is_folded(self, section: Section) -> bool:
        """Whether a section shows its heading alone."""
        return self._owner.folds.get(section.title, section.is_rare)

    def refresh(self) -> None:
        """Take what was slid, and bring fields that were typed into to the values that they gave."""
        self._take_slide()
        if self._is_stale:
            self._is_stale = False
            for each in list(self.properties.values()):
                self._show_value(each)

    def close(self) -> None:
        """Take what is being typed, and take the widgets away."""
        if self._ui.focus in [field for fields in self.fields.values() for field in fields]:
            self._ui.blur()
        self._holder.clear()
        self._named = {}

    # Making widgets.

    def _structure_of(self, each: Property) -> tuple[object, ...]:
        about = each.about
        shape = (about.kind, about.title, about.unit, about.choices, about.empty, each.axes, each.slides)
        lines = 0 if each.editable else self._lines(each)
        return each.field, each.remove is not None, lines, self._is_long(each), *shape

    def _lines(self, each: Property) -> int:
        """How many lines a text takes that is only shown."""
        return 1

    def _remake(self, sections: Sequence[Section]) -> None:
        focused = next((name for name, widget in self._named.items() if widget is self._ui.focus), "")
        self.close()
        self._forget()
        self._lay_out(sections)
        if focused in self._named:
            self._ui.focus_on(self._named[focused])

    def _lay_out(self, sections: Sequence[Section]) -> None:
        """Make the widgets of all that is shown, each in its place."""
        raise NotImplementedError

    def _keep(self, widget: Any, name: str) -> Any:
        self._named[name] = widget
        return widget

    def _rect(self, x: float, width: float, height: float | None = None) -> pygame.Rect:
        return self._ui.rect(x, self._y, width, self._tall if height is None else height)

    def _is_long(self, each: Property) -> bool:
        return each.about.kind in ("list", "pairs", "outlines", "words") and len(each.texts[0]) > TEXT_LENGTH

    def _make(self, each: Property, x: float, width: float) -> None:
        """Make what a property is changed by, so wide, in the present row."""
        about, ui, content = each.about, self._ui, self._holder
        if about.kind == "point":
            half = (width - GAP) / 2
            self.fields[each.field] = self._entry(each, x, half, 0), self._entry(each, x + half + GAP, half, 1)
        elif about.kind == "flags" or (about.kind == "yes_no" and not about.optional):
            self._add_boxes(each, x, width)
        elif about.kind in ("choice", "material", "touches", "colour", "thing", "picture", "yes_no"):
            self._add_choice(each, x, width)
        elif about.kind in ("part", "extras"):
            act = self._press_object if about.kind == "part" else self._ask_for_entry
            text, press = "" if about.kind == "part" else "Add\u2026", partial(act, each.field)
            button = ui.button(self._rect(x, width), text, press, content, style="segment", tip=about.tooltip)
            self.buttons[each.field] = self._keep(button, each.field)
        elif about.kind == "key":
            box = KeyBox(ui, self._rect(x, width), partial(self._press_key, each.field), content)
            box.tip = f"{about.tooltip} Click here, then press it; Delete takes it away."
            self.keys[each.field] = self._keep(box, each.field)
        elif self._is_long(each):
            text, offer = f"{len(each.value):,} of them", partial(self._offer_text, each.field)
            self._keep(ui.button(self._rect(x, width), text, offer, content, tip=about.tooltip), each.field)
        else:
            self.fields[each.field] = (self._entry(each, x, self._beside_pick(each, x, width), 0),)

    def _beside_pick(self, each: Property, x: float, width: float) -> float:
        """Make the button that lets the value be picked on the sheet, if there is one; the width that remains."""
        pick = each.about.pick
        if not pick:
            return width
        press = partial(self._owner.pick, pick, partial(self._set, each.field))
        place = self._rect(x + width - PICK_WIDTH, PICK_WIDTH)
        tip = "Drag it on the sheet" if pick == "box" else f"Click the {PICKED.get(pick, pick)} on the sheet"
        button = self._ui.button(place, "Pick", press, self._holder, style="segment", tip=tip)
        self._keep(button, f"{each.field} pick")
        return width - PICK_WIDTH - GAP

    def _add_label(self, each: Property, place: pygame.Rect) -> None:
        """Make a property's title, which is dragged where it is a number."""
        about, text = each.about, title_of(each)
        if each.editable and each.scrubs and about.kind in ("number", "integer"):
            scrub = Scrub(self._ui, place, text, partial(self._scrub, each.field), self._owner.end_merge, self._holder)
            scrub.tip = f"{about.tooltip} Drag to change it."
            self.scrubs[each.field] = scrub
            return
        self._ui.label(place, text, self._holder, "muted").tip = about.tooltip

    def _entry(self, each: Property, x: float, width: float, axis: int) -> Field:
        commit = partial(self._type, each.field, axis)
        field = self._ui.field(self._rect(x, width), "", commit, self._holder, TEXT_LENGTH)
        if each.about.empty:
            # A dash says all by itself.
            field.hint = each.about.empty if each.about.empty == DASH else f"({each.about.empty})"
            field.typed = ""
        axis_name = f"{each.axes[axis]}. " if each.about.kind == "point" else ""
        field.tip = axis_name + each.about.tooltip
        self._keep(field, f"{each.field} {axis}")
        return field

    def _add_slider(self, each: Property, place: pygame.Rect) -> None:
        slider = Slider(self._ui, place, partial(self._slide, each.field), self._end_slide, self._holder)
        slider.tip = each.about.tooltip
        self.sliders[each.field] = self._keep(slider, f"{each.field} slider")

    def _add_boxes(self, each: Property, x: float, width: float) -> None:
        labels = each.about.choices or ("yes",)
        wide = width / max(len(labels), 2)
        self.boxes[each.field] = {}
        for number, label in enumerate(labels):
            place = self._rect(x + number * wide, wide - GAP)
            box = CheckBox(self._ui, place, label, partial(self._tick, each.field, label), self._holder)
            self.boxes[each.field][label] = self._keep(box, f"{each.field} {label}")

    def _add_choice(self, each: Property, x: float, width: float) -> None:
        about, content = each.about, self._holder
        few = len(about.choices) in range(2, MOST_SIDE_BY_SIDE + 1) and not (about.optional or about.pick)
        width = self._beside_pick(each, x, width)
        if about.tips or (few and sum(map(len, about.choices)) <= SIDE_BY_SIDE):
            labels, tips = about.labels or about.choices, about.tips or (about.tooltip,) * len(about.choices)
            options = list(zip(about.choices, labels, tips, strict=True))
            row = self._ui.choice(self._rect(x, width), options, partial(self._choose, each.field), content)
            self.choices[each.field] = row
            for value, button in row.buttons.items():
                self._keep(button, f"{each.field} {value}")
            return
        picker = Picker(self._ui, self._rect(x, width), partial(self._pick, each.field), content)
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
            self.choices[name].show("" if is_mixed or each.value is None else each.value)
        if name in self.sliders:
            self.sliders[name].show_state(self._slider_state(each))
        if name in self.pickers:
            rows = self._rows(each)
            mixed_row = Row(MIXED.value, colour=MUTED)
            text = each.texts[0] if each.about.kind == "touches" else _choice_text(each)
            other = Row(text, swatch=unpacked(colour_of(text)) if text.startswith("#") else None)
            shown = mixed_row if is_mixed else next((row for row in rows if row.text == text), other)
            self.pickers[name].show_value(rows, shown)

    def _rows(self, each: Property) -> list[Row]:
        if each.about.kind == "touches":
            return [Row(EVERYTHING), Row(NOTHING), *(Row(name, self._toggle_of(each, name)) for name in self._groups)]
        about = each.about
        first = [Row(about.empty or NONE, colour=MUTED)] if about.optional else []
        if about.kind == "thing":
            level = self._owner.document.level
            return [*first, *(Row(body.id, _kind_of(body)) for body in level.bodies),
                    *(Row(particle.id, _kind_of(particle)) for particle in level.particles)]  # fmt: skip
        if about.kind == "picture":
            return [*first, *(Row(name) for name in sorted(self._pictures())), Row(OTHER_PICTURE)]
        if about.kind != "material":
            if about.kind == "colour":
                palette = [Row(name, swatch=unpacked(colour_of(name))) for name in about.choices]
                return [*first, *palette, Row(OTHER_COLOUR)]
            return first + [Row(text) for text in (YES_NO if about.kind == "yes_no" else about.labels or about.choices)]
        colours = material_colours(self._owner.document.level.materials)
        return [*first, *(Row(name, swatch=colour) for name, colour in colours.items())]

    def _pictures(self) -> dict[str, Path]:
        """Pictures that can be chosen, and their files: those beside the level, and those that things of it wear."""
        folder = self._owner.folder
        beside = {} if folder is None else {path.name: path for path in folder.glob("*.png")}
        return {name: Path(picture.path) for name, picture in pictures_of(self._owner.document.level).items()} | beside

    @property
    def _groups(self) -> tuple[str, ...]:
        return collision_groups(self._owner.document.level)

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
        self._owner.edit(f"{verb}: {each.about.title.lower()}", lambda document: each.set(document, wanted))

    def _press_key(self, name: str, key: str | None) -> None:
        if not self._set(name, key) or key is None:
            return
        code = next(code for code, name in KEYS.items() if name == key)
        action = action_of(code, 0, "play")
        if action is not None:
            self._owner.say(f"While this level is played, {key.upper()} drives; else it is: {tip_of(action, 'play')}.")

    def _scrub(self, name: str, steps: int) -> None:
        each = self.properties[name]
        value = each.stepped(steps)
        if value is not None:
            self._is_stale = True
            self._owner.edit(each.step, lambda document: each.set(document, value), merge=f"scrub {each.step} {name}")

    def _slide(self, name: str, value: float) -> None:
        # The mouse moves more often than a large level can be changed.
        self._slid = (name, value)

    def _take_slide(self) -> None:
        if self._slid is not None:
            (name, value), self._slid = self._slid, None
            each, self._is_stale = self.properties[name], True
            self._owner.edit(each.step, lambda document: each.set(document, value), merge=f"slide {each.step}")

    def _end_slide(self) -> None:
        self._take_slide()
        self._owner.end_merge()

    def _choose(self, name: str, value: str) -> None:
        self._set(name, value)

    def _set(self, name: str, value: Any) -> bool:
        each = self.properties.get(name)
        if each is None:
            return False
        self._is_stale = True
        remark = "" if each.remark is None else each.remark(self._owner.document, value)
        taken = self._owner.edit(each.step, lambda document: each.set(document, value))
        if taken and remark:
            self._owner.say(sentence(remark))
        return taken

    def _type(self, name: str, axis: int, text: str) -> bool:
        each = self.properties.get(name)
        if each is None:
            return False
        try:
            value = each.typed(text, axis)
        except EditError as error:
            self._owner.say(sentence(error))
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
        elif each.about.kind == "picture":
            self._choose_picture(name, text)
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
            self._owner.edit(f"Remove: {each.about.title}", each.remove)

    def _ask_for_entry(self, name: str) -> None:
        each = self.properties[name]

        def take(typed: str) -> str | None:
            try:
                each.set(self._owner.document, typed)
            except EditError as error:
                return sentence(error)
            self._owner.edit(f"Add: {typed.partition('=')[0].strip()}", lambda document: each.set(document, typed))
            return None

        ask(self._ui, each.about.title, HOW_TO_ADD, "", "Add", take)

    def _choose_picture(self, name: str, text: str) -> None:
        if text == OTHER_PICTURE:
            self._ask_for_picture(name)
            return
        worn = pictures_of(self._owner.document.level)
        fault = None if text in worn and self._set(name, worn[text]) else self._wear(name, self._pictures()[text])
        if fault is not None:
            self._owner.say(fault)

    def _wear(self, name: str, path: Path) -> str | None:
        """Let the picture of a file be worn; the line that says why not, None = it is."""
        try:
            self._set(name, read_picture(path))
        except NoPicture as error:
            return f"{one_line(path.name)}: {error}."
        return None

    def _ask_for_picture(self, name: str) -> None:
        folder = self._owner.folder or Path()
        hint = "The path of a PNG. It is copied beside the level when that is saved."
        ask(
            self._ui, self.properties[name].about.title, hint, "", "Take it",
            lambda text: self._wear(name, folder / os.path.expanduser(text)),
        )  # fmt: skip

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
                self._owner.say("The system's clipboard cannot be used.")

        def take() -> None:
            self._type(name, 0, copied_text())

        title = self.properties[name].about.title
        choices = [("Copy as text", put), ("Paste in its place", take)]
        choose(self._ui, title, "This list is too long for one line.", choices)


def title_of(each: Property) -> str:
    """What is written beside the value, with its unit."""
    unit = each.about.unit
    return f"{each.about.title} [{SQUARED.get(unit, unit)}]" if unit else each.about.title


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
