// The verdict in words, sign and colour. A listener is told when the hand has come to rest,
// not at every step of a drag.

import { html, setAll, svg } from "./svg.js";
import { MEANINGS, NO_CAGE, collisionWords, listed } from "./words.js";

const QUIET_AFTER = 500; // [ms] at rest before it is read out

/** The sign of each verdict, on 24 by 24. */
export const SIGNS = {
  target: ["M12 3a9 9 0 1 0 0 18a9 9 0 1 0 0-18z", "M12 9a3 3 0 1 0 0 6a3 3 0 1 0 0-6z"],
  caged: ["M12 3a9 9 0 1 0 0 18a9 9 0 1 0 0-18z"],
  other: ["M4 4h16v16h-16z", "M9 12h6"],
  escapes: ["M15.5 3.8a8.9 8.9 0 1 0 0 16.4", "M10 12h12", "M18 8l4 4l-4 4"],
  collision: ["M5 5l14 14", "M19 5l-14 14"],
};

/** The card of the verdict: { element, show(answer, friction) }. */
export function verdictCard(page) {
  const { plan, length } = page;
  const sign = svg("svg", { viewBox: "0 0 24 24", class: "sign", "aria-hidden": true });
  const word = html("strong", { class: "word" });
  const meaning = html("p", { class: "meaning" });
  const rows = html("ul", { class: "margins" });
  const spoken = html("p", { class: "unseen", role: "status", "aria-live": "polite" });
  const head = html("p", { class: "head" }, sign, word);
  const element = html("section", { class: "verdict", "aria-label": "Verdict" },
    head, meaning, rows, spoken);
  let waiting = 0;
  return { element, show };

  function show(answer, friction) {
    element.dataset.verdict = answer.verdict;
    setAll(sign, { "data-verdict": answer.verdict });
    sign.replaceChildren(...SIGNS[answer.verdict].map((d) => svg("path", { d })));
    word.textContent = answer.verdict;
    meaning.textContent = meaningOf(answer);
    const margins = marginsOf(answer, friction);
    rows.replaceChildren(...margins.map((parts) => html("li", {}, ...parts.map((part, k) => (
      html(k === 1 ? "b" : "span", {}, part))))));
    clearTimeout(waiting);
    const sentence = [`${word.textContent}.`, meaning.textContent,
      ...margins.map((parts) => `${parts.join(" ")}.`)].join(" ");
    waiting = setTimeout(() => {
      if (spoken.textContent !== sentence) spoken.textContent = sentence;
    }, QUIET_AFTER);
  }

  function meaningOf({ verdict, inside }) {
    if (verdict === "collision") return collisionWords(inside);
    // there are no cells of a cage to look into, and no others were searched
    if (plan.verdict === "not_a_cage") return NO_CAGE;
    return MEANINGS[verdict];
  }

  /** Lines [words, value, words]: by how much the hand may still open, and until what. */
  function marginsOf(answer, friction) {
    if (answer.verdict === "escapes" || answer.verdict === "collision") return [];
    const lines = [answer.margin === null
      ? ["may open", "as far as it can", "and the object does not escape"]
      : ["may open by", withUnit(answer.margin), "before the object can escape"]];
    if (answer.target_margin !== null) {
      lines.push(["by", withUnit(answer.target_margin), "before closing may end elsewhere"]);
    }
    if (answer.verdict === "target" && friction !== null && friction.mu > 0) {
      const with_ = `with friction up to μ = ${friction.mu}`;
      const left = friction.sigma_first === null ? Infinity : friction.sigma_first - answer.sigma;
      if (left === Infinity) lines.push(["as far as it can", "", with_]);
      else if (left > 0) lines.push(["by", withUnit(left), `${with_}, closing ending near the target`]);
      else lines.push(["by", "nothing", `${with_}: it may jam on the way to the target`]);
    }
    if (answer.grasps.some((id) => id !== 0)) lines.push(["closing may end in", namesOf(answer.grasps), ""]);
    return lines;
  }

  function namesOf(ids) {
    if (ids.length > 6) return `${ids.length} grasps`;
    const others = ids.filter((id) => id !== 0), name = others.length > 1 ? "grasps" : "grasp";
    return `${ids.includes(0) ? "the target and " : ""}${name} ${listed(others)}`;
  }

  function withUnit(value) {
    return `${length(value)} ${plan.unit}`;
  }
}
