"""The server: who is refused, what is served, and that it stops."""

import http.client
import os
import re
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from symhyb.errors import InputError
from symhyb.workbench.serving import Workbench, page_policy, refusal
from symhyb.workbench.shared import Shared

Write = Callable[..., Path]
HERE = "127.0.0.1:80"


@pytest.mark.parametrize(
    ("host", "path", "refused"),
    [
        (HERE, "/secret/", None),
        ("localhost:80", "/secret/ws", None),
        (HERE, "/other/0/report.html", None),
        (HERE, "/", 403),
        (HERE, "", 403),
        (HERE, "/wrong/", 403),
        (HERE, "/secre", 403),
        (HERE, "//secret/", 403),
        (HERE, "/ü/", 403),
        ("rebound.example:80", "/secret/", 403),
        ("127.0.0.1:81", "/secret/", 403),
        ("", "/secret/", 403),
    ],
)
def test_requests_need_the_secret_and_this_host(host: str, path: str, refused: int | None) -> None:
    assert refusal(host, path, 80, ("secret", "other")) == refused


def test_the_policy_allows_no_other_server() -> None:
    policy = page_policy("mark", 8080)
    assert "default-src 'none'" in policy
    assert "unsafe-eval" not in policy
    assert set(re.findall(r"//([^ ;]+)", policy)) == {"127.0.0.1:8080", "localhost:8080"}
    (scripts,) = re.findall(r"script-src ([^;]+)", policy)
    assert scripts == "'self' 'nonce-mark'"


def get(server: Workbench, path: str, **headers: str) -> tuple[int, str, dict[str, str]]:
    """The answer of a server: status, text and headers."""
    line = http.client.HTTPConnection("127.0.0.1", server.port, timeout=30)
    line.request("GET", path, headers=headers)
    answer = line.getresponse()
    text = answer.read().decode("utf-8")
    line.close()
    return answer.status, text, {k.lower(): v for k, v in answer.getheaders()}


def socket_status(server: Workbench, origin: str) -> int:
    """How a server answers who asks for its socket of events from a page of some origin."""
    line = http.client.HTTPConnection("127.0.0.1", server.port, timeout=30)
    headers = {
        "Upgrade": "websocket",
        "Connection": "Upgrade",
        "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==",
        "Sec-WebSocket-Version": "13",
        "Origin": origin,
    }
    line.request("GET", f"/{server.key}/ws", headers=headers)
    status = line.getresponse().status
    line.close()
    return status


@pytest.fixture
def server(
    write_result: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Workbench]:
    """A server of one result, in a thread of its own; the environment would open it."""
    monkeypatch.setenv("BOKEH_ALLOW_WS_ORIGIN", "evil.example")
    monkeypatch.setenv("BOKEH_RESOURCES", "cdn")
    folder = write_result("one")
    (folder / "report.html").write_text("<p>report</p>", encoding="utf-8")
    made: list[Workbench] = []
    ready = threading.Event()

    def run() -> None:
        made.append(Workbench(Shared(None, [folder], tmp_path)))
        ready.set()
        made[0].serve()

    thread = threading.Thread(target=run)
    thread.start()
    assert ready.wait(60)
    yield made[0]
    made[0].stop()
    thread.join(30)
    assert not thread.is_alive()
    with pytest.raises(ConnectionError), socket.create_connection(("127.0.0.1", made[0].port), 5):
        pass


def test_it_serves_who_knows_the_secret_and_stops(server: Workbench) -> None:
    status, text, _ = get(server, f"/{server.key}/")
    assert status == 200
    assert "Content-Security-Policy" in text
    assert "<h1>Results</h1>" in text
    assert "https:" not in text
    assert get(server, "/")[0] == 403
    assert get(server, "/favicon.ico")[0] == 403
    assert get(server, f"/{server.key}x/")[0] == 403
    assert get(server, f"/{server.key}/", Host="rebound.example")[0] == 403
    assert get(server, f"/{server.key}/static/js/bokeh.min.js")[0] == 200
    assert socket_status(server, "http://evil.example") == 403
    assert socket_status(server, "null") == 403
    assert socket_status(server, f"http://127.0.0.1:{server.port}") != 403
    shared = server._shared
    status, text, headers = get(server, shared.address(shared.results[0].folder))
    assert (status, text) == (200, "<p>report</p>")
    policy = headers["content-security-policy"]
    assert policy.startswith("sandbox allow-scripts; default-src 'none'")
    assert get(server, f"/{shared.key}/7/report.html")[0] == 404
    assert get(server, f"/{server.key}/0/report.html")[0] == 404


def test_a_port_that_is_taken_is_said(server: Workbench, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=f"port {server.port} cannot be used"):
        Workbench(Shared(None, (), tmp_path), server.port)


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.slow
def test_ctrl_c_ends_the_command_cleanly(write_result: Write) -> None:
    command = [sys.executable, "-m", "symhyb", "view", str(write_result("one"))]
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # where a shell ignores it
    try:
        running = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
    finally:
        signal.signal(signal.SIGINT, before)
    with running:
        assert running.stdout is not None
        assert running.stderr is not None
        said = running.stdout.readline(), running.stdout.readline()
        running.send_signal(signal.SIGINT)
        try:
            status = running.wait(60)
        finally:
            running.kill()
        assert status == 0
        assert re.fullmatch(r"http://127\.0\.0\.1:\d+/[-\w]{32}/\n", said[0])
        assert said[1] == "Ctrl-C ends it\n"
        assert (running.stdout.read(), running.stderr.read()) == ("", "")
