"""Panel: Cs and Cd by a pad or by sliders, with their Hz reading and what is proven; gravity, solver and settings."""

import math
from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass, field

import numpy as np
import pygame

from sandbox.app.draw.colours import WARNING
from sandbox.app.edit.side.scroll import ScrollArea
from sandbox.app.play.coefficient_pad import STIFFNESSES, CoefficientPad, PadState
from sandbox.app.play.firmness_rows import ALL_BODIES, FirmnessRows
from sandbox.app.play.playback import Playback
from sandbox.app.play.response_curve import ResponseCurve
from sandbox.app.play.view_row import ViewRow
from sandbox.app.sentences import sentence
from sandbox.app.sweeps.pad_maps import PadMaps
from sandbox.app.sweeps.pad_sweeps import PadSweeps
from sandbox.app.widgets.fields import Field, typed_number
from sandbox.app.widgets.fold import FoldHeading
from sandbox.app.widgets.painted import TextBlock
from sandbox.app.widgets.sliders import LogSlider
from sandbox.app.widgets.ui import Ui
from sandbox.level.format.limits import GRAVITY_LIMIT, SUBSTEPS
from sandbox.physics.analysis.coefficient_zones import CoefficientZones, coefficient_zones
from sandbox.physics.energy import gravity_energy, kinetic_energy, spring_energy
from sandbox.physics.equation import coefficients_from_frequency, frequency_from_coefficients
from sandbox.physics.firmness import WORDS
from sandbox.physics.settings import AUTO
from sandbox.physics.solvers import SOLVERS
from sandbox.physics.stability import CoefficientLimits, coefficient_limits
from sandbox.physics.world import LAW_HOOKE
from sandbox.session.commands import Command, SetCoefficients, SetGravity, SetSolver
from sandbox.tools.drag import STRENGTHS

# Sizes in layout units.
PANEL_WIDTH = 292.0
MARGIN = 18.0
INSIDE = PANEL_WIDTH - 2 * MARGIN
ROW = 28.0
ENTRY_WIDTH = 82.0
HAND_LABEL = 46.0
# Height that everything takes; in a lower window rows and gaps shrink by the same part.
FULL_HEIGHT = 636.0
# Rows shrink to no less than this part of their height: text would be cut.
TIGHTEST = 0.94
# What is added where there are bodies whose firmness can be set; by the pad, in place of sliders; and what of the full
# height the section of the world takes, which is folded where the pad leaves it no room.
FIRMNESS_HEIGHT = 118.0
PAD_HEIGHT, CURVE_HEIGHT = 208.0, 84.0
PAD_MORE = PAD_HEIGHT + CURVE_HEIGHT - 68.0
WORLD_HEIGHT = 300.0
SPRINGS_CHOICE = 118.0
SIDES_HEIGHT = 38.0
# Frames between two looks at all springs for changes that no command of the person's made: those of a replay.
LOOK_EVERY = 15
ALL_MATERIALS = "All springs"
DASH = "–"
SOLVER_LABELS = {"single_pass": "Single pass", "iterative": "Iterative", "direct": "Direct"}


@dataclass
class PanelShape:
    """How a person has the panel: springs by "pad" or "sliders", the world open or not; None: as room allows."""

    springs: str | None = None
    world: bool | None = None
    # Of two runs the one that it shows: "A" or "B".
    side: str | None = None
    # What is measured of the level for the pad.
    sweeps: PadSweeps = field(default_factory=PadSweeps)


