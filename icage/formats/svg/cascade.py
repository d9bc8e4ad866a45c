"""Which declarations win on each element: attributes, style rules, ``style``, ``!important``.

cssselect2 tests the selectors; how often it may look at an element is counted, since a few short
rules can ask for more than a machine can do. [CSSCascade2022, Sec. 6]
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, NamedTuple
from xml.etree.ElementTree import Element

import tinycss2
from cssselect2 import ElementWrapper, SelectorError, compile_selector_list

from icage.errors import FormatError
from icage.formats.svg.properties import ATTRIBUTES, GEOMETRY
from icage.formats.svg.style_sheets import Declarations, Declared, Rule, StyleReader
from icage.formats.svg.xml_tree import local_name

MAX_TESTS: Final = 4_000_000
"""Elements that selectors look at, all together: seconds."""

_NO_VALUES: Final = ("", "null", "undefined")
"""What programs write for nothing; it is no value of any property, so the attribute is ignored."""

_USUAL: Final = 40
"""Characters of a selector that looks at an element once; a longer one counts more often."""


class _Selector(NamedTuple):
    """One selector of a rule, in the order in which its declarations apply."""

    specificity: Any
    order: int
    cost: int
    test: Callable[[Any], bool]
    declarations: Declarations


class _Budget:
    left = MAX_TESTS

    def spend(self, count: int) -> None:
        self.left -= count
        if self.left < 0:
            raise FormatError(
                f"the selectors of the style sheets look at more than {MAX_TESTS} elements"
            )


class _Wrapped(ElementWrapper):
    """An element for the selectors that counts whom they look at, and keeps no lists of it."""

    budget: _Budget

    @property
    def ancestors(self) -> tuple[_Wrapped, ...]:  # pyright: ignore
        found: list[_Wrapped] = []
        element = self.parent
        while element is not None:
            found.append(element)
            element = element.parent
        self.budget.spend(len(found))
        return tuple(found)

    @property
    def previous_siblings(self) -> tuple[_Wrapped, ...]:  # pyright: ignore
        found: list[_Wrapped] = []
        element = self.previous
        while element is not None:
            found.append(element)
            self.budget.spend(1)
            element = element.previous
        return tuple(found)

    @property
    def etree_siblings(self) -> list[Element]:
        self.budget.spend(len(self._siblings))
        return self._siblings

    @etree_siblings.setter
    def etree_siblings(self, siblings: list[Element]) -> None:
        self._siblings = siblings

    def iter_children(self) -> Any:
        self.budget.spend(1 + len(self.etree_children))
        return super().iter_children()


class Cascade:
    """The declarations that count on each element of a tree.

    Raises
    ------
    FormatError:
        Style sheets that are not understood, or ask for too much.
    """

    def __init__(self, root: Element) -> None:
        self._reader = StyleReader()
        self._matched: dict[Element, list[Declarations]] = {}
        try:
            rules = self._reader.rules(root)
            if rules:
                self._match(root, rules)
        except RecursionError as error:
            raise FormatError("the style sheets are nested too deeply") from error
        self._known: dict[Element, Declarations] = {}

    def declared(self, element: Element) -> Declarations:
        """What counts on an element, by property."""
        known = self._known.get(element)
        if known is None:
            known = self._known[element] = self._declared(element)
        return known

    def _declared(self, element: Element) -> Declarations:
        tag = local_name(element)
        winning: Declarations = {}
        for name, value in element.items():
            if (name in ATTRIBUTES or tag in GEOMETRY.get(name, ())) and (
                value.strip() not in _NO_VALUES
            ):
                winning[name] = Declared(value.strip(), False)
        sheets = self._matched.get(element, [])
        own = element.get("style")
        layers = [*sheets, self._attribute(own)] if own else sheets
        for important in (False, True):
            for layer in layers:
                for name, value in layer.items():
                    if value.important == important and tag in GEOMETRY.get(name, (tag,)):
                        winning[name] = value
        return winning

    def _attribute(self, text: str) -> Declarations:
        try:
            return self._reader.attribute(text)
        except RecursionError as error:
            raise FormatError("a style attribute is nested too deeply") from error

    def _match(self, root: Element, rules: list[Rule]) -> None:
        by_id: dict[str, list[_Selector]] = {}
        by_class: dict[str, list[_Selector]] = {}
        others: list[_Selector] = []
        for order, rule in enumerate(rules):
            compiled = _compiled(rule)
            cost = 1 + len(tinycss2.serialize(rule.selectors)) // (_USUAL * len(compiled))
            for selector in compiled:
                if selector.pseudo_element is not None or selector.never_matches:
                    continue
                entry = _Selector(
                    selector.specificity, order, cost, selector.test, rule.declarations
                )
                if selector.id is not None:
                    by_id.setdefault(selector.id, []).append(entry)
                elif selector.class_name is not None:
                    by_class.setdefault(selector.class_name, []).append(entry)
                else:
                    others.append(entry)
        budget = _Budget()
        kind = type("_Counted", (_Wrapped,), {"budget": budget})
        walk = kind.from_xml_root(root).iter_subtree()
        for element in walk:
            candidates = [*others, *by_id.get(element.id or "", ())]
            for name in element.classes:
                candidates += by_class.get(name, ())
            budget.spend(sum(entry.cost for entry in candidates))
            matched = [entry for entry in candidates if entry.test(element)]
            if matched:
                matched.sort(key=lambda entry: entry[:2])
                self._matched[element.etree_element] = [one.declarations for one in matched]


def _compiled(rule: Rule) -> list[Any]:
    try:
        return list(compile_selector_list(rule.selectors, rule.spaces))
    except (SelectorError, SyntaxError, MemoryError, NotImplementedError) as error:
        text = " ".join(tinycss2.serialize(rule.selectors).split())
        raise FormatError(f"the selector {text!r:.60} of a style sheet is not supported") from error
