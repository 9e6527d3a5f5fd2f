"""What the keys and buttons of the editor do, by the names of the table of shortcuts."""

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Literal

from sandbox.app.base.sentences import capitalised, sentence
from sandbox.app.base.shortcuts import shortcuts, tip_of
from sandbox.app.contracts.application import Application, Editing
from sandbox.app.draw.camera import Box
from sandbox.app.draw.looks import material_colours
from sandbox.app.edit.bar import open_menu_by_key
from sandbox.app.edit.canvas.pointer import DrawTool, SelectTool
from sandbox.app.edit.clipboard import Clipboard
from sandbox.app.widgets.dialogs import ask, choose, choose_row, fill_in
from sandbox.app.widgets.rows import Row
from sandbox.editor.document import Document, EditError
from sandbox.editor.edits.additions import wave_in_order
from sandbox.editor.edits.copying import array_circle, array_line, duplicate, part_of
from sandbox.editor.edits.deleting import break_apart, delete
from sandbox.editor.edits.grouping import group, reorder, ungroup
from sandbox.editor.edits.moving import align, distribute, mirror
from sandbox.editor.edits.placing import unweld
from sandbox.editor.items import Item, chosen_definitions
from sandbox.editor.pick import items_of_material
from sandbox.editor.storage.level_file import StorageError, keep_part
from sandbox.editor.tools.palette import TOOLS
from sandbox.editor.tools.snap import PLACE_DECIMALS

# A copy is put beside what it is of, this many steps of the grid and less than one to the right of it.
COPY_STEPS = 2
COPY_LIMIT = 1_000
FIRST_COPY = "The selection counts as the first copy."
# A step of the grid that a person may set [m].
SMALLEST_GRID, LARGEST_GRID = 0.001, 1_000.0

# Actions that have no button in the bar.
MENU = (
    "rename", "thing_menu", "copy", "cut", "paste", "copy_level", "keep_part", "wave_in_order", "select_all",
    "select_material", "find", "hide", "lock", "grid", "lattice", "try_range", "forward", "backward", "recent",
    "open_file", "save_as", "revert", "settings",
)  # fmt: skip

NO_JOINTS = "Nothing in the selection is joined to anything."

Edge = Literal["left", "right", "top", "bottom", "centre_x", "centre_y"]
Place = Literal["front", "forward", "backward", "back"]


def edit_actions(screen: Editing, app: Application, clipboard: Clipboard) -> dict[str, Callable[[], object]]:
    """The actions of a screen."""
    documents = app.documents
    tools: dict[str, Callable[[], object]] = {
        tool.action: partial(screen.choose_tool, name) for name, tool in TOOLS.items()
    }
    return (
        tools
        | _viewing(screen)
        | {
            "tool_part": lambda: _show_parts(screen),
            "keep_part": lambda: ask_to_keep_part(screen),
            "play": documents.play,
            "undo": lambda: _step(screen, -1),
            "redo": lambda: _step(screen, 1),
            "new": documents.new_place,
            "open": app.open_gallery,
            "open_file": app.files.ask_to_open,
            "recent": lambda: app.open_gallery("mine"),
            "save": documents.save,
            "save_as": documents.save_as,
            "revert": documents.revert,
            "copy": clipboard.copy,
            "cut": clipboard.cut,
            "paste": clipboard.paste,
            "copy_level": clipboard.copy_level,
            "duplicate": lambda: _duplicate(screen),
            "delete": lambda: _delete_or_back(screen),
            "select_all": lambda: screen.select(frozenset(screen.scene.items) - screen.visibility.closed),
            "select_material": lambda: _ask_material(screen),
            "mirror": lambda: _ask_mirror(screen),
            "array": lambda: _ask_array(screen),
            "parts": lambda: _ask_parts(screen),
            "rename": lambda: _rename(screen),
            "menu": lambda: _show_menu(screen, app),
            "thing_menu": lambda: open_menu_by_key(screen),
            "group": lambda: _edit_selection(screen, "Group", group),
            "ungroup": lambda: _edit_selection(screen, "Ungroup", ungroup, "Nothing in the selection is in a group."),
            "break_apart": lambda: _edit_selection(screen, "Break apart", break_apart),
            "unjoin": lambda: _edit_selection(screen, "Take joints apart", _unjoined, NO_JOINTS),
            "align": lambda: _ask_align(screen),
            "order": lambda: _ask_order(screen),
            "forward": lambda: _reorder(screen, "forward"),
            "backward": lambda: _reorder(screen, "backward"),
            "wave_in_order": lambda: _ask_wave(screen),
            "numbers": lambda: screen.options.focus(),
            "next_item": lambda: _visit(screen, 1),
            "previous_item": lambda: _visit(screen, -1),
            "press": screen.press_cursor,
            "finish": lambda: _finish(screen),
            "cancel": screen.cancel,
        }
    )