class Panel:
    """The panel at the right of a window; `say` shows a line to the person.

    choose: what is done with a strength of the "hand", with a "view" that is shown or no longer, with how "springs" are
    set ("pad" or "sliders"), the "fold" of the world ("open" or "folded"), another tick "rate" [1/s], and of two runs
    the "side" to show.
    """

    def __init__(
        self, ui: Ui, playback: Playback, say: Callable[[str], None], choose: Mapping[str, Callable[[str], None]],
        top: float, height: float, shape: PanelShape,
    ) -> None:  # fmt: skip
        self._ui, self.playback, self._say, self._choose = ui, playback, say, choose
        self.pad: CoefficientPad | None = None
        self.curve: ResponseCurve | None = None
        self.maps: PadMaps | None = None
        self._sweeps = shape.sweeps
        self._zones: CoefficientZones | None = None
        self._zones_of: tuple[object, ...] = ()
        self.material = self._first_material()
        self._gesture: int | None = None
        self._limits: CoefficientLimits | None = None
        self._limits_of: tuple[object, ...] = ()
        self._refreshes = -1
        self._refreshed_at: tuple[object, ...] = ()
        self._y = 0.0
        self.firmness = FirmnessRows(playback, say)
        self._offered = self._present()
        full = FULL_HEIGHT + (FIRMNESS_HEIGHT if self.firmness.shown else 0.0)
        # With the world folded, if need be.
        least = TIGHTEST * (full + PAD_MORE - WORLD_HEIGHT)
        self.by_pad = height >= least if shape.springs is None else shape.springs == "pad"
        full += (PAD_MORE if self.by_pad else 0.0) + (0.0 if shape.side is None else SIDES_HEIGHT)
        self.is_folded = (self.by_pad and height < TIGHTEST * full) if shape.world is None else not shape.world
        full -= WORLD_HEIGHT if self.is_folded else 0.0
        self._tight = min(1.0, max(height / full, TIGHTEST))
        background = ui.panel(ui.rect(ui.units[0] - PANEL_WIDTH, top, PANEL_WIDTH, height))
        # What does not fit is scrolled to.
        self.area = ScrollArea(ui, ui.rect(0, 0, PANEL_WIDTH, height), background)
        self.back = self.area.content
        if shape.side is not None:
            self._build_sides(shape.side)
        self._build_springs()
        if self.firmness.shown:
            self._build_firmness()
        self._build_world()
        self.area.set_height(ui.px(full * self._tight))
        self.refresh()

    # Building.

    def _row(self, height: float, gap: float = 0.0, x: float = MARGIN, width: float = INSIDE) -> pygame.Rect:
        """The next row, and the gap after it."""
        place = self._place(x, 0.0, width, height)
        self._y += (height + gap) * self._tight
        return place

    def _place(self, x: float, below: float, width: float, height: float) -> pygame.Rect:
        return self._ui.rect(x, 14 + self._y + below * self._tight, width, height * self._tight)

    def _named_field(self, text: str, commit: Callable[[str], bool]) -> Field:
        """A label at the left and a line to type into at the right, on a row of their own."""
        self._ui.label(self._place(MARGIN, 0, INSIDE - ENTRY_WIDTH - 8, ROW), text, self.back)
        return self._ui.field(self._row(ROW, 4, MARGIN + INSIDE - ENTRY_WIDTH, ENTRY_WIDTH), "", commit, self.back, 24)

    def _beside(self, titles: Sequence[str], commits: Sequence[Callable[[str], bool]]) -> list[Field]:
        """Labelled lines to type into, side by side."""
        width, fields = (INSIDE - 12 * (len(titles) - 1)) / len(titles), []
        for index, (text, commit) in enumerate(zip(titles, commits, strict=True)):
            x = MARGIN + index * (width + 12)
            self._ui.label(self._place(x, 0, width, 18), text, self.back, "@muted")
            fields.append(self._ui.field(self._place(x, 19, width, ROW), "", commit, self.back, 24))
        self._row(19 + ROW, 6)
        return fields

    def _build_sides(self, side: str) -> None:
        """Which of two runs all below is of."""
        options = [(name, name, f"Show and set the springs and the solver of {name}") for name in ("A", "B")]
        self.sides = self._ui.choice(self._row(SIDES_HEIGHT - 8, 8), options, self._choose["side"], self.back)
        self.sides.show(side)

    def follow(self, playback: Playback) -> None:
        """Show and change another run of the same level."""
        self.playback = self.firmness.playback = playback

    def _build_springs(self) -> None:
        ui = self._ui
        ui.label(self._place(MARGIN, 2, INSIDE - SPRINGS_CHOICE, 18), "SPRINGS", self.back, "@heading")
        ways = [("pad", "Pad", "Cs and Cd on a map of what they do"), ("sliders", "Sliders", "Cs and Cd one by one")]
        place = self._row(22, 6, MARGIN + INSIDE - SPRINGS_CHOICE, SPRINGS_CHOICE)
        self.ways = ui.choice(place, ways, self._choose["springs"], self.back)
        self.ways.show("pad" if self.by_pad else "sliders")
        names = [ALL_MATERIALS, *self._material_names()]
        chosen = ALL_MATERIALS if self.material is None else self._material_names()[self.material]
        width = INSIDE / 2 - 4 if self.by_pad else INSIDE
        if self.by_pad:
            place = self._place(MARGIN + INSIDE - width, 0, width, 30)
        self.menu = ui.menu(self._row(30, 10, width=width), names, chosen, self._choose_material, self.back)
        if self.by_pad:
            self.maps = PadMaps(ui, place, self.playback, self._sweeps, self.back)
            self._build_pad()
        else:
            self._build_sliders()
        self.frequency, self.ratio = self._beside(
            ("Frequency [Hz]", "Damping ratio"), (self._type_frequency, self._type_ratio)
        )
        self.note = TextBlock(ui, self._row(45, 8), "", self.back)

    def _build_sliders(self) -> None:
        self.stiffness_limit = self._limit_label()
        self.stiffness_field = self._named_field("Cs  stiffness", lambda text: self._type_coefficient(text, True))
        self.stiffness = self._slider(lambda value: self._slide(value, True))
        self.damping_limit = self._limit_label()
        self.damping_field = self._named_field("Cd  damping", lambda text: self._type_coefficient(text, False))
        self.damping = self._slider(lambda value: self._slide(value, False))

    def _build_pad(self) -> None:
        place = self._row(PAD_HEIGHT - 6, 6, MARGIN - 8, INSIDE + 12)
        self.pad = CoefficientPad(self._ui, place, self._move, self._end_gesture, self.back)
        self.curve = ResponseCurve(self._ui, self._row(CURVE_HEIGHT - 6, 6), self.back)
        self.stiffness_field, self.damping_field = self._beside(
            ("Cs  stiffness", "Cd  damping"),
            (lambda text: self._type_coefficient(text, True), lambda text: self._type_coefficient(text, False)),
        )

    def _limit_label(self) -> TextBlock:
        """Room for a coefficient's proven limit, on its row."""
        place = self._place(MARGIN + 96, 6, INSIDE - ENTRY_WIDTH - 104, ROW - 8)
        return TextBlock(self._ui, place, "", self.back, 11.0, WARNING)

    def _slider(self, changed: Callable[[float], None]) -> LogSlider:
        return LogSlider(self._ui, self._row(28, 2, MARGIN - 8, INSIDE + 16), changed, self._end_gesture, self.back)

    def _build_firmness(self) -> None:
        ui, rows = self._ui, self.firmness
        ui.label(self._place(MARGIN, 0, 84, ROW), "Firmness", self.back)
        names = [ALL_BODIES, *rows.bodies]
        rows.menu = ui.menu(self._row(ROW, 5, MARGIN + 84, INSIDE - 84), names, ALL_BODIES, rows.choose_body, self.back)
        tips = {
            word: f"Sags by {100 * sag:g} % of its height" if sag else "Gives way to nothing"
            for word, sag in WORDS.items()
        }
        words = [(word, word.capitalize(), tips[word]) for word in WORDS]
        rows.words = ui.choice(self._row(ROW - 2, 6), words, rows.choose_word, self.back)
        rows.fields = self._beside(
            ("Sag [%]", "Wobble [Hz]", "Ratio"), (rows.type_sag, rows.type_frequency, rows.type_ratio)
        )

    def _build_world(self) -> None:
        ui = self._ui
        FoldHeading(ui, self._row(18, 6), "World", self.is_folded, self._toggle_fold, self.back)
        before = len(self.back.elements)
        self.gravity_x, self.gravity_y = self._beside(
            ("Gravity x [m/s²]", "Gravity y [m/s²]"),
            (lambda text: self._type_gravity(text, 0), lambda text: self._type_gravity(text, 1)),
        )
        options = [(name, SOLVER_LABELS.get(name, name), "Solver") for name in SOLVERS]
        self.solver = ui.choice(self._row(ROW, 8), options, self._choose_solver, self.back)
        ui.label(self._row(18, 2), "Substeps", self.back, "@muted")
        counts = [(str(count), str(count), "Springs move per second as they did") for count in SUBSTEPS]
        counts.insert(0, (AUTO, "Auto", "Every tick takes as many as it needs, 1 to 8"))
        self.substeps = ui.choice(self._row(ROW - 2, 6), counts, self._choose_substeps, self.back)
        self.iterations, self.warm_start, self.rate = self._beside(
            ("Iterations", "Warm start", "Ticks/s"),
            (self._type_iterations, self._type_warm_start, self._type_rate),
        )
        self.warm_start.entry.set_tooltip("0 to 1")
        self.rate.entry.set_tooltip("Ticks a second; the run begins anew with another number of them")
        ui.label(self._place(MARGIN, 0, HAND_LABEL, ROW - 2), "Hand", self.back, "@muted")
        options = [(name, name.capitalize(), _strength_tip(strength)) for name, strength in STRENGTHS.items()]
        place = self._row(ROW - 2, 8, MARGIN + HAND_LABEL, INSIDE - HAND_LABEL)
        self.hand = ui.choice(place, options, self._choose["hand"], self.back)
        ui.label(self._place(MARGIN, 0, HAND_LABEL, ROW - 2), "Show", self.back, "@muted")
        self.views = ViewRow(
            ui, self._row(ROW - 2, 8, MARGIN + HAND_LABEL, INSIDE - HAND_LABEL), self._choose["view"], self.back
        )
        columns = (self._place(MARGIN, 0, INSIDE / 2, 34), self._place(MARGIN + INSIDE / 2, 0, INSIDE / 2, 34))
        self.energies = [TextBlock(ui, place, "", self.back) for place in columns]
        self._row(40)
        if self.is_folded:
            for element in self.back.elements[before:]:
                element.hide()

    def _toggle_fold(self) -> None:
        self._choose["fold"]("open" if self.is_folded else "folded")

    def _first_material(self) -> int | None:
        """The material of the most springs, so that a slider does not change all at once; None: there is none."""
        world = self.playback.session.world
        counts = np.bincount(world.material[world.spring_active & (world.material >= 0) & (world.law != LAW_HOOKE)])
        return int(np.argmax(counts)) if len(counts) else None

    def _material_names(self) -> list[str]:
        return list(self.playback.session.world.material_names)

    # Showing.

    def refresh(self) -> None:
        """Show what the world has now."""
        world = self.playback.session.world
        settings = world.settings
        self._follow_what_joins()
        self.gravity_x.show(f"{settings.gravity[0]:g}")
        self.gravity_y.show(f"{settings.gravity[1]:g}")
        self.solver.show(settings.solver)
        self.substeps.show(str(settings.substeps))
        self.iterations.show(str(settings.iterations))
        self.warm_start.show(f"{settings.warm_start:g}")
        self.rate.show(f"{settings.tick_rate:g}")
        if self._refreshes % LOOK_EVERY == 0 or self.playback.clock.paused:
            self._show_energy()
        self._refreshes += 1
        if self.maps is not None and self.pad is not None:
            self.maps.refresh(self.playback, self.material, self.pad)
        self.firmness.refresh(self._refreshes % LOOK_EVERY == 0)
        fresh = (self.playback.revision, self.material)
        if fresh == self._refreshed_at and self._refreshes % LOOK_EVERY:
            return
        self._refreshed_at = fresh
        inputs = (world.stiffness, world.damping, world.spring_active, world.inverse_mass)
        key = (settings, self.material, *(array.tobytes() for array in inputs))
        if key != self._limits_of:
            self._limits_of = key
            self._limits = coefficient_limits(world, self.material)
            self._find_zones()
            self._show_springs()

    def show_choices(self, strength: str, views: Set[str]) -> None:
        """Show the strength of the hand, and which overlays are seen."""
        self.hand.show(strength)
        self.views.show(views)

    def _show_energy(self) -> None:
        world = self.playback.session.world
        kinetic, springs, gravity = kinetic_energy(world), spring_energy(world), gravity_energy(world)
        dissipated = self.playback.dissipation.energy
        self.energies[0].show_text(f"kinetic {kinetic:.4g} J\nsprings {springs:.4g} J")
        self.energies[1].show_text(f"gravity {gravity:.4g} J\ndissipated {dissipated:.4g} J")

    def _chosen(self) -> np.ndarray:
        world = self.playback.session.world
        chosen = world.material >= 0 if self.material is None else world.material == self.material
        return np.flatnonzero(chosen & (world.law != LAW_HOOKE) & world.spring_active)

    def _show_springs(self) -> None:
        world, chosen, limits = self.playback.session.world, self._chosen(), self._limits
        assert limits is not None
        stiffness, damping = world.stiffness[chosen], world.damping[chosen]
        if self.by_pad:
            self._show_on_pad(stiffness, damping)
        else:
            self._show_on_sliders(stiffness, damping, limits)
        for values, entry in ((stiffness, self.stiffness_field), (damping, self.damping_field)):
            entry.show(DASH if not len(values) else "mixed" if values.min() != values.max() else f"{values[0]:.6g}")
        if not len(chosen):
            self.frequency.show(DASH)
            self.ratio.show(DASH)
            self.note.show_text(self._no_spring_note())
            return
        self._show_reading(stiffness, damping)
        self.note.show_text(sentence(limits.reason))

    def _show_on_sliders(self, stiffness: np.ndarray, damping: np.ndarray, limits: CoefficientLimits) -> None:
        for values, slider, limit, label in (
            (stiffness, self.stiffness, limits.stiffness, self.stiffness_limit),
            (damping, self.damping, limits.damping, self.damping_limit),
        ):
            if not len(values):
                label.show_text("")
                slider.show_value(slider.value, None, False, False)
                continue
            label.show_text(f"limit {limit:.3g}" if limit is not None and limit < 1.0 else "")
            slider.show_value(float(np.median(values)), limit, bool(values.min() != values.max()), True)

    def _find_zones(self) -> None:
        """Find the pad's zones anew, where what they depend on has changed: not the chosen springs' own Cs and Cd."""
        if not self.by_pad:
            return
        world = self.playback.session.world
        others = world.material != self.material if self.material is not None else world.material < 0
        arrays = (world.stiffness[others], world.damping[others], world.spring_active, world.inverse_mass)
        key = (world.settings, self.material, world.constraint_count, *(array.tobytes() for array in arrays))
        if key != self._zones_of:
            self._zones_of, self._zones = key, coefficient_zones(world, self.material, STIFFNESSES)

    def _show_on_pad(self, stiffness: np.ndarray, damping: np.ndarray) -> None:
        assert self.pad is not None and self.curve is not None
        if not len(stiffness):
            self.pad.show_state(self.pad.state._replace(enabled=False), self._zones)
            self.curve.show_none("One spring: there is none")
            return
        is_mixed = bool(stiffness.min() != stiffness.max() or damping.min() != damping.max())
        pair = float(np.median(stiffness)), float(np.median(damping))
        self.pad.show_state(PadState(*pair, is_mixed, True), self._zones)
        if is_mixed:
            self.curve.show_none("One spring: the chosen ones differ")
        else:
            self.curve.show_spring(pair, self.playback.session.world.settings.tick_rate)

    def _show_reading(self, stiffness: np.ndarray, damping: np.ndarray) -> None:
        if stiffness.min() != stiffness.max() or damping.min() != damping.max():
            self.frequency.show("mixed")
            self.ratio.show("mixed")
            return
        frequency, ratio = frequency_from_coefficients(float(stiffness[0]), float(damping[0]), self._tick_time())
        self.frequency.show(_reading(frequency))
        self.ratio.show(_reading(ratio))

    def _no_spring_note(self) -> str:
        world = self.playback.session.world
        hooke = (world.law == LAW_HOOKE) & ((world.material == self.material) | (self.material is None))
        if not hooke.any():
            return "There are no springs." if self.material is None else "No spring is of this material."
        first = int(np.flatnonzero(hooke)[0])
        k, c = world.hooke_stiffness[first], world.hooke_damping[first]
        return f"Classic Hooke springs, k = {k:g} N/m, c = {c:g} N s/m: Cs and Cd do not apply."

    # Changing.

    def _tick_time(self) -> float:
        return 1.0 / self.playback.session.world.settings.tick_rate

    def _submit(self, command: Command, gesture: int | None = None) -> None:
        self.playback.submit(command, gesture)

    def _present(self) -> tuple[object, object]:
        world = self.playback.session.world
        return world.material_names, world.forms

    def _follow_what_joins(self) -> None:
        """Offer the materials and bodies that there are: some join a run with what is dropped, and go again."""
        if all(now is then for now, then in zip(self._present(), self._offered, strict=True)):
            return
        self._offered, names = self._present(), self._material_names()
        if self.material is not None and self.material >= len(names):
            self.material = None
        chosen = ALL_MATERIALS if self.material is None else names[self.material]
        self._ui.offer(self.menu, [ALL_MATERIALS, *names], chosen)
        self.firmness.offer_bodies(self._ui)

    def choose_material(self, material: int | None) -> None:
        """Show and change the springs of a material (index); None = all."""
        self.material = material
        self._ui.replace_menu(self.menu, ALL_MATERIALS if material is None else self._material_names()[material])

    def _choose_material(self, name: str) -> None:
        self.choose_material(None if name == ALL_MATERIALS else self._material_names().index(name))

    def _choose_solver(self, name: str) -> None:
        self._submit(SetSolver(solver=name))

    def _choose_substeps(self, count: str) -> None:
        self._submit(SetSolver(substeps=AUTO if count == AUTO else int(count)))

    def _slide(self, value: float, is_stiffness: bool) -> None:
        if self._gesture is None:
            self._gesture = self.playback.session.new_gesture()
        self._set(value, is_stiffness, self._gesture)

    def _move(self, stiffness: float, damping: float) -> None:
        """Take up what the pad was dragged to."""
        if self._gesture is None:
            self._gesture = self.playback.session.new_gesture()
        self._submit(SetCoefficients(stiffness, damping, self.material), self._gesture)
        self._tell_of_all()

    def _set(self, value: float, is_stiffness: bool, gesture: int | None = None) -> None:
        command = SetCoefficients(
            stiffness=value if is_stiffness else None,
            damping=None if is_stiffness else value,
            material=self.material,
        )
        self._submit(command, gesture)
        self._tell_of_all()

    def _tell_of_all(self) -> None:
        """Say how a change of all springs is taken back, where there are several materials."""
        count = len(np.unique(self.playback.session.world.material[self._chosen()]))
        if self.material is None and count > 1:
            self._say(f"This changes the springs of all {count} materials; Ctrl+Z takes it back.")

    def _end_gesture(self) -> None:
        self._gesture = None

    def _type_coefficient(self, text: str, is_stiffness: bool) -> bool:
        value = typed_number(self._say, text, "Cs" if is_stiffness else "Cd", 0.0, 1.0)
        if value is None or not self._has_springs():
            return False
        self._set(value, is_stiffness)
        return True

    def _has_springs(self) -> bool:
        if not len(self._chosen()):
            self._say("There is no spring here that Cs and Cd apply to.")
            return False
        return True

    def _type_frequency(self, text: str) -> bool:
        frequency = typed_number(self._say, text, "Frequency", 0.0, math.inf)
        if frequency is None:
            return False
        ratio = _typed_or_none(self.ratio.text)
        if ratio is None:
            self._say("There was no single damping ratio to keep: it is 1 now.")
        return self._set_frequency(frequency, 1.0 if ratio is None else ratio)

    def _type_ratio(self, text: str) -> bool:
        ratio = typed_number(self._say, text, "Damping ratio", 0.0, math.inf)
        if ratio is None:
            return False
        frequency = _typed_or_none(self.frequency.text)
        if frequency is None:
            self._say("There is no single frequency to keep: type the frequency first.")
            return False
        return self._set_frequency(frequency, ratio)

    def _set_frequency(self, frequency: float, ratio: float) -> bool:
        try:
            stiffness, damping = coefficients_from_frequency(frequency, ratio, self._tick_time())
        except ValueError as error:
            self._say(sentence(error))
            return False
        if not self._has_springs():
            return False
        self._submit(SetCoefficients(stiffness=stiffness, damping=damping, material=self.material))
        return True

    def _type_gravity(self, text: str, axis: int) -> bool:
        value = typed_number(self._say, text, "Gravity", -GRAVITY_LIMIT, GRAVITY_LIMIT)
        if value is None:
            return False
        x, y = self.playback.session.world.settings.gravity
        self._submit(SetGravity((value, y) if axis == 0 else (x, value)))
        return True

    def _type_iterations(self, text: str) -> bool:
        value = typed_number(self._say, text, "Iterations", 1, 1000)
        if value is None or value != int(value):
            if value is not None:
                self._say(f"Iterations: {value:g} is not a whole number.")
            return False
        self._submit(SetSolver(iterations=int(value)))
        return True

    def _type_rate(self, text: str) -> bool:
        """Ask how to go on at another tick rate; the run has the old one until it begins anew."""
        if not text.strip().isdecimal():
            self._say(f"Ticks a second: {text.strip() or 'nothing'!r} is not a whole number.")
        elif int(text) != self.playback.session.world.settings.tick_rate:
            self._choose["rate"](text)
        return False

    def _type_warm_start(self, text: str) -> bool:
        value = typed_number(self._say, text, "Warm start", 0.0, 1.0)
        if value is None:
            return False
        self._submit(SetSolver(warm_start=value))
        return True


def _strength_tip(strength: float) -> str:
    return f"Pulls with at most {strength:g} N for each kg of what it holds, from the next hold on"


def _reading(value: float) -> str:
    return "infinite" if math.isinf(value) else f"{value:.4g}"


def _typed_or_none(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None
