"""The server of the live page: one page, a few questions, on loopback, nothing else."""

from __future__ import annotations

import socket
import threading
from contextlib import suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, Final
from urllib.parse import urlsplit

from experiments.explore.live.answers import Answers
from experiments.explore.live.guards import HOST, Guard, Refusal
from experiments.explore.live.lane import OutOfDateError, OverError
from experiments.io.gave_out import what_gave_out
from experiments.io.one_line import one_line
from icage.errors import InputError
from icage.formats.json_out import json_text
from icage.formats.json_text import an_object, parse_json

IDLE: Final = 60.0
"""[s] A connection on which nothing comes is closed, and one whose question stops in the midst."""

LINGER: Final = 0.5
"""[s] How long what is left of a refused request is waited for."""

MOST_UNREAD: Final = 1 << 23
"""[byte] ... and how much of it is read."""

MOST_CONNECTIONS: Final = 32
"""At a time: a browser opens six."""

PAGE, QUIT, ICON = "/", "/api/quit", "/favicon.ico"

_HEADERS: Final = {
    "Cache-Control": "no-store",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "X-Frame-Options": "DENY",
}


class LiveServer(ThreadingHTTPServer):
    """Listens on 127.0.0.1; ``page`` is its HTML and ``policy`` what that may load and ask."""

    daemon_threads = True
    block_on_close = False
    allow_reuse_address = True

    def __init__(self, port: int, token: str, page: bytes, policy: str, answers: Answers) -> None:
        super().__init__((HOST, port), _Handler)
        self.guard = Guard(self.server_port, token)
        self.page, self.policy, self.answers = page, policy, answers
        self._free = threading.BoundedSemaphore(MOST_CONNECTIONS)

    @property
    def address(self) -> str:
        """What a browser opens."""
        return f"http://{HOST}:{self.server_port}/?token={self.guard.token}"

    def process_request(self, request: Any, client_address: Any) -> None:
        """A thread for it, if there are not too many."""
        if not self._free.acquire(blocking=False):
            with suppress(OSError):
                request.sendall(
                    b"HTTP/1.1 503 Busy\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"
                )
            self.shutdown_request(request)
            return
        super().process_request(request, client_address)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        """The thread."""
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._free.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A browser that goes away in the midst is no news."""

    def end(self) -> None:
        """Stop serving, from any thread."""
        threading.Thread(target=self.shutdown, daemon=True).start()


class _Handler(BaseHTTPRequestHandler):
    """One connection."""

    server: LiveServer  # pyright: ignore[reportIncompatibleVariableOverride]
    protocol_version = "HTTP/1.1"
    server_version, sys_version = "icage", ""
    timeout = IDLE
    wbufsize = -1  # an answer goes out in one piece ...
    disable_nagle_algorithm = True  # ... at once

    def do_GET(self) -> None:
        """The page, to who knows its address."""
        try:
            self.server.guard.check_host(self.headers)
            parts = urlsplit(self.path)
            if parts.path == ICON:
                self._send(204, b"", "image/x-icon")
                return
            if parts.path != PAGE:
                raise self._no_such(parts.path)
            self.server.guard.check_page(parts.query)
            policy = {"Content-Security-Policy": self.server.policy}
            self._send(200, self.server.page, "text/html; charset=utf-8", policy)
        except (Refusal, ValueError) as error:
            self._refuse(error)

    def do_POST(self) -> None:
        """An answer, to our own page."""
        try:
            self.server.guard.check_host(self.headers)
            answer = self.server.answers.paths.get(self.path)
            if answer is None and self.path != QUIT:
                raise self._no_such(urlsplit(self.path).path)
            length = self.server.guard.check_question(self.headers)
            content = self.rfile.read(length)
            if len(content) < length:
                raise Refusal(400, "the question is shorter than its Content-Length")
            body = an_object(parse_json(content, "the question"), "the question")
        except (Refusal, ValueError, InputError) as error:
            self._refuse(error)
            return
        if answer is None:
            self._send_json(200, "{}")
            self.server.end()
            return
        self._send_json(*_answered(answer, body))

    def _no_such(self, path: str) -> Refusal:
        known = path in (PAGE, QUIT) or path in self.server.answers.paths
        if known:
            return Refusal(405, f"{path} does not take {self.command}")
        return Refusal(404, "there is no such page here")

    def _refuse(self, error: Exception) -> None:
        status, why = (error.status, error.why) if isinstance(error, Refusal) else (400, str(error))
        self.close_connection = True
        self._send_json(status, _error_text(why))
        self._linger()

    def _linger(self) -> None:
        """Read some of what is still sent: a connection that is cut loses the answer, too."""
        with suppress(OSError):
            self.connection.shutdown(socket.SHUT_WR)
            self.connection.settimeout(LINGER)
            left = MOST_UNREAD
            while left > 0 and (part := self.connection.recv(1 << 16)):
                left -= len(part)

    def _send_json(self, status: int, text: str) -> None:
        self._send(status, text.encode("utf-8"), "application/json; charset=utf-8")

    def _send(
        self, status: int, content: bytes, kind: str, more: dict[str, str] | None = None
    ) -> None:
        with suppress(OSError):  # whoever asked has gone
            self.send_response(status)
            for name, value in {**_HEADERS, **(more or {}), "Content-Type": kind}.items():
                self.send_header(name, value)
            self.send_header("Content-Length", str(len(content)))
            if self.close_connection:
                self.send_header("Connection", "close")
            self.end_headers()
            if self.command != "HEAD":
                self.wfile.write(content)
            self.wfile.flush()

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        """What the library refuses by itself (a method, a line that is no HTTP) in our form."""
        self.close_connection = True
        if code == 501:
            code, message = 405, "GET of the page and POST of questions is all there is"
        if not hasattr(self, "headers"):
            self.command = self.command or "GET"
        self._send_json(code, _error_text(message or "the request is no use"))
        self._linger()

    def log_message(self, format: str, *args: Any) -> None:
        """Nothing: the address with its token is nobody's business."""


def _answered(answer: Any, body: dict[str, Any]) -> tuple[int, str]:
    """Status and text; whatever happens is one line.

    That there is no answer is an answer, too: a browser would report any other status as a fault.
    """
    try:
        return 200, answer(body)
    except OutOfDateError:
        return 200, json_text({"out_of_date": True})
    except InputError as error:
        return 200, _error_text(str(error))
    except OverError as error:
        return 200, json_text({"error": str(error), "over": True})
    except Exception as error:
        return 500, _error_text(
            what_gave_out(error) or f"internal: {type(error).__name__} (our fault)"
        )


def _error_text(why: str) -> str:
    return json_text({"error": one_line(why)})
