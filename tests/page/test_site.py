"""The site: every link leads somewhere, every level plays at its address, and all can be read and reached by keys."""

import shutil
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag, urljoin

import pytest

from sandbox.cli import main
from sandbox.level.reading.files import shipped_levels
from tests.page.browser import Browser, page_address
from tests.page.contrast import CONTRAST, LEAST_CONTRAST
from tests.page.site_server import served
from tests.support.wholes import some_and_whole

ROOT = Path(__file__).resolve().parents[2]
LEVELS = [path.stem for path in shipped_levels()]


@pytest.fixture(scope="module")
def address(site: Path) -> Iterator[str]:
    with served(site) as at:
        yield at


class _Page(HTMLParser):
    """What a page links to and shows, the names in it, and what of it a person needs."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.linked: list[str] = []
        self.names: set[str] = set()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.tags.append((tag, given))
        self.linked += [value for key in ("href", "src", "data-src") if (value := given.get(key))]
        for several in (given.get("srcset"), given.get("data-srcset")):
            self.linked += [each.split()[0] for each in (several or "").split(",") if each]
        if given.get("id"):
            self.names.add(str(given["id"]))


def test_a_crawler_finds_something_behind_every_link(site: Path) -> None:
    waiting, seen, astray = ["index.html"], {}, []
    while waiting:
        name = waiting.pop()
        seen[name] = _Page(site / name)
        for link in seen[name].linked:
            target, _ = urldefrag(link)
            path = unquote(urljoin(name, target)) if target else name
            if "://" in link or link.startswith("data:"):
                continue
            if not (site / path).is_file():
                astray.append(f"{name}: {link}")
            elif path.endswith(".html") and path not in seen and path not in waiting:
                waiting.append(path)
    for name, page in seen.items():
        for link in page.linked:
            target, place = urldefrag(link)
            path = unquote(urljoin(name, target)) if target else name
            if place and "://" not in link and place not in seen[path].names:
                astray.append(f"{name}: {link}")
    assert astray == []
    assert {f"levels/{stem}.html" for stem in LEVELS} | {"README.html", "docs/physics.html"} <= set(seen)
    # Nothing lies there that no link leads to, but what scripts fetch.
    pages = {path.relative_to(site).as_posix() for path in site.rglob("*.html")}
    assert pages == set(seen)


def test_a_document_begins_with_its_heading_below_one_row_of_links_and_ends_with_all_documents(site: Path) -> None:
    text = (site / "docs" / "physics.html").read_text(encoding="utf-8")
    first, last = text[: text.index("<h1")], text[text.index("<footer") :]
    assert first.count("<a ") == 2 and "index.html" in first and "README.html" in first
    assert last.count("<a ") == len(list(site.glob("docs/*.html"))) + len(list(site.glob("*.html"))) - 1


def test_every_page_has_a_title_a_language_one_heading_and_words_for_its_pictures(site: Path) -> None:
    wrong, titles = [], set()
    for path in site.rglob("*.html"):
        page, text = _Page(path), path.read_text(encoding="utf-8")
        tags = [tag for tag, _ in page.tags]
        title = text.partition("<title>")[2].partition("</title>")[0]
        titles.add(title)
        is_good = ("html", {"lang": "en"}) in page.tags and title and tags.count("h1") == 1 and "main" not in tags[:5]
        if not is_good or any(tag == "img" and "alt" not in given for tag, given in page.tags):
            wrong.append(path.name)
    assert wrong == []
    assert len(titles) > len(LEVELS)


@pytest.mark.parametrize("stem", some_and_whole(("rope", "hooke_comparison", "pinball_score", "ferry"), LEVELS))
def test_a_level_plays_at_its_own_address(browser: Browser, address: str, stem: str) -> None:
    tab = browser.tab().open(f"{address}levels/{stem}.html")
    assert tab.evaluate("document.getElementById('error').textContent") == ""
    tab.evaluate("page.toy.pause(); for (let k = 0; k < 5; k++) page.toy.tick()")
    assert tab.evaluate("page.toy.world.time") >= 5
    assert tab.faults == []


def test_a_page_that_lacks_its_modules_says_so_in_a_line(browser: Browser, site: Path, tmp_path: Path) -> None:
    said = "document.getElementById('error').textContent"
    tab = browser.tab().open(page_address(site / "levels" / "rope.html"))
    assert tab.evaluate(said) == "From a disk browsers load no modules. Put the whole site on a web server."
    shutil.copytree(site / "levels", tmp_path / "levels")
    with served(tmp_path) as at:
        assert browser.tab().open(f"{at}levels/rope.html").evaluate(said).startswith("This page was cut off")


@pytest.mark.parametrize("scheme", ["dark", "light"])
@pytest.mark.parametrize("name", ["index.html", "docs/physics.html"])
def test_text_can_be_read_and_nothing_is_wider_than_a_phone(
    browser: Browser, address: str, name: str, scheme: str
) -> None:
    tab = browser.tab(width=390, height=844, scheme=scheme, is_phone=True).show(f"{address}{name}")
    for pair in (["text", "back"], ["text", "surface"], ["muted", "surface"], ["muted", "back"], ["accent", "back"]):
        assert tab.evaluate(f"({CONTRAST})({pair})") >= LEAST_CONTRAST, pair
    assert tab.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_the_keyboard_reaches_every_level_and_opens_it(browser: Browser, address: str) -> None:
    tab = browser.tab().open(f"{address}index.html")
    reached = []
    # Before them come the toy at the top, its button and its link.
    for _ in range(3 + len(LEVELS)):
        tab.key("Tab")
        reached.append(tab.evaluate("document.activeElement.getAttribute('href')"))
        assert tab.evaluate("getComputedStyle(document.activeElement).outlineStyle") != "none"
    assert reached[:3] == [None, None, "levels/trampoline.html"]
    assert sorted(reached[3:]) == sorted(f"levels/{stem}.html" for stem in LEVELS)


def test_levels_of_ones_own_are_a_site_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    own = tmp_path / "own.json"
    own.write_bytes((ROOT / "levels" / "rope.json").read_bytes().replace(b'"Rope"', b'"My <rope>"'))
    assert main(["site", str(own), "low_door", "-o", str(tmp_path / "site"), "--title", "Mine"]) == 0
    text = (tmp_path / "site" / "index.html").read_text(encoding="utf-8")
    assert "My &lt;rope&gt;" in text and 'href="levels/low_door.html"' in text and "<h1>Mine</h1>" in text
    # Its author's solution is beside it; the other level has none.
    assert text.count("class=solved>Solved in ") == 1
    assert (tmp_path / "site" / "pictures" / "own-dark.jpg").is_file()
    assert "2 levels" in capsys.readouterr().out


def test_what_cannot_be_a_site_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    own, document, outside = (tmp_path / name for name in ("rope.json", "broken.md", "in/outside.md"))
    own.write_bytes((ROOT / "levels" / "rope.json").read_bytes())
    outside.parent.mkdir()
    loud, index = tmp_path / "in" / "ROPE.json", tmp_path / "in" / "Index.md"
    loud.write_bytes(own.read_bytes())
    index.write_text("# Index\n", encoding="utf-8")
    outside.write_text("No heading, and [a level](../rope.json)\n", encoding="utf-8")
    refused = (
        (["rope", str(own)], "rope: two levels have files of this name"),
        (["rope", str(loud)], "rope: two levels have files of this name, where capitals do not count"),
        (["rope", "--document", str(index)], "two pages of the site would be index.html"),
        (["rope", "--document", str(document)], "there is no gone.md"),
        (["rope", "--document", str(outside)], "../rope.json lies outside of the folder"),
        (["nothing_like_it"], "there is no such file"),
        (["rope", "--address", "example.org"], "example.org is no address of a site"),
    )
    document.write_text("# Broken\n\n[gone](gone.md), [mail](mailto:nobody@example.org)\n", encoding="utf-8")
    for given, said in refused:
        assert main(["site", *given, "-o", str(tmp_path / "site")]) == 2
        told = capsys.readouterr().err
        assert said in told and len(told.strip().splitlines()) == 1
    assert not (tmp_path / "site" / "index.html").exists()


def test_html_of_a_document_is_text_on_its_page(tmp_path: Path) -> None:
    document = tmp_path / "notes.md"
    document.write_text("# Notes\n\n<form action=x><img src=y></form>\n\nA <b>word</b>.\n", encoding="utf-8")
    assert main(["site", "rope", "--document", str(document), "-o", str(tmp_path / "site")]) == 0
    text = (tmp_path / "site" / "notes.html").read_text(encoding="utf-8")
    assert "<form" not in text and "<b>" not in text and "&lt;form action=x&gt;" in text and "&lt;b&gt;word" in text
