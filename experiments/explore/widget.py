"""The page as a widget of a notebook: the same module, and the placement in both directions."""

from __future__ import annotations

import importlib
import json
import os
import re
from collections.abc import Sequence
from typing import Any, Final

from experiments.explore.document import explore_document
from experiments.explore.page_html import module_text, style_text
from icage.cage import Cage
from icage.cells.query_tables import query_tables
from icage.errors import InputError
from icage.formats.json_out import json_text
from icage.friction.levels import JamTolerance, friction_levels

RENDER: Final = """
/** "light" or "dark" as JupyterLab, VS Code or marimo say it; null where nobody does. */
const themeOf = () => {
  const root = document.documentElement, { body } = document;
  const { jpThemeLight, vscodeThemeKind } = body.dataset;
  if (jpThemeLight) return jpThemeLight === "false" ? "dark" : "light";
  if (vscodeThemeKind) return vscodeThemeKind.includes("light") ? "light" : "dark";
  const says = (one) => [root, body].some(({ classList, dataset }) => (
    classList.contains(one) || dataset.theme === one));
  return ["dark", "light"].find(says) ?? null;
};

export default {
  render({ model, el }) {
    el.classList.add("icage");
    const themed = () => {
      const theme = themeOf();
      for (const one of ["dark", "light"]) el.classList.toggle(`icage-${one}`, one === theme);
    };
    themed();
    const watching = new MutationObserver(themed);
    for (const one of [document.documentElement, document.body]) {
      watching.observe(one, { attributes: true });
    }
    let told = null;
    const placed = ({ x, y, theta, sigma }) => {
      told = [x, y, theta, sigma];
      model.set("placement", told);
      model.save_changes();
    };
    const page = mount(el, model.get("document"), { placed });
    model.on("change:placement", () => {
      const [x, y, theta, sigma] = model.get("placement");
      if (told?.join() !== [x, y, theta, sigma].join()) page.place({ x, y, theta, sigma });
    });
    return () => watching.disconnect();
  },
};
"""

_DARK: Final = re.compile(r"@media \(prefers-color-scheme: dark\) \{\n  \.icage \{([^}]*)\}\n\}")
"""The colours of the page where the system is dark."""


def themed_style() -> str:
    """The page's style, whose colours follow the notebook's theme and else the system's."""
    return _DARK.sub(
        r"@media (prefers-color-scheme: dark) { .icage:not(.icage-light) {\1} }\n"
        r".icage.icage-light { color-scheme: light; }\n"
        r".icage.icage-dark { color-scheme: dark;\1}",
        style_text(),
    )


def explore_widget(cage: Cage, mus: Sequence[float] = ()) -> Any:
    """A widget that shows a cage: drag, turn and open the hand in Jupyter, marimo or VS Code.

    Its trait ``placement`` is [x, y, theta, sigma] of the hand as it stands, to observe and to set:
    ``cage.query(widget.placement)`` says what the page says.

    Parameters
    ----------
    cage:
        Planned by the cells.
    mus:
        [1] Coefficients of friction for the slider, point fingers only.

    Raises
    ------
    InputError:
        anywidget is not installed; as ``experiments.explore.run.write_page``.
    """
    try:
        anywidget, traitlets = map(importlib.import_module, ("anywidget", "traitlets"))
    except ImportError as error:
        raise InputError(
            "the widget needs anywidget, which is not installed: pip install 'icage[notebook]'"
        ) from error
    tolerance = JamTolerance()
    friction = friction_levels(cage, sorted(set(mus)), tolerance) if mus else ()
    tables = query_tables(cage, os.cpu_count() or 1)
    name = cage.name or "object"
    document = explore_document(cage, tables, name, cage.unit, friction, tolerance)
    made = type(
        "ExploreWidget",
        (anywidget.AnyWidget,),
        {
            "_esm": module_text() + RENDER,
            "_css": themed_style(),
            "document": traitlets.Dict().tag(sync=True),
            "placement": traitlets.List(traitlets.Float()).tag(sync=True),
        },
    )
    start = cage.target_placement.as_array().tolist()
    return made(document=json.loads(json_text(document)), placement=start)
