"""Things that a stranger draws in New, each by strokes: what to take up, and where to press, draw and let go."""

import itertools
import math

import pygame

# The drawings are so many times as large.
SIZE = 1.5
# SDL gives what a finger does as a mouse's events, which say so.
FINGER = {"touch": True}


def ring(x, y, radius, count=24):
    """A circle drawn by hand, a little out of round [m]."""
    turns = [math.tau * k / count for k in range(count)]
    return [
        (x + radius * (1.0 + 0.03 * math.sin(3.0 * turn)) * math.cos(turn), y + radius * math.sin(turn))
        for turn in turns
    ]


def slab(x, y, width, height, turn=0.0):
    """A plank or a box about its middle [m], turned by an angle."""
    corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5)]
    points = []
    for (ax, ay), (bx, by) in itertools.pairwise(corners):
        points += [(width * (ax + (bx - ax) * k / 6), height * (ay + (by - ay) * k / 6)) for k in range(6)]
    c, s = math.cos(turn), math.sin(turn)
    return [(x + c * px - s * py, y + s * px + c * py) for px, py in points]


class Hands:
    """A person with a mouse or a finger at the window; strokes: how many presses there were."""

    def __init__(self, driver, is_finger=False):
        self.driver, self.is_finger, self.strokes = driver, is_finger, 0

    def take(self, tool):
        """Press the button of a tool."""
        self.press([self.driver.app.play.palette.buttons[tool].rect.center])

    def pause(self):
        """Press the button that lets time stand, or go on."""
        self.press([self.driver.app.play.toolbar.buttons["pause"].rect.center])

    def draw(self, *points):
        """Press at the first of some points [m], go along the others, and let go."""
        self.press([self.driver.stage.camera.to_pixels((SIZE * x, SIZE * y)) for x, y in points])

    def press(self, pixels):
        """A stroke along pixels."""
        self.strokes += 1
        driver, more = self.driver, FINGER if self.is_finger else {}
        places = [(round(x), round(y)) for x, y in pixels]
        if not self.is_finger:
            driver.move(places[0])
        kinds = [pygame.MOUSEBUTTONDOWN, *[pygame.MOUSEMOTION] * (len(places) - 1), pygame.MOUSEBUTTONUP]
        for kind, place in zip(kinds, [*places, places[-1]], strict=True):
            moved = {"rel": (0, 0), "buttons": (1, 0, 0)} if kind == pygame.MOUSEMOTION else {"button": 1}
            driver.post(kind, pos=place, **moved | more)
            driver.pass_unseen()
        driver.pass_unseen()


def cart(hands):
    """A plank on two wheels, one of which has a motor."""
    hands.pause()
    hands.take("draw_wood")
    hands.draw(*slab(-2.0, 1.3, 2.4, 0.3))
    hands.draw(*ring(-2.8, 1.1, 0.4))
    hands.draw(*ring(-1.2, 1.1, 0.4))
    hands.take("axle")
    hands.draw((-2.75, 1.15))
    hands.draw((-1.2, 1.1))
    hands.draw((-2.8, 1.1))
    hands.pause()


def swing(hands):
    """A seat on two ropes from the air."""
    hands.pause()
    hands.take("draw_wood")
    hands.draw(*slab(0.0, 1.2, 1.6, 0.25))
    hands.take("pull_rope")
    hands.draw((-0.7, 1.25), (-0.7, 2.5), (-0.7, 4.0))
    hands.draw((0.7, 1.25), (0.7, 2.5), (0.7, 4.0))
    hands.pause()


def see_saw(hands):
    """A plank that turns about an axle in the air, with a jelly at one end."""
    hands.pause()
    hands.take("draw_wood")
    hands.draw(*slab(0.0, 1.2, 4.0, 0.3))
    hands.take("axle")
    hands.draw((0.0, 1.2))
    hands.take("draw_jelly")
    hands.draw(*ring(1.5, 1.9, 0.35))
    hands.pause()


def cross(x, y, reach, half):
    """A cross of two bars about its middle [m], in one stroke."""
    quarter = [(half, half), (half, reach), (-half, reach)]
    turned = [(c * px - s * py, s * px + c * py) for c, s in ((1, 0), (0, 1), (-1, 0), (0, -1)) for px, py in quarter]
    return [(x + px, y + py) for px, py in turned]


