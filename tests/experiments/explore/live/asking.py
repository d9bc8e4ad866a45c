"""Ask a live server as its page does, or as nobody should."""

from __future__ import annotations

import json
import threading
from collections.abc import Generator
from contextlib import contextmanager
from http.client import HTTPConnection, HTTPResponse
from typing import Any

from experiments.explore.live.run import Asked, server_of
from experiments.explore.live.server import LiveServer
from icage.case import Case


@contextmanager
def served(case: Case, **asked: Any) -> Generator[LiveServer]:
    """A server that answers while the block lasts."""
    server = server_of(case, Asked(**asked))
    thread = threading.Thread(target=server.serve_forever, args=(0.02,))
    thread.start()
    try:
        yield server
    finally:
        server.shutdown()
        thread.join()
        server.server_close()
        server.answers.end()


def headers_of(server: LiveServer, **changed: str | None) -> dict[str, str]:
    """What the page sends; ``Content_Type`` stands for Content-Type, None leaves one out."""
    usual: dict[str, str | None] = {
        "Host": f"127.0.0.1:{server.server_port}",
        "Origin": f"http://127.0.0.1:{server.server_port}",
        "X-Icage-Token": server.guard.token,
        "Content-Type": "application/json",
    }
    given = {name.replace("_", "-"): value for name, value in changed.items()}
    return {name: value for name, value in {**usual, **given}.items() if value is not None}


def request(
    server: LiveServer, method: str, path: str, body: bytes | None = None, **headers: str | None
) -> tuple[HTTPResponse, bytes]:
    """One request with its answer."""
    connection = HTTPConnection("127.0.0.1", server.server_port, timeout=60)
    try:
        connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
        sent = headers_of(server, **headers)
        if body is not None and "Content-Length" not in sent:
            sent["Content-Length"] = str(len(body))
        for name, value in sent.items():
            connection.putheader(name, value)
        connection.endheaders()
        if body is not None:
            connection.send(body)
        response = connection.getresponse()
        return response, response.read()
    finally:
        connection.close()


def ask(server: LiveServer, path: str, question: Any) -> dict[str, Any]:
    """The answer to a question of the page."""
    response, content = request(server, "POST", path, json.dumps(question).encode())
    assert response.status == 200, content
    return json.loads(content)


def of_case(case: Case, **more: Any) -> dict[str, Any]:
    """A question about the grasp of a case."""
    return {"radius": case.finger_radius, "contacts": case.contacts.tolist(), **more}
