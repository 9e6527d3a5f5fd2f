"""How well text can be read, by WCAG 2.1: on what is behind it in a style, and on what is drawn behind it."""

import io

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tests.page.browser import Tab

# Of small text on what is behind it, at AA.
LEAST_CONTRAST = 4.5
# A function of two colours by their names in a page's style.
CONTRAST = """([first, second]) => {
  const probe = document.createElement('i');
  document.body.append(probe);
  const light = (name) => {
    probe.style.color = `var(--${name})`;
    const parts = getComputedStyle(probe).color.match(/[0-9.]+/g).slice(0, 3).map((part) => part / 255);
    const [r, g, b] = parts.map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const [low, high] = [light(first), light(second)].sort((x, y) => x - y);
  probe.remove();
  return (high + 0.05) / (low + 0.05);
}"""
# Every text that is seen: its first words, its colour, and the boxes of its lines [pixels].
TEXTS = """(() => {
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT), found = [];
  for (let node = walk.nextNode(); node; node = walk.nextNode()) {
    const on = node.parentElement, style = getComputedStyle(on);
    const isShown = node.data.trim() && !on.closest('script, style, noscript, .unseen, option');
    if (!isShown || style.visibility !== 'visible') continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    const boxes = [...range.getClientRects()].map(({ left, top, right, bottom }) => [left, top, right, bottom]);
    const colour = style.color.match(/[0-9.]+/g).slice(0, 3).map(Number);
    if (boxes.length) found.push([node.data.trim().slice(0, 30), colour, boxes]);
  }
  return found;
})()"""
# A style sheet that leaves what is behind texts.
WITHOUT = """(() => {
  const sheet = new CSSStyleSheet();
  sheet.replaceSync('* { color: transparent !important; transition: none !important }');
  document.adoptedStyleSheets = [sheet];
})()"""


def luminance(colours: NDArray[np.float64]) -> NDArray[np.float64]:
    """Relative luminance (...) of colours (..., 3) of 0..255."""
    parts = colours / 255.0
    linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
    return linear @ np.array([0.2126, 0.7152, 0.0722])


def contrasts(tab: Tab) -> dict[str, float]:
    """The lowest contrast of each text that is seen with any pixel that is drawn behind it, by its first words."""
    texts = tab.evaluate(TEXTS)
    tab.evaluate(WITHOUT)
    picture = np.asarray(Image.open(io.BytesIO(tab.picture())).convert("RGB"), dtype=np.float64)
    tab.evaluate("document.adoptedStyleSheets = []")
    ratio = picture.shape[1] / tab.evaluate("innerWidth")
    behind, found = luminance(picture), dict[str, float]()
    for text, colour, boxes in texts:
        own = float(luminance(np.array(colour, dtype=np.float64)))
        for box in boxes:
            left, top, right, bottom = (max(round(ratio * side), 0) for side in box)
            pixels = behind[top:bottom, left:right]
            if pixels.size:
                low, high = np.minimum(pixels, own), np.maximum(pixels, own)
                least = float(((high + 0.05) / (low + 0.05)).min())
                found[text] = min(found.get(text, np.inf), least)
    return found
