// The target, other grasps and punctures: a table of their levels, and the hand goes there.

import { placementOf } from "./hand.js";
import { html, setAll } from "./svg.js";
import { listed, ratio } from "./words.js";

/** Places of the plan: { key, name, about, sigma, contacts, kind }. */
export function placesOf(plan) {
  const grasps = plan.grasps.map((grasp) => ({
    key: `grasp ${grasp.id}`, kind: "grasp", sigma: grasp.sigma_0, contacts: grasp.contacts,
    name: grasp.target ? "Target grasp" : `Grasp ${grasp.id}`,
    about: [grasp.free_fingers?.length ? `finger ${listed(grasp.free_fingers)} free` : "",
      grasp.plateau ? "plateau" : ""].filter(Boolean).join(", "),
  }));
  const punctures = plan.punctures.map((puncture, k) => ({
    key: `puncture ${k}`, kind: "puncture", sigma: puncture.sigma, contacts: puncture.contacts,
    name: puncture.kind === "escape" ? "Escape puncture" : `Puncture ${k + 1}`,
    about: puncture.kind === "escape" ? "the way out"
      : `joins grasp ${listed(puncture.joins)}`,
  }));
  const nothing = { key: "contacts", kind: "grasp", sigma: plan.sigma_0, contacts: plan.contacts,
    name: "The contacts", about: "hold nothing" };
  return plan.verdict === "not_a_cage" ? [nothing] : [...grasps, ...punctures];
}

/** { element, chosen(key) }; `go(place)` is told of the place that somebody picks. */
export function placesTable(page, go) {
  const { plan, length } = page;
  const buttons = new Map();
  const rows = page.places.map((place) => {
    const button = html("button", { type: "button", on: { click: () => go(place) } }, place.name);
    buttons.set(place.key, button);
    return html("tr", {},
      html("th", { scope: "row" }, html("div", { class: "place" }, button, html("small", {}, place.about))),
      html("td", {}, length(place.sigma)),
      html("td", {}, ratio(place.sigma / plan.sigma_0)));
  });
  const head = html("tr", {}, html("th", { scope: "col" }, "Put the hand at"),
    html("th", { scope: "col" }, `σ [${plan.unit}]`), html("th", { scope: "col" }, "σ / σ₀"));
  const table = html("table", {}, html("thead", {}, head), html("tbody", {}, ...rows));
  const element = html("section", { class: "places" }, html("h2", {}, "Grasps and punctures"),
    html("div", { class: "scroll" }, table));
  return { element, chosen };

  function chosen(key) {
    for (const [one, button] of buttons) setAll(button, { "aria-pressed": String(one === key) });
  }
}

/** The placement of a place. */
export function standAt(place) {
  return placementOf(place.contacts);
}
