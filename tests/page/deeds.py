"""People who play a page: what commands do, by what they press, move and let go, with a mouse or with fingers."""

from abc import ABC, abstractmethod
from typing import Any

from tests.page.browser import Tab
from tests.page.opened import FRAMES, SETTLED, START_OVER
from tests.page.pointing import click, middle, place, tap

# A page has no boxes: they are drawn, as steel.
DRAWN = "steel"
# A press that rests asks for a menu after half a second.
RESTED = "new Promise((done) => setTimeout(done, 700))"
# By the button that steps, until a tick or an outcome.
STEPS = """(() => {
  const { toy } = page, button = document.getElementById('step');
  while (toy.run.time < UNTIL && !toy.outcome) button.click();
  return toy.outcome && toy.outcome.tick;
})()"""
# The name of the key that drives a part in a direction.
KEY_OF = """Object.entries(page.toy.drives.keys).find(([, parts]) => parts.some(([part, value]) =>
  page.toy.level.about.names.part[part] === 'PART' && Math.sign(value) === VALUE))[0]"""


class Player(ABC):
    """Somebody at a page: turns the commands of a solution into what is pressed, moved and released."""

    def __init__(self, tab: Tab, words: list[str]) -> None:
        self.tab, self._words, self._held = tab, list(words), {}
        tab.evaluate(START_OVER)

    @abstractmethod
    def down(self, point: tuple[float, float]) -> None:
        """Come down on a pixel."""

    def take(self, point: tuple[float, float]) -> None:
        """Come down on what is to be dragged."""
        self.down(point)

    @abstractmethod
    def move(self, point: tuple[float, float]) -> None:
        """Move there while it is down."""

    @abstractmethod
    def up(self) -> None:
        """Let go."""

    @abstractmethod
    def use(self, chosen: str) -> None:
        """Click or tap an element."""

    @abstractmethod
    def ask(self, point: tuple[float, float]) -> None:
        """Ask for the menu of what is at a pixel."""

    @abstractmethod
    def look_closer(self, point: tuple[float, float]) -> None:
        """Have what lies at a pixel as large as it takes to draw there."""

    @abstractmethod
    def key_down(self, name: str) -> None:
        """Hold a key of the level."""

    @abstractmethod
    def key_up(self, name: str) -> None:
        """Release it."""

    def until(self, tick: float) -> int | None:
        """Step until a tick; that of the outcome, where there is one by then."""
        ended: int | None = self.tab.evaluate(STEPS.replace("UNTIL", str(tick)))
        return ended

    def pixel(self, x: float, y: float) -> tuple[float, float]:
        """Where a place of the world is in the picture [pixels]."""
        across, down = self.tab.evaluate(f"page.toy.camera.toPixels({x}, {y})")
        return across, down

    def do(self, record: dict[str, Any]) -> None:
        """Do what a command of a solution does."""
        match record["type"]:
            case "grab":
                self.take(place(self.tab, record["particle"]))
                self.move(self.pixel(*record["target"]))
            case "move_grab":
                self.move(self.pixel(*record["target"]))
            case "release":
                self.up()
            case "set_drive":
                self._drive(record["part"], record["value"])
            case "hold_key":
                (self.key_down if record["down"] else self.key_up)(record["key"])
            case "set_firmness":
                self.ask(place(self.tab, f"{record['body']}.0"))
                word = self._words.pop(0)
                number = self.tab.evaluate(
                    f"[...document.querySelectorAll('#menu button')].findIndex((each) => each.textContent === '{word}')"
                )
                self.use(f"#menu button:nth-child({number + 1})")
            case "set_coefficients":
                self._material(record["material"], record["stiffness"])
            case "add_body":
                self._draw(*record["body"]["position"], *record["body"]["shape"]["box"])
            case other:
                raise ValueError(other)

    def _drive(self, part: str, value: float) -> None:
        if not value:
            key = self._held.pop(part)
            if key not in self._held.values():
                self.key_up(key)
            return
        key = self.tab.evaluate(KEY_OF.replace("PART", part).replace("VALUE", str(value)))
        if key not in self._held.values():
            self.key_down(key)
        self._held[part] = key

    def _material(self, name: str, stiffness: float) -> None:
        """Move the slider of Cs there."""
        self.use("#tune")
        self.tab.evaluate(SETTLED)
        # What the browser's own list of choices does.
        self.tab.evaluate(
            f"""(() => {{
              const choice = document.getElementById('material');
              choice.value = String(page.panel.materials.findIndex((each) => each.name === '{name}'));
              choice.dispatchEvent(new Event('change'));
            }})()"""
        )
        left, width, y, now, wanted = self.tab.evaluate(
            f"""(() => {{
              const slider = document.getElementById('slider0'), box = slider.getBoundingClientRect();
              return [box.left, box.width, box.top + box.height / 2, Number(slider.value),
                page.panel.chosen.scale.placeOf({stiffness})];
            }})()"""
        )
        # The middle of the knob does not leave the slider.
        knob = 16.0
        at = [left + knob / 2 + share * (width - knob) for share in (now, wanted)]
        self.down((at[0], y))
        self.move((left + width - knob / 2, y))
        self.move((at[1], y))
        self.up()
        self.use("#tune")
        self.tab.evaluate(SETTLED)

    def _draw(self, x: float, y: float, width: float, height: float) -> None:
        """Draw around a box about a place [m]."""
        self.use("#make")
        self.use(f"#{DRAWN}")
        self.tab.evaluate(SETTLED)
        self.look_closer(self.pixel(x, y))
        across, up = width / 2, height / 2
        corners = [(x - across, y - up), (x + across, y - up), (x + across, y + up), (x - across, y + up)]
        first, *others = (self.pixel(*corner) for corner in corners)
        self.down(first)
        for corner in others:
            self.move(corner)
        self.up()
        self.use("#make")
        self.tab.evaluate(SETTLED)


