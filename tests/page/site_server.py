"""A site on a web server of its own, as long as tests of it run."""

import functools
import gzip
import http
import http.server
import io
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

# Where the whole site says that it is.
AT = "https://example.org/toys"


class _Server(http.server.SimpleHTTPRequestHandler):
    """Sends text compressed, as public hosts of pages do, and files that are compressed already as they are."""

    def send_head(self) -> io.BytesIO | BinaryIO | None:
        path = Path(self.translate_path(self.path))
        kind = self.guess_type(path)
        if path.suffix not in (".html", ".css", ".js", ".svg", ".json") or not path.is_file():
            return super().send_head()
        sent = gzip.compress(path.read_bytes())
        self.send_response(http.HTTPStatus.OK)
        for name, value in (("Type", kind), ("Encoding", "gzip"), ("Length", len(sent))):
            self.send_header(f"Content-{name}", str(value))
        self.end_headers()
        return io.BytesIO(sent)

    def log_message(self, format: str, *arguments: object) -> None:
        pass


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """The address of a folder's files, with a slash at its end."""
    handler = functools.partial(_Server, directory=str(folder))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        thread = threading.Thread(target=server.serve_forever, args=(0.05,))
        thread.start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()
        thread.join()
