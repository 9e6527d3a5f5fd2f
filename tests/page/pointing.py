"""Where things of a page are, and what people do there by mouse, finger and keys."""

from tests.page.browser import Tab


def middle(tab: Tab, chosen: str) -> tuple[float, float]:
    """The middle of an element [pixels]."""
    box = f"document.querySelector(`{chosen}`).getBoundingClientRect()"
    x, y = tab.evaluate(f"(({{ x, y, width, height }}) => [x + width / 2, y + height / 2])({box})")
    return x, y


def place(tab: Tab, particle: str) -> tuple[float, float]:
    """Where a particle is in the picture [pixels]."""
    slot = f"page.toy.level.about.names.particle.indexOf('{particle}')"
    position = "page.toy.world.view('state.position')"
    x, y = tab.evaluate(f"page.toy.camera.toPixels({position}[2 * {slot}], {position}[2 * {slot} + 1])")
    return x, y


def tap(tab: Tab, chosen: str) -> None:
    """Touch an element shortly."""
    tab.touch("touchStart", middle(tab, chosen))
    tab.touch("touchEnd")


def click(tab: Tab, chosen: str | tuple[float, float], button: str = "left") -> None:
    """Click an element, or a pixel."""
    x, y = middle(tab, chosen) if isinstance(chosen, str) else chosen
    for kind in ("mousePressed", "mouseReleased"):
        tab.mouse(kind, x, y, button)


def drag(tab: Tab, *way: tuple[float, float]) -> None:
    """Press, move and let go of the left button."""
    tab.mouse("mousePressed", *way[0])
    for each in way[1:]:
        tab.mouse("mouseMoved", *each)
    tab.mouse("mouseReleased", *way[-1])


def text(tab: Tab, chosen: str) -> str:
    """The text of an element as people read it."""
    found = tab.evaluate(f"document.querySelector('{chosen}').innerText")
    assert isinstance(found, str)
    return found
