"""Cases, plans, lists of grasps, placements, studies: what icage reads of its own formats."""

from __future__ import annotations

import json
import tempfile
from functools import cache
from pathlib import Path
from typing import Final

import numpy as np

import icage
from models import CASES
from tests.experiments.small import t_case
from tests.fuzz.seeds.drawings import svg

_SHORT: Final = ("L_best", "T_best", "triangle_eq_best", "disc_Y", "rectangle_notcage",
                 "never_escapes_a", "Z_twofold_multi", "tunnel_golden")  # fmt: skip


@cache
def cases() -> tuple[bytes, ...]:
    """Small case files, and one whose outline is a drawing."""
    found = [(CASES / f"{name}.json").read_bytes() for name in _SHORT]
    drawn = {
        "format": "icage-case/1", "name": "drawn", "unit": "mm",
        "outline": {"file": "a.svg", "width": 40.0, "tolerance": 0.1, "pick": "largest"},
        "grasp": {"contacts": [[0.0, 10.0], [40.0, 5.0], [40.0, 15.0]]},
    }  # fmt: skip
    return (*found, json.dumps(drawn).encode())


@cache
def beside_cases() -> dict[str, bytes]:
    return {"a.svg": svg()[0], "p.csv": b"x,y,theta,sigma\n0,0,0,1\n-1,2,0.5,3\n"}


@cache
def plans() -> tuple[bytes, ...]:
    found: list[bytes] = []
    for content in cases()[:4]:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "a.json"
            path.write_bytes(content)
            case = icage.load(path)
            icage.plan(case).save(str(path))
            found.append(path.read_bytes())
    return tuple(found)


@cache
def grasps() -> tuple[bytes, ...]:
    found: list[bytes] = []
    for content in cases()[:2]:
        document = json.loads(content)
        contacts = document.pop("grasp")["contacts"]
        turned = [*contacts[1:], contacts[0]]
        rows = [{"contacts": contacts, "score": 2.0}, {"contacts": turned, "score": 1.0}]
        document |= {"format": "icage-grasps/1", "grasps": rows}
        found.append(json.dumps(document).encode())
    return tuple(found)


@cache
def placements() -> tuple[bytes, ...]:
    rng = np.random.default_rng(0)
    rows = rng.uniform((-3, -3, -4, 0), (3, 3, 4, 5), (30, 4)).tolist()
    text = "\n".join(",".join(map(repr, row)) for row in rows)
    return (
        f"x,y,theta,sigma\n{text}\n".encode(),
        b'x, y, theta, sigma\r\n"1", 2 ,0,.5\r\n\r\n-1e0,+2.,0,1\r\n',
        b"\xef\xbb\xbfx,y,theta,sigma\n0,0,0,0\n",
    )


@cache
def beside_placements() -> dict[str, bytes]:
    return {"a.json": cases()[1]}


@cache
def studies() -> tuple[bytes, ...]:
    return (
        b'case = "t.json"\ntrials = 20\nseed = 3\nstarts = "nominal"\nsampling = "sobol"\n'
        b'position_tolerance = 0.01\n\n[vary]\nplace_xy = "-2%:2%"\nplace_theta = "-8deg:8deg"\n'
        b'friction = "grid:0,0.02,0.3"\nspeed = "log:0.5:2"\n',
        b'case = "t.json"\ntrials = 8\nsampling = "saltelli"\nuncaged = "skip"\nmax_time = 2.0\n'
        b'time_step = 1e-3\n[vary]\nfinger_radius = "-0.3%:0.3%"\noutline_scale = "0.97:1.03"\n'
        b'outline_noise = "0:0.5%"\nphi_1 = "truncated:0:0.5deg:-1.5deg:1.5deg"\nweight = 0.2\n',
        b'case = "t.json"\ntrials = 4\nuntil_half_width = 0.1\nnominal = [0.1, 0.2, 0.3, 3.0]\n'
        b'[vary]\nplace_xy = "normal:0.2"\ntilt = "0deg:20deg"\n'
        b'tilt_direction = "-180deg:180deg"\n',
    )


@cache
def t_json() -> bytes:
    case = t_case()
    return json.dumps({
        "format": "icage-case/1", "name": case.name, "unit": case.unit,
        "outline": {"vertices": case.outline.vertices.tolist()},
        "finger_radius": case.finger_radius, "grasp": {"contacts": case.contacts.tolist()},
    }).encode()  # fmt: skip


@cache
def beside_studies() -> dict[str, bytes]:
    return {"t.json": t_json()}
