"""Panel: how firm bodies are, Cs and Cd by a pad or sliders and what is proven of them; solver, gravity, settings."""

from collections.abc import Callable, Iterable, Mapping, Set
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from sandbox.app.base.sag_map import PLAIN, CoefficientScale, own_of, scale_of
from sandbox.app.base.sentences import sentence
from sandbox.app.draw.colours import TEXT, WARNING
from sandbox.app.panel.coefficient_pad import STIFFNESSES, CoefficientPad, PadState
from sandbox.app.panel.contacts import ContactSettings
from sandbox.app.panel.engineers_rows import EngineersRows
from sandbox.app.panel.firmness_rows import ALL_BODIES, FirmnessRows
from sandbox.app.panel.panel_rows import ENTRY_WIDTH, GAP, INSIDE, MARGIN, PANEL_WIDTH, ROW, PanelRows, PanelSection
from sandbox.app.panel.play_rows import PlayRows
from sandbox.app.panel.readings import number, stability_words
from sandbox.app.panel.sweeps.pad_sweeps import PadMaps, PadSweeps
from sandbox.app.panel.world_rows import WorldRows
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.field import DASH
from sandbox.app.widgets.picker import WordPicker
from sandbox.app.widgets.property_widgets import PropertyOwner
from sandbox.app.widgets.scroll import ScrollArea
from sandbox.app.widgets.slider import SliderState
from sandbox.app.widgets.texts import TextBlock
from sandbox.app.widgets.ui import Ui
from sandbox.editor.document import EditError
from sandbox.editor.panel.field_info import SAG
from sandbox.editor.panel.material_properties import COEFFICIENTS
from sandbox.editor.panel.property import MIXED, Property, Section, in_range
from sandbox.level.document.model import Level
from sandbox.level.format.quantities import significant
from sandbox.physics.analysis.stability import (
    CoefficientLimits,
    CoefficientZones,
    coefficient_limits,
    coefficient_zones,
)
from sandbox.physics.marks import LAW_HOOKE
from sandbox.physics.softness.body_motion import BodyMotion
from sandbox.physics.softness.firmness import WORDS, firm_bodies
from sandbox.session.commands import Command, SetCoefficients

# Sizes in layout units.
PAD_HEIGHT = 214.0
# Cs and Cd are set by the pad where so much of the panel's height is left for their rows.
PAD_ROOM = 334.0
SPRINGS_CHOICE = 118.0
HEADING = 26.0
SIDES_HEIGHT = 38.0
# Of Cs and Cd as they are shown.
DIGITS = 6
# Frames between two looks at all springs for changes that no command of the person's made: those of a replay.
LOOK_EVERY = 15
ALL_MATERIALS = "All springs"
# What all is under that play does without, and that the level's text does not ask for.
MORE, MORE_TITLE = "more", "More"

NO_SPRING = "there is no spring here that Cs and Cd apply to"
NOTHING_LEFT = "Nothing of it is left here: its springs are cut, broken or gone. R begins again."


def has_use(level: Level) -> bool:
    """Whether hands may do anything in a level that the panel is for."""
    return level.hands is None or any(map(level.hands.allows, ("firmness", "material", "air", "solver")))


@dataclass
class PanelShape:
    """The shape of the panel: springs by "pad" or "sliders", None: as room allows; which sections are open.

    open: by name, MORE too; of those that are not in it all but MORE are open.
    """

    springs: str | None = None
    open: dict[str, bool] = field(default_factory=dict)
    # Of two runs the one that it shows: "A" or "B".
    side: str | None = None
    # What is measured of the level for the pad.
    sweeps: PadSweeps = field(default_factory=PadSweeps)


