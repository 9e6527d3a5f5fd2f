"""Every page that is written has a policy: it runs its own scripts, loads what is its own, and nothing else."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import sandbox
from sandbox.cli import main
from sandbox.replay import read_replay, verify
from tests.page.browser import Browser, Tab, page_address
from tests.page.levels import level_page
from tests.page.opened import FRAMES
from tests.page.site_server import served
from tests.support.player_page import rope_page

PACKAGE = Path(sandbox.__file__).parent
HEAD = '<meta charset="utf-8">\n<meta http-equiv="Content-Security-Policy" content="@POLICY@">\n'
PAGES = ("played.html", "player.html", "index.html", "README.html", "levels/suspension_car.html")
TABLE = """# A <script>table</script>

| name | figure |
|:---|---:|
| one | 1 |

![local](dot.png) ![elsewhere](http://127.0.0.1:9/dot.png)
![here](data:image/gif;base64,R0lGODlhAQABAIAAAAAAAP///yH5BAEAAAAALAAAAAABAAEAAAIBRAA7)

<p style="color: red" onclick="globalThis.injected = 1">raw <script>globalThis.injected = 1</script></p>
"""
# What an intruder would try; which directives were in the way of it.
INTRUDING = """(async () => {
  const seen = new Set(), { body } = document, elsewhere = 'http://127.0.0.1:9/';
  const add = (name, given) => body.append(Object.assign(document.createElement(name), given));
  document.addEventListener('securitypolicyviolation', (event) => seen.add(event.effectiveDirective));
  add('script', { textContent: 'globalThis.injected = 1' });
  add('script', { src: `${elsewhere}script.js` });
  add('style', { textContent: 'body { opacity: 0 }' });
  body.insertAdjacentHTML('beforeend', '<i style="opacity: 0" onclick="globalThis.injected = 1">i</i>');
  body.lastElementChild.click();
  add('img', { src: `${elsewhere}image.png` });
  add('iframe', { src: elsewhere });
  add('object', { data: elsewhere });
  add('base', { href: elsewhere });
  add('form', { action: elsewhere });
  body.lastElementChild.submit();
  const worker = URL.createObjectURL(new Blob([''], { type: 'text/javascript' }));
  try { new Worker(worker); } catch { /* It was in the way at once. */ }
  await fetch(elsewhere).catch(() => null);
  await import(`${elsewhere}module.js`).catch(() => null);
  await FRAMES;
  return [[...seen].sort(), globalThis.injected ?? null, getComputedStyle(body).opacity];
})()""".replace("FRAMES", FRAMES)
IN_THE_WAY = [
    "base-uri", "connect-src", "form-action", "frame-src", "img-src", "object-src", "script-src-attr",
    "script-src-elem", "style-src-attr", "style-src-elem", "worker-src",
]  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A page of each kind that is written."""
    folder = tmp_path_factory.mktemp("policy")
    assert main(["site", "suspension_car", "--document", str(PACKAGE.parent / "README.md"), "-o", str(folder)]) == 0
    (folder / "played.html").write_text(level_page("suspension_car"), encoding="utf-8")
    (folder / "player.html").write_text(rope_page().text(), encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def address(folder: Path) -> Iterator[str]:
    with served(folder) as at:
        yield at


def test_every_page_of_the_package_begins_with_its_policy() -> None:
    pages = {path.name: path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.html")}
    whole = {name for name, text in pages.items() if "<html" in text}
    assert {name for name, text in pages.items() if HEAD in text.partition("<title>")[0]} == whole >= {"page.html"}
    written = [path for path in PACKAGE.rglob("*.py") if re.search("<html|<!doctype", path.read_text(encoding="utf-8"))]
    assert written == []


@pytest.mark.parametrize("name", PAGES)
def test_a_policy_lets_nothing_in(browser: Browser, folder: Path, address: str, name: str) -> None:
    policy = re.search(r'Policy" content="([^"]*)"', (folder / name).read_text(encoding="utf-8"))
    assert policy and "unsafe-inline" not in policy[1] and policy[1].startswith("default-src 'none'; base-uri 'none'; ")
    for place in (address + name, page_address(folder / name)):
        tab = browser.tab().show(place)
        assert not [fault for fault in tab.faults if "Policy" in fault]
        assert tab.evaluate(INTRUDING) == [IN_THE_WAY, None, "1"]


def _play(tab: Tab) -> None:
    """Do all that can be done in a page of the car."""
    toy = "page.toy.camera.toPixels(...page.toy.world.view('state.position').subarray(0, 2))"
    x, y = tab.evaluate(toy)
    tab.mouse("mousePressed", x, y)
    tab.mouse("mouseMoved", x + 60, y - 40)
    tab.evaluate(FRAMES)
    tab.mouse("mouseReleased", x + 60, y - 40)
    for key in ("m", "h", "?", "n", "Enter", "ArrowUp", "Escape", "c", "p", "d", "f", " ", ".", " "):
        tab.key(key)
    tab.press("d")
    tab.evaluate("document.querySelector('.words button').click()")
    tab.evaluate(FRAMES)
    tab.release("d")


@pytest.mark.parametrize("kind", ["played by http", "played from a disk", "of a site"])
def test_a_page_plays_sounds_and_saves_under_its_policy(
    browser: Browser, folder: Path, address: str, tmp_path: Path, kind: str
) -> None:
    place = {
        "played by http": f"{address}played.html", "played from a disk": page_address(folder / "played.html"),
        "of a site": f"{address}levels/suspension_car.html",
    }[kind]  # fmt: skip
    tab = browser.tab().open(place)
    browser.send("Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": str(tmp_path)})
    _play(tab)
    assert tab.evaluate("page.toy.sound.isOn")
    tab.evaluate("document.getElementById('save').click()")
    file = tmp_path / "car_with_suspension.replay.gz"
    for _ in range(200):
        if file.is_file():
            break
        tab.evaluate(FRAMES)
    assert verify(read_replay(file)) is None
    assert tab.faults == []


def test_a_document_shows_its_pictures_and_aligns_its_tables_and_runs_nothing(browser: Browser, tmp_path: Path) -> None:
    (tmp_path / "table.md").write_text(TABLE, encoding="utf-8")
    (tmp_path / "dot.png").write_bytes((PACKAGE.parent / "assets" / "icon.png").read_bytes())
    site = tmp_path / "site"
    assert main(["site", "rope", "--document", str(tmp_path / "table.md"), "-o", str(site)]) == 0
    with served(site) as at:
        tab = browser.tab().show(f"{at}table.html")
        cells = "[...document.querySelectorAll('td')].map((each) => getComputedStyle(each).textAlign)"
        assert tab.evaluate(cells) == ["left", "right"]
        assert tab.evaluate("[...document.images].map((each) => each.naturalWidth > 0)") == [True, False, True]
        assert tab.evaluate("document.querySelector('[onclick]')") is None
        assert tab.evaluate("document.body.innerText.includes('onclick=') && (globalThis.injected ?? null)") is None
        # Raw HTML is text: nothing is there that the policy would have to refuse.
        assert not any("Policy" in fault for fault in tab.faults)


def test_a_name_of_a_level_is_an_address_and_no_script(browser: Browser, tmp_path: Path) -> None:
    own = tmp_path / "it's #1 'ö' <b>.json"
    own.write_bytes((PACKAGE.parent / "levels" / "rope.json").read_bytes())
    site = tmp_path / "site"
    assert main(["site", str(own), "-o", str(site)]) == 0
    with served(site) as at:
        tab = browser.tab().show(f"{at}index.html")
        tab.evaluate(FRAMES)
        assert (
            tab.evaluate("Promise.all([...document.images].map((each) => each.decode())).then(() => 'seen')") == "seen"
        )
        tab.open(tab.evaluate("document.querySelector('.cards a').href"))
        assert tab.evaluate("page.toy.level.name") == "Rope"
        assert tab.faults == []
