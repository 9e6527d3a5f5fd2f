"""`sandbox site`."""

import argparse
from pathlib import Path

from sandbox.cli.command import Commands, add_command
from sandbox.cli.inputs import EXIT_OK, Refused, level_of
from sandbox.terminal import Progress


def add(commands: Commands) -> None:
    """The command."""
    parser = add_command(commands, "site", site, "write a folder of pages that play levels, for any web server")
    parser.add_argument("levels", metavar="LEVEL", nargs="*", help="default: all that are shipped")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER")
    parser.add_argument("--title", default="Spring Sandbox", help="what the site is called")
    text = "a Markdown file that becomes pages of the site, with all that it leads to; needs the extra `site`"
    parser.add_argument("--document", type=Path, metavar="FILE.md", help=text)


def site(options: argparse.Namespace) -> int:
    """Write the site, and tell how large it is. Raises Refused."""
    from sandbox.app.site.site import SiteLevel, write_site
    from sandbox.level.reading.files import shipped_levels

    shipped = {path.stem: path for path in shipped_levels()}
    paths = [shipped.get(name, Path(name)) for name in options.levels or shipped]
    levels = {path.stem: SiteLevel(path.stem, path, level_of(str(path))) for path in paths}
    if len(levels) < len(paths):
        raise Refused("two levels have files of one name; their pages would have one address")
    if options.output.exists() and not options.output.is_dir():
        raise Refused(f"{options.output}: is no folder")
    links = _write_documents(options.document, options.output) if options.document else {}
    with Progress(len(levels)) as bar:
        for _ in write_site(levels, options.output, options.title, links):
            bar.update()
    size = sum(path.stat().st_size for path in options.output.rglob("*") if path.is_file())
    print(f"{options.output}: {len(levels)} levels, {size / 1e6:.1f} MB; begin at {options.output / 'index.html'}")
    return EXIT_OK


def _write_documents(start: Path, folder: Path) -> dict[str, str]:
    """Write the pages of documents; their addresses by what they are called. Raises Refused."""
    try:
        from sandbox.app.site.markdown_pages import DocumentError, documents_of, write_documents
    except ModuleNotFoundError:
        raise Refused("--document: needs markdown-it-py; install the extra site") from None
    try:
        documents = documents_of(start)
    except DocumentError as error:
        raise Refused(*error.faults) from None
    return write_documents(documents, folder)
