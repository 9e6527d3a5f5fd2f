"""Shared values: what the window and pages go by alike, as a module for pages.

python -m sandbox.app.site.shared_values writes it.
"""

import json
from collections.abc import Mapping
from typing import Any

from sandbox.app.base import gamepads, loop, sag_map
from sandbox.app.draw import colours, effects, looks, water
from sandbox.app.draw.things import belt_marks, drawables, faces, level_slots, members, soft, wheels
from sandbox.app.panel import engineers_rows, readings
from sandbox.app.panel.feel import feel_curve, feel_page, feel_work
from sandbox.app.play import hand_labels, stage
from sandbox.app.run import playback
from sandbox.app.sound import sound_events, voices, waves
from sandbox.export import curves, feel, release
from sandbox.level import checks
from sandbox.page.page import WEB
from sandbox.physics import world
from sandbox.physics.analysis import applied_forces, feel_search, query, step_response
from sandbox.physics.marks import LAW_HOOKE, SOLID_LEFT
from sandbox.physics.meshing import fitting
from sandbox.physics.softness import body_motion
from sandbox.session import summary, tuning
from sandbox.session.replay import format, link
from sandbox.tools import cut, drag, drawing, pulling

MODULE = WEB / "shared.js"
_HEAD = """// Shared: values that the window goes by too. Made by `python -m sandbox.app.site.shared_values`.
"""


def shared_values() -> dict[str, dict[str, Any]]:
    """Values by their names, by what goes by them; colours are "#rrggbb", times in seconds, lengths in pixels."""
    return {
        "RECORDING": _of(format, "TICK_DIGITS", "ARRAY_DIGITS", "STATE_TICKS")
        | {"CHAIN_DIGITS": format.CHAIN_DIGITS[format.VERSION]},
        "LINK": _of(link, "MARK", "BEAT", "VERSION", "LONGEST", "UNPACKED_LIMIT", "RUN_LIMIT", "COMMAND_LIMIT")
        | _of(link, "FARTHEST", "PER_METRE", "HANDS", "MOVE"),
        "CHECKS": _of(checks, "STILL") | _of(summary, "STRAIN_WINDOW"),
        "TUNING": {"KINDS": [each.type for each in tuning.TUNING], "SUBJECTS": tuning.SUBJECTS},
        "PACE": {"LONGEST": loop.LONGEST_FRAME, "BUDGET": playback.TICK_BUDGET},
        "HANDS": {
            "STRENGTH": world.HAND_STRENGTH, "SOFT_REACH": query.REACH, "AT_LIMIT": applied_forces.HAND_AT_LIMIT,
            "PICK_RADIUS": stage.PICK_RADIUS, "UNITS": hand_labels.UNITS,
            "TIME_STANDS": drag.TIME_STANDS, "SOLID": SOLID_LEFT, "SHARES": 10**cut.DIGITS,
        },
        "GAMEPAD": _of(gamepads, "ACROSS", "UPWARDS", "BUTTONS", "PRESSES", "LETS_GO"),
        "MAKING": _of(pulling, "SEGMENTS", "ROPE_MASS", "SHARE", "PIN_RADIUS", "PIN_SHARE", "TOO_SHORT")
        | {"ROPE_RADIUS": pulling.THICKEST}
        | _of(drawing, "HAND_TOLERANCE", "SKIN", "THICKEST", "REFUSALS"),
        "MESH": _of(fitting, "NUMBERS", "PLACES", "TRIANGLES", "PAIRS"),
        "PAD": _of(sag_map, "NUMBERED", "DIGITS", "END")
        | {"LOWEST": sag_map.PLAIN.lowest, "REST": sag_map.PLAIN.rest}
        | {"RIGID": body_motion.RIGID, "UNSEEN": readings.UNSEEN},
        "SOLVING": {"LABELS": engineers_rows.SOLVER_LABELS, "TIPS": engineers_rows.SOLVER_TIPS},
        "SOUND": _of(
            sound_events, "SOFTEST", "HARDEST", "NEWS", "MEMORY", "MOST", "JERK", "HARD_JERK", "TUNED",
            "HIGHEST_STRING", "SNAP_PITCH", "MOTOR_PITCH", "MOTOR_RISE", "SOFT_SPLASH", "HARD_SPLASH", "SPLASH_PITCH",
        )
        | _of(waves, "SCALE", "LOWEST", "STEPS")
        | _of(voices, "VOICES", "REST", "MOTOR_FADE", "WIDTH")
        | _of(waves, "LEVELS"),
        "THINGS": _of(looks, "STRANDS")
        | {"WORKING": drawables.WORKING, "LAID": drawables.CRATES, "HANGER": members.HANGER}
        | _of(members, "TRUSS", "MESH", "LOOSE", "BRACE"),
        "STRAIN": _of(level_slots, "FLUSH_FROM", "FLUSH_RANGE") | _of(soft, "LEAST_FLUSH"),
        "LINES": _of(members, "HALF", "PERIOD", "USUAL_PERIOD", "MOST_OF_STEP", "LEAST", "LEAST_BEND")
        | {"PLANKS": members.PLANKS_A_CELL, "BOLTS_FROM": members.BOLTS_FROM, "CYLINDER": _hex(members.CYLINDER)},
        "SHAPES": _of(soft, "LEAST_ROUNDING", "MOST_ROUNDING", "MOST_GROWN", "LINE_HALF")
        | _of(soft, "CLOTH_TEXELS", "LAID_TEXELS", "HEM_HALF"),
        "TREADS": _of(
            belt_marks, "STRAP_HALF", "CHEVRON", "CHEVRON_HALF", "SIDE", "APART", "MOST_PASSING", "LEAST_APART",
            "BESIDE",
        )
        | {"COLOUR": _hex(belt_marks.CHEVRON_COLOUR)},
        "WHEELS": _of(wheels, "RIM_FROM", "LUGS_FROM", "LUG"),
        "WATER": _of(
            water, "CLEAR", "MURKY", "DEEP", "NEAR", "SLOWEST", "PER_SPEED", "HIGHEST", "LENGTH", "PERIOD", "FADE",
            "MOST", "STEP", "LINE_HALF", "LIGHT", "STREAKS", "STREAK",
        )
        | _of(effects, "SPLASH", "DROPS_A_SPEED", "FASTEST_DROP", "FALL", "PLACES", "MOST_DROPS")
        | {"DROP_LIFE": effects.LIVES["drop"]},
        "FACES": _of(faces, "LARGEST", "SMALLEST", "SQUEEZED", "FAST", "BLINK", "BLINK_EVERY", "MOST_COMPARED")
        | {"TONGUE": _hex(faces.TONGUE)},
        "COLOURS": {
            "SQUEEZED": _hex(colours.SQUEEZED_FLUSH), "STRETCHED": _hex(colours.STRETCHED_FLUSH),
            "SANDS": list(map(_hex, colours.SANDS)),
        },
    } | _of_feel()  # fmt: skip


