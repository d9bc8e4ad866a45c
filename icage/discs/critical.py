"""Minima and punctures of disc fingers on the true curve, to rounding.

Every level at which the sublevel sets change has a hand whose forces balance at the features that
it touches. How many directions along these descend (the index of w . w / 2 - sum lambda_i g_i)
tells what it is: none for a minimum, one for a puncture. A polygon's answer says where to look,
Newton's method does the rest, and features are exchanged where its solution asks for others. Our
own. [docs/theory.md, Sec. 4]
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations, islice, product

import numpy as np

from icage.arrays import FloatArray
from icage.discs.balance import balanced, free_directions, pushes, slope_of_half_square
from icage.discs.descent import FLAT, way_down
from icage.discs.features import Feature, Features
from icage.discs.kernels.features import felt, nearly_balanced
from icage.discs.kernels.newton import BALANCED, STEPS, TOUCHES, Ended, descend, newton
from icage.hand import HandShape
from icage.outline import Outline
from icage.tolerance import FREE_FINGER

_ASLANT = 1e-6
"""[1] A touched feature that a direction is inclined to by more is in its way."""

_CHANGES = 8
"""How often the set of touched features may change on the way."""

_SUBSETS = 40
"""Sets of features that are tried one by one where the likely one fails."""

_DESCENT = 240
"""Steps of a descent along the true curve."""

_STRETCH = 8
"""Steps of it from one try of Newton's method to the next."""

_STRIDE = 0.25
"""[radius] How far a finger goes in one step."""

_NEARLY_BALANCED = 0.1
"""[1] Residual of the forces, over the size of the hand, above which no minimum is near."""

_NUDGE = 0.02
"""[radius] How far a hand at rest on a puncture is pushed off it."""


@dataclass(frozen=True, slots=True)
class Critical:
    """A hand on the true curve whose forces balance.

    ``contacts`` (fingers, 2) are the finger centres, ``sigma`` is the distance of the first two.
    ``descending`` counts the directions along the touched features in which sigma falls, ``level``
    those in which it neither falls nor grows (parallel edges).
    """

    contacts: FloatArray
    sigma: float
    descending: int
    level: int