def ask_to_keep_part(screen: Editing) -> None:
    """Ask for the name of a part, and write it."""
    document = screen.document
    if not document.selection:
        screen.say("Select what the part consists of first.")
        return
    names = {getattr(part, "group", None) for part in chosen_definitions(document.level, document.selection)}
    one = names.pop() if len(names) == 1 else None
    first = chosen_definitions(document.level, document.selection)[0]
    kept: list[Path] = []
    suggestion: str = one or getattr(first, "id", None) or "Part"

    def answer(typed: str) -> str | None:
        try:
            path = keep_part(part_of(document, typed))
        except (EditError, StorageError) as error:
            return sentence(error)
        kept.append(path)
        return None

    def show(typed: str) -> None:
        screen.say(f"{typed} is in the catalogue now, under Your own parts.")
        screen.show_parts(kept[-1])

    hint = "The selection becomes a part that you can use in all your levels."
    ask(screen.ui, "Keep as a part", hint, capitalised(suggestion), "Keep", answer, then=show)


def _viewing(screen: Editing) -> dict[str, Callable[[], object]]:
    """The actions that change what is seen, and nothing of the level but where it begins."""
    return {
        "snap": lambda: _toggle_snap(screen),
        "grid": lambda: _ask_grid_step(screen),
        "lattice": lambda: _toggle_lattice(screen),
        "forecast": screen.watch.toggle_forecast,
        "trail": screen.watch.toggle_trail,
        "try_range": lambda: screen.turn_to("range"),
        "rest": screen.watch.begin_at_rest,
        "fit": screen.fit,
        "panel": screen.toggle_side,
        "next_page": lambda: screen.turn_page(1),
        "previous_page": lambda: screen.turn_page(-1),
        "zoom_in": lambda: _adjust_or_zoom(screen, 1),
        "zoom_out": lambda: _adjust_or_zoom(screen, -1),
        "find": lambda: screen.turn_to("objects"),
        "hide": lambda: _hide(screen),
        "lock": lambda: _lock(screen),
    }


def _toggle_snap(screen: Editing) -> None:
    screen.snapping = not screen.snapping
    screen.say("Snapping is on." if screen.snapping else "Snapping is off.")


def _ask_grid_step(screen: Editing) -> None:
    """Ask for the distance of the points that the pointer snaps to."""

    def take(typed: str) -> str | None:
        if not typed:
            screen.set_grid(None)
            return None
        try:
            step = _number(typed)
        except ValueError as error:
            return str(error)
        if not SMALLEST_GRID <= step <= LARGEST_GRID:
            return f"A step lies between {SMALLEST_GRID:g} and {LARGEST_GRID:g} m."
        screen.set_grid(step)
        return None

    hint = "In metres, such as 0.25. Leave it empty to let the grid follow the zoom."
    ask(screen.ui, "Step of the grid", hint, f"{screen.grid:g}", "Take it", take)


def _toggle_lattice(screen: Editing) -> None:
    screen.shows_lattice = not screen.shows_lattice
    screen.say("Springs and particles are shown." if screen.shows_lattice else "The level is shown as it is played.")