def mill(hands):
    """A tower, and sails on an axle that a motor turns."""
    hands.pause()
    hands.take("draw_wood")
    hands.draw((-0.8, 0.05), (0.8, 0.05), (0.5, 1.5), (0.25, 2.8), (-0.25, 2.8), (-0.5, 1.5))
    hands.draw(*cross(0.0, 2.4, 1.5, 0.15))
    hands.take("axle")
    hands.draw((0.1, 2.35))
    hands.draw((0.0, 2.4))
    hands.pause()


def catapult(hands):
    """A beam about an axle, a stone on its long arm, and a heavy thing that falls on its short one."""
    hands.pause()
    hands.take("draw_wood")
    hands.draw(*slab(0.0, 0.8, 4.0, 0.3))
    hands.take("axle")
    hands.draw((0.6, 0.8))
    hands.take("draw_jelly")
    hands.draw(*ring(-1.7, 1.3, 0.25))
    hands.take("draw_steel")
    hands.draw(*slab(1.6, 4.0, 1.0, 1.0))
    hands.pause()


def bridge(hands):
    """Planks in a row, joined by axles to each other and to the air."""
    hands.pause()
    hands.take("draw_wood")
    for x in (-2.1, -0.7, 0.7, 2.1):
        hands.draw(*slab(x, 2.0, 1.7, 0.25))
    hands.take("axle")
    for x in (-2.8, -1.4, 0.0, 1.4, 2.8):
        hands.draw((x, 2.0))
    hands.pause()


def chain(hands):
    """Three rings, each joined to the next by a rope, that hang in the air."""
    hands.pause()
    hands.take("draw_steel")
    for y in (3.3, 2.3, 1.3):
        hands.draw(*ring(0.0, y, 0.3))
    hands.take("pull_rope")
    for top, low in ((4.4, 3.3), (3.3, 2.3), (2.3, 1.3)):
        hands.draw((0.0, top), (0.0, (top + low) / 2), (0.0, low))
    hands.pause()


def house(hands):
    """Two walls, a beam on them and a roof."""
    hands.pause()
    hands.take("draw_wood")
    hands.draw(*slab(-1.0, 0.75, 0.4, 1.5))
    hands.draw(*slab(1.0, 0.75, 0.4, 1.5))
    hands.draw(*slab(0.0, 1.68, 2.8, 0.35))
    hands.draw((-1.5, 1.86), (0.0, 2.8), (1.5, 1.86), (0.8, 1.86), (-0.8, 1.86))
    hands.pause()


def boat(hands):
    """A hull, a mast that a rod and axles hold, and a sail: it stands on the ground, as New has no water."""
    hands.pause()
    hands.take("draw_wood")
    hands.draw((-1.2, 0.9), (-0.8, 0.2), (0.8, 0.2), (1.2, 0.9), (0.4, 0.9), (-0.4, 0.9))
    hands.draw(*slab(0.0, 1.7, 0.2, 2.2))
    hands.take("axle")
    hands.draw((0.0, 0.75))
    hands.take("pull_rod")
    hands.draw((0.0, 2.5), (-0.5, 1.5), (-1.0, 0.8))
    hands.draw((0.0, 2.5), (0.5, 1.5), (1.0, 0.8))
    hands.pause()


def walker(hands):
    """A body on two crosses of four legs, each about an axle that a motor turns."""
    hands.pause()
    hands.take("draw_wood")
    hands.draw(*slab(-2.0, 1.7, 2.4, 0.5))
    hands.draw(*cross(-2.9, 1.5, 0.8, 0.12))
    hands.draw(*cross(-1.1, 1.5, 0.8, 0.12))
    hands.take("axle")
    hands.draw((-2.9, 1.5))
    hands.draw((-1.1, 1.5))
    hands.draw((-2.9, 1.5))
    hands.draw((-1.1, 1.5))
    hands.pause()


THINGS = {made.__name__: made for made in (cart, swing, see_saw, mill, catapult, bridge, chain, house, boat, walker)}
