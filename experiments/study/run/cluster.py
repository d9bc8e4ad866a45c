"""The same shards on a cluster: a worker gets the study's document and the numbers of its trials.

It plans the cage once and sends tables back, as bytes.
"""

from __future__ import annotations

import json
from collections.abc import Generator, Mapping
from functools import lru_cache
from typing import Any

import numpy as np

from experiments.io.arrow_bytes import bytes_of, table_in
from experiments.io.arrow_table import Schema, Table
from experiments.io.cluster import Cluster, Work, document_here
from experiments.study.run.document import study_of
from experiments.study.run.shard import STUDY_OUTCOMES, Study
from experiments.study.run.shards import Backend, Span, shard_table


def on_cluster(address: str, document: Mapping[str, Any], any_code: bool = False) -> Backend:
    """Shards on the workers of the scheduler at ``tcp://HOST:PORT``.

    Raises
    ------
    ClusterError:
        As ``experiments.io.cluster.Cluster``.
    """
    cluster = Cluster(address, document, any_code)

    def backend(study: Study, spans: list[Span]) -> Generator[tuple[Span, Table]]:
        if spans:
            schema = shard_table(study, (0, -1)).schema
            work = Work(
                run_remote, list, lambda span, data: shard_in(data, schema, study, span), _name
            )
            yield from cluster.run(work, spans)

    return backend


def _name(span: Span) -> str:
    return f"trials {span[0]} to {span[1]}"


def run_remote(text: str, asked: str) -> bytes:
    """On a worker: the table of a shard, first and last trial, of the study with this document."""
    first, last = json.loads(asked)
    return bytes_of(shard_table(_study(text), (first, last)))


def shard_in(data: Any, schema: Schema, study: Study, span: Span) -> Table:
    """The table of a shard that a worker has sent.

    Raises
    ------
    ValueError:
        It has other columns, trials, values of the inputs or outcomes than a shard of the study.
    """
    numbers = np.arange(span[0], span[1] + 1)
    table = table_in(data, schema, len(numbers))
    if not np.array_equal(table["trial"].to_numpy(), numbers):
        raise ValueError("its trials are others")
    drawn = study.design.values(numbers)
    for name in study.design.names:
        if not np.allclose(table[name].to_numpy(), drawn[name], rtol=1e-9, atol=0.0):
            raise ValueError(f"its {name} is not what the study draws")
    if not set(table["outcome"].to_pylist()) <= set(STUDY_OUTCOMES):
        raise ValueError("its outcomes are none of a study's")
    return table


@lru_cache(maxsize=4)
def _study(text: str) -> Study:
    """The study, on a worker with the versions that it is recorded with."""
    return study_of(document_here(text))
