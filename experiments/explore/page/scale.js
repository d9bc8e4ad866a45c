// The vertical scale of sigma: levels as marks with their names, the hand's size as the handle of
// a slider. Sizes beyond its ends are reached by keys and numbers, and shown by an arrow there.

import { html, setAll, svg } from "./svg.js";

const WIDE = 172, TALL = 330, TOP = 20, BOTTOM = 18, AXIS = 34, APART = 17;

/** { element, show(sigma, verdict, friction) }; `opened(sigma)` is told of a new size. */
export function levelScale(page, opened) {
  const { plan, length } = page;
  const [low, high] = rangeOf(page.sizes, plan.sigma_0);
  const y = (sigma) => TALL - BOTTOM - ((sigma - low) / (high - low)) * (TALL - TOP - BOTTOM);
  const bands = svg("g"), marks = svg("g"), frictionMark = svg("g");
  const handle = svg("g", { class: "handle" });
  const drawing = svg("svg", {
    viewBox: `0 0 ${WIDE} ${TALL}`, width: WIDE, height: TALL, class: "levels", tabindex: 0,
    role: "slider", "aria-orientation": "vertical", "aria-label": "Size of the hand, sigma",
    "aria-valuemin": low, "aria-valuemax": high,
  }, bands, svg("line", { x1: AXIS, x2: AXIS, y1: TOP - 8, y2: TALL - BOTTOM, class: "axis" }),
  marks, frictionMark, handle);
  let current = low;
  drawFixed();
  listen();
  const step = (high - low) / 200;
  const button = (sign, words, by) => html("button", { type: "button", "aria-label": words,
    on: { click: () => opened(Math.max(0, current + by)) } }, sign);
  const element = html("div", { class: "scale" }, drawing,
    html("div", { class: "steps" }, button("−", "Close the hand a little", -step),
      html("span", { "aria-hidden": true }, "σ"), button("+", "Open the hand a little", step)));
  return { element, show };

  function drawFixed() {
    const first = plan.sigma_first ?? plan.sigma_max ?? high, last = plan.sigma_max ?? high;
    if (plan.verdict !== "not_a_cage") {
      band(plan.sigma_0, first, "sure");
      band(first, last, "whole");
    }
    const { levels } = page;
    const heights = apart(levels.map((level) => y(level.sigma)));
    levels.forEach((level, k) => {
      const at = y(level.sigma);
      marks.append(
        svg("path", { d: `M${AXIS - 5} ${at}H${AXIS + 6}L${AXIS + 22} ${heights[k]}H${AXIS + 27}`,
          class: "mark" }),
        nameOf(level, AXIS + 31, heights[k] + 4.5));
    });
  }

  function band(from, to, kind) {
    bands.append(svg("rect", {
      x: AXIS - 5, width: 10, y: y(Math.min(to, high)), height: Math.max(0, y(from) - y(Math.min(to, high))),
      class: `band ${kind}`,
    }));
  }

  function nameOf(level, x, at) {
    return svg("text", { x, y: at }, svg("tspan", { class: "symbol" }, "σ"),
      svg("tspan", { "font-size": "0.72em", dy: 3 }, level.below),
      svg("tspan", { dy: -3, dx: 5 }, `${length(level.sigma)}`));
  }

  function show(sigma, verdict, friction) {
    const inside = Math.min(high, Math.max(low, sigma)), at = y(inside);
    const beyond = sigma > high ? -1 : sigma < low ? 1 : 0;
    handle.replaceChildren(
      svg("path", { d: `M${AXIS - 7} ${at}l-16 -9v18z`, class: "arrow" }),
      svg("line", { x1: AXIS - 7, x2: AXIS + 7, y1: at, y2: at, class: "now" }));
    if (beyond !== 0) {
      const tip = at + 14 * beyond, wing = 6 * beyond;
      handle.append(svg("path", { d: `M${AXIS - 15} ${tip}v${-wing}m-5 0l5 ${wing}l5 ${-wing}`, class: "beyond" }));
    }
    drawing.dataset.verdict = verdict;
    setAll(drawing, { "aria-valuenow": sigma, "aria-valuetext": `${length(sigma)}: ${verdict}` });
    frictionMark.replaceChildren();
    if (friction?.mu > 0 && friction.sigma_first !== null && friction.sigma_first > low && friction.sigma_first < high) {
      const f = y(friction.sigma_first);
      frictionMark.append(
        svg("line", { x1: AXIS - 9, x2: AXIS + 9, y1: f, y2: f, class: "rubbing" }),
        svg("circle", { cx: AXIS + 13, cy: f, r: 3.2, class: "rubbing" }));
    }
    current = sigma;
  }

  function listen() {
    const follow = (event) => {
      const box = drawing.getBoundingClientRect();
      const down = ((event.clientY - box.top) / box.height) * TALL;
      const share = (TALL - BOTTOM - down) / (TALL - TOP - BOTTOM);
      opened(low + Math.min(1, Math.max(0, share)) * (high - low));
    };
    drawing.addEventListener("pointerdown", (event) => {
      drawing.setPointerCapture(event.pointerId);
      drawing.focus();
      follow(event);
      event.preventDefault();
    });
    drawing.addEventListener("pointermove", (event) => {
      if (drawing.hasPointerCapture(event.pointerId)) follow(event);
    });
    drawing.addEventListener("keydown", (event) => {
      const steps = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1, PageUp: 10, PageDown: -10 };
      const by = event.shiftKey ? 0.1 * step : step;
      if (event.key in steps) opened(Math.max(0, current + steps[event.key] * by));
      else if (event.key === "Home") opened(low);
      else if (event.key === "End") opened(high);
      else return;
      event.preventDefault();
    });
  }
}

/** From somewhat below all levels to somewhat above them. */
function rangeOf(levels, sigma0) {
  const low = Math.min(...levels), high = Math.max(...levels);
  const room = 0.25 * Math.max(high - low, 0.1 * sigma0);
  return [Math.max(0, low - room), high + room];
}

/** Heights moved as little as it takes to be apart, order kept. */
function apart(heights) {
  const order = heights.map((_, k) => k).sort((a, b) => heights[a] - heights[b] || b - a);
  const moved = order.map((k) => heights[k]);
  for (let round = 0; round < 200; round++) {
    for (let k = 0; k + 1 < moved.length; k++) {
      const short = APART - (moved[k + 1] - moved[k]);
      if (short > 0.01) {
        moved[k] -= short / 2;
        moved[k + 1] += short / 2;
      }
    }
    const over = TOP - moved[0], under = moved.at(-1) - (TALL - 4);
    if (over > 0) moved[0] += over;
    if (under > 0) moved[moved.length - 1] -= under;
  }
  const found = [];
  order.forEach((k, place) => { found[k] = moved[place]; });
  return found;
}
