"""Rows of the panel for the world as a whole: gravity, contacts, the hand, overlays, and where its energy is."""

from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import replace
from functools import partial
from typing import Any

import pygame

from sandbox.app.base.shortcuts import tip_of
from sandbox.app.draw.overlays import names_for
from sandbox.app.panel.contacts import ContactSettings
from sandbox.app.panel.panel_rows import BESIDE, INSIDE, MARGIN, ROW, PanelRows
from sandbox.app.panel.readings import with_unit
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.field import DASH
from sandbox.app.widgets.property_widgets import PropertyOwner
from sandbox.app.widgets.texts import TextBlock
from sandbox.app.widgets.ui import Ui
from sandbox.editor.panel.field_info import FieldInfo, fields_of
from sandbox.editor.panel.property import Property, Section, in_range
from sandbox.level.document.model import ContactsDef, Settings
from sandbox.physics.analysis.energy import gravity_energy, kinetic_energy, spring_energy
from sandbox.session.commands import Command, SetGravity
from sandbox.tools.drag import STRENGTHS

_AXES = tuple(replace(fields_of(Settings)["gravity"], kind="number", title=f"Gravity {axis}") for axis in "xy")
_TOUCH = FieldInfo(
    "choice", "Touch", choices=("off", "on"), labels=("Off", "On"),
    tips=("Things pass through each other; the run starts over", "Things touch each other; the run starts over"),
)  # fmt: skip
_FRICTION, _BOUNCE = (
    replace(fields_of(ContactsDef)[name], tooltip=f"{tip}; the run starts over.", empty=DASH)
    for name, tip in (
        ("friction", "Friction of everything without its own: 0 slides, 1 grips"),
        ("restitution", "How much speed a bounce keeps, 0 to 1"),
    )
)
_HAND = FieldInfo(
    "choice", "Hand", choices=tuple(STRENGTHS), labels=tuple(name.capitalize() for name in STRENGTHS),
    tips=tuple(
        f"Pulls with at most {strength:g} N for each kg of what it holds, from the next hold on"
        for strength in STRENGTHS.values()
    ),
)  # fmt: skip
ICON = 17.0
GAP = 3.0


class WorldRows:
    """What the rows show and do; choose: what is done with a strength of the "hand" and with a "view".

    set_contacts: what begins the run again where things touch otherwise.
    """

    def __init__(
        self, playback: Playback, owner: PropertyOwner, choose: Mapping[str, Callable[[str], None]],
        set_contacts: Callable[[ContactSettings], None],
    ) -> None:  # fmt: skip
        self.playback, self._owner, self._choose, self._set_contacts = playback, owner, choose, set_contacts
        self._strength = ""
        self._shown: tuple[object, ...] = ()

    def build(self, rows: PanelRows) -> None:
        """Make the widgets."""
        self.form = rows.form(self._owner, [self._section()])
        rows.ui.label(rows.place(MARGIN, 0, BESIDE, ROW - 2), "Show", rows.back, "muted")
        place, names = rows.row(ROW - 2, 8, MARGIN + BESIDE, INSIDE - BESIDE), names_for(self.playback.level)
        self.views = ViewRow(rows.ui, place, names, self._choose["view"], rows.back)
        columns = (rows.place(MARGIN, 0, INSIDE / 2, 34), rows.place(MARGIN + INSIDE / 2, 0, INSIDE / 2, 34))
        self.energies = [TextBlock(rows.ui, place, "", rows.back) for place in columns]
        rows.row(40)

    def refresh(self, is_look: bool) -> None:
        """Show what the world has now; its energies at a look."""
        fresh = (self.playback.session.world.settings.gravity, self.playback.level.contacts, self._strength)
        if fresh != self._shown:
            self._shown = fresh
            self.form.show([self._section()])
        self.form.refresh()
        if is_look:
            world = self.playback.session.world
            found = kinetic_energy(world), spring_energy(world), gravity_energy(world), self.playback.dissipation.energy
            kinetic, springs, height, lost = (with_unit(value, "J") for value in found)
            self.energies[0].show_text(f"moving {kinetic}\nin springs {springs}")
            self.energies[1].show_text(f"in height {height}\nlost {lost}")

    def show_choices(self, strength: str, views: Set[str]) -> None:
        """Show the strength of the hand, and which overlays are seen."""
        self._strength = strength
        self.views.show(views)

    def _section(self) -> Section:
        gravity, contacts = self.playback.session.world.settings.gravity, ContactSettings.of(self.playback.level)
        friction, bounce = (contacts.friction, contacts.restitution) if contacts.is_on else (None, None)
        found = [
            Property(f"gravity_{axis}", about, gravity[number], partial(_set_gravity, number))
            for number, (axis, about) in enumerate(zip("xy", _AXES, strict=True))
        ]
        found += [
            Property("contacts", _TOUCH, "on" if contacts.is_on else "off", self._set_touch),
            Property("friction", _FRICTION, friction, partial(self._set_contact, _FRICTION, "friction"), scrubs=False),
            Property("bounce", _BOUNCE, bounce, partial(self._set_contact, _BOUNCE, "restitution"), scrubs=False),
            Property("hand", _HAND, self._strength, lambda _, name: self._choose["hand"](name)),
        ]
        return Section("", tuple(found))

    def _set_touch(self, playback: Playback, way: str) -> None:
        self._change_contacts(is_on=way == "on")

    def _set_contact(self, about: FieldInfo, name: str, playback: Playback, value: float) -> None:
        self._change_contacts(is_on=True, **{name: in_range(about, value)})

    def _change_contacts(self, **changes: Any) -> None:
        before = ContactSettings.of(self.playback.level)
        if replace(before, **changes) != before:
            self._set_contacts(replace(before, **changes))


def _set_gravity(axis: int, playback: Playback, value: float) -> Command:
    x, y = playback.session.world.settings.gravity
    value = in_range(_AXES[axis], value)
    return SetGravity((value, y) if axis == 0 else (x, value))


class ViewRow:
    """The buttons of overlays; toggle: what a press does with the name of one."""

    def __init__(
        self, ui: Ui, rect: pygame.Rect, names: Sequence[str], toggle: Callable[[str], None], container: Any
    ) -> None:  # fmt: skip
        self.buttons = {}
        step = (rect.width + ui.px(GAP)) / len(names)
        for index, name in enumerate(names):
            left, right = round(index * step), round((index + 1) * step - ui.px(GAP))
            place = pygame.Rect(rect.left + left, rect.top, right - left, rect.height)
            self.buttons[name] = ui.button(
                place, "", partial(toggle, name), container, style="segment", icon=name, icon_size=ICON,
                tip=tip_of(name, "play"),
            )  # fmt: skip

    def show(self, shown: Set[str]) -> None:
        """Mark the views that are on."""
        for name, button in self.buttons.items():
            button.is_selected = name in shown
