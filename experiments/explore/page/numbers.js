// The placement in numbers, to read and to type, and as a row for `icage query`.

import { withinHalfTurns } from "./hand.js";
import { html } from "./svg.js";
import { degrees, radians } from "./words.js";

/** { element, show(at) }; `wanted(at)` is told of a placement typed in. */
export function placementFields(page, wanted) {
  const { plan } = page, unit = plan.unit ? ` [${plan.unit}]` : "";
  // to a hundred-thousandth of the object, as number fields take them
  const decimals = 4 - Math.floor(Math.log10(plan.diameter));
  const written = (value) => String(Number(
    decimals > 12 ? value.toPrecision(6) : value.toFixed(Math.max(1, decimals))));
  const step = 10 ** (Math.floor(Math.log10(plan.diameter)) - 2);
  const fields = {
    x: field("x", `x${unit}`, step), y: field("y", `y${unit}`, step),
    theta: field("theta", "θ [°]", 0.5), sigma: field("sigma", `σ${unit}`, step, 0),
  };
  const row = html("code", {});
  const element = html("section", { class: "numbers" },
    html("h2", {}, "The hand in numbers"),
    html("div", { class: "fields" }, ...Object.values(fields).map(({ whole }) => whole)),
    html("p", { class: "note" }, "Finger 1 at (x, y), finger 2 at distance σ from it in direction θ. As a row for ",
      html("code", {}, "icage query"), ": ", row));
  let at = null;
  return { element, show };

  function field(key, words, by, min = null) {
    const id = `${page.id}-${key}`;
    const input = html("input", { id, type: "number", step: "any", min, "data-step": by,
      on: { change: typed, keydown: stepped } });
    return { input, whole: html("p", {}, html("label", { for: id }, words), input) };
  }

  function typed(event) {
    const key = Object.keys(fields).find((one) => fields[one].input === event.target);
    const value = event.target.valueAsNumber;
    if (!Number.isFinite(value) || (key === "sigma" && value < 0)) show(at);
    else wanted({ ...at, [key]: key === "theta" ? withinHalfTurns(radians(value)) : value });
  }

  /** Arrows step by round amounts; any number may be typed. */
  function stepped(event) {
    const by = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (by === undefined) return;
    event.preventDefault();
    const input = event.target, to = input.valueAsNumber + by * Number(input.dataset.step);
    input.value = Number(to.toPrecision(12));
    typed({ target: input });
  }

  function show(now) {
    at = now;
    const shown = { ...at, theta: degrees(at.theta) };
    for (const [key, { input }] of Object.entries(fields)) {
      if (document.activeElement !== input || Number(input.value) !== Number(written(shown[key]))) {
        input.value = written(shown[key]);
      }
    }
    row.textContent = [at.x, at.y, at.theta, at.sigma].join(",");
  }
}

