"""Conditional attributes: which elements are meant for this reader. [SVG2018, Sec. 5]"""

from __future__ import annotations

from typing import Final
from xml.etree.ElementTree import Element

LANGUAGE: Final = "en"
"""The reader's language, for ``systemLanguage``."""

_FEATURES: Final = ("http://www.w3.org/tr/svg11/feature#", "http://www.w3.org/tr/svg2/feature#",
                    "org.w3c.svg")  # fmt: skip


def holds(element: Element) -> bool:
    """Whether all conditions of an element hold; it has no part in the drawing if not.

    >>> holds(Element("g", systemLanguage="de, en-GB")), holds(Element("g", systemLanguage="fr"))
    (True, False)
    """
    features = element.get("requiredFeatures")
    if features is not None:
        words = features.lower().split()
        if not words or not all(word.startswith(_FEATURES) for word in words):
            return False
    if element.get("requiredExtensions") is not None:
        return False
    languages = element.get("systemLanguage")
    if languages is None:
        return True
    wanted = [one.strip().lower() for one in languages.split(",")]
    return any(one == LANGUAGE or one.startswith(LANGUAGE + "-") for one in wanted)