def _adjust_or_zoom(screen: Editing, by: int) -> None:
    """Count the parts of what is drawn up or down, or zoom."""
    if isinstance(screen.pointer_tool, DrawTool) and screen.pointer_tool.drawing.under_way:
        screen.pointer_tool.adjust(by)
    else:
        screen.camera.zoom_at(screen.cursor, 2 * by)


def _hide(screen: Editing) -> None:
    """Hide what is selected; with nothing selected, show all that is hidden."""
    selection, visibility = screen.document.selection, screen.visibility
    if not (selection or visibility.hidden):
        screen.say("Nothing is selected, and nothing is hidden.")
        return
    screen.set_visibility(visibility.hide(selection or visibility.hidden, on=bool(selection)))


def _lock(screen: Editing) -> None:
    """Lock what is selected; with nothing selected, unlock all that is locked."""
    selection, visibility = screen.document.selection, screen.visibility
    if not (selection or visibility.locked):
        screen.say("Nothing is selected, and nothing is locked.")
        return
    screen.set_visibility(visibility.lock(selection or visibility.locked, on=bool(selection)))
    screen.select(frozenset())


def _rename(screen: Editing) -> None:
    """Ask for another name of the selected thing or group, on the page of objects."""
    if _has_selection(screen):
        if screen.side is None:
            screen.toggle_side()
        assert screen.side is not None
        screen.side.choose("objects")
        screen.side.ask_name()


def _show_parts(screen: Editing) -> None:
    """Show the catalogue, and let the keyboard choose from it."""
    screen.choose_tool("part")
    screen.show_parts()


def _step(screen: Editing, by: int) -> None:
    """Take the last point of what is drawn back or put it in its place again, else undo or redo a step."""
    if isinstance(screen.pointer_tool, DrawTool):
        drawing = screen.pointer_tool.drawing
        if by < 0 and drawing.under_way:
            drawing.back()
            return
        if by > 0 and drawing.again():
            return
    history = screen.history
    if not (history.can_undo if by < 0 else history.can_redo):
        screen.say(f"There is nothing to {'undo' if by < 0 else 'redo'}.")
        return
    screen.step_to(history.index + by)
    if screen.document.selection:
        screen.reveal(screen.document.selection)


def _duplicate(screen: Editing) -> None:
    """Put a copy beside what is selected, on the right, as far off as the grid has it."""
    grid, box = screen.grid, screen.selection_box
    width = 0.0 if box is None else box[2] - box[0]
    step = (math.ceil(round(width / grid, PLACE_DECIMALS)) + COPY_STEPS) * grid
    _edit_selection(screen, "Duplicate", lambda document: duplicate(document, step, 0.0))
    if screen.document.selection:
        screen.reveal(screen.document.selection)


def _delete_or_back(screen: Editing) -> None:
    """Take the last point of what is drawn back, or delete the selection."""
    if isinstance(screen.pointer_tool, DrawTool) and screen.pointer_tool.drawing.under_way:
        screen.pointer_tool.drawing.back()
    elif not (isinstance(screen.pointer_tool, SelectTool) and screen.pointer_tool.delete_corner()):
        _edit_selection(screen, "Delete", delete)


def _finish(screen: Editing) -> None:
    if isinstance(screen.pointer_tool, DrawTool):
        screen.pointer_tool.finish()


def _visit(screen: Editing, by: int) -> None:
    """Select the next item of the file, or the one before."""
    items = [item for item in screen.scene.items if item not in screen.visibility.closed]
    if not items:
        return
    chosen = [index for index, item in enumerate(items) if item in screen.document.selection]
    start = (chosen[-1] if by > 0 else chosen[0]) if chosen else (-1 if by > 0 else 0)
    item: Item = items[(start + by) % len(items)]
    screen.select(frozenset({item}))


def _unjoined(document: Document) -> Document:
    """The document without the welds of the selected bodies and particles."""
    ids = {str(item.key) for item in document.selection if item.kind != "spring"}
    for pair in document.level.welds:
        for name in pair:
            if name.partition(".")[0] in ids:
                document = unweld(document, name)
                break
    return document


