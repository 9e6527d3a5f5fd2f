"""Rows of the panel for the world as a whole: gravity, the hand, overlays, and where its energy is."""

from collections.abc import Callable, Mapping, Set
from dataclasses import replace
from typing import Any

from sandbox.app.draw.views.overlays import names_for
from sandbox.app.panel.contacts import ContactSettings
from sandbox.app.panel.panel_rows import INSIDE, MARGIN, ROW, PanelRows
from sandbox.app.panel.readings import with_unit
from sandbox.app.panel.view_row import ViewRow
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.field import DASH, typed_number
from sandbox.app.widgets.texts import TextBlock
from sandbox.level.format.limits import FRICTION_LIMIT, GRAVITY_LIMIT
from sandbox.physics.analysis.energy import gravity_energy, kinetic_energy, spring_energy
from sandbox.session.commands import SetGravity
from sandbox.tools.drag import STRENGTHS

LABEL = 46.0
GRAVITY_TIP = "How fast things fall; -9.81 is the Earth's gravity, at 0 they float"


class WorldRows:
    """What the rows show and do; choose: what is done with a strength of the "hand" and with a "view".

    set_contacts: what begins the run again where things touch otherwise.
    """

    def __init__(
        self, playback: Playback, say: Callable[[str], None], choose: Mapping[str, Callable[[str], None]],
        set_contacts: Callable[[ContactSettings], None],
    ) -> None:  # fmt: skip
        self.playback, self._say, self._choose, self._set_contacts = playback, say, choose, set_contacts

    def build(self, rows: PanelRows) -> None:
        """Make the widgets."""
        ui, back = rows.ui, rows.back
        self.gravity_x, self.gravity_y = rows.beside(
            ("Gravity x [m/s\u00b2]", GRAVITY_TIP, lambda text: self._type_gravity(text, 0)),
            ("Gravity y [m/s\u00b2]", GRAVITY_TIP, lambda text: self._type_gravity(text, 1)),
        )
        ui.label(rows.place(MARGIN, 0, LABEL, ROW - 2), "Touch", back, "muted")
        options = [("off", "Off", "Things pass through each other; the run starts over"),
                   ("on", "On", "Things touch each other; the run starts over")]  # fmt: skip
        place = rows.row(ROW - 2, 6, MARGIN + LABEL, INSIDE - LABEL)
        self.contacts = ui.choice(place, options, self._choose_contacts, back)
        self.friction, self.bounce = rows.beside(
            (
                "Friction",
                "Friction of everything without its own: 0 slides, 1 grips; the run starts over",
                self._type_friction,
            ),
            ("Bounce", "How much speed a bounce keeps, 0 to 1; the run starts over", self._type_bounce),
        )
        ui.label(rows.place(MARGIN, 0, LABEL, ROW - 2), "Hand", back, "muted")
        options = [(name, name.capitalize(), _strength_tip(strength)) for name, strength in STRENGTHS.items()]
        self.hand = ui.choice(rows.row(ROW - 2, 8, MARGIN + LABEL, INSIDE - LABEL), options, self._choose["hand"], back)
        ui.label(rows.place(MARGIN, 0, LABEL, ROW - 2), "Show", back, "muted")
        place, names = rows.row(ROW - 2, 8, MARGIN + LABEL, INSIDE - LABEL), names_for(self.playback.level)
        self.views = ViewRow(ui, place, names, self._choose["view"], back)
        columns = (rows.place(MARGIN, 0, INSIDE / 2, 34), rows.place(MARGIN + INSIDE / 2, 0, INSIDE / 2, 34))
        self.energies = [TextBlock(ui, place, "", back) for place in columns]
        rows.row(40)

    def refresh(self, is_look: bool) -> None:
        """Show what the world has now; its energies at a look."""
        gravity = self.playback.session.world.settings.gravity
        self.gravity_x.show(f"{gravity[0]:g}")
        self.gravity_y.show(f"{gravity[1]:g}")
        contacts = ContactSettings.of(self.playback.level)
        self.contacts.show("on" if contacts.is_on else "off")
        self.friction.show(f"{contacts.friction:g}" if contacts.is_on else DASH)
        self.bounce.show(f"{contacts.restitution:g}" if contacts.is_on else DASH)
        if is_look:
            self._show_energies()

    def show_choices(self, strength: str, views: Set[str]) -> None:
        """Show the strength of the hand, and which overlays are seen."""
        self.hand.show(strength)
        self.views.show(views)

    def _show_energies(self) -> None:
        world = self.playback.session.world
        found = kinetic_energy(world), spring_energy(world), gravity_energy(world), self.playback.dissipation.energy
        kinetic, springs, height, lost = (with_unit(value, "J") for value in found)
        self.energies[0].show_text(f"moving {kinetic}\nin springs {springs}")
        self.energies[1].show_text(f"in height {height}\nlost {lost}")

    def _choose_contacts(self, way: str) -> None:
        self._change_contacts(is_on=way == "on")

    def _type_friction(self, text: str) -> bool:
        value = typed_number(self._say, text, "Friction", 0.0, FRICTION_LIMIT)
        return value is not None and self._change_contacts(is_on=True, friction=value)

    def _type_bounce(self, text: str) -> bool:
        value = typed_number(self._say, text, "Bounce", 0.0, 1.0)
        return value is not None and self._change_contacts(is_on=True, restitution=value)

    def _change_contacts(self, **changes: Any) -> bool:
        before = ContactSettings.of(self.playback.level)
        if replace(before, **changes) != before:
            self._set_contacts(replace(before, **changes))
        return False

    def _type_gravity(self, text: str, axis: int) -> bool:
        value = typed_number(self._say, text, "Gravity", -GRAVITY_LIMIT, GRAVITY_LIMIT)
        if value is None:
            return False
        x, y = self.playback.session.world.settings.gravity
        self.playback.submit(SetGravity((value, y) if axis == 0 else (x, value)))
        return True


def _strength_tip(strength: float) -> str:
    return f"Pulls with at most {strength:g} N for each kg of what it holds, from the next hold on"
