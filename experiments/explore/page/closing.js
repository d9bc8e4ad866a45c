// Close: MuJoCo closes the hand from where it stands, in a process of the server; the way is played
// here, and the end is told in numbers.

import { html, setAll, svg } from "./svg.js";
import { SIGNS } from "./verdict.js";

const SLOWER = 2.5; // [1] it is played so many times slower than the small world's time
const SHORTEST = 1.2, LONGEST = 5; // [s] of a film

/** What an outcome says, and the verdict whose colour and sign it has. */
const OUTCOMES = {
  target: ["target", () => "The hand closed into the target grasp."],
  other_grasp: ["caged", (id) => `The hand closed into grasp ${id}, not into the target.`],
  jammed: ["other", () => "The hand is at rest in no grasp: friction holds it there."],
  escaped: ["escapes", () => "The object escaped: the hand has closed on nothing."],
  unmatched: ["other", () => "The hand is at rest in a grasp that is not of this cage."],
  timed_out: ["collision", () => "The hand was still moving when the time was up."],
  diverged: ["collision", () => "The physics engine gave up."],
};

/** { element, attach(page, question), moved() }; `question()` is the { radius, contacts } of the page. */
export function closingSection(live, ask) {
  const { data } = live, id = `${live.id}-closingmu`;
  const still = matchMedia("(prefers-reduced-motion: reduce)");
  const mu = html("input", { id, type: "number", min: 0, max: 10, step: 0.05, value: 0 });
  const button = html("button", { type: "button", class: "main", on: { click: close } }, "Close the hand");
  const sign = svg("svg", { viewBox: "0 0 24 24", class: "sign small", "aria-hidden": true });
  const words = html("strong", { class: "word" }), told = html("p", { class: "outcome", role: "status" }, sign, words);
  const numbers = html("ul", { class: "margins" }), note = html("p", { class: "note" });
  const slider = html("input", { type: "range", min: 0, max: 1000, step: 1, value: 1000,
    "aria-label": "Time of the closing", on: { input: () => { stop(); show(slider.valueAsNumber / 1000); } } });
  const again = html("button", { type: "button", on: { click: () => play() } }, "Play again");
  const player = html("p", { class: "player" }, again, slider);
  const element = html("section", { class: "closing" }, html("h2", {}, "Close it in physics"),
    html("p", { class: "row" }, button, html("span", { class: "together" }, html("label", { for: id }, "with friction μ ="), mu)), told, numbers, player, note);
  let page = null, question = null, film = null, playing = 0, ours = false, clear = null;
  player.hidden = told.hidden = numbers.hidden = true;
  return { element, attach, moved, pressing };

  /**
   * An answer about a hand of the film. A finger that presses stands a hair inside the object, which
   * the query calls a collision: then the answer before it holds on, at the size of now.
   */
  function pressing(answer) {
    if (!ours || answer.verdict !== "collision" || clear === null) {
      if (ours) clear = answer;
      return answer;
    }
    const closed = clear.sigma - answer.sigma;
    const wider = (margin) => (margin === null ? null : margin + closed);
    return { ...clear, sigma: answer.sigma, margin: wider(clear.margin), target_margin: wider(clear.target_margin) };
  }

  function attach(to, asked) {
    stop();
    page = to;
    question = asked;
    film = null;
    player.hidden = told.hidden = numbers.hidden = true;
    const points = !(question().radius > 0);
    button.disabled = points;
    note.textContent = points ? "These fingers are points, and simulated fingers need a radius: give them one under Contacts."
      : "From where the hand stands now, pulled shut by a constant force on a viscous table.";
  }

  /** Somebody has put the hand elsewhere: the film is over. */
  function moved() {
    if (!ours) stop();
  }

  async function close() {
    stop();
    const at = page.placement(), here = page;
    button.disabled = true;
    note.textContent = "MuJoCo is closing the hand …";
    player.hidden = told.hidden = numbers.hidden = true;
    try {
      const answer = await ask("/api/close", { ...question(), friction: mu.valueAsNumber || 0,
        placement: [at.x, at.y, at.theta, at.sigma] });
      if (here !== page) return; // another cage is shown by now
      if (answer.out_of_date) note.textContent = "Another page has closed its hand; press once more.";
      else ended(answer);
    } catch (error) {
      note.textContent = error.message;
    } finally {
      button.disabled = !(question().radius > 0);
    }
  }

  function ended(answer) {
    film = answer;
    clear = null;
    const [verdict, say] = OUTCOMES[answer.outcome];
    told.dataset.verdict = verdict;
    setAll(sign, { "data-verdict": verdict });
    setAll(element, { "data-outcome": answer.outcome });
    sign.replaceChildren(...SIGNS[verdict].map((d) => svg("path", { d })));
    const length = (value) => `${brief(value)}\u00a0${data.unit}`;
    const lines = answer.end === null || answer.outcome === "escaped" ? []
      : [["off the target by", length(answer.position_error)], ["turned from it by", `${brief(answer.angle_error_deg)}°`]];
    if (answer.end !== null) {
      lines.push(["deepest penetration", length(answer.penetration_max)], ["penetration at rest", length(answer.penetration_rest)]);
    }
    numbers.replaceChildren(...lines.map(([what, value]) => (
      html("li", {}, html("span", {}, what), html("b", {}, value)))));
    note.textContent = `${answer.engine}, friction μ = ${answer.friction}, time step ${brief(1000 * answer.time_step)} ms, `
      + `${answer.simulated.toFixed(2)} s of the simulated world, in which the object is 1 across and weighs 1.`;
    words.textContent = say(answer.grasp_id);
    player.hidden = told.hidden = numbers.hidden = false;
    if (still.matches) show(1);
    else play();
  }

  function play() {
    stop();
    const lasts = 1000 * Math.min(LONGEST, Math.max(SHORTEST, SLOWER * film.simulated));
    let begun = null;
    const frame = (now) => {
      begun ??= now;
      const share = Math.min(1, (now - begun) / lasts);
      show(share);
      if (share < 1) playing = requestAnimationFrame(frame);
      else playing = 0;
    };
    playing = requestAnimationFrame(frame);
  }

  function stop() {
    cancelAnimationFrame(playing);
    playing = 0;
  }

  /** The hand as it stood at a share of the time; at the end as it was judged. */
  function show(share) {
    const { time, placements, end } = film, wanted = share * time.at(-1);
    let k = time.findIndex((one) => one >= wanted);
    if (k < 0) k = time.length - 1;
    const [x, y, theta, sigma] = share >= 1 && end !== null ? end : placements[k];
    slider.value = Math.round(1000 * share);
    setAll(slider, { "aria-valuetext": `${(share * time.at(-1)).toFixed(2)} s` });
    ours = true;
    page.place({ x, y, theta, sigma });
    ours = false;
  }
}

const RAISED = "⁰¹²³⁴⁵⁶⁷⁸⁹";

/** Two digits; powers of ten for what is tiny. */
function brief(value) {
  if (value === 0 || Math.abs(value) >= 1e-3) return String(Number(value.toPrecision(2)));
  const [digits, power] = value.toExponential(1).split("e-");
  return `${digits}\u00a0×\u00a010⁻${[...power].map((digit) => RAISED[digit]).join("")}`;
}
