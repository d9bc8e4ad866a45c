"""The kinds of input: what each begins from, how it is spoiled, and what is asked of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from random import Random
from typing import Final, Protocol

from tests.fuzz.geometry import hostile_case
from tests.fuzz.job import Job
from tests.fuzz.laws import lawful_case
from tests.fuzz.mutations import chunks, dxf_tags, json_tree, markup, raw, text
from tests.fuzz.options import option_job
from tests.fuzz.seeds import documents, drawings, recorded

Mutation = Callable[[bytes, tuple[bytes, ...], Random], bytes]
Seeds = Callable[[], tuple[bytes, ...]]


class Kind(Protocol):
    """Makes the inputs of one kind."""

    def job(self, random: Random) -> Job:
        """One input."""
        ...


@dataclass(frozen=True, slots=True)
class Spoiled:
    """A file of a format, mutated; ``asked`` are the commands, the file is ``name`` in them."""

    name: str
    seeds: Seeds
    mutations: tuple[Mutation, ...]
    asked: tuple[tuple[str, tuple[str, ...]], ...]
    beside: Callable[[], dict[str, bytes]] = dict

    def job(self, random: Random) -> Job:
        """One input."""
        whole = self.seeds()
        content = random.choice(whole)
        for _ in range(random.choice((1, 1, 1, 1, 2))):
            content = random.choice(self.mutations)(content, whole, random)
        call, arguments = random.choice(self.asked)
        return Job({**self.beside(), self.name: content[: raw.LONGEST]}, arguments, call, self.name)


@dataclass(frozen=True, slots=True)
class Made:
    """Inputs that a function makes."""

    make: Callable[[Random], Job]

    def job(self, random: Random) -> Job:
        """One input."""
        return self.make(random)


def _drawing(name: str, found: Seeds, *own: Mutation, more: tuple[str, ...] = ()) -> Spoiled:
    """A drawing, asked for its outline in several ways; bytes are spoiled least."""
    plain = ("outline", name, "--width", "40", "--unit", "mm")
    one = (*plain, "--pick", "largest")
    ways = [plain, one, one, ("outline", name, "--unit", "mm", "--json", "-"), (*one, *more)]
    mutations = (*own, *own, *own, raw.spoiled)
    return Spoiled(name, found, mutations, tuple(("main", way) for way in ways))


_JSON: Final = (json_tree.spoiled, json_tree.spoiled, json_tree.spoiled, text.spoiled, raw.spoiled)

KINDS: Final[dict[str, Kind]] = {
    "case": Spoiled(
        "a.json", documents.cases, _JSON,
        (
            ("main", ("plan", "a.json", "--json", "-")),
            ("main", ("plan", "a.json", "--method", "both")),
            ("main", ("query", "a.json", "p.csv", "--json", "-")),
        ),
        documents.beside_cases,
    ),
    "plan": Spoiled(
        "plan.json", documents.plans, _JSON,
        (("read_cage", ("plan.json",)), ("main", ("plan", "plan.json"))),
    ),
    "grasps": Spoiled(
        "grasps.json", documents.grasps, _JSON,
        (
            ("main", ("plan", "grasps.json")),
            ("main", ("plan", "grasps.json", "--grasp", "2", "--json", "-")),
        ),
    ),
    "placements": Spoiled(
        "p.csv", documents.placements, (text.spoiled, text.spoiled, raw.spoiled),
        (("main", ("query", "a.json", "p.csv", "--json", "-")),), documents.beside_placements,
    ),
    "study-toml": Spoiled(
        "s.toml", documents.studies, (text.spoiled, text.spoiled, raw.spoiled),
        (("checked only", ("study", "s.toml", "--out", "out")),), documents.beside_studies,
    ),
    "study-json": Spoiled(
        "out/study.json", recorded.study_documents, _JSON,
        (("checked only", ("study", "--resume", "--out", "out")),),
    ),
    "replay-json": Spoiled(
        "out/replay.json", recorded.replay_documents, _JSON,
        (("main", ("replay-trial", "out", "0", "--json", "-")),), recorded.beside_replay_documents,
    ),
    "replay-table": Spoiled(
        "out/trials.parquet", recorded.replay_tables, (raw.spoiled,),
        (("main", ("replay-trial", "out", "0")),), recorded.beside_replay_tables,
    ),
    "svg": _drawing("a.svg", drawings.svg, markup.spoiled, more=("--strokes", "drawn")),
    "dxf": _drawing(
        "a.dxf", drawings.dxf, dxf_tags.spoiled, text.spoiled, more=("--safe", "inside")
    ),
    "stl": _drawing("a.stl", drawings.stl, text.spoiled, more=("--section", "1")),
    "obj": _drawing("a.obj", drawings.obj, text.spoiled, more=("--axis", "x")),
    "ply": _drawing("a.ply", drawings.ply, text.spoiled, more=("--section", "1e-3")),
    "png": _drawing("a.png", drawings.png, chunks.spoiled, more=("--threshold", "0.5")),
    "jpeg": _drawing("a.jpg", drawings.jpeg, chunks.spoiled, more=("--threshold", "0.9")),
    "geojson": _drawing("a.geojson", drawings.geojson, *_JSON, more=("--safe", "outside")),
    "wkt": _drawing("a.wkt", drawings.wkt, text.spoiled, more=("--strokes", "outline")),
    "options": Made(option_job),
    "geometry": Made(hostile_case),
    "laws": Made(lawful_case),
}  # fmt: skip
"""By the name that ``--formats`` takes."""


def job_of(kind: str, seed: int, number: int) -> Job:
    """The input that a kind, a seed and a number name: the same on every machine."""
    return KINDS[kind].job(Random(f"{kind}/{seed}/{number}"))
