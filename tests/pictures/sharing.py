"""Draws the pictures of docs/sharing.md: the deeds of that page, by mouse, in a window that nobody sees."""

from tests.pictures.photographer import DOCS, Photographer

FOLDER = DOCS / "sharing"
WIDTH = 720
# What is drawn on the sheet: a tool, and from where to where it is dragged [m].
DRAWN = (
    ("tool_box", (-4.5, 0.5), (-2.0, 2.5)),
    ("tool_circle", (0.5, 1.5), (1.3, 2.0)),
    ("tool_box", (3.0, 0.5), (5.0, 1.5)),
)


def draw() -> None:
    """Do what the page says and draw each step."""
    driver = Photographer()
    driver.width = WIDTH
    driver.wait_for_gallery()
    driver.take(FOLDER / "1-gallery.png")
    driver.choose("New")
    driver.app.act("edit")
    for tool, start, end in DRAWN:
        driver.app.act(tool)
        driver.drag(start, end)
    driver.app.act("cancel")
    driver.app.act("tool_select")
    driver.take(FOLDER / "2-sheet.png")
    driver.app.act("play")
    driver.frames(60)
    names = driver.world.particle_names
    first = {name.partition(".")[0]: name for name in names}
    for name, by in zip(first.values(), ((6.0, 6.0), (-4.0, 5.0), (-5.0, 5.0)), strict=False):
        driver.throw(name, by)
        driver.frames(25)
    driver.take(FOLDER / "3-play.png")
    driver.frames(200)
    driver.app.act("share")
    while driver.app.sharing._filming is not None:
        driver.app.sharing.update(0.0)
    driver.frames(240)
    driver.take(FOLDER / "4-share.png")
    driver.choose("Save")
    while driver.app.sharing.step == "work" or driver.app.sharing._copying is not None:
        driver.app.sharing.update(0.0)
    driver.take(FOLDER / "5-saved.png")
    driver.app.sharing.saved.replace(FOLDER / "my-toy.gif")
    driver.app.close()
