"""How large the package is, room by room, and how it is cut: `python -m tests.size` prints it.

`python -m tests.size FOLDER` measures another checkout, `--word belt` also lists the files that name a thing, and
`--keep` puts the lines of each room into CHANGELOG.md, which a test holds to be true.
"""

import argparse
import ast
import io
import re
import statistics
import textwrap
import tokenize
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# Lines that a person wrote for pages; what is generated or vendored is not.
GENERATED = {"bundle.js", "shared.js", "tables.d.ts"}


@dataclass
class Module:
    """One file of Python: its lines, those of code, the lines of each function, and the modules that it imports."""

    lines: int
    code: int
    functions: list[int]
    imports: set[str]


def measured(path: Path) -> Module:
    """The measures of a file. Code: lines that are neither blank nor docstring, comment or import."""
    text = path.read_text(encoding="utf-8")
    tree = ast.parse(text)
    other: set[int] = set()
    found: set[str] = set()
    functions = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            other |= set(range(node.lineno, (node.end_lineno or node.lineno) + 1))
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found |= {str(node.module), *(f"{node.module}.{alias.name}" for alias in node.names)}
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            functions.append((node.end_lineno or node.lineno) - node.lineno + 1)
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef) and node.body:
            first = node.body[0]
            if (
                isinstance(first, ast.Expr)
                and isinstance(first.value, ast.Constant)
                and isinstance(first.value.value, str)
            ):
                other |= set(range(first.lineno, (first.end_lineno or first.lineno) + 1))
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    without = (tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER)
    code = {line for token in tokens if token.type not in without for line in range(token.start[0], token.end[0] + 1)}
    return Module(len(text.splitlines()), len(code - other), functions, found)


def modules(root: Path) -> dict[str, Module]:
    """Every module of the package in a checkout, by its dotted name."""
    found = {}
    for path in sorted((root / "sandbox").rglob("*.py")):
        parts = path.relative_to(root).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = measured(path)
    return found


def room(name: str) -> str:
    """The room of a module: `other` for what lies in the package itself."""
    parts = name.split(".")
    return parts[1] if len(parts) > 2 or (len(parts) == 2 and parts[1] in ROOMS) else "other"


KEPT_MARK = "- Lines as they stand:"
ROOMS = (
    "physics", "level", "editor", "session", "app", "cli", "bring", "export", "tools", "testing", "page", "other",
)  # fmt: skip


def lines_by_room(root: Path = ROOT) -> dict[str, int]:
    """Lines of Python in each room, and of JavaScript by hand."""
    found: dict[str, int] = dict.fromkeys(ROOMS, 0)
    for name, module in modules(root).items():
        found[room(name)] += module.lines
    scripts = [path for path in (root / "sandbox").rglob("*.js") if path.name not in GENERATED]
    found["JavaScript"] = sum(len(path.read_text(encoding="utf-8").splitlines()) for path in scripts)
    return found


def with_one_importer(found: dict[str, Module]) -> list[str]:
    """Modules that one other module of the package imports, and no more."""
    importers = defaultdict(set)
    for name, module in found.items():
        for other in module.imports:
            importers[other].add(name)
    return [name for name in found if len(importers[name] - {name}) == 1]


def named_in(word: str, root: Path = ROOT) -> list[str]:
    """Files of the package that name a thing, by hand."""
    pattern = re.compile(rf"(?<![A-Za-z]){word}s?(?![A-Za-z])")
    files = [*(root / "sandbox").rglob("*.py"), *(root / "sandbox").rglob("*.js")]
    return sorted(
        path.relative_to(root / "sandbox").as_posix()
        for path in files
        if path.name not in GENERATED and pattern.search(path.read_text(encoding="utf-8"))
    )


def kept_line(lines: dict[str, int]) -> str:
    """The line of CHANGELOG.md that says how large each room is."""
    said = ", ".join(f"{name} {count:,}" for name, count in lines.items())
    return f"{KEPT_MARK} {said}; together {sum(lines.values()):,}."


def kept_lines() -> dict[str, int]:
    """Lines of each room, as CHANGELOG.md says."""
    text = " ".join((ROOT / "CHANGELOG.md").read_text(encoding="utf-8").split())
    said = text.partition(KEPT_MARK)[2].partition(";")[0]
    return {name: int(count.replace(",", "")) for name, count in re.findall(r"(\w+) ([\d,]*\d)", said)}


def keep() -> None:
    """Put the lines of each room into CHANGELOG.md."""
    path = ROOT / "CHANGELOG.md"
    text = path.read_text(encoding="utf-8")
    before, mark, after = text.partition(KEPT_MARK)
    if not mark:
        raise SystemExit(f"CHANGELOG.md has no line that begins with: {KEPT_MARK}")
    line = "\n".join(textwrap.wrap(kept_line(lines_by_room()), 120, subsequent_indent="  "))
    path.write_text(f"{before}{line}\n{after.partition('together')[2].partition(chr(10))[2]}", encoding="utf-8")


def main() -> None:
    """Print it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", nargs="?", type=Path, default=ROOT, metavar="FOLDER")
    parser.add_argument("--word")
    parser.add_argument("--keep", action="store_true")
    given = parser.parse_args()
    if given.keep:
        keep()
    found, lines = modules(given.root), lines_by_room(given.root)
    print(f"{'room':12}{'files':>7}{'lines':>9}{'code':>9}{'median':>8}{'function':>10}")
    for name in (*ROOMS, "all"):
        mine = [module for each, module in found.items() if name in (room(each), "all")]
        functions = [length for module in mine for length in module.functions]
        print(
            f"{name:12}{len(mine):7}{sum(module.lines for module in mine):9,}{sum(module.code for module in mine):9,}"
            f"{statistics.median(module.lines for module in mine):8.0f}{statistics.mean(functions or [0]):10.1f}"
        )
    print(f"JavaScript by hand: {lines['JavaScript']:,} lines")
    tests = [path.read_text(encoding="utf-8") for path in (given.root / "tests").rglob("*.py")]
    print(f"tests: {sum(len(text.splitlines()) for text in tests):,} lines in {len(tests)} files")
    print(f"modules with one importer: {len(with_one_importer(found))}")
    below = sum(module.lines < 60 for module in found.values())
    print(f"files below 60 lines: {below}")
    if given.word:
        files = named_in(given.word, given.root)
        print(f"{given.word}: {len(files)} files", *files, sep="\n  ")


if __name__ == "__main__":
    main()