def _reorder(screen: Editing, to: Place) -> None:
    where = "front" if to in ("front", "forward") else "back"
    _edit_selection(screen, f"Order: {to}", lambda document: reorder(document, to), f"It is at the {where} already.")


def _edit_selection(screen: Editing, label: str, function: Callable[[Document], Document], otherwise: str = "") -> None:
    """Edit what is selected; otherwise: what is said where that changes nothing."""
    before = screen.document.level
    is_made = _has_selection(screen) and screen.edit(label, function)
    if is_made and otherwise and screen.document.level is before:
        screen.say(otherwise)


def _has_selection(screen: Editing) -> bool:
    if not screen.document.selection:
        screen.say("Nothing is selected.")
    return bool(screen.document.selection)


def _ask_material(screen: Editing) -> None:
    colours = material_colours(screen.scene.level.materials)

    def take(index: int) -> None:
        screen.select(items_of_material(screen.document.level, list(colours)[index]))

    rows = [Row(name, swatch=colour) for name, colour in colours.items()]
    choose_row(screen.ui, "Select everything made of one material", rows, take)


def _ask_mirror(screen: Editing) -> None:
    box = _box(screen)
    if box is None:
        return
    left, bottom, right, top = box
    x, y = (left + right) / 2, (bottom + top) / 2

    def do(axis: Literal["x", "y"], centre: tuple[float, float], copies: bool = False) -> None:
        def mirrored(document: Document) -> Document:
            return mirror(duplicate(document, 0.0, 0.0) if copies else document, axis, centre)

        screen.edit("Mirrored copy" if copies else "Mirror", mirrored)

    choices: list[tuple[str, Callable[[], object]]] = [
        ("Left and right", lambda: do("x", (x, y))),
        ("Up and down", lambda: do("y", (x, y))),
        ("Left and right about x = 0", lambda: do("x", (0.0, y))),
        ("A copy to the right", lambda: do("x", (right, y), copies=True)),
        ("A copy to the left", lambda: do("x", (left, y), copies=True)),
        ("A copy about x = 0", lambda: do("x", (0.0, y), copies=True)),
    ]
    choose(screen.ui, "Mirror", "Which way should it be mirrored?", choices, columns=2)


def _box(screen: Editing) -> Box | None:
    box = screen.selection_box
    if box is None:
        screen.say("Nothing is selected.")
    return box


def _ask_array(screen: Editing) -> None:
    if _has_selection(screen):
        choices = [
            ("Along a line", lambda: _ask_line(screen)),
            ("In rows and columns", lambda: _ask_grid(screen)),
            ("Along a circle", lambda: _ask_circle(screen)),
        ]
        choose(screen.ui, "Array", "Put several copies of the selection", choices)


def _ask_line(screen: Editing) -> None:
    box = screen.selection_box
    assert box is not None
    apart = box[2] - box[0] + 2 * screen.grid
    _ask_numbers(
        screen, "Array along a line", FIRST_COPY, "Array", array_line,
        ("Number of copies, with the first", "5", _count),
        ("Step to the right [m]", f"{apart:.4g}", _number), ("Step upward [m]", "0", _number),
    )  # fmt: skip


def _ask_grid(screen: Editing) -> None:
    box = screen.selection_box
    assert box is not None
    across, up = box[2] - box[0] + 2 * screen.grid, box[3] - box[1] + 2 * screen.grid

    def filled(document: Document, columns: int, dx: float, rows: int, dy: float) -> Document:
        return array_line(array_line(document, columns, dx, 0.0), rows, 0.0, dy)

    _ask_numbers(
        screen, "Rows and columns", FIRST_COPY, "Array", filled,
        ("Columns", "3", _count), ("Step to the right [m]", f"{across:.4g}", _number),
        ("Rows", "3", _count), ("Step upward [m]", f"{up:.4g}", _number),
    )  # fmt: skip