def _of_feel() -> dict[str, dict[str, Any]]:
    """What the card of how a thing feels goes by."""
    return {
        "RELEASE": _of(
            step_response, "NUMBER", "RATE", "DONE", "HELD", "REST", "COUNT", "ERRORS", "MOST_SECONDS", "STEP", "BEGIN",
            "LET_GO", "FREE", "FOUND",
        ),
        "RESPONSE": _of(
            step_response, "TICK", "OVERSHOOT", "SETTLING", "SWINGS", "STIFFNESS", "DAMPING", "FREQUENCY", "RATIO",
            "DIFFERENCE", "RESPONSE", "SETTLED",
        ),
        "SEARCH": _of(
            feel_search, "TRIED", "HAS", "GOT", "MISSED", "BEST_ROUND", "ROUND", "SOONEST", "SEARCH", "SOUGHT", "TRY",
            "OVER",
        ),
        "FEEL": {"HOOKE": LAW_HOOKE, "REASONS": release.REASONS, "CSS": curves.CSS}
        | _of(feel, "ALL_HOOKE", "FEELS", "REFUSALS", "AS_ASKED", "CLOSEST", "PAIR", "PAIR_OF_ALL")
        | _of(feel_curve, "ABOVE", "BEHIND", "LEAST_ABOVE", "SHORTEST", "MOST_OVERSHOOT", "LEAST_TICKS")
        | _of(feel_page, "MOST_SECONDS", "READINGS")
        | _of(feel_work, "HINT", "NO_HANDS", "MEASURING", "LOOKING", "WAYS"),
    }  # fmt: skip


def _of(module: Any, *names: str) -> dict[str, Any]:
    return {name: getattr(module, name) for name in names}


def _hex(colour: int) -> str:
    return f"#{colour:06x}"


def as_module(values: Mapping[str, Mapping[str, Any]]) -> str:
    """The values as a module of JavaScript."""
    return _HEAD + "".join(f"export const {name} = {_written(found)};\n" for name, found in values.items())


def _written(values: Mapping[str, Any]) -> str:
    plain = {name: json.dumps(_plain(value)).replace("'", r"\'") for name, value in values.items()}
    rows = [f"  {name}: {text},\n" for name, text in plain.items()]
    return "".join(["{\n", *rows, "}"]).replace('"', "'")


def _plain(value: Any) -> Any:
    """A value with whole numbers as JavaScript writes them."""
    if isinstance(value, Mapping):
        return {name: _plain(each) for name, each in value.items()}
    if isinstance(value, tuple | list):
        return [_plain(each) for each in value]
    return int(value) if isinstance(value, float) and value.is_integer() else value


if __name__ == "__main__":
    MODULE.write_text(as_module(shared_values()), encoding="utf-8", newline="\n")
