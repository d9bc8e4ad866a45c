// Grasps that the search proposes: the best few, each with a small picture, to choose by click or
// keys.

import { html, setAll, svg } from "./svg.js";
import { boxOf, pairs, ringsPath, viewOf, widened } from "./view.js";
import { ratio } from "./words.js";

const THUMB_WIDE = 66, THUMB_TALL = 56; // [px] of a picture

/** { element, propose(take), chosen(contacts), clear(), any() }; `go(grasp)` is told of the grasp that is picked. */
export function proposalList(live, ask, current, go) {
  const { data } = live, id = `${live.id}-seconds`;
  const seconds = html("input", { id, type: "number", min: 1, max: 600, step: "any", value: data.seconds });
  const button = html("button", { type: "button", class: "main", on: { click: pressed } }, "Propose grasps");
  const note = html("p", { class: "note", role: "status" }, "The best grasps of any hand, searched by the planner.");
  const list = html("ol", { class: "proposals" });
  const element = html("section", { class: "proposing" }, html("h2", {}, "Let it propose"),
    html("p", { class: "row" }, button, html("span", { class: "together" }, html("label", { for: id }, "for at most"), seconds, "s")), note, list);
  let begun = null, ticking = 0, found = [];
  return { element, propose, chosen, clear, any: () => found.length > 0 };

  function pressed() {
    if (begun === null) propose();
    else {
      note.textContent = "Taking what there is …";
      ask("/api/stop", {}).catch(() => {});
    }
  }

  /** Searches; where `take()` says so then, the best comes to the page by itself. */
  async function propose(take = () => false) {
    if (begun !== null) return;
    const most = Math.min(600, Math.max(1, seconds.valueAsNumber || data.seconds));
    const { radius } = current();
    begun = performance.now();
    button.textContent = "Take what there is";
    tell(most);
    ticking = setInterval(() => tell(most), 500);
    try {
      const answer = await ask("/api/propose", { radius, seconds: most, top: 6 });
      if (answer.out_of_date) return;
      if (radius !== current().radius) {
        clear();
        return;
      }
      show(answer);
      if (found.length > 0 && take()) go(found[0]);
    } catch (error) {
      note.textContent = error.message;
    } finally {
      clearInterval(ticking);
      begun = null;
      button.textContent = "Propose grasps";
    }
  }

  /** What was proposed is for fingers of another radius. */
  function clear() {
    found = [];
    list.replaceChildren();
    note.textContent = "Grasps of other fingers were proposed: propose again.";
  }

  function tell(most) {
    const passed = Math.floor((performance.now() - begun) / 1000);
    note.textContent = passed > most ? `${passed} s: the best that were found are being planned …`
      : `Searching: ${passed} of at most ${Number(most.toPrecision(3))} s …`;
  }

  function show(answer) {
    found = answer.grasps;
    const ended = { "out of time": "; the time was up", interrupted: "; you ended it" }[answer.ended] ?? "";
    note.textContent = found.length === 0 ? `None of ${answer.compared} grasps compared is a cage.`
      : `The best of ${answer.compared} grasps compared${ended}. The score is σ first / σ₀.`;
    list.replaceChildren(...found.map((grasp, k) => html("li", {}, proposal(grasp, k))));
    chosen(current().contacts);
  }

  function proposal(grasp, k) {
    const top = grasp.sigma_max === null ? "never opens"
      : `σ max ${live.length(grasp.sigma_max)} ${data.unit}`;
    return html("button", { type: "button", class: "proposal", "aria-pressed": "false",
      "aria-label": `Grasp ${k + 1}, score ${ratio(grasp.score)}, ${top}`, on: { click: () => go(grasp) } },
    picture(grasp.contacts), html("span", {}, html("b", {}, ratio(grasp.score)), html("small", {}, top)));
  }

  function picture(contacts) {
    const box = widened(boxOf([...data.outline.vertices, ...contacts]), 0.04 * data.diameter);
    const view = viewOf(box, THUMB_WIDE, THUMB_TALL);
    return svg("svg", { viewBox: `0 0 ${THUMB_WIDE} ${THUMB_TALL}`, width: THUMB_WIDE, height: THUMB_TALL, "aria-hidden": true },
      svg("path", { d: ringsPath(view, [data.outline.vertices]), class: "object" }),
      svg("polygon", { points: pairs(view, contacts), class: "thumb" }),
      ...contacts.map(view.to).map(([cx, cy], k) => svg("circle", { cx, cy, r: 2.6, class: `dot f${k + 1}` })));
  }

  function chosen(contacts) {
    // contacts that were put onto the true curve differ in their last digits
    const same = (one) => one.length === contacts.length && one.every(([x, y], k) => (
      Math.hypot(x - contacts[k][0], y - contacts[k][1]) < 1e-5 * data.diameter));
    [...list.querySelectorAll("button")].forEach((one, k) => (
      setAll(one, { "aria-pressed": String(same(found[k].contacts)) })));
  }
}
