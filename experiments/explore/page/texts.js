// What does not change: the heading, what the shades mean, how to take the hand.

import { KEYS } from "./gestures.js";
import { foreign, html, subscripted } from "./svg.js";

/** The level below which closing ends in the target, and its name. */
function guaranteed(plan) {
  const levels = [["first", plan.sigma_first],
    ...["shelf", "brink", "wedge"].map((name) => [name, plan[name]?.sigma ?? null])];
  const known = levels.filter(([, sigma]) => sigma !== null).sort(([, a], [, b]) => a - b);
  return known[0] ?? ["first", null];
}

/** The name and the answer in one sentence. */
export function heading({ plan, length }) {
  const [name, first] = guaranteed(plan);
  const wedged = first !== null && first <= plan.sigma_0;
  const exact = "closing ends in the target grasp by an exact fit only (a wedge).";
  const unit = plan.unit ? ` ${plan.unit}` : "";
  const kind = plan.finger_radius > 0
    ? `disc fingers of radius ${Number(plan.finger_radius.toPrecision(4))}${unit}` : "point fingers";
  const level = (below, value) => [subscripted("σ", below), ` = ${length(value)}${unit}`];
  const answer = html("p", { class: "lead" });
  if (plan.verdict === "not_a_cage") answer.append(`These contacts are not a cage: ${plan.why}.`);
  else if (plan.sigma_max === null) {
    answer.append("However far the hand opens, the object cannot leave it. ");
    if (wedged) answer.append(`But ${exact}`);
    else if (first !== null) {
      answer.append("Below ", ...level(name, first), " closing can end only in the target grasp.");
    }
  } else if (wedged) {
    answer.append("Below ", ...level("max", plan.sigma_max), ` the object cannot leave the hand, but ${exact}`);
  } else if (first === plan.sigma_max) {
    answer.append("Below ", ...level("max", plan.sigma_max),
      " the object cannot leave the hand, and closing can end only in the target grasp.");
  } else {
    answer.append("Below ", ...level("max", plan.sigma_max), " the object cannot leave the hand; below ",
      ...level(name, first), " closing can end only in the target grasp.");
  }
  const [a, b] = plan.hand.phi_deg.map((angle) => `${Number(angle.toPrecision(4))}°`);
  return html("header", {},
    html("h1", {}, foreign(plan.name || "object")), answer,
    html("p", { class: "note" }, `A hand of ${plan.contacts.length} ${kind} on a triangle of fixed shape, φ = (${a}, ${b}). `,
      html("i", {}, "σ"), ", its size, is the distance between fingers 1 and 2."),
    ...plan.warnings.map((warning) => html("p", { class: "note" }, `Note: ${warning}`)));
}

/** What the shades mean. */
export function legend({ plan, document: data }) {
  const chips = (kind) => html("span", { class: "chips", "aria-hidden": true },
    ...plan.contacts.map((_, k) => html("span", { class: `chip f${k + 1} ${kind}` })));
  const line = (kind, ...words) => html("li", {}, chips(kind), html("span", {}, ...words));
  const levels = new Set(data.drawn_regions.map((region) => region.level));
  const lines = [];
  if (levels.has("sigma_first")) {
    lines.push(line("sure", "each finger below ", subscripted("σ", "first"), ": closing ends in the target"));
  }
  if (levels.has("sigma_max")) {
    const only = plan.sigma_first === plan.sigma_max;
    lines.push(line(only ? "sure" : "whole", "each finger below ", subscripted("σ", "max"),
      only ? ": closing ends in the target" : ": the object cannot leave"));
  }
  if (levels.has("all")) lines.push(line("whole", "each finger at any size: the object cannot leave"));
  if (lines.length === 0) return "";
  return html("div", { class: "legend" }, html("ul", {}, ...lines),
    html("p", { class: "note" }, "Every finger in its region is not enough: the verdict is of all of them together."));
}

/** How to take the hand. */
export function hints({ id }) {
  const keys = KEYS.map(([key, does]) => html("div", {}, html("dt", {}, key), html("dd", {}, does)));
  return html("div", { class: "hints", id: `${id}-keys` },
    html("p", { class: "note" }, "Drag the hand; turn it by its knob, or with the wheel over it; the scale of σ opens "
      + "and closes it. On a touch screen two fingertips move, turn and open it. Keys, with the drawing in focus:"),
    html("dl", { class: "keys" }, ...keys));
}
