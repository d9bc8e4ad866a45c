"""A failing input made smaller: pieces of the file are left out while the fault stays."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Final

from tests.fuzz.job import Job

MOST: Final = 120
"""Jobs that are run to make one smaller."""


def smaller(job: Job, still: Callable[[Job], bool]) -> Job:
    """The job with as little of its spoiled file as still has the fault, within ``MOST`` runs."""
    if not job.spoiled:
        return job
    content, runs = job.files[job.spoiled], 0
    piece = max(1, len(content) // 2)
    while piece and runs < MOST:
        at = 0
        while at < len(content) and runs < MOST:
            shorter = content[:at] + content[at + piece :]
            runs += 1
            if shorter and still(replace(job, files={**job.files, job.spoiled: shorter})):
                content = shorter
            else:
                at += piece
        piece //= 2
    return replace(job, files={**job.files, job.spoiled: content})
