"""How well text can be read, by WCAG 2.1."""

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
