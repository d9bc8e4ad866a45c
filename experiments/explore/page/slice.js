// A slice through all placements: where the middle of the hand may stand, at the angle and size that
// it has now. Drawn coarsely at once and then finer, a few milliseconds at a time.

import { fingersOf } from "./query.js";
import { middleOf } from "./hand.js";
import { html, setAll, svg } from "./svg.js";

const GRIDS = [16, 8, 4]; // [px] squares, coarse to fine
const SHIFT = 8; // [ms] of work between two frames
const HELD = ["target", "caged", "other"];

/**
 * { element, toggle, note, show(at, view) }: the drawing, its switch, what it means, and what it is a
 * slice at; `switched(on)` is told.
 */
export function sliceOf(page, ask, switched) {
  const unit = page.plan.hand.unit_fingers;
  const paths = new Map(HELD.map((verdict) => (
    [verdict, svg("path", { class: "slice", "data-verdict": verdict })])));
  const element = svg("g", { "aria-hidden": true }, ...paths.values());
  const toggle = html("button", { type: "button", "aria-pressed": "false", on: { click: pressed } },
    "Where else it may stand");
  const note = html("p", { class: "note slicenote", hidden: true }, "Where the cross may be, at this angle and size: ",
    ...HELD.map((verdict) => html("span", { "data-verdict": verdict, class: "swatch" }, verdict)));
  let on = false, asked = "", now = null, waiting = 0;
  return { element, toggle, note, show };

  function pressed() {
    on = !on;
    setAll(toggle, { "aria-pressed": String(on) });
    note.hidden = !on;
    switched(on);
    asked = "";
    if (on) show(...now);
    else clear();
  }

  function clear() {
    cancelAnimationFrame(waiting);
    for (const path of paths.values()) path.removeAttribute("d");
  }

  function show(at, view) {
    now = [at, view];
    const key = [at.theta, at.sigma, view.zoom, view.wide, view.tall, view.to([0, 0])].join();
    if (!on || key === asked) return;
    asked = key;
    cancelAnimationFrame(waiting);
    begin(at, view, 0);
  }

  /** Fills the slice row by row; when a grid is done it is drawn, and a finer one begun. */
  function begin({ theta, sigma }, view, grid) {
    const size = GRIDS[grid], rows = Math.ceil(view.tall / size), columns = Math.ceil(view.wide / size);
    const [mx, my] = middleOf(fingersOf(unit, 0, 0, theta, sigma));
    const squares = new Map(HELD.map((verdict) => [verdict, []]));
    let row = 0;
    const work = () => {
      const until = performance.now() + SHIFT;
      while (row < rows && performance.now() < until) fillRow(row++);
      if (row < rows) waiting = requestAnimationFrame(work);
      else {
        for (const [verdict, path] of paths) setAll(path, { d: squares.get(verdict).join("") });
        if (grid + 1 < GRIDS.length) waiting = requestAnimationFrame(() => begin({ theta, sigma }, view, grid + 1));
      }
    };
    work();

    function fillRow(down) {
      const y = down * size;
      let run = null, since = 0;
      for (let column = 0; column <= columns; column++) {
        const x = column * size;
        const verdict = column < columns ? verdictAt(x + 0.5 * size, y + 0.5 * size) : null;
        if (verdict === run) continue;
        squares.get(run)?.push(`M${since} ${y}H${x}v${size}H${since}z`);
        run = verdict;
        since = x;
      }
    }

    function verdictAt(px, py) {
      const [x, y] = view.from([px, py]);
      return ask({ x: x - mx, y: y - my, theta, sigma }).verdict;
    }
  }
}
