"""svg(flat): a picture of a flat level as it begins, in metres, with y up, that any browser opens."""

from collections.abc import Iterable
from xml.sax.saxutils import escape, quoteattr

from sandbox.export.flat import FlatBody, FlatLevel, Place
from sandbox.level.format.look import PALETTE, colour_of

# Share of the larger side of the picture that is left free around, and by which the thinnest lines are thick.
MARGIN, HAIR = 0.04, 0.0015
# Pixels of the larger side, where a viewer asks.
LARGEST_SIDE = 1000
PAPER, GROUND, LINE, PIN = "#ffffff", "#8a7f70", "#3c4650", "#0f7f78"
COLOURS = tuple(PALETTE)


def svg(level: FlatLevel) -> str:
    """The text of the picture: terrain, skins of bodies, springs, and loose particles and pins as discs."""
    left, bottom, right, top = _frame(level)
    width, height = right - left, top - bottom
    hair, scale = HAIR * max(width, height), LARGEST_SIDE / max(width, height)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{_n(left)} {_n(-top)} {_n(width)} {_n(height)}" '
        f'width="{_n(width * scale)}" height="{_n(height * scale)}">',
        f"<title>{escape(level.name)}</title>",
        f'<rect x="{_n(left)}" y="{_n(-top)}" width="{_n(width)}" height="{_n(height)}" fill="{PAPER}"/>',
        f'<g transform="scale(1 -1)" stroke-width="{_n(hair)}" stroke-linejoin="round" stroke-linecap="round">',
        *_terrain(level, (left, bottom, right, top), hair),
        *_bodies(level),
        *_springs(level),
        *_discs(level, hair),
        "</g>",
        "</svg>",
    ]
    return "\n".join(lines) + "\n"


def _frame(level: FlatLevel) -> tuple[float, float, float, float]:
    """Left, bottom, right, top [m] of the picture: the level's view, or everything."""
    if level.view is not None:
        return level.view
    places = [(x, y, part.radius) for part in level.particles for x, y in [part.position]]
    places += [(x, y, 0.0) for piece in level.terrain for x, y in piece.corners]
    if not places:
        return -1.0, -1.0, 1.0, 1.0
    left, bottom = min(x - r for x, _, r in places), min(y - r for _, y, r in places)
    right, top = max(x + r for x, _, r in places), max(y + r for _, y, r in places)
    margin = MARGIN * max(right - left, top - bottom, 0.1)
    return left - margin, bottom - margin, right + margin, top + margin


def _terrain(level: FlatLevel, frame: tuple[float, float, float, float], hair: float) -> Iterable[str]:
    left, bottom, right, top = frame
    for piece in level.terrain:
        path = _path(piece.corners, piece.kind != "line")
        name = f"<title>{escape(piece.id)}</title>"
        if piece.kind == "line":
            yield f'<path d="{path}" fill="none" stroke="{GROUND}" stroke-width="{_n(4 * hair)}">{name}</path>'
        elif piece.kind == "hollow":
            around = _path(((left, bottom), (right, bottom), (right, top), (left, top)), True)
            yield f'<path d="{around}{path}" fill="{GROUND}" fill-rule="evenodd">{name}</path>'
        else:
            yield f'<path d="{path}" fill="{GROUND}">{name}</path>'


def _bodies(level: FlatLevel) -> Iterable[str]:
    for number, body in enumerate(level.bodies):
        closed = [outline for outline in body.outlines if outline.closed]
        if closed:
            path = "".join(_path([level.particles[p].position for p in outline.particles], True) for outline in closed)
            yield (
                f'<path id={quoteattr(body.id)} d="{path}" fill="{_colour(level, body, number)}" fill-opacity="0.6" '
                f'fill-rule="evenodd" stroke="{LINE}"><title>{escape(body.id)}</title></path>'
            )


def _colour(level: FlatLevel, body: FlatBody, number: int) -> str:
    for look in (body.look, level.materials[body.material].look):
        if look is not None and look.colour is not None:
            return f"#{colour_of(look.colour):06x}"
    return f"#{PALETTE[COLOURS[number % len(COLOURS)]]:06x}"


def _springs(level: FlatLevel) -> Iterable[str]:
    if level.springs:
        places = [part.position for part in level.particles]
        path = "".join(_path([places[spring.a], places[spring.b]], False) for spring in level.springs)
        yield f'<path d="{path}" fill="none" stroke="{LINE}"/>'


def _discs(level: FlatLevel, hair: float) -> Iterable[str]:
    for number, part in enumerate(level.particles):
        if part.body is None or part.pinned:
            x, y = part.position
            look = part.look
            colour = colour_of(look.colour) if look is not None and look.colour is not None else None
            fill = (
                PIN if part.pinned else f"#{PALETTE[COLOURS[number % len(COLOURS)]] if colour is None else colour:06x}"
            )
            radius = min(part.radius, 4 * hair) if part.pinned else part.radius
            yield f'<circle cx="{_n(x)}" cy="{_n(y)}" r="{_n(radius)}" fill="{fill}" stroke="{LINE}"/>'


def _path(places: Iterable[Place], closed: bool) -> str:
    return "M" + "L".join(f"{_n(x)} {_n(y)}" for x, y in places) + ("Z" if closed else "")


def _n(value: float) -> str:
    """To a tenth of a millimetre."""
    text = f"{value:.4f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text
