"""Who is not answered: other hosts, other pages, who lacks the token, and what is no question."""

from __future__ import annotations

import json
import socket
from typing import Any

import pytest

from experiments.explore.live.guards import LARGEST_BODY
from experiments.explore.live.server import LiveServer
from tests.experiments.explore.live.asking import headers_of, request

ASK = "/api/standing"


def refused(answer: tuple[Any, bytes], status: int) -> str:
    """The one line of a refusal, which is JSON whatever was wrong."""
    response, content = answer
    assert response.status == status, content
    assert response.getheader("Content-Type").startswith("application/json")
    document = json.loads(content)
    assert list(document) == ["error"]
    assert "\n" not in document["error"]
    assert "Traceback" not in document["error"]
    return document["error"]


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:{port}", "127.0.0.1", "127.0.0.1:1", "", "[::1]:{port}"]
)
@pytest.mark.parametrize("method", ["GET", "POST"])
def test_another_host_is_refused(host: str, method: str, pliers: LiveServer) -> None:
    path = ASK if method == "POST" else f"/?token={pliers.guard.token}"
    host = host.format(port=pliers.server_port)
    why = refused(request(pliers, method, path, b"{}", Host=host), 403)
    assert "127.0.0.1 and localhost" in why


def test_no_host_is_refused(pliers: LiveServer) -> None:
    refused(request(pliers, "POST", ASK, b"{}", Host=None), 403)


def test_localhost_is_the_same_machine(pliers: LiveServer) -> None:
    here = f"localhost:{pliers.server_port}"
    answer = request(pliers, "POST", ASK, b"{}", Host=here, Origin=f"http://{here}")
    assert "no key 'radius'" in json.loads(answer[1])["error"]


@pytest.mark.parametrize(
    "origin",
    [None, "null", "http://evil.example", "https://127.0.0.1:{port}", "http://127.0.0.1:1",
     "http://127.0.0.1:{port}.evil.example"],
)  # fmt: skip
def test_another_page_is_refused(origin: str | None, pliers: LiveServer) -> None:
    if origin is not None:
        origin = origin.format(port=pliers.server_port)
    assert "own page" in refused(request(pliers, "POST", ASK, b"{}", Origin=origin), 403)


@pytest.mark.parametrize("token", [None, "", "wrong", "ü"])
def test_who_lacks_the_token_is_refused(token: str | None, pliers: LiveServer) -> None:
    assert "token" in refused(request(pliers, "POST", ASK, b"{}", X_Icage_Token=token), 403)


@pytest.mark.parametrize(
    "query", ["", "?token=", "?token=wrong", "?token={t}&token={t}", "?" + "a&" * 50]
)
def test_the_page_is_for_who_knows_its_address(query: str, pliers: LiveServer) -> None:
    answer = request(pliers, "GET", "/" + query.format(t=pliers.guard.token))
    refused(answer, 400 if query.count("&") > 8 else 403)
    assert b"icage-data" not in answer[1]


@pytest.mark.parametrize("kind", [None, "text/plain", "application/x-www-form-urlencoded"])
def test_a_form_is_no_question(kind: str | None, pliers: LiveServer) -> None:
    refused(request(pliers, "POST", ASK, b"{}", Content_Type=kind), 415)


def test_what_is_too_long_is_refused_before_it_is_read(pliers: LiveServer) -> None:
    for length in (LARGEST_BODY + 1, 10**30):
        why = refused(request(pliers, "POST", ASK, b"{}", Content_Length=str(length)), 413)
        assert str(LARGEST_BODY) in why


def test_who_sends_a_million_bytes_hears_why_not(pliers: LiveServer) -> None:
    refused(request(pliers, "POST", ASK, b"x" * 1_000_000), 413)
    refused(request(pliers, "POST", ASK, b"x" * 1_000_000, X_Icage_Token="no"), 403)


