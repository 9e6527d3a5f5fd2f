"""`sandbox site`."""

from dataclasses import dataclass
from pathlib import Path

from sandbox.cli.base.command import Subcommand, arguments, needed_option, option, option_or
from sandbox.cli.base.inputs import EXIT_OK, Refused, level_of, require_address
from sandbox.terminal import Progress


@dataclass(frozen=True, kw_only=True)
class SiteOptions:
    """Options of `site`: the levels, and where the site goes."""

    levels: list[str] = arguments(str, "LEVEL", "default: all that are shipped", at_least=0)
    output: Path = needed_option(Path, "-o", metavar="FOLDER")
    title: str = option_or("Spring Sandbox", str, help="what the site is called")
    address: str | None = option(
        str,
        metavar="ADDRESS",
        help="where the site will be, https://...; links to its pages then show pictures in chats",
    )
    document: Path | None = option(
        Path,
        metavar="FILE.md",
        help="a Markdown file that becomes pages of the site, with all that it leads to; needs the extra `site`",
    )


def site(options: SiteOptions) -> int:
    """Write the site, and tell how large it is. Raises Refused."""
    from sandbox.app.site.index_page import IndexPage, SiteLevel
    from sandbox.app.site.site import write_site
    from sandbox.level.format.writing import alike
    from sandbox.level.reading.files import shipped_levels

    shipped = {path.stem: path for path in shipped_levels()}
    paths = [shipped.get(name, Path(name)) for name in options.levels or shipped]
    for stem in alike([path.stem for path in paths]):
        raise Refused(f"{stem}: two levels have files of this name, where capitals do not count; rename one")
    levels = {path.stem: SiteLevel(path.stem, path, level_of(str(path))) for path in paths}
    if options.output.exists() and not options.output.is_dir():
        raise Refused(f"{options.output}: is no folder")
    if options.address is not None:
        require_address(options.address)
    links = _write_documents(options.document, options.output) if options.document else {}
    with Progress(len(levels)) as bar:
        for _ in write_site(levels, options.output, IndexPage(options.title, links, options.address)):
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


COMMAND = Subcommand("site", "write a folder of pages that play levels, for any web server", SiteOptions, site)
