"""`sandbox feel`."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from sandbox.cli.base.command import Subcommand, argument, flag, option, option_or, optional_argument
from sandbox.cli.base.inputs import EXIT_OK, Refused, level_of
from sandbox.terminal import seconds, share

if TYPE_CHECKING:
    from collections.abc import Generator

    from sandbox.export.feel import Feel
    from sandbox.level.assembly.build_world import LevelWorld

# Seconds that a level runs before its thing is measured as it stands.
BEFORE = 10.0
WAYS = ("down", "aside")
TOOLS = ("css", "unity", "godot", "swiftui", "flutter", "motion", "react-spring")


@dataclass(frozen=True, kw_only=True)
class FeelOptions:
    """Options of `feel`: the thing, how it is pulled, what is wanted of it, and for which tool."""

    level: str = argument(str, "LEVEL")
    thing: str | None = optional_argument(str, "THING", "a body; default: the first that has springs")
    particle: str | None = option(
        str, metavar="NAME", help="which particle is pulled; default: the farthest from all that holds the body"
    )
    way: str = option_or("down", str, choices=WAYS, help="down, as gravity has it, or aside; default: down")
    overshoot: float | None = option(
        share, metavar="X", help="look for Cs and Cd with which it overshoots by this share, such as 0.15"
    )
    settle: float | None = option(seconds, metavar="SECONDS", help="and after which it has settled to 2 %%")
    to: str | None = option(
        str, choices=TOOLS,
        help="css, unity, godot: the curve as measured; swiftui, flutter, motion, react-spring: the nearest spring",
    )  # fmt: skip
    nearest: bool = flag("the curve of the nearest spring, also where the measured one can be had")
    output: Path | None = option(
        Path, "-o", "--output", metavar="FILE", help="write a picture (.svg), or a page that plays the curve (.html)"
    )


def feel(options: FeelOptions) -> int:
    """Print how a thing feels, or what makes it feel so. Raises Refused."""
    from sandbox.export.curves import MEASURED, NEAREST, card_page, card_picture, card_text, curve_for
    from sandbox.export.engines import NoSuchBody
    from sandbox.export.release import NoCurve
    from sandbox.level.assembly.build_world import build_world
    from sandbox.physics.step import step

    if (options.overshoot is None) != (options.settle is None):
        raise Refused("--overshoot and --settle go together: a spring has two numbers")
    form = NEAREST if options.nearest else None
    writers = {".svg": card_picture, ".html": lambda found: card_page(found, form or MEASURED)}
    if options.output is not None and options.output.suffix not in writers:
        raise Refused(f"{options.output}: a picture ends in .svg, and a page in .html")
    world = build_world(level_of(options.level))
    for _ in range(round(BEFORE * world.settings.tick_rate)):
        step(world)
    try:
        found, wanted = _found(options, world)
        text = f"{card_text(found)}\n{wanted}"
        if options.to:
            text = "{}:\n{}\n".format(*curve_for(found, options.to, form))
    except NoSuchBody as error:
        raise Refused(f"{options.level}: {error}") from None
    except (NoCurve, ValueError) as error:
        raise Refused(f"{options.level}: {options.thing or 'its first body'}: {error}") from None
    print(text, end="")
    if options.output is not None:
        options.output.write_text(writers[options.output.suffix](found), encoding="utf-8")
    return EXIT_OK


def _found(options: FeelOptions, world: "LevelWorld") -> "tuple[Feel, str]":
    # The card, and what was looked for, as lines.
    from sandbox.export.engines import choose_body
    from sandbox.export.feel import feel_in_slices, feel_of, material_of, sought

    if options.particle is not None and options.particle not in world.particle_names:
        raise Refused(f"{options.level}: there is no particle called {options.particle}")
    if options.overshoot is None or options.settle is None:
        return feel_of(world, options.thing, options.particle, options.way), ""

    def measure(tried: "LevelWorld") -> "Generator[float, None, Feel]":
        return feel_in_slices(tried, options.thing, options.particle, options.way)

    material = material_of(world, choose_body(world, options.thing).name)
    found = sought(world, options.overshoot, options.settle, measure, material)
    return found.feel, f"  with {found.pair_text(world)}: {found.nearness}\n"


COMMAND = Subcommand("feel", "measure how a thing comes back, and take its curve to another tool", FeelOptions, feel)
