"""The server of the workbench: on the loopback address alone, for who knows the secret.

Every request must name this server as its host, so that no page of the network reaches it through
a name of its own, and begin with a secret: that of the page, or that of reports. All else is
refused. What is served asks nothing of any network, which the policy of each page says.
"""

import asyncio
import secrets
import socket
from collections.abc import Callable
from hmac import compare_digest
from importlib import resources
from typing import Any

from symhyb.errors import InputError, Problem
from symhyb.limits import REPORT_BYTES, content_of
from symhyb.report.canvas import DARK
from symhyb.report.embed import painting
from symhyb.report.page import template
from symhyb.workbench.page import Page
from symhyb.workbench.shared import Shared

LOOPBACK = "127.0.0.1"
FORBIDDEN, UNKNOWN = 403, 404
REPORT_POLICY = (
    "sandbox allow-scripts; default-src 'none'; base-uri 'none'; form-action 'none'; "
    "img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'"
)


def refusal(host: str, path: str, port: int, keys: tuple[str, ...]) -> int | None:
    """The status with which a request is refused, None if it is not: its ``host`` must be this
    server, and its ``path`` must begin with one of the secrets."""
    if host not in (f"{LOOPBACK}:{port}", f"localhost:{port}"):
        return FORBIDDEN
    given = path.split("/")[1] if path.startswith("/") else ""
    known = [compare_digest(given.encode(), key.encode()) for key in keys]
    return None if any(known) else FORBIDDEN


def page_policy(nonce: str, port: int) -> str:
    """The content security policy of the page: scripts of this server and those marked, and no
    connection but to this server."""
    here = " ".join(f"ws://{name}:{port}" for name in (LOOPBACK, "localhost"))
    return (
        "default-src 'none'; base-uri 'none'; form-action 'none'; object-src 'none'; "
        f"script-src 'self' 'nonce-{nonce}'; connect-src 'self' {here}; "
        "style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; font-src data:"
    )


class Workbench:
    """A server that listens, with its ``address``; `serve` answers until an interruption."""

    def __init__(self, shared: Shared, port: int = 0) -> None:
        from bokeh.core.validation import silence
        from bokeh.core.validation.warnings import EMPTY_LAYOUT
        from bokeh.server.tornado import BokehTornado
        from bokeh.settings import settings
        from tornado.httpserver import HTTPServer
        from tornado.ioloop import IOLoop

        settings.resources = "server"  # no network, whatever the environment says
        silence(EMPTY_LAYOUT)  # tabs are filled when there is something to show
        listening = _listening(port)
        self._shared = shared
        asyncio.set_event_loop(asyncio.new_event_loop())
        self._turns = IOLoop.current()
        self.port: int = listening.getsockname()[1]
        origins = [f"{LOOPBACK}:{self.port}", f"localhost:{self.port}"]
        settings.allowed_ws_origin = origins  # it goes before the argument
        self.key = secrets.token_urlsafe(24)
        self._pages = BokehTornado(
            {"/": self._fill},
            prefix=self.key,
            extra_websocket_origins=origins,
            use_index=False,
            redirect_root=False,
            log_function=_unlogged,
        )
        self._pages.initialize(self._turns)
        self._http = HTTPServer(guarded(self._pages, shared, self.key, self.port))
        self._http.add_sockets([listening])
        self._pages.start()

    @property
    def address(self) -> str:
        """Where the page is, with the secret."""
        return f"http://{LOOPBACK}:{self.port}/{self.key}/"

    def serve(self, begun: Callable[[], None] = lambda: None) -> None:
        """Answer until an interruption, then end the diagnosis that may run; ``begun`` is called
        when an interruption ends it cleanly."""
        try:
            begun()
            self._turns.start()
        except KeyboardInterrupt:
            pass
        finally:
            self.close()

    def stop(self) -> None:
        """Let `serve` return; from any thread."""
        self._turns.add_callback(self._turns.stop)

    def close(self) -> None:
        """Listen no more, and end the diagnosis that may run."""
        self._shared.stop()
        self._pages.stop(wait=False)
        self._http.stop()
        self._turns.run_sync(self._http.close_all_connections)
        self._turns.close(all_fds=True)

    def _fill(self, document: Any) -> None:
        bench = self._shared.bench
        title = "Results" if bench is None else bench.model.title or bench.file.name
        nonce = secrets.token_urlsafe(16)
        document.title = f"{title}: symhyb"
        document.template = page_template()
        variables = {
            "heading": title,
            "files": "" if bench is None else bench.file.name,
            "nonce": nonce,
            "policy": page_policy(nonce, self.port),
            "style": template("style.css.j2").render(),
            "own_style": _own("page.css"),
            "scripts": painting() + _own("page.js"),
            "dark": DARK,
        }
        document.template_variables.update(variables)
        Page(document, self._shared).begin()


def guarded(pages: Any, shared: Shared, key: str, port: int) -> Any:
    """What answers requests: the ``pages`` where the secret is theirs, reports where it is that of
    reports, and a refusal for all else."""
    from tornado.routing import Router
    from tornado.web import Application, RequestHandler

    class Refused(RequestHandler):
        def prepare(self) -> None:
            self.set_status(FORBIDDEN)
            self.finish("Refused: open the address that symhyb view printed.\n")

    class Report(RequestHandler):
        def get(self) -> None:
            file = shared.report(self.request.path)
            try:
                page = None if file is None else content_of(file, REPORT_BYTES)
            except InputError:
                page = None
            if page is None:
                self.set_status(UNKNOWN)
                self.finish("There is no such report.\n")
                return
            self.set_header("Content-Security-Policy", REPORT_POLICY)
            self.set_header("Referrer-Policy", "no-referrer")
            self.set_header("X-Content-Type-Options", "nosniff")
            self.finish(page)

    refusing, reports = (
        Application([(r".*", handler)], log_function=_unlogged) for handler in (Refused, Report)
    )

    class Guard(Router):
        def find_handler(self, request: Any, **more: Any) -> Any:
            host = request.headers.get("Host", "")
            if refusal(host, request.path, port, (key, shared.key)) is not None:
                return refusing.find_handler(request, **more)
            own = refusal(host, request.path, port, (shared.key,)) is None
            return (reports if own else pages).find_handler(request, **more)

    return Guard()


def _unlogged(handler: Any) -> None:
    """Keep addresses, which hold the secret, out of the terminal."""


def _listening(port: int) -> socket.socket:
    """What listens on the loopback address.

    Raises:
        InputError: the port cannot be had.
    """
    try:
        listening = socket.create_server((LOOPBACK, port))
    except (OSError, OverflowError) as error:
        reason = getattr(error, "strerror", None) or error
        text = f"port {port} cannot be used: {reason}; leave --port out for a free one"
        raise InputError(Problem(text)) from error
    listening.setblocking(False)
    return listening


def page_template() -> Any:
    """The page around what Bokeh draws."""
    from jinja2 import Environment

    return Environment(autoescape=False).from_string(_own("page.html.j2"))


def _own(name: str) -> str:
    return resources.files("symhyb.workbench").joinpath(name).read_text("utf-8")