class Panel(PropertyOwner):
    """The panel at the right of a window; `say` shows a line to the person.

    choose: what is done with a strength of the "hand", with a "view" that is shown or no longer, with how "springs" are
    set ("pad" or "sliders"), that they are to "melt", the section whose "fold" changes, another tick "rate" [1/s], and
    of two runs the "side" to show. touch: what begins the run again where things touch otherwise.
    """

    def __init__(
        self, ui: Ui, playback: Playback, say: Callable[[str], None], choose: Mapping[str, Callable[[str], None]],
        top: float, height: float, shape: PanelShape, set_contacts: Callable[[ContactSettings], None],
    ) -> None:  # fmt: skip
        self.ui, self.playback, self.choose, self._say = ui, playback, choose, say
        self.folds = {}
        self.pad: CoefficientPad | None = None
        self.maps: PadMaps | None = None
        self._sweeps = shape.sweeps
        self._zones: CoefficientZones | None = None
        self._zones_of: tuple[object, ...] = ()
        self.material = self._first_material()
        self._gesture: int | None = None
        self._limits: CoefficientLimits | None = None
        self._limits_of: tuple[object, ...] = ()
        self._limit_labels: dict[str, TextBlock] = {}
        self._refreshes = -1
        self._refreshed_at: tuple[object, ...] = ()
        hands = playback.level.hands
        self._open = dict.fromkeys(SECTIONS, True) | {MORE: False} | shape.open
        # What is for engineers alone is shown where MORE is open, which levels with hands do without.
        self._is_plain = (hands is not None or not self._open[MORE]) and shape.sweeps.measure is None
        self.firmness = FirmnessRows(playback, say, self._is_plain)
        if playback.level.look is not None and playback.level.look.material is not None:
            self.firmness.speak_of(self.material)
        self.engineers: EngineersRows = EngineersRows(playback, self, choose["rate"], self.firmness, self._both)
        self.world: WorldRows = WorldRows(playback, self, choose, set_contacts)
        self.play = PlayRows(playback, lambda: choose["melt"](""), self._take_home)
        self.springs: _SpringsSection = _SpringsSection(self)
        self._offered = self._present()
        self._scale_of: tuple[object, ...] = ()
        self._scale: CoefficientScale = PLAIN
        self._body: BodyMotion | None = None
        self.by_pad = shape.springs == "pad"
        # Without a choice of the person's the pad is taken where this height has room for it.
        self._height = height if shape.springs is None else 0.0
        background = ui.panel(ui.rect(ui.units[0] - PANEL_WIDTH, top, PANEL_WIDTH, height))
        # What does not fit is scrolled to.
        self.area = ScrollArea(ui, ui.rect(0, 0, PANEL_WIDTH, height), background)
        self.rows = rows = PanelRows(ui, self.area.content)
        if shape.side is not None:
            self._build_sides(shape.side)
        if self.firmness.shown:
            self._build_firmness()
        self.play.build(rows)
        self.sections = {name: section.make(self) for name, section in SECTIONS.items()}
        if hands is None:
            asked = [name for name, each in SECTIONS.items() if each.is_asked_for(playback.level.description)]
        else:
            asked = ["springs"] if hands.allows("material") else []
        self._build_sections(asked)
        others = [name for name in SECTIONS if name not in asked]
        if hands is None:
            more = partial(choose["fold"], MORE)
            rows.section(MORE_TITLE, self._open[MORE], more, lambda: self._build_sections(others))
        else:
            rows.unseen(lambda: self._build_sections(others))
        self.area.set_height(ui.px(rows.y))
        self.refresh()

    # Building.

    def is_open(self, name: str) -> bool:
        """Whether a section, by its name in SECTIONS, or MORE is unfolded."""
        return self._open[name]

    def _build_sections(self, names: Iterable[str]) -> None:
        for name in names:
            fold, made = partial(self.choose["fold"], name), self.sections[name]
            self.rows.section(SECTIONS[name].title, self._open[name], fold, partial(made.build, self.rows))

    def _build_sides(self, side: str) -> None:
        """Make the buttons that choose which of two runs the panel shows."""
        rows = self.rows
        options = [(name, name, f"Show and set the springs and the solver of {name}") for name in ("A", "B")]
        self.sides = self.ui.choice(rows.row(SIDES_HEIGHT - 8, 8), options, self.choose["side"], rows.back)
        self.sides.show(side)

    def attach(self, playback: Playback) -> None:
        """Show and change another run of the same level."""
        self.playback = self.firmness.playback = self.play.playback = playback
        for section in self.sections.values():
            section.playback = playback

    def _build_firmness(self) -> None:
        ui, rows, firmness = self.ui, self.rows, self.firmness
        ui.label(rows.place(MARGIN, 4, 90, 18), "FIRMNESS", rows.back, "heading")
        place = rows.row(ROW, 6, MARGIN + 90, INSIDE - 90)
        firmness.menu = WordPicker(ui, place, firmness.offered, firmness.body, self.choose_body, rows.back)
        words = [(word, word.capitalize(), _word_tip(sag)) for word, sag in WORDS.items()]
        firmness.words = ui.choice(rows.row(ROW + 4, 6), words, firmness.choose_word, rows.back)
        width = ENTRY_WIDTH - 20
        firmness.text = TextBlock(ui, rows.place(MARGIN, 0, INSIDE - width - 12, 52), "", rows.back, 13.0, TEXT)
        x = MARGIN + INSIDE - width
        ui.label(rows.place(x, -2, width, 15), "Sag [%]", rows.back, "muted")
        firmness.sag = ui.field(rows.place(x, 14, width, ROW - 2), "", firmness.type_sag, rows.back, 24)
        firmness.sag.tip = SAG.tooltip
        rows.row(52, 6)

    def build_springs(self) -> None:
        """Make the rows that set Cs and Cd, by the pad where it is whole in sight."""
        ui, rows = self.ui, self.rows
        self.by_pad = self.by_pad or self._height - rows.y >= PAD_ROOM
        ways = [("pad", "Pad", "Cs and Cd on a map of what they do"), ("sliders", "Sliders", "Cs and Cd one by one")]
        place = rows.place(MARGIN + INSIDE - SPRINGS_CHOICE, -HEADING - 2, SPRINGS_CHOICE, 22)
        self.ways = ui.choice(place, ways, self.choose["springs"], rows.back)
        self.ways.show("pad" if self.by_pad else "sliders")
        names = [ALL_MATERIALS, *self._material_names()]
        chosen = ALL_MATERIALS if self.material is None else self._material_names()[self.material]
        width = INSIDE if self._is_plain or not self.by_pad else INSIDE / 2 - 4
        if self.by_pad:
            place = rows.place(MARGIN + INSIDE - width, 0, width, 30)
        self.menu = WordPicker(ui, rows.row(30, 6, width=width), names, chosen, self._choose_material, rows.back)
        if self.by_pad:
            if not self._is_plain:
                self.maps = PadMaps(ui, place, self.playback, self._sweeps, rows.back)
            place = rows.row(PAD_HEIGHT - 6, 6, MARGIN - 8, INSIDE + 12)
            self.pad = CoefficientPad(ui, place, self._move, self.end_merge, rows.back, self._is_plain)
        for row, name in enumerate(() if self.by_pad else COEFFICIENTS):
            self._limit_labels[name] = TextBlock(ui, rows.aside(row), "", rows.back, 11.0, WARNING)
        self.form = rows.form(self, [self._coefficients()], self._slider_state)
        self.note = TextBlock(ui, rows.row(28, 2), "", rows.back)
        self.feel = ui.button(rows.row(ROW, 8, width=(INSIDE - GAP) / 2), "Feel ...", self._feel, rows.back)
        self.feel.tip = "How a thing comes back once it is let go, and Cs and Cd for the feel that you want"

    def _first_material(self) -> int | None:
        """The material that the level's text speaks of, else that of the most springs; None: there is none."""
        world, look = self.playback.session.world, self.playback.level.look
        if look is not None and look.material in world.material_names:
            return list(world.material_names).index(look.material)
        counts = np.bincount(world.material[world.spring_active & (world.material >= 0) & (world.law != LAW_HOOKE)])
        return int(np.argmax(counts)) if len(counts) else None

    def _material_names(self) -> list[str]:
        return list(self.playback.session.world.material_names)

    # Showing.

    def refresh(self) -> None:
        """Show the world's present values."""
        world = self.playback.session.world
        settings = world.settings
        self._follow_what_joins()
        self.play.refresh()
        is_look = self._refreshes % LOOK_EVERY == 0 or self.playback.clock.paused
        self._refreshes += 1
        self.firmness.refresh(self._refreshes % LOOK_EVERY == 0)
        for section in self.sections.values():
            section.refresh(is_look)
        self.form.refresh()
        if self.maps is not None and self.pad is not None:
            self.maps.refresh(self.playback, self.material, self.pad)
        fresh = (self.playback.revision, self.material)
        if fresh == self._refreshed_at and self._refreshes % LOOK_EVERY:
            return
        self._refreshed_at = fresh
        inputs = (world.stiffness, world.damping, world.spring_active, world.inverse_mass)
        curve, word = self.firmness.curve_of(self.material), self.firmness.word_of(self.material)
        key = (settings, self.material, self.firmness.body, curve, word, *(array.tobytes() for array in inputs))
        if key != self._limits_of:
            self._limits_of = key
            self._limits = coefficient_limits(world, self.material)
            self._find_scale()
            self._find_zones()
            self._show_springs()

    def show_choices(self, strength: str, views: Set[str]) -> None:
        """Show the strength of the hand, and which overlays are seen."""
        self.world.show_choices(strength, views)

    def _chosen(self) -> np.ndarray:
        world = self.playback.session.world
        chosen = world.material >= 0 if self.material is None else world.material == self.material
        return np.flatnonzero(chosen & (world.law != LAW_HOOKE) & world.spring_active)

    def _coefficients(self) -> Section:
        """Cs and Cd of the chosen springs."""
        world, chosen, found = self.playback.session.world, self._chosen(), []
        for name, about in COEFFICIENTS.items():
            values = getattr(world, name)[chosen]
            value: Any = None
            if len(values):
                value = MIXED if values.min() != values.max() else significant(values[0], DIGITS)
            write = partial(self._set, name)
            found.append(Property(name, replace(about, empty=DASH), value, write, slides=not self.by_pad))
        return Section("", tuple(found))

    def _show_springs(self) -> None:
        world, chosen, limits = self.playback.session.world, self._chosen(), self._limits
        assert limits is not None
        stiffness, damping = world.stiffness[chosen], world.damping[chosen]
        if self.by_pad:
            self._show_on_pad(stiffness, damping)
        self.form.show([self._coefficients()])
        for name, label in self._limit_labels.items():
            limit = getattr(limits, name) if len(chosen) else None
            label.show_text(f"limit {number(limit)}" if limit is not None and limit < 1.0 else "")
        if not len(chosen):
            self.engineers.show_spring(None)
            self.note.show_text(self._no_spring_note())
            return
        self.engineers.show_spring((stiffness, damping))
        self.note.show_text(stability_words(world.settings.solver, limits, stiffness, damping, self._is_plain))

    def _slider_state(self, each: Property) -> SliderState:
        """The middle of the chosen springs' values, what is proven of them, and what the level gives them."""
        values = getattr(self.playback.session.world, each.field)[self._chosen()]
        if not len(values):
            return SliderState(enabled=False)
        own, limit = self._own(), None if self._limits is None else getattr(self._limits, each.field)
        of_level = None if own is None else own[each.field == "damping"]
        return SliderState(float(np.median(values)), limit, of_level, each.value is MIXED, True, self._scale)

    def _own(self) -> tuple[float, float] | None:
        """Cs and Cd that the level gives the material, None where it gives none."""
        if self.material is None:
            return None
        return own_of(self.playback.level, self._material_names()[self.material])

    def _find_scale(self) -> None:
        """Find the axes on which most is seen of the body that is spoken of; they stay while something is dragged."""
        name = self.firmness.body_of(self.material)
        body = None if name is None else self.firmness.motion_of(name)
        key = (body, name, self.material)
        if self._gesture is not None or key == self._scale_of:
            return
        self._scale_of, self._body, self._scale = key, body, PLAIN
        if name is not None and body is not None and body.tells_sag:
            self._scale = scale_of(body, self.firmness.word_pairs(name, body), self._own() or ())

    def _find_zones(self) -> None:
        """Find the pad's zones again, where what they depend on has changed: not the chosen springs' own Cs and Cd."""
        if not self.by_pad or self._is_plain:
            return
        world = self.playback.session.world
        others = world.material != self.material if self.material is not None else world.material < 0
        arrays = (world.stiffness[others], world.damping[others], world.spring_active, world.inverse_mass)
        key = (world.settings, self.material, world.constraint_count, *(array.tobytes() for array in arrays))
        if key != self._zones_of:
            self._zones_of, self._zones = key, coefficient_zones(world, self.material, STIFFNESSES)

    def _show_on_pad(self, stiffness: np.ndarray, damping: np.ndarray) -> None:
        assert self.pad is not None
        if not len(stiffness):
            self.pad.show_state(self.pad.state._replace(enabled=False), self._zones)
            return
        is_mixed = bool(stiffness.min() != stiffness.max() or damping.min() != damping.max())
        pair = float(np.median(stiffness)), float(np.median(damping))
        name = None if self._body is None else self.firmness.body_of(self.material)
        subject = "" if name is None else self.firmness.subject_of(name)
        word = self.firmness.word_of(self.material) if subject else ""
        self.pad.show_state(
            PadState(*pair, is_mixed, True, self._own(), self._scale, self._body, subject, word), self._zones
        )  # fmt: skip

    def _no_spring_note(self) -> str:
        world = self.playback.session.world
        hooke = (world.law == LAW_HOOKE) & ((world.material == self.material) | (self.material is None))
        if not hooke.any():
            return NOTHING_LEFT if (world.material >= 0).any() else "There are no springs."
        first = int(np.flatnonzero(hooke)[0])
        k, c = world.hooke_stiffness[first], world.hooke_damping[first]
        return f"Classic Hooke springs, k = {k:g} N/m, c = {c:g} N s/m: Cs and Cd do not apply."

    # Changing.

    @property
    def document(self) -> Playback:
        """The run, of which properties of the panel are."""
        return self.playback

    def edit(self, label: str, change: Callable[[Playback], Command | None], merge: str | None = None) -> bool:
        """Give the run the command that a change comes to; None: it was seen to."""
        try:
            command = change(self.playback)
        except EditError as error:
            self.say(sentence(error))
            return False
        if command is not None:
            if merge is not None and self._gesture is None:
                self._gesture = self.playback.session.new_gesture()
            self._submit(command, None if merge is None else self._gesture)
        return command is not None

    def end_merge(self) -> None:
        """End the run of changes that count as one gesture."""
        self._gesture = None

    def say(self, text: str) -> None:
        """Show a line to the person."""
        self._say(text)

    def _both(self, stiffness: float | None, damping: float | None) -> Command:
        """The command that sets Cs and Cd (None: leave) of the chosen springs. Raises EditError where there are none.

        It says how a change of all springs is taken back, where there are several materials.
        """
        chosen = self._chosen()
        if not len(chosen):
            raise EditError(NO_SPRING)
        count = len(np.unique(self.playback.session.world.material[chosen]))
        if self.material is None and count > 1:
            self.say(f"This changes the springs of all {count} materials; Ctrl+Z takes it back.")
        return SetCoefficients(stiffness=stiffness, damping=damping, material=self.material)

    def _set(self, name: str, playback: Playback, value: float) -> Command:
        value = in_range(COEFFICIENTS[name], value)
        return self._both(value, None) if name == "stiffness" else self._both(None, value)

    def _move(self, stiffness: float, damping: float) -> None:
        """Set Cs and Cd to where the pad was dragged."""
        self.edit("Cs and Cd", lambda _: self._both(stiffness, damping), merge="pad")

    def _submit(self, command: Command, gesture: int | None = None) -> None:
        self.playback.submit(command, gesture)

    @property
    def lacks_rows(self) -> bool:
        """Whether a body has joined a run that had none, so that it is to be laid out anew."""
        return self.firmness.may and not self.firmness.shown and bool(self.firmness.bodies)

    def _present(self) -> tuple[object, object]:
        world = self.playback.session.world
        return world.material_names, tuple(body.name for body in firm_bodies(world))

    def _follow_what_joins(self) -> None:
        """Offer the materials and bodies that there are: some join a run with what is dropped, and go again."""
        if self._present() == self._offered:
            return
        self._offered, names = self._present(), self._material_names()
        if self.material is not None and self.material >= len(names):
            self.material = None
        chosen = ALL_MATERIALS if self.material is None else names[self.material]
        self.menu.offer([ALL_MATERIALS, *names], chosen)
        self.firmness.offer_bodies()

    def choose_material(self, material: int | None) -> None:
        """Show and change the springs of a material (index); None = all."""
        self.material = material
        if self.firmness.body != ALL_BODIES and material != self.firmness.material_of(self.firmness.body):
            self.firmness.choose_body(ALL_BODIES)
            if self.firmness.shown:
                self.firmness.menu.show_chosen(ALL_BODIES)
        self.menu.show_chosen(ALL_MATERIALS if material is None else self._material_names()[material])

    def _take_home(self) -> None:
        """Show code for another loop or engine with the body that the panel is about."""
        # What works out the numbers of other engines, which a window does without until then.
        from sandbox.app.panel.take_home_page import show_take_home

        world, name = self.playback.session.world, self.firmness.body_of(self.material)
        has_form = name in {body.name for body in world.forms}
        show_take_home(self.ui, world, self.say, name if has_form else None)

    def _feel(self) -> None:
        """Show how the body feels that the panel is about."""
        from sandbox.app.panel.feel.feel_page import show_feel

        show_feel(self.ui, self.playback, self.say, self.firmness.body_of(self.material))

    def choose_body(self, name: str) -> None:
        """Show and change a body, by its name, or all, and the springs that it is made of."""
        if not self.firmness.shown or name not in (ALL_BODIES, *self.firmness.bodies):
            return
        self.firmness.choose_body(name)
        self.firmness.menu.show_chosen(name)
        material = self.firmness.material_of(name)
        if material is not None:
            self.choose_material(material)

    def choose_particle(self, particle: int) -> None:
        """Show and change the body of a particle, or what it hangs on, where that is nothing that stands by itself."""
        world = self.playback.session.world
        name = self.firmness.body_at(particle)
        if name is not None:
            self.choose_body(name)
            return
        holds = world.spring_active & (world.material >= 0)
        springs = np.flatnonzero(holds & ((world.particle_a == particle) | (world.particle_b == particle)))
        if len(springs):
            self.choose_material(int(world.material[springs[0]]))

    def pointed_springs(self) -> np.ndarray | None:
        """The springs (m,) of the material or body that the mouse points at in a menu; None: it points at none."""
        world, row = self.playback.session.world, self.menu.pointed
        if row is not None:
            of_material = world.material >= 0
            is_all = row.text == ALL_MATERIALS
            return of_material if is_all else world.material == self._material_names().index(row.text)
        row = self.firmness.menu.pointed if self.firmness.shown else None
        return None if row is None else self.firmness.springs_of(row.text)

    def _choose_material(self, name: str) -> None:
        self.choose_material(None if name == ALL_MATERIALS else self._material_names().index(name))


def _word_tip(sag: float) -> str:
    return f"Sags by {100.0 * sag:g} % as it stands or hangs" if sag else "Perfectly rigid: it gives way to nothing"


class _SpringsSection:
    """The section of springs, whose rows are the panel's own."""

    def __init__(self, panel: Panel) -> None:
        self.playback, self._panel = panel.playback, panel

    def build(self, rows: PanelRows) -> None:
        """Make the widgets."""
        self._panel.build_springs()

    def refresh(self, is_look: bool) -> None:
        """Do nothing: the panel itself shows what has changed in these rows."""


# Sections that fold, in the order in which the panel shows them: first those that the level's text asks for.
SECTIONS = {
    "springs": PanelSection("Springs", lambda panel: panel.springs, ("Cs", "Cd")),
    "engineers": PanelSection("For engineers", lambda panel: panel.engineers),
    "world": PanelSection("World", lambda panel: panel.world),
}
