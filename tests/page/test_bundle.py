"""The script of a page is that of its modules, and does what they do."""

import json
import shutil
import subprocess
from pathlib import Path

from sandbox.page.bundle import BUNDLE, ESBUILD, WEB, bundled, digest_of
from tests.support.wants import needs

needs_esbuild = needs("esbuild", ESBUILD.is_file() and shutil.which("node"))

STRANGE = """export default function texts() {
  return [`first
// no comment
    indented
`, "// neither", /\\/\\/ 'nor'/.source];
}
export const later = async () => 'later', { length } = 'four';
"""
USING = """import texts, {
  later,
  length as count,
} from './strange.js';
console.log(JSON.stringify([...texts(), await later(), count]));
"""


def test_the_bundle_is_that_of_the_modules_beside_it() -> None:
    first, _, _ = BUNDLE.read_text(encoding="utf-8").partition("\n")
    assert first == f"// {digest_of(WEB)}", "modules of pages were changed: run `make bundle`"


@needs_esbuild
def test_esbuild_makes_the_bundle_that_is_kept() -> None:
    assert bundled(WEB) == BUNDLE.read_text(encoding="utf-8")


@needs_esbuild
def test_a_bundle_says_what_its_modules_say_where_texts_look_like_comments(tmp_path: Path) -> None:
    (tmp_path / "strange.js").write_text(STRANGE, encoding="utf-8")
    command = [str(shutil.which("node")), "--input-type=module", "--eval", bundled(tmp_path, USING)]
    said = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    assert said == ["first\n// no comment\n    indented\n", "// neither", "\\/\\/ 'nor'", "later", 4]