class ByMouse(Player):
    """With a mouse and a keyboard."""

    def down(self, point: tuple[float, float]) -> None:
        self._at = point
        self.tab.mouse("mousePressed", *point)

    def move(self, point: tuple[float, float]) -> None:
        self._at = point
        self.tab.mouse("mouseMoved", *point)

    def up(self) -> None:
        self.tab.mouse("mouseReleased", *self._at)

    def use(self, chosen: str) -> None:
        click(self.tab, chosen)

    def ask(self, point: tuple[float, float]) -> None:
        click(self.tab, point, "right")

    def look_closer(self, point: tuple[float, float]) -> None:
        """A mouse is fine enough."""

    def key_down(self, name: str) -> None:
        self.tab.press(_typed(name))

    def key_up(self, name: str) -> None:
        self.tab.release(_typed(name))


class ByFinger(Player):
    """With fingers on a phone: one in the picture, one on each key that is held."""

    def __init__(self, tab: Tab, words: list[str]) -> None:
        super().__init__(tab, words)
        self._fingers: dict[str, tuple[float, float]] = {}
        self._numbers: dict[str, int] = {}

    def _touch(self, kind: str, finger: str, point: tuple[float, float]) -> None:
        """What one finger does; the others stay where they are."""
        x, y = self._fingers[finger] = point
        number = self._numbers.setdefault(finger, len(self._numbers))
        self.tab.send("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y, "id": number}])

    def down(self, point: tuple[float, float]) -> None:
        self._touch("touchStart", "picture", point)

    def move(self, point: tuple[float, float]) -> None:
        self._touch("touchMove", "picture", point)
        # A browser tells of moves once in a frame.
        self.tab.evaluate("new Promise(requestAnimationFrame)")

    def up(self) -> None:
        # A finger that is lifted while it moves would be a flick, whose next tap only stops it.
        self.tab.evaluate(FRAMES)
        self._lift("picture")

    def take(self, point: tuple[float, float]) -> None:
        self.down(point)
        # One that rests would ask for a menu: it moves at once.
        self.move((point[0], point[1] - 20))

    def _lift(self, finger: str) -> None:
        self._touch("touchEnd", finger, self._fingers[finger])

    def use(self, chosen: str) -> None:
        tap(self.tab, chosen)

    def ask(self, point: tuple[float, float]) -> None:
        self.down(point)
        self.tab.evaluate(RESTED)
        self.up()

    def look_closer(self, point: tuple[float, float]) -> None:
        """By a second finger, while the tool is in hand."""
        x, y = point
        self._touch("touchStart", "picture", (x - 40, y))
        self._touch("touchStart", "other", (x + 40, y))
        self._touch("touchMove", "picture", (x - 80, y))
        self._touch("touchMove", "other", (x + 80, y))
        self.tab.evaluate(FRAMES)
        self._lift("other")
        self._lift("picture")

    def key_down(self, name: str) -> None:
        self._touch("touchStart", name, middle(self.tab, f'[aria-label="Key {name}"]'))

    def key_up(self, name: str) -> None:
        self._lift(name)


def _typed(key: str) -> str:
    return f"Arrow{key.capitalize()}" if key in ("left", "right", "up", "down") else key
