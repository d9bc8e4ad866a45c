"""Who may ask the live page's server: its own page, on this machine, with the token in hand.

Any page that a browser has open can send requests to a port of this machine, and a name that its
owner points at 127.0.0.1 makes it look like the same origin (DNS rebinding). So the name that was
asked for, the page that asks and a secret in its address are all looked at.
"""

from __future__ import annotations

import hmac
from dataclasses import dataclass
from email.message import Message
from typing import Final
from urllib.parse import parse_qs

HOST: Final = "127.0.0.1"
"""Nobody outside this machine reaches it."""

TOKEN_HEADER: Final = "X-Icage-Token"

LARGEST_BODY: Final = 1 << 16
"""[byte] Of a question; the largest that the page asks has a few hundred."""


@dataclass(frozen=True, slots=True)
class Refusal(Exception):
    """Why a request is not answered: the HTTP status and one line."""

    status: int
    why: str


@dataclass(frozen=True, slots=True)
class Guard:
    """What requests must bring; ``port`` is the server's."""

    port: int
    token: str

    def check_host(self, headers: Message) -> None:
        """Refuse a request for another name than this machine's own.

        Raises
        ------
        Refusal:
            403.
        """
        if headers.get("Host", "") not in self._hosts():
            raise Refusal(403, "this server answers to 127.0.0.1 and localhost only")

    def check_page(self, query: str) -> None:
        """Refuse the page itself to whoever does not know its address.

        Raises
        ------
        Refusal:
            403.
        """
        given = parse_qs(query, max_num_fields=8).get("token", [""])
        self._check_token(given[0] if len(given) == 1 else "")

    def check_question(self, headers: Message) -> int:
        """Refuse questions that are not from our page; the length of the body, [byte].

        Raises
        ------
        Refusal:
            403, 411, 413 or 415.
        """
        if headers.get("Origin", "") not in {f"http://{host}" for host in self._hosts()}:
            raise Refusal(403, "questions are taken from this server's own page only")
        self._check_token(headers.get(TOKEN_HEADER, ""))
        if headers.get("Content-Type", "").partition(";")[0].strip().lower() != "application/json":
            raise Refusal(415, "a question is application/json")
        length = headers.get("Content-Length", "")
        if "Transfer-Encoding" in headers or not (length.isascii() and length.isdigit()):
            raise Refusal(411, "a question needs its Content-Length")
        if len(length) > 12 or int(length) > LARGEST_BODY:
            raise Refusal(413, f"a question has at most {LARGEST_BODY} bytes")
        return int(length)

    def _hosts(self) -> set[str]:
        names = (HOST, "localhost")
        plain = names if self.port == 80 else ()
        return {*plain, *(f"{name}:{self.port}" for name in names)}

    def _check_token(self, given: str) -> None:
        if not hmac.compare_digest(given.encode(), self.token.encode()):
            raise Refusal(403, "the address lacks the token that was printed when the server began")
