// What the contacts are, at every moment of a drag: a grasp or not and why, then how far its hand
// may open.

import { html, setAll, svg, subscripted } from "./svg.js";
import { SIGNS } from "./verdict.js";
import { lengthWriter, ratio } from "./words.js";

const SAID_AFTER = 700; // [ms] at rest before it is read out

/** What a state is called: [verdict for the colour and the sign, word]. */
export function standingWord({ standing, levels, trouble, lost }) {
  if (trouble && lost) return ["pending", "no answer"];
  if (trouble) return ["collision", "no hand"];
  if (!standing) return ["pending", "looking"];
  if (standing.holds && levels?.verdict === "not_a_cage") return ["escapes", "no cage"];
  if (standing.holds) return ["target", "immobilizing"];
  return [standing.grasp ? "caged" : "escapes", "not immobilizing"];
}

/** { element, show(state) }; `take()` is told that the contacts shall go to the nearest grasp. */
export function contactCard(live, take) {
  const { data } = live;
  const sign = svg("svg", { viewBox: "0 0 24 24", class: "sign", "aria-hidden": true });
  const word = html("strong", { class: "word" }), meaning = html("p", { class: "meaning" });
  const near = html("p", { class: "near" }), rows = html("dl", { class: "levellist" });
  const button = html("button", { type: "button", on: { click: take } }, "Move the contacts there");
  const spoken = html("p", { class: "unseen", role: "status", "aria-live": "polite" });
  const element = html("section", { class: "verdict standing", "aria-label": "The contacts" },
    html("p", { class: "head" }, sign, word), meaning, near, button, rows, spoken);
  let waiting = 0;
  return { element, show };

  function show(state) {
    const { standing, levels, trouble, unplanned } = state, [verdict, name] = standingWord(state);
    element.dataset.verdict = verdict;
    setAll(sign, { "data-verdict": verdict });
    sign.replaceChildren(...(SIGNS[verdict] ?? []).map((d) => svg("path", { d })));
    word.textContent = name;
    meaning.textContent = trouble ? sentence(trouble) : meaningOf(standing, levels);
    const grasp = !trouble && standing && !standing.holds ? standing.grasp : null;
    near.textContent = grasp ? "The nearest grasp of a hand of this shape (dashed) is "
      + `${live.length(grasp.moved)} ${data.unit} away, turned by ${Number(grasp.turned_deg.toPrecision(2))}°. Of that grasp:` : "";
    if (unplanned && !levels) near.textContent += ` ${sentence(unplanned)}`;
    near.hidden = near.textContent === "";
    button.hidden = !grasp;
    const held = !trouble && !(unplanned && !levels) && standing && (standing.holds || grasp) && levels?.verdict !== "not_a_cage";
    rows.hidden = !held;
    if (held) rows.replaceChildren(...levelRows(levels));
    setAll(rows, { "aria-busy": held && !levels ? "true" : null });
    clearTimeout(waiting);
    waiting = setTimeout(() => {
      const said = [`${name}.`, meaning.textContent, near.textContent,
        held && levels ? rows.textContent : ""].join(" ");
      if (spoken.textContent !== said) spoken.textContent = said;
    }, SAID_AFTER);
  }

  function meaningOf(standing, levels) {
    if (!standing) return "";
    if (levels?.verdict === "not_a_cage") return sentence(levels.why);
    if (!standing.holds) {
      return `${sentence(standing.why)}${standing.grasp ? "" : " No grasp of a hand of this shape is near."}`;
    }
    if (!levels) return "These contacts hold the object.";
    if (levels.sigma_max === null) return "However far this hand opens, the object cannot leave it.";
    return "These contacts hold the object; the hand may open this far:";
  }

  function levelRows(levels) {
    const known = levels ? [levels.sigma_0, levels.shelf, levels.brink, levels.wedge, levels.sigma_first, levels.sigma_max].filter((one) => one !== null) : [];
    const length = lengthWriter(data.diameter, known);
    const row = (below, value, words) => html("div", {}, html("dt", {}, subscripted("σ", below)),
      html("dd", {}, value === undefined ? html("span", { class: "pending" }, "…")
        : value === null ? "there is none"
          : html("span", {}, html("b", {}, `${length(value)} ${data.unit}`), ...(below === "0" ? []
            : [` = ${ratio(value / levels.sigma_0)} `, subscripted("σ", "0")]))),
      html("dd", { class: "note" }, value === null ? words.replace("below it", "at any size") : words));
    const stops = [["shelf", levels?.shelf ?? null, "on parallel edges"],
      ["brink", levels?.brink ?? null, "at the end of an edge"]]
      .filter(([, sigma]) => sigma !== null).sort(([, a], [, b]) => a - b);
    const stop = stops[0] ?? null;
    const wedge = levels?.wedge ?? null;
    if (wedge !== null && (stop === null || wedge < stop[1])) {
      const words = wedge > levels.sigma_0
        ? "below it closing ends in this grasp; from it on only if all fits exactly"
        : "closing ends in this grasp by an exact fit only: a hair more or less, and it ends elsewhere";
      return [row("0", levels.sigma_0, "at the grasp"), row("wedge", wedge, words),
        row("max", levels.sigma_max, "below it the object cannot leave")];
    }
    const one = stop === null && levels && levels.sigma_first !== null && levels.sigma_first === levels.sigma_max;
    if (one) {
      return [row("0", levels.sigma_0, "at the grasp"), row("max", levels.sigma_max,
        "below it the object cannot leave, and closing ends in this grasp")];
    }
    if (stop !== null) {
      const [name, sigma, where] = stop;
      return [row("0", levels.sigma_0, "at the grasp"),
        row(name, sigma, `below it closing ends in this grasp; from it on it may stop ${where}`),
        row("max", levels.sigma_max, "below it the object cannot leave")];
    }
    return [row("0", levels?.sigma_0, "at the grasp"),
      row("first", levels?.sigma_first, "below it closing ends in this grasp"),
      row("max", levels?.sigma_max, "below it the object cannot leave")];
  }
}

function sentence(text) {
  const first = text[0].toUpperCase() + text.slice(1);
  return /[.!?]$/.test(first) ? first : `${first}.`;
}
