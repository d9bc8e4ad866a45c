// The page: one hand, one answer, and everything that shows them. `mount` puts it into an element;
// a file, a notebook and a server can all do that.

import { frictionSlider } from "./friction.js";
import { reshaped } from "./hand.js";
import { placementFields } from "./numbers.js";
import { placesOf, placesTable, standAt } from "./places.js";
import { queryOf } from "./query.js";
import { escapeRoute } from "./route.js";
import { levelScale } from "./scale.js";
import { stageOf } from "./stage.js";
import { heading, hints, legend } from "./texts.js";
import { html } from "./svg.js";
import { verdictCard } from "./verdict.js";
import { lengthWriter } from "./words.js";

/**
 * Fills an element with the page of a document `icage-explore/1`. What comes back asks and moves:
 * { query(at), placement(), place(at) } with placements { x, y, theta, sigma }.
 *
 * `ask(at)` answers about a placement; without it the tables of the document do. `placed(at, answer)`
 * is told wherever the hand is put; `beside` are elements that stand below the answer.
 */
export function mount(element, data, { ask = queryOf(data), placed = () => {}, beside = [] } = {}) {
  const page = pageOf(data), { plan } = page, unit = plan.hand.unit_fingers;
  const target = page.places[0];
  let at = standAt(target), chosen = target;

  const taken = (wanted) => { route.stop(); leave(); place(wanted); };
  const stage = stageOf(page, ask, (wanted) => (wanted === null ? goTo(target) : taken(wanted)));
  const card = verdictCard(page);
  const scale = levelScale(page, (sigma) => taken(reshaped(unit, at, at.theta, sigma)));
  const numbers = placementFields(page, taken);
  const table = placesTable(page, goTo);
  const friction = frictionSlider(page, () => place(at), goTo);
  const route = escapeRoute(page, (wanted) => { leave(); place(wanted); }, stage.showRoute);
  element.replaceChildren(
    heading(page),
    html("main", {},
      html("div", { class: "left" }, stage.element, legend(page), hints(page)),
      html("div", { class: "right" },
        html("div", { class: "answer" }, card.element, scale.element),
        ...beside, numbers.element, table.element, route.element, friction.element)));
  goTo(target);
  return { query: ask, placement: () => ({ ...at }), place: taken };

  /** Puts the hand at a grasp, a puncture or a jam; it stays there as a ghost. */
  function goTo(somewhere) {
    route.stop();
    chosen = somewhere;
    place(standAt(somewhere));
    table.chosen(somewhere.key);
  }

  function leave() {
    table.chosen(null);
  }

  /** Puts the hand somewhere; every part that shows it is told. */
  function place(wanted) {
    at = wanted;
    const answer = ask(at), rubbing = friction.current();
    const ghosts = chosen === target ? [target] : [target, chosen];
    stage.show(at, answer, ghosts);
    card.show(answer, rubbing);
    scale.show(at.sigma, answer.verdict, rubbing);
    numbers.show(at);
    placed(at, answer);
  }
}

let pages = 0;

/** What all parts of a page share. */
function pageOf(data) {
  const { plan } = data, levels = levelsOf(plan);
  const length = lengthWriter(plan.diameter, levels.map((level) => level.sigma));
  // grasps and the largest size of a hand that never escapes lie on the scale, without a name
  const sizes = [...levels.map((level) => level.sigma), ...plan.grasps.map((grasp) => grasp.sigma_0)];
  if (data.sigma_largest !== null) sizes.push(data.sigma_largest);
  return {
    document: data, plan, levels, sizes, length, places: placesOf(plan), id: `icage-${++pages}`,
  };
}

/** The named levels, ascending. */
function levelsOf(plan) {
  const levels = [{ below: "0", sigma: plan.sigma_0 }];
  if (plan.verdict === "not_a_cage") return levels;
  const first = plan.sigma_first, last = plan.sigma_max;
  if (first !== null && first === last) return [...levels, { below: "first = max", sigma: first }];
  if (first !== null) levels.push({ below: "first", sigma: first });
  if (last !== null) levels.push({ below: "max", sigma: last });
  return levels;
}
