"""The map of a sweep as a picture: Cs across, Cd up, a panel for each point of all else, with what is proven."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import BoundaryNorm, ListedColormap, LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator

from sandbox.app.panel.sweeps.sweep_layer import SweepMeasure, measure_of, scale_of, shown_values
from sandbox.physics.analysis.stability import CoefficientZones
from sandbox.physics.arrays import Floats
from sandbox.session.sweep.grid import CD, CS, Rows, SweepGrid
from sandbox.session.sweep.sweep_map import SweepPanel, edges, is_logarithmic, sweep_panels

# Sizes of a panel, and what stands around all of them [inch]; pixels an inch.
PANEL, MARGINS, RESOLUTION = (3.1, 2.5), (1.4, 1.75), 110
# Yellow is calm and dark blue is much, alike to every kind of colour vision; the rest is from Okabe and Ito (2008).
COLOURS = "cividis_r"
BAD, GOOD, GREY, BLOWN = "#e69f00", "#56b4e9", "#d9d9d9", "#b03a00"
INK = "#1c2330"
# Limits, in lines of one colour.
LineStyle = Literal["-", "--", ":"]
LIMIT = "#ffffff"
ARTICLE: LineStyle = "-"
PROVEN: LineStyle = "--"
ESTIMATED: LineStyle = ":"


def draw_map(grid: SweepGrid, rows: Rows, measures: Sequence[str], path: Path) -> None:
    """Draw measures of a sweep over Cs and Cd, a row of panels for each, as PNG. Raises OSError."""
    panels = list(sweep_panels(grid, rows))
    counts = len(panels), len(measures)
    width, height = (count * size + more for count, size, more in zip(counts, PANEL, MARGINS, strict=True))
    with matplotlib.rc_context({"font.family": "DejaVu Sans", "font.size": 9, "hatch.linewidth": 0.8,
                                "text.color": INK, "axes.labelcolor": INK, "axes.edgecolor": INK}):  # fmt: skip
        figure = Figure(figsize=(max(width, 5.6), height), dpi=RESOLUTION, layout="constrained")
        FigureCanvasAgg(figure)
        table = figure.subplots(len(measures), len(panels), squeeze=False, sharex=True, sharey=True)
        for name, row in zip(measures, table, strict=True):
            _draw_measure(figure, grid, panels, name, row)
        for panel, axes in zip(panels, table[0], strict=True):
            axes.set_title(panel.title, fontsize=10)
        for axes in table[-1]:
            axes.set_xlabel("Cs  stiffness")
        for axes in table[:, 0]:
            axes.set_ylabel("Cd  damping")
        of = "" if grid.material is None else f", {grid.material}"
        figure.suptitle(f"{grid.level.name}{of}: {grid.runs} runs of {grid.seconds:g} s", fontweight="bold", x=0.02,
                        ha="left")  # fmt: skip
        figure.legend(handles=_legend(panels, measures), loc="outside lower left", ncols=2, frameon=False,
                      facecolor="none")  # fmt: skip
        figure.savefig(path, format="png", metadata={"Software": None})


def _draw_measure(figure: Figure, grid: SweepGrid, panels: list[SweepPanel], name: str, row: np.ndarray) -> None:
    measure = measure_of(name)
    shown = [shown_values(name, panel.values) for panel in panels]
    colours, norm, ticks = _colours(measure, name, np.concatenate([values.ravel() for values in shown]))
    across, up = (np.sort(np.array(grid.columns[column], dtype=np.float64)) for column in (CS, CD))
    for panel, values, axes in zip(panels, shown, row, strict=True):
        if isinstance(norm, LogNorm):
            # What counts as nothing is in the colour of the least.
            values = np.maximum(values, float(norm.vmin or 0.0))
        axes.set_facecolor(GREY)
        cells = axes.pcolormesh(edges(across), edges(up), np.ma.masked_invalid(values), cmap=colours, norm=norm)
        if name != "blew_up":
            _hatch(axes, across, up, panel.values["blew_up"] > 0.0)
        axes.set_xscale("log" if is_logarithmic(across) else "linear")
        axes.set_yscale("log" if is_logarithmic(up) else "linear")
        axes.set_xlim(edges(across)[[0, -1]])
        axes.set_ylim(edges(up)[[0, -1]])
        if panel.zones is not None:
            _draw_limits(axes, panel.zones)
    bar = figure.colorbar(cells, ax=list(row), label=measure.title, pad=0.015, aspect=22)
    if measure.is_flag:
        bar.set_ticks([0, 1], labels=measure.words)
    elif ticks is not None:
        bar.locator = ticks
        bar.update_ticks()


def _colours(measure: SweepMeasure, name: str, values: Floats) -> tuple[Any, Any, Any]:
    """Colours of a measure, what they are put on, and where numbers stand (None: as usual)."""
    if measure.is_flag:
        pair = [GREY, BLOWN] if name == "blew_up" else [BAD, GOOD]
        return ListedColormap(pair), BoundaryNorm([-0.5, 0.5, 1.5], 2), None
    low, high, is_wide = scale_of(values)
    ticks = MaxNLocator(5, integer=True) if name == "broken_springs" and not is_wide else None
    return matplotlib.colormaps[COLOURS], LogNorm(low, high) if is_wide else Normalize(low, high), ticks


def _hatch(axes: Axes, across: Floats, up: Floats, where: np.ndarray) -> None:
    """Cross cells out."""
    if where.any():
        cells = np.ma.masked_where(~where, np.ones(where.shape))
        axes.pcolor(edges(across), edges(up), cells, hatch="xxxx", facecolor="none", edgecolor=BLOWN, linewidth=0.0,
                    cmap=ListedColormap([(0, 0, 0, 0)]))  # fmt: skip


def _draw_limits(axes: Axes, zones: CoefficientZones) -> None:
    if zones.bounded:
        axes.text(0.97, 0.03, "energy bounded everywhere", transform=axes.transAxes, ha="right", va="bottom",
                  fontsize=7.5, color="white", path_effects=[withStroke(linewidth=2.5, foreground=INK)])  # fmt: skip
        return
    found: list[tuple[Floats | None, LineStyle]] = [(zones.article, ARTICLE)]
    if zones.holds:
        found += [(zones.proven, PROVEN), (zones.estimated, ESTIMATED)]
    for highest, line in found:
        if highest is None:
            continue
        inside = highest >= 0.0
        across, up = zones.stiffness[inside], highest[inside]
        if not inside.all():
            # Where nothing is inside any more the edge falls to the bottom.
            across, up = np.append(across, across[-1:]), np.append(up, np.full(len(up[-1:]), axes.get_ylim()[0]))
        drawn = axes.plot(across, up, line, color=LIMIT, linewidth=1.6, scalex=False, scaley=False)
        drawn[0].set_path_effects([withStroke(linewidth=3.4, foreground=INK)])


def _legend(panels: list[SweepPanel], measures: Sequence[str]) -> list[Any]:
    """The legend of the map's lines and patterns."""
    limits = [panel.zones for panel in panels if panel.zones is not None and not panel.zones.bounded]
    handles: list[Any] = []

    def line(style: LineStyle, text: str) -> None:
        handles.append(Line2D([], [], color=LIMIT, linestyle=style, linewidth=1.6, label=text,
                              path_effects=[withStroke(linewidth=3.4, foreground=INK)]))  # fmt: skip

    if limits:
        line(ARTICLE, f"1/(n+1), n = {limits[0].most_springs}, for a single pass")
    if any(zones.holds for zones in limits):
        line(PROVEN, "proven stable, single pass")
        if any(zones.estimated is not None for zones in limits):
            line(ESTIMATED, "explodes beyond, by the largest eigenvalue")
    if any((panel.values["blew_up"] > 0.0).any() for panel in panels):
        handles.append(Patch(facecolor="white", edgecolor=BLOWN, hatch="xxxx", label="blew up"))
    for name in measures:
        if not measure_of(name).is_flag and any(np.isnan(panel.values[name]).any() for panel in panels):
            handles.append(Patch(facecolor=GREY, edgecolor=INK, label=measure_of(name).missing))
    unique = {handle.get_label(): handle for handle in handles}
    return list(unique.values())
