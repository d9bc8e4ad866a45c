// What friction leaves of the guarantee, for the coefficients that were computed.

import { html, setAll } from "./svg.js";
import { listed } from "./words.js";

/** { element, current() }; `changed()` is told of another coefficient, `go(place)` of a jam. */
export function frictionSlider(page, changed, go) {
  const { plan, length } = page, levels = plan.friction ?? [], id = `${page.id}-mu`;
  if (levels.length === 0) return { element: "", current: () => null };
  const words = html("p", { class: "note" });
  const value = html("output", {});
  const slider = html("input", { type: "range", min: 0, max: levels.length - 1, step: 1, value: 0,
    id, on: { input: () => { told(); changed(); } } });
  const jam = html("button", { type: "button", on: { click: () => go({ ...levels[slider.valueAsNumber].jam, key: "jam", kind: "puncture" }) } },
    "Show the jam that limits it");
  const marks = html("p", { class: "ticks" }, ...levels.map(({ mu }) => html("span", {}, String(mu))));
  const element = html("section", { class: "friction" }, html("h2", {}, "Friction"),
    html("p", { class: "field" }, html("label", { for: id }, "Coefficient μ"), value),
    slider, marks, words, jam);
  told();
  return { element, current: () => levels[slider.valueAsNumber] };

  function endsWords({ position_max: off, angle_max_deg: turned }) {
    return ` It stops at most ${length(off * plan.diameter)} ${plan.unit} and ${Number(turned.toPrecision(3))}° off.`;
  }

  function told() {
    const level = levels[slider.valueAsNumber], near = plan.tolerance;
    value.textContent = String(level.mu);
    setAll(slider, { "aria-valuetext": `mu = ${level.mu}` });
    const below = level.sigma_first === null ? "However far the hand opens"
      : `Below σ = ${length(level.sigma_first)} ${plan.unit}`;
    const within = `${near.position} diameters and ${Number(near.angle_deg.toPrecision(3))}°`;
    words.textContent = `${below}, closing ends within ${within} of the target with friction up to `
      + `this.${level.mu > 0 ? endsWords(level.ends) : ""}${level.jam ? ` There fingers ${listed(level.jam.fingers)} can jam.` : ""}`;
    jam.hidden = level.jam === null;
  }
}
