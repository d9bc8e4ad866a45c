// The escape path: played, or gone along by a slider. Whoever has asked for less motion gets one
// corner of the path at a press.

import { wayAlong } from "./hand.js";
import { html, setAll, subscripted } from "./svg.js";

const LASTS = 7000; // [ms] to play all of it
const STEPS = 1000; // of the slider

/** { element, stop() }; `wanted(at)` is told where the hand shall be, `drawn(rows)` what to draw. */
export function escapeRoute(page, wanted, drawn) {
  const { plan } = page;
  if (plan.escape_path === null) return { element: "", stop() {} };
  // after this row nothing holds the object any more
  const rows = plan.escape_path.slice(0, (plan.escape_free_at ?? plan.escape_path.length - 1) + 1);
  const way = wayAlong(plan.hand.unit_fingers, rows);
  const still = matchMedia("(prefers-reduced-motion: reduce)");
  const button = html("button", { type: "button", class: "wide", on: { click: pressed } });
  const slider = html("input", {
    type: "range", min: 0, max: STEPS, step: 1, value: 0, "aria-label": "Place on the escape path",
    on: { input: () => { stop(); go(slider.valueAsNumber / STEPS); } },
  });
  const note = html("p", { class: "note" });
  const element = html("section", { class: "route" }, html("h2", {}, "The way out"),
    html("div", { class: "player" }, button, slider), note);
  let playing = 0, share = 0;
  named();
  still.addEventListener("change", named);
  note.append("It opens to ", subscripted("σ", "max"), " and no further; where it ends, nothing holds the object.");
  return { element, stop };

  function named() {
    button.textContent = playing ? "Pause" : still.matches ? "Next corner" : "Play";
  }

  function pressed() {
    if (playing) stop();
    else if (still.matches) nextCorner();
    else play();
  }

  function nextCorner() {
    const shares = rows.map((_, k) => way.shareOf(k));
    const next = shares.find((one) => one > share + 1e-9);
    go(next ?? 0);
  }

  function play() {
    let begun = null;
    const from = share >= 1 ? 0 : share;
    const frame = (now) => {
      begun ??= now;
      go(Math.min(1, from + (now - begun) / LASTS));
      if (share < 1) playing = requestAnimationFrame(frame);
      else stop();
    };
    playing = requestAnimationFrame(frame);
    named();
  }

  function stop() {
    cancelAnimationFrame(playing);
    playing = 0;
    named();
  }

  function go(to) {
    share = to;
    slider.value = Math.round(to * STEPS);
    const at = way.at(to);
    setAll(slider, { "aria-valuetext": `${Math.round(100 * to)} %, sigma ${page.length(at.sigma)}` });
    drawn(rows);
    wanted(at);
  }
}
