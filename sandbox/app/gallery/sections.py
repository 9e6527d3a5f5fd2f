"""Sections: in what order the gallery shows the shipped levels, under which headings, and what to do with each."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class GallerySection:
    """A heading, a line beside it, and the stems of level files, each with what to do with the level in a few words."""

    title: str
    line: str
    levels: dict[str, str]


SECTIONS = (
    GallerySection("Toys", "Pick one and grab anything.", {
        "jelly_pile": "Squish, stack, throw",
        "truck_bridge": "Will it hold? Set Cs of iron to 1",
        "balloons": "Cut the rope and fly",
        "wrecking_crane": "Drag the ball back and let go",
        "rope_bridge_wheel": "Watch it roll across",
        "pinball": "A and D flip",
        "hourglass": "Turn gravity over",
        "suspension_car": "D drives, A drives back",
        "catapult": "Hold D and let fly",
    }),
    GallerySection("Puzzles", "Each can be won. The first ones are easy.", {
        "chain_of_events": "One push, and all follows",
        "egg_drop": "Make the cushion soft, then press D",
        "low_door": "Soften the deck, then drive",
        "squeeze": "Soft, then firm again",
        "bridge_budget": "Three things to fill the pit with",
        "trampoline_basket": "Tune the bed, then press D",
        "catapult_practice": "Tune the thread, then hold D",
        "basket_throw": "Swing the ball, then let go",
        "truck_course": "D drives, but not too fast",
        "crane": "A, D, W, S, and C lets go",
        "sorting_belt": "D lifts the flap",
        "ferry": "Load the boat with care",
        "pinball_score": "A and D flip",
    }),
    GallerySection("Soft things", "Jellies, cloth and creatures.", {
        "curtain": "Tug a corner, unpin a hook",
        "jelly_cube": "Lower Cs, and it softens",
        "trampoline": "Pull the bed down and let go",
        "desk_toy": "Two jellies and a marble in a box",
        "walker": "Hold it back, or lift it over",
        "beating_heart": "Pull at one, or cut its cord",
        "jelly_wheel": "Spin it by its rim",
        "quad_mesh": "Tear it, or unpin a corner",
        "rope_bridge_jelly": "One of each kind to pull at",
    }),
    GallerySection("Machines", "Motors, wheels and balls.", {
        "tumble_drum": "Hold D or A to turn it",
        "ferris_wheel": "D and A turn it either way",
        "marble_mill": "Drag marbles back up",
        "dominoes": "Stand them up again",
        "newtons_cradle": "Lift two, and two leave",
        "clock_spring": "Wind it by its rim",
    }),
    GallerySection("Bridges and ropes", "Pull, cut, and see who takes the load.", {
        "rope": "Crack it like a whip",
        "suspension_bridge": "Pull the deck, cut the cable",
        "breaking_bridge": "Swing the ball",
        "spider_web": "Pull at the fly",
    }),
    GallerySection("Proofs for engineers", "What the equations promise, and how to try it.", {
        "girder": "Drag its free end: it hardly gives",
        "mast": "Drag its head: it stays where it is",
        "truss_bridge": "Cut one bar; then cut it through",
        "wrecking_ball": "A ball a thousand times its links",
        "side_by_side": "Right after one tick at Cs = Cd = 1",
        "hooke_comparison": "See the classic spring explode",
    }),
)  # fmt: skip
# Where levels go that no section names.
OTHERS = GallerySection("More", "", {})
# What a first visit is to begin with.
FIRST = "jelly_pile"


def in_sections(paths: Iterable[Path]) -> list[tuple[GallerySection, list[Path]]]:
    """Shipped level files by the sections that name them, in their order; those that none names come last."""
    remaining = {path.stem: path for path in paths}
    result = [(section, [remaining.pop(name) for name in section.levels if name in remaining]) for section in SECTIONS]
    return [(section, found) for section, found in [*result, (OTHERS, list(remaining.values()))] if found]


def is_found(query: str, *texts: str) -> bool:
    """Whether every word of a query stands in one of the texts, wherever in it and however written."""
    low = [text.casefold() for text in texts]
    return all(any(word in text for text in low) for word in query.casefold().split())


def search_rank(query: str, name: str) -> int:
    """How well a name fits a query, 0 best: it is the query, begins with it, has all of its words, or none of these."""
    query_words, found = " ".join(query.casefold().split()), name.casefold()
    fits = found == query_words, found.startswith(query_words), all(word in found for word in query_words.split())
    return fits.index(True) if True in fits else len(fits)