@pytest.mark.parametrize("length", ["-1", "1e3", "", "²", "0x10"])
def test_a_length_that_is_none_is_refused(length: str, pliers: LiveServer) -> None:
    refused(request(pliers, "POST", ASK, b"{}", Content_Length=length), 411)


def test_pieces_without_a_length_are_refused(pliers: LiveServer) -> None:
    body = b"2\r\n{}\r\n0\r\n\r\n"
    refused(request(pliers, "POST", ASK, body, Transfer_Encoding="chunked"), 411)


@pytest.mark.parametrize("method", ["PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "BREW"])
def test_other_methods_are_refused(method: str, pliers: LiveServer) -> None:
    refused(request(pliers, method, ASK, b"{}"), 405)


def test_a_known_path_takes_its_own_method(pliers: LiveServer) -> None:
    refused(request(pliers, "GET", ASK), 405)
    refused(request(pliers, "POST", "/", b"{}"), 405)
    refused(request(pliers, "GET", "/api/quit"), 405)
    response, content = request(pliers, "HEAD", "/")
    assert (response.status, content) == (405, b"")


@pytest.mark.parametrize(
    "path", ["/api/nothing", "/..%2f..%2fetc/passwd", "/index.html", "//x", "*"]
)
def test_there_is_nothing_else(path: str, pliers: LiveServer) -> None:
    for method in ("GET", "POST"):
        refused(request(pliers, method, path, b"{}"), 404)


GARBAGE = [
    b"", b"{", b"\xff\xfe", b"null", b"[]", b"3", b'"x"', b'{"radius": NaN}', b"[" * 60000,
    b'{"radius": 1' + b"0" * 60000 + b"}", b'{"a": 1, "a": 2}',
]  # fmt: skip


@pytest.mark.parametrize("body", GARBAGE, ids=lambda body: body[:12].decode("latin-1"))
def test_garbage_is_one_clear_line(body: bytes, pliers: LiveServer) -> None:
    refused(request(pliers, "POST", ASK, body), 400)


def test_a_line_that_is_no_http_is_refused_in_the_same_form(pliers: LiveServer) -> None:
    for line in (b"hello\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n", b"GET " + b"a" * 70000 + b"\r\n\r\n"):
        with socket.create_connection(("127.0.0.1", pliers.server_port), timeout=10) as end:
            end.sendall(line)
            answer = b""
            while part := end.recv(65536):
                answer += part
        assert b'"error"' in answer
        assert b"<html" not in answer.lower()


def test_whoever_goes_away_in_the_midst_is_forgotten(pliers: LiveServer) -> None:
    head = "".join(f"{k}: {v}\r\n" for k, v in headers_of(pliers).items())
    for _ in range(3):
        with socket.create_connection(("127.0.0.1", pliers.server_port)) as end:
            end.sendall(f"POST {ASK} HTTP/1.1\r\n{head}Content-Length: 50\r\n\r\n{{".encode())
    refused(request(pliers, "POST", ASK, b"{"), 400)


def test_the_page_may_ask_nobody_but_its_server(pliers: LiveServer) -> None:
    response, content = request(pliers, "GET", f"/?token={pliers.guard.token}", Origin=None)
    assert response.status == 200
    assert pliers.guard.token.encode() in content
    policy = response.getheader("Content-Security-Policy")
    assert policy.startswith("default-src 'none'; ")
    assert "; script-src 'sha256-" in policy
    assert "connect-src 'self'" in policy
    assert "frame-ancestors 'none'" in policy
    assert "unsafe" not in policy
    for name, value in (("Cache-Control", "no-store"), ("Referrer-Policy", "no-referrer")):
        assert response.getheader(name) == value
    assert response.getheader("Server").strip() == "icage"
    assert response.getheader("Access-Control-Allow-Origin") is None


def test_it_listens_on_loopback_only(pliers: LiveServer) -> None:
    assert pliers.socket.getsockname()[0] == "127.0.0.1"