def _ask_circle(screen: Editing) -> None:
    box = screen.selection_box
    assert box is not None
    x, y = (box[0] + box[2]) / 2, box[1] - (box[3] - box[1]) - 1.0

    def filled(document: Document, count: int, x: float, y: float, angle: float) -> Document:
        return array_circle(document, count, (x, y), math.radians(angle))

    _ask_numbers(
        screen, "Array along a circle", FIRST_COPY, "Array", filled,
        ("Number of copies, with the first", "6", _count),
        ("Middle x [m]", f"{x:.4g}", _number), ("Middle y [m]", f"{y:.4g}", _number),
        ("Angle from one to the next [degrees]", "60", _number),
    )  # fmt: skip


def _ask_parts(screen: Editing) -> None:
    names = ("group", "ungroup", "break_apart", "unjoin")
    labels = ("Group", "Ungroup", "Break bodies apart", "Take joints apart")
    choices = [(label, screen.actions[name]) for label, name in zip(labels, names, strict=True)]
    text = (
        "A click selects the whole group. A double click selects one member. "
        "Breaking a body apart turns it into loose particles and springs."
    )
    choose(screen.ui, "Parts", text, choices)


def _ask_align(screen: Editing) -> None:
    if not _has_selection(screen):
        return
    edges: tuple[tuple[str, Edge], ...] = (
        ("Left edges", "left"), ("Right edges", "right"), ("Top edges", "top"), ("Bottom edges", "bottom"),
        ("Middles, side by side", "centre_y"), ("Middles, one above another", "centre_x"),
    )  # fmt: skip
    choices: list[tuple[str, Callable[[], object]]] = [
        (label, lambda edge=edge: screen.edit("Align", lambda document: align(document, edge)))  # type: ignore[misc]
        for label, edge in edges
    ]
    choices += [
        ("Even gaps across", lambda: screen.edit("Distribute", lambda document: distribute(document, "x"))),
        ("Even gaps upward", lambda: screen.edit("Distribute", lambda document: distribute(document, "y"))),
    ]
    choose(screen.ui, "Align", "Line up what is selected.", choices, columns=2)


def _ask_order(screen: Editing) -> None:
    if not _has_selection(screen):
        return
    places: tuple[tuple[str, Place], ...] = (
        ("To the front", "front"), ("Forward", "forward"), ("Backward", "backward"), ("To the back", "back"),
    )  # fmt: skip
    text = "Things later in the file are drawn in front of earlier ones."
    choose(screen.ui, "Order", text, [(label, partial(_reorder, screen, to)) for label, to in places])


def _ask_wave(screen: Editing) -> None:
    """Ask for a wave through muscles in their order."""
    hint = "Phases of the selected muscles, or of all, from first to last."
    _ask_numbers(screen, "Phase wave", hint, "Phase wave", wave_in_order, ("Waves along them", "1", _number))


def _ask_numbers(
    screen: Editing, title: str, hint: str, step: str, change: Callable[..., Document],
    *fields: tuple[str, str, Callable[[str], float]],
) -> None:  # fmt: skip
    """Ask for numbers, (label, first text, how it is read) each, and make change(document, *numbers) an edit."""

    def make(*texts: str) -> str | None:
        try:
            numbers = [read(text) for (_, _, read), text in zip(fields, texts, strict=True)]
        except ValueError as error:
            return str(error)
        return None if screen.edit(step, lambda document: change(document, *numbers)) else "Not possible."

    fill_in(screen.ui, title, hint, [(label, text) for label, text, _ in fields], "Make", make)


def _count(text: str) -> int:
    value = _number(text)
    if value != int(value) or not 2 <= value <= COPY_LIMIT:
        raise ValueError(f"How many: {text!r} is no whole number from 2 to {COPY_LIMIT:,}.")
    return int(value)


def _number(text: str) -> float:
    try:
        value = float(text.replace(",", "."))
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"{text or 'nothing'!r} is not a number.")
    return value


def _show_menu(screen: Editing, app: Application) -> None:
    """Open the menu of actions that have no button."""
    entries = [entry for entry in shortcuts("edit") if entry.action in (*MENU, *screen.without_button)]
    choices = [(tip_of(entry.action, "edit"), partial(app.act, entry.action)) for entry in entries]
    choose(screen.ui, "More", "", choices, columns=2)
