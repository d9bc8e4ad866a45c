"""A worker for tests of the lane: it waits, dies or fails as it is asked."""

from __future__ import annotations

import os
import time
from typing import Any

from experiments.explore.live.lane import Stopped
from icage.errors import InputError


class MadeUp:
    def answer(self, kind: str, question: dict[str, Any], stopped: Stopped) -> str:
        if kind == "die":
            os._exit(9)
        if kind == "refuse":
            raise InputError("not\nthis")
        if kind == "fail":
            raise KeyError("ours")
        if kind == "interrupt":
            while not stopped():
                time.sleep(0.01)
            return "stopped"
        time.sleep(question.get("seconds", 0.0))
        return f"{os.getpid()}"


def worker(_thing: object) -> MadeUp:
    return MadeUp()
