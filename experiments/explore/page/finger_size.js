// The radius of the fingers: points at 0.

import { html } from "./svg.js";

/** { element, show(radius) }; `sized(answer)` is told of fingers of another radius. */
export function fingerSize(live, ask, current, sized) {
  const { data } = live, id = `${live.id}-radius`;
  const input = html("input", { id, type: "number", min: 0, step: "any", on: { change: typed } });
  const note = html("p", { class: "note", role: "status" });
  const element = html("section", { class: "fingersize" }, html("h2", {}, "Fingers"),
    html("p", { class: "row" }, html("label", { for: id }, `Radius [${data.unit}], 0 for points`), input), note);
  return { element, show };

  function show(radius) {
    input.value = String(Number(radius.toPrecision(12)));
  }

  async function typed() {
    const to = input.valueAsNumber, { radius, contacts } = current();
    if (!Number.isFinite(to) || to < 0 || to === radius) {
      show(radius);
      return;
    }
    note.textContent = "Looking for the same grasp with these fingers …";
    try {
      const answer = await ask("/api/fingers", { radius, contacts, to });
      if (answer.out_of_date) return;
      note.textContent = answer.contacts ? ""
        : `The same grasp is not there with these fingers (${answer.why}); the contacts were moved to the boundary.`;
      sized(answer);
    } catch (error) {
      note.textContent = error.message;
      show(radius);
    }
  }
}