class CriticalHands:
    """The critical hands of one outline, for fingers of one radius.

    Examples
    --------
    Fingers of radius 0.1 at the middles of a triangle's sides, put a little beside them:

    >>> outline = Outline([[-1.0, 0.0], [1.0, 0.0], [0.0, 3.0**0.5]])
    >>> directions = np.radians([-90.0, 30.0, 150.0])
    >>> contacts = (1.0 / 3.0**0.5 + 0.1) * np.column_stack(
    ...     [np.cos(directions), np.sin(directions)]
    ... )
    >>> contacts += [0.0, 1.0 / 3.0**0.5]
    >>> hands = CriticalHands(outline, 0.1, HandShape.from_contacts(contacts))
    >>> found = hands.minimum(contacts + [1e-5, 0.0], 1e-3)
    >>> bool(np.abs(found.contacts - contacts).max() < 1e-14), found.descending, found.level
    (True, 0, 0)
    >>> hands.puncture(contacts, 1e-3) is None
    True
    """

    def __init__(self, outline: Outline, radius: float, hand: HandShape) -> None:
        self.size = outline.diameter
        self.hand = hand
        self._features = Features(outline, radius, hand)
        self._remembered: dict[tuple[frozenset[Feature], int], Critical] = {}

    def minimum(self, contacts: FloatArray, reach: float) -> Critical | None:
        """The local minimum next to contacts (fingers, 2), or None if Newton's method finds none.

        Every finger is within ``reach`` [unit] of the features that it touches there.
        """
        return self._solve(contacts, reach, 0)

    def puncture(self, contacts: FloatArray, reach: float) -> Critical | None:
        """The puncture next to contacts (fingers, 2), as ``minimum``."""
        return self._solve(contacts, reach, 1)

    def below(self, contacts: FloatArray, reach: float) -> Critical | None:
        """The minimum that a hand at contacts (fingers, 2) comes to as it closes on the true curve.

        Each finger keeps to the half planes that the nearest points of the edges around it leave:
        all of them free, so that every step is a motion of the hand that never opens it.
        """
        features = self._features
        v = features.as_hand(contacts)
        stride = _STRIDE * features.radius
        sigma, step = math.inf, 0
        while step < _DESCENT:
            way = descend(features.sides, v, sigma, stride, _STRETCH - step % _STRETCH)
            if way.ended == Ended.LOST:
                return None
            v, sigma, step = way.v, way.sigma, step + way.steps
            found = self._solve(features.as_contacts(v), reach, 0)
            if found is not None and found.sigma <= sigma * self.size * (1.0 + 1e-9):
                return found
            if way.ended == Ended.STANDS:
                down = way_down(features, v)
                if down is None:
                    return None
                v = v + _NUDGE * features.radius * down
        return None

    def minima_near(self, hands: FloatArray, reach: float) -> list[Critical]:
        """Minima (of any number) next to some of the hands (k, fingers, 2), ascending in sigma.

        Of hands that touch the same features, to within ``reach`` [unit], only the smallest is
        looked at, and Newton's method is tried where forces nearly balance.
        """
        solved = [self._solve(hands[k], reach, 0) for k in self._nearly_balanced(hands, reach)]
        return sorted((one for one in solved if one is not None), key=lambda one: one.sigma)

    def stops_near(self, hands: FloatArray, likely: FloatArray, reach: float) -> list[Critical]:
        """Minima as ``minima_near``, and hands that are minima to one side only.

        Where an edge goes over into an arc its normal is that of both: forces balance on the one if
        they do on the other, and sigma may grow on the edge's side and fall on the arc's. All of
        the hands ``likely`` (k, fingers, 2) are looked at, whatever features they touch.
        """
        found: list[Critical] = []
        every = [*hands[self._nearly_balanced(hands, reach)], *likely]
        known = np.empty((0, *hands.shape[1:]))
        for one in every:
            if len(known) and np.abs(known - one).max(axis=(1, 2)).min() <= 1e-9 * self.size:
                continue
            known = np.concatenate([known, one[None]])
            minimum = self._solve(one, reach, 0)
            found += [] if minimum is None else [minimum]
            found += self._on_edges(one, reach)
        return sorted(found, key=lambda one: one.sigma)

    def _nearly_balanced(self, hands: FloatArray, reach: float) -> list[int]:
        """Which hands (k, fingers, 2) Newton's method may find a minimum beside, ascending."""
        rows = self._features.as_hand(hands)
        order = np.argsort(np.hypot(rows[:, 2], rows[:, 3]), kind="stable")
        near = nearly_balanced(
            self._features.sides, rows[order], reach / self.size, _NEARLY_BALANCED
        )
        return order[near].tolist()

    def _on_edges(self, contacts: FloatArray, reach: float) -> list[Critical]:
        """Minima next to contacts if edges are taken for arcs that they go over into."""
        start = self._features.as_hand(contacts)
        feel = felt(self._features.sides, start, max(reach / self.size, 1e-7))
        near = self._features.named(feel.which)
        likely = [f for f, p in zip(near, pushes(feel.force), strict=True) if p]
        far = self._furthest(reach)
        choices = [
            (f, *self._features.edges_at(start, f, far)) if f.is_arc else (f,) for f in likely
        ]
        found: list[Critical] = []
        for chosen in islice(product(*choices), 1, _SUBSETS):
            one = self._with_changes(start, list(chosen), reach, 0, changes=1)
            if one is not None:
                found.append(one)
        return found

    def free_fingers(self, contacts: FloatArray) -> tuple[int, ...]:
        """Fingers (1..) of contacts (fingers, 2) that touch nothing."""
        free = self._features.depths(contacts) < -FREE_FINGER
        return tuple(k + 1 for k in np.flatnonzero(free).tolist())

    def _solve(self, contacts: FloatArray, reach: float, descending: int) -> Critical | None:
        start = self._features.as_hand(contacts)
        feel = felt(self._features.sides, start, max(reach / self.size, 1e-7))
        near = self._features.named(feel.which)
        if not near:
            return None
        likely = [f for f, p in zip(near, pushes(feel.force), strict=True) if p]
        known = self._remembered.get((frozenset(likely), descending))
        if known is not None:
            moved = float(np.hypot(*(known.contacts - contacts).T).max())
            if moved <= 0.5 * self._furthest(reach) * self.size:
                return known
        touched = [f for f, g in zip(near, feel.gap, strict=True) if g < 1e-7]
        for features in (likely, touched):
            found = self._with_changes(start, features, reach, descending)
            if found is not None:
                self._remembered[frozenset(likely), descending] = found
                return found
        if descending == 0:
            return None  # a descent finds what features are missing
        tried = 0
        for count in (3, 2, 4):
            for chosen in combinations(near, count):
                if len({f.finger for f in chosen}) < 2:
                    continue
                tried += 1
                if tried > _SUBSETS:
                    return None
                found = self._with_changes(start, list(chosen), reach, descending, changes=1)
                if found is not None:
                    return found
        return None

    def _with_changes(
        self, start: FloatArray, features: list[Feature], reach: float, descending: int,
        changes: int = _CHANGES,
    ) -> Critical | None:  # fmt: skip
        """Newton's method on a set of features that may change where the solution asks for it."""
        v = start
        far = self._furthest(reach)
        seen: set[frozenset[Feature]] = set()
        for _ in range(changes):
            if len({f.finger for f in features}) < 2 or frozenset(features) in seen:
                return None
            seen.add(frozenset(features))
            solved = self._newton(v, features)
            if solved is None:
                return None
            v, force = solved
            if float(np.abs(self._features.fingers(v - start)).max()) > far:
                return None
            better = self._changed(v, features, force)
            if better is None:
                return self._judged(v, features, descending)
            features = better
        return None

    def _furthest(self, reach: float) -> float:
        """How far a finger may be from where the polygon had it, [diameter]: a chord's length."""
        return max(math.sqrt(8.0 * self._features.radius * reach / self.size), 1e-6) * 2.0

    def _newton(
        self, v: FloatArray, features: list[Feature]
    ) -> tuple[FloatArray, FloatArray] | None:
        """A hand that balances forces, of either sign, and touches all of the features; or None."""
        fast = newton(self._features.sides, v, self._features.numbers(features))
        if fast.ended != Ended.IRREGULAR:
            return (fast.v, fast.force) if fast.ended == Ended.SOLVED else None
        return self._newton_of_many(v, features)

    def _newton_of_many(
        self, v: FloatArray, features: list[Feature]
    ) -> tuple[FloatArray, FloatArray] | None:
        """The same where there are more forces than needed, or hands of one level side by side: of
        all solutions the nearest one.
        """
        chosen = self._features.chosen(features)
        gaps = self._features.gaps_of(v, chosen)
        force: FloatArray = np.asarray(
            np.linalg.lstsq(gaps.slope.T, slope_of_half_square(v), rcond=1e-9)[0], np.float64
        )
        m = len(features)
        matrix = np.zeros((4 + m, 4 + m))
        for _ in range(STEPS):
            matrix[:4, :4] = self._features.curvature(chosen, gaps, force)
            matrix[:4, 4:] = -gaps.slope.T
            matrix[4:, :4] = gaps.slope
            off = slope_of_half_square(v) - gaps.slope.T @ force
            residual = np.concatenate([off, gaps.value])
            step = np.linalg.lstsq(matrix, -residual, rcond=1e-11)[0]
            longest = float(np.abs(step[:4]).max())
            if not longest < 0.5:
                return None
            v, force = np.asarray(v + step[:4]), np.asarray(force + step[4:], np.float64)
            gaps = self._features.gaps_of(v, chosen)
            if longest < 1e-14:
                break
        off = slope_of_half_square(v) - gaps.slope.T @ force
        if float(np.abs(off).max()) > BALANCED * np.hypot(v[2], v[3]):
            return None
        return (v, force) if float(np.abs(gaps.value).max()) <= TOUCHES else None

    def _changed(
        self, v: FloatArray, features: list[Feature], force: FloatArray
    ) -> list[Feature] | None:
        """The set of features that the solution asks for instead, or None if it is right."""
        for k, f in enumerate(features):
            other = self._features.beside(v, f, TOUCHES)
            if other is not None:
                if not self._features.exists(other):
                    return features[:k] + features[k + 1 :]
                return [*(g for g in features if g not in (f, other)), other]
        deepest = self._features.deepest(v, TOUCHES)
        if deepest is not None and deepest not in features:
            return [*features, deepest]
        weak = int(np.argmin(force))
        if pushes(-force)[weak]:
            slopes = self._features.gaps(v, features).slope.T
            if balanced(slopes, slope_of_half_square(v), BALANCED) is not None:
                return None  # more are touched than are needed
            return features[:weak] + features[weak + 1 :]
        return None

    def _judged(self, v: FloatArray, features: list[Feature], descending: int) -> Critical | None:
        """What the hand is, if its forces balance pushing and it is of the wanted kind."""
        chosen = self._features.chosen(features)
        gaps = self._features.gaps_of(v, chosen)
        force = balanced(gaps.slope.T, slope_of_half_square(v), BALANCED)
        if force is None:
            return None
        loaded = pushes(force)
        along = free_directions(gaps.slope[loaded])
        hessian = self._features.curvature(chosen, gaps, force)
        bend, ways = np.linalg.eigh(along @ hessian @ along.T)
        down, level = int((bend < -FLAT).sum()), int((np.abs(bend) <= FLAT).sum())
        arcs = bool(chosen.is_arc[loaded].any())
        if down != descending and not (level and not arcs and down <= descending):
            return None
        # a puncture goes on to both sides, down or, between parallel edges, on the level first
        if descending and self._is_blocked(v, ways[:, 0] @ along):
            return None
        if level and arcs:
            return None  # neither a minimum nor a puncture, to second order
        contacts = self._features.as_contacts(v)
        sigma = float(np.hypot(*(contacts[1] - contacts[0])))
        return Critical(contacts, sigma, down, level)

    def _is_blocked(self, v: FloatArray, way: FloatArray) -> bool:
        """Whether a feature that is touched, pushing or not, is in the way on one side or other."""
        near = self._features.near(v, 10.0 * TOUCHES)
        return bool(np.abs(self._features.gaps(v, near).slope @ way).max() > _ASLANT)
