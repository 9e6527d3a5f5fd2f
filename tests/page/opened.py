"""Pages that a browser has opened, and the files that they save."""

import base64
from pathlib import Path

from tests.page.browser import Browser, Tab, page_address

# Until the level is shown where bars leave room by now.
SETTLED = """(async () => {
  for (let left = 3; left; left--) await new Promise((done) => requestAnimationFrame(done));
  page.toy.fit();
})()"""
# From the start, while tests make the ticks: hands take it that time passes.
TICKED = "page.toy.restart(); page.toy.pause(); page.toy.hands.isStill = () => false"
# The same, without the words that go once somebody has played: the view then stands.
# Has what hands may not do in sight, to be refused.
ALL_SHOWN = """for (const name of page.toy.level.absent.splice(0)) {
  for (const each of document.querySelectorAll(`#${name}, #panel .${name}`)) each.hidden = false;
}
page.panel.show()"""
START_OVER = f"""(async () => {{
  if (!document.getElementById('hints').hidden) document.getElementById('hint').click();
  await {SETTLED};
  {TICKED};
}})()"""
# Time stands for hands too.
STANDS = "page.toy.hands.isStill = () => page.toy.isPaused"
# What a page says of a recording at last, or why there is none.
VERDICT = """new Promise((done) => {
  const said = () => ['verdict', 'state'].map((id) => document.getElementById(id)).find(({ className }) =>
    ['good', 'bad', 'refusal'].includes(className));
  const look = () => (said() ? done(said().textContent) : requestAnimationFrame(look));
  look();
})"""
# Until a toy of one's own page is there.
READY = """new Promise((done) => {
  const look = () => (globalThis.toy?.run ? done() : requestAnimationFrame(look));
  look();
})"""
# Until some frames have passed: a browser has seen a finger stand still, or what is out of sight.
FRAMES = """new Promise((done) => {
  let left = 20;
  const next = () => (left-- ? requestAnimationFrame(next) : done());
  next();
})"""
SAVE = """TOY.recording().then(async (file) => {
  const bytes = new Uint8Array(await file.arrayBuffer());
  return btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(''));
})"""


def opened(browser: Browser, folder: Path, text: str, **how: object) -> Tab:
    """A page in a tab of its own."""
    file = folder / "page.html"
    file.write_text(text, encoding="utf-8")
    return browser.tab(**how).open(page_address(file))  # type: ignore[arg-type]


def saved(tab: Tab, folder: Path, toy: str = "page.toy") -> Path:
    """The file of what was done in a page to its toy."""
    file = folder / "saved.replay.gz"
    file.write_bytes(base64.b64decode(tab.evaluate(SAVE.replace("TOY", toy))))
    return file
