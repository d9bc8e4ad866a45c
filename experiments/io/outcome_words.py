"""What outcomes and verdicts are called, once: for films, pages and pictures."""

from __future__ import annotations

from typing import Final

VERDICT_WORDS: Final = {
    "target": "closing can end only in the target",
    "caged": "caged, other grasps within reach",
    "other": "held, but not with the target",
    "escapes": "not caged",
    "collision": "in collision with the object",
}
"""What the planner says of a start: of the planned hand, without friction."""

END_WORDS: Final = {
    "target": "in the target grasp",
    "other_grasp": "in another grasp of the plan",
    "jammed": "at rest elsewhere, held by friction or weight",
    "unmatched": "in a grasp that the plan does not have; no friction or weight holds it",
    "escaped": "the hand shut on nothing",
    "timed_out": "still moving when time was up",
    "diverged": "the engine gave up",
}
"""How a closing ended."""

NOT_CLOSED: Final = {
    "collision": "a finger would start inside the object",
    "not_caged": "the start is not caged",
    "no_shape": "the outline or hand drawn crosses itself",
}
"""Why a trial of a study was not closed."""
