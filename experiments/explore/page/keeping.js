// The case file: downloaded, and written where the command said.

import { html } from "./svg.js";

/** { element, can(yes) }; `current()` is the { radius, contacts } to keep. */
export function caseKeeper(live, ask, current) {
  const { data } = live;
  const note = html("p", { class: "note", role: "status" });
  const button = html("button", { type: "button", on: { click: keep } }, "Save case");
  const where = data.save === null ? "A file that every icage command reads."
    : `A file that every icage command reads; also written to ${data.save}.`;
  const element = html("section", { class: "keeping" }, html("h2", {}, "Keep it"),
    html("p", { class: "row" }, button), html("p", { class: "note" }, where), note);
  return { element, can: (yes) => { button.disabled = !yes; } };

  async function keep() {
    try {
      const answer = await ask("/api/save", current());
      const url = URL.createObjectURL(new Blob([`${JSON.stringify(answer.case, null, 1)}\n`],
        { type: "application/json" }));
      html("a", { href: url, download: answer.file }).click();
      setTimeout(() => URL.revokeObjectURL(url), 1000);
      note.textContent = `Downloaded as ${answer.file}${answer.written ? `, written to ${answer.written}` : ""}.`;
    } catch (error) {
      note.textContent = error.message;
    }
  }
}
