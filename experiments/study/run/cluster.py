"""The same shards on a cluster: a worker gets the study's document and the numbers of its trials.

It plans the cage once and sends tables back.
"""

from __future__ import annotations

from collections.abc import Generator, Mapping
from functools import lru_cache
from typing import Any

from experiments.io.arrow_table import Table
from experiments.io.cluster import Cluster, document_here
from experiments.study.run.document import study_of
from experiments.study.run.shard import Study
from experiments.study.run.shards import Backend, Span, shard_table


def on_cluster(address: str, document: Mapping[str, Any]) -> Backend:
    """Shards on the workers of the scheduler at ``tcp://HOST:PORT``.

    Raises
    ------
    ClusterError:
        As ``experiments.io.cluster.Cluster``.
    """
    cluster = Cluster(address, document)

    def backend(study: Study, spans: list[Span]) -> Generator[tuple[Span, Table]]:
        if spans:
            yield from cluster.run(run_remote, spans, _name)

    return backend


def _name(span: Span) -> str:
    return f"trials {span[0]} to {span[1]}"


def run_remote(text: str, span: Span) -> Table:
    """On a worker: the table of a shard of the study with this document."""
    return shard_table(_study(text), span)


@lru_cache(maxsize=4)
def _study(text: str) -> Study:
    """The study, on a worker with the versions that it is recorded with."""
    return study_of(document_here(text))
