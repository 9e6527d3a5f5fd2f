"""Rows of the panel that say how ticks are solved: solver, substeps, iterations, warm start, ticks a second."""

from collections.abc import Callable

from sandbox.app.panel.panel_rows import ROW, PanelRows
from sandbox.app.run.playback import Playback
from sandbox.app.widgets.field import typed_number
from sandbox.level.format.limits import SUBSTEPS
from sandbox.physics.settings import AUTO
from sandbox.physics.solvers import SOLVERS
from sandbox.session.commands import SetSolver

SOLVER_TIPS = {
    "single_pass": "The article's loop: solves each spring once a tick; stiff things may explode",
    "iterative": "Solves each spring several times a tick; more iterations make things firmer",
    "direct": "Solves all springs at once; stiff things stay stiff and nothing explodes",
}
SOLVER_LABELS = {"single_pass": "Single pass", "iterative": "Iterative", "direct": "Direct"}


class SolverRows:
    """What the rows show and do; ask_rate: what is done with another tick rate that was typed."""

    def __init__(self, playback: Playback, say: Callable[[str], None], ask_rate: Callable[[str], None]) -> None:
        self.playback, self._say, self._ask_rate = playback, say, ask_rate

    def build(self, rows: PanelRows) -> None:
        """Make the widgets."""
        ui, back = rows.ui, rows.back
        options = [(name, SOLVER_LABELS.get(name, name), SOLVER_TIPS.get(name, name)) for name in SOLVERS]
        ui.label(rows.row(18, 2), "Solver", back, "muted")
        self.solver = ui.choice(rows.row(ROW, 8), options, self._choose_solver, back)
        ui.label(rows.row(18, 2), "Substeps", back, "muted")
        several = "things stay as stiff and hold better"
        counts = [(str(count), str(count), f"A tick in {count}: {several}" if count > 1 else "A tick in one")
                  for count in SUBSTEPS]  # fmt: skip
        counts.insert(0, (AUTO, "Auto", "Each tick uses as many as it needs, 1 to 8"))
        self.substeps = ui.choice(rows.row(ROW - 2, 6), counts, self._choose_substeps, back)
        self.iterations, self.warm_start, self.rate = rows.beside(
            ("Iterations", "Rounds of the iterative solver; fewer make things softer", self._type_iterations),
            (
                "Warm start",
                "How much of the last tick's impulses the iterative solver starts with, 0 to 1",
                self._type_warm_start,
            ),
            ("Ticks/s", "Ticks a second; the run starts over when you change it", self._type_rate),
        )

    def refresh(self) -> None:
        """Show what the world has now."""
        settings = self.playback.session.world.settings
        self.solver.show(settings.solver)
        self.substeps.show(str(settings.substeps))
        self.iterations.show(str(settings.iterations))
        self.warm_start.show(f"{settings.warm_start:g}")
        self.rate.show(f"{settings.tick_rate:g}")

    def _choose_solver(self, name: str) -> None:
        self.playback.submit(SetSolver(solver=name))

    def _choose_substeps(self, count: str) -> None:
        self.playback.submit(SetSolver(substeps=AUTO if count == AUTO else int(count)))

    def _type_iterations(self, text: str) -> bool:
        value = typed_number(self._say, text, "Iterations", 1, 1000)
        if value is None or value != int(value):
            if value is not None:
                self._say(f"Iterations: {value:g} is not a whole number.")
            return False
        return self._submit(SetSolver(iterations=int(value)))

    def _type_rate(self, text: str) -> bool:
        """Ask how to go on at another tick rate; the run has the old one until it starts over."""
        if not text.strip().isdecimal():
            self._say(f"Ticks a second: {text.strip() or 'nothing'!r} is not a whole number.")
        elif int(text) != self.playback.session.world.settings.tick_rate:
            self._ask_rate(text)
        return False

    def _type_warm_start(self, text: str) -> bool:
        value = typed_number(self._say, text, "Warm start", 0.0, 1.0)
        return value is not None and self._submit(SetSolver(warm_start=value))

    def _submit(self, command: SetSolver) -> bool:
        self.playback.submit(command)
        if self.playback.session.world.settings.solver != "iterative":
            self._say("Only the iterative solver uses it.")
        return True
