// The live page: contacts are chosen on one tab, the hand is played with and closed on the other.
// A server on the same machine plans and simulates; what a drag shows never waits for it.

import { askerOf, newestOf } from "./asking.js";
import { closingSection } from "./closing.js";
import { contactCard, standingWord } from "./contact_card.js";
import { CONTACT_KEYS, contactStage } from "./contact_stage.js";
import { mount } from "./explore.js";
import { fingerSize } from "./finger_size.js";
import { caseKeeper } from "./keeping.js";
import { proposalList } from "./proposals.js";
import { queryOf } from "./query.js";
import { foreign, html, setAll } from "./svg.js";
import { trackOf } from "./track.js";
import { lengthWriter } from "./words.js";

const REST = 250; // [ms] contacts have to be left alone before their regions are computed

/** Fills an element with the live page of a document `icage-live/1`. */
export function mountLive(element, data) {
  const live = { data, id: "icage-live", length: lengthWriter(data.diameter, []) };
  const ask = askerOf(data.token);
  const state = { contacts: data.contacts ?? spreadOver(data), radius: data.radius, track: tracked(data.track), standing: null,
    levels: null, document: null, fresh: false, trouble: null, unplanned: null, verdict: "pending" };
  const counts = { moves: 0, standings: 0, levels: 0, documents: 0 };
  let dragging = false, resting = 0, shown = null, hand = null;

  const standings = newestOf((question) => ask("/api/standing", question), stood, (error) => {
    Object.assign(state, { standing: null, levels: null, trouble: error.message, lost: error.lost });
    levels.forget();
    documents.forget();
    show();
  }, 2);
  const levels = newestOf((question) => ask("/api/levels", question), leveled, unplanned);
  const documents = newestOf((question) => ask("/api/document", question), documented, unplanned);

  const stage = contactStage(live, moved);
  const card = contactCard(live, () => moved(state.standing.grasp.contacts, false));
  const proposals = proposalList(live, ask, current, (grasp) => moved(grasp.contacts, false));
  const fingers = fingerSize(live, ask, current, (answer) => {
    Object.assign(state, { radius: answer.radius, track: tracked(answer.track), standing: null,
      levels: null, document: null });
    fingers.show(state.radius);
    if (proposals.any()) proposals.clear();
    moved(answer.contacts ?? state.contacts.map((contact) => state.track.nearest(contact).point), false);
  });
  const keeper = caseKeeper(live, ask, () => ({ radius: state.radius, contacts: graspNow() ?? state.contacts }));
  const closing = closingSection(live, ask);
  const handPanel = html("div", { class: "handpanel" }), planned = html("p", { class: "lead", role: "status" });
  const tabs = tabsOf(live, [
    ["contacts", "1. Contacts", html("main", {},
      html("div", { class: "left" }, stage.element, keysOf(live)),
      html("div", { class: "right" }, card.element, proposals.element, fingers.element, keeper.element))],
    ["hand", "2. Hand", html("div", {}, planned, handPanel)],
  ], (key) => { if (key === "hand") showHand(); else show(); });
  const quit = html("button", { type: "button", on: { click: end } }, "End the server");
  const over = html("span", { class: "note", role: "status" });
  element.replaceChildren(html("header", {}, html("h1", {}, foreign(data.name)),
    ...data.notes.map((note) => html("p", { class: "note" }, `Note: ${note}`))),
  tabs.element, html("footer", { class: "row" }, quit, over));
  fingers.show(state.radius);
  moved(state.contacts, false);
  if (data.contacts === null) proposals.propose(() => counts.moves === 1);
  return { ...counts, counts: () => ({ ...counts }), state: () => ({ ...state }),
    placement: () => hand?.placement(), place: (at) => hand?.place(at), query: (at) => hand?.query(at),
    contacts: (contacts) => moved(contacts, false) };

  function current() {
    return { radius: state.radius, contacts: state.contacts };
  }

  /** The grasp whose cage is shown: the contacts, or the one next to them. */
  function graspNow() {
    return state.standing?.grasp?.contacts ?? null;
  }

  /** Other contacts, drawn at once; what they are is asked. */
  function moved(contacts, held) {
    dragging = held;
    Object.assign(state, { contacts, fresh: false, unplanned: null });
    counts.moves += 1;
    show();
    standings.put(current());
  }

  function stood(answer, question) {
    counts.standings += 1;
    const same = JSON.stringify(question.contacts) === JSON.stringify(state.contacts);
    Object.assign(state, { standing: answer, trouble: null });
    // put onto the true curve, once nobody holds them any more
    if (same && !dragging) state.contacts = answer.contacts;
    const grasp = graspNow();
    if (grasp === null) {
      state.levels = null;
      levels.forget();
      documents.forget();
    } else levels.put({ radius: question.radius, contacts: grasp });
    show();
  }

  function leveled(answer, question) {
    counts.levels += 1;
    if (graspNow() === null) return;
    state.levels = answer;
    show();
    if (!isNow(question)) return;
    clearTimeout(resting);
    resting = setTimeout(() => { if (!dragging && isNow(question)) documents.put(question); }, REST);
  }

  function documented(answer, question) {
    counts.documents += 1;
    Object.assign(state, { document: answer, fresh: isNow(question) });
    show();
    if (tabs.current() === "hand") showHand();
  }

  function isNow(question) {
    return question.radius === state.radius && JSON.stringify(question.contacts) === JSON.stringify(graspNow());
  }

  /** The contacts are what they are, but their cage could not be planned or is too large to show. */
  function unplanned(error, question) {
    if (isNow(question)) state.unplanned = error.message;
    show();
  }

  /** Everything on the first tab. */
  function show() {
    [state.verdict] = standingWord(state);
    stage.show(state);
    card.show(state);
    proposals.chosen(state.contacts);
    keeper.can(!state.trouble);
    tellHand();
  }

  function tellHand() {
    const there = state.document !== null && state.fresh;
    handPanel.hidden = !there;
    planned.hidden = there;
    planned.textContent = state.trouble ?? state.unplanned ?? (state.standing && graspNow() === null
      ? "These contacts are no grasp and none is near: choose others." : "The cage of the contacts is being planned …");
  }

  /** The page of a cage, made anew when there is another one. */
  function showHand() {
    tellHand();
    if (state.document === null || !state.fresh || shown === state.document) return;
    shown = state.document;
    const question = { radius: state.radius, contacts: graspNow() };
    const query = queryOf(shown), ask = (at) => closing.pressing(query(at));
    hand = mount(handPanel, shown, { ask, placed: () => closing.moved(), beside: [closing.element] });
    handPanel.querySelector("h1").remove(); // the live page has it already
    closing.attach(hand, () => question);
  }

  async function end() {
    try {
      await ask("/api/quit", {});
      over.textContent = "The server has ended; this page can be closed.";
    } catch (error) {
      over.textContent = error.message;
    }
  }
}

/** Contacts of an object that has none yet: as far from each other along the boundary as can be. */
function spreadOver({ track, fingers }) {
  const { at, length } = trackOf(track);
  return Array.from({ length: fingers }, (_, k) => at((k * length) / fingers));
}

function tracked(ring) {
  return { ring, ...trackOf(ring) };
}

function keysOf({ id }) {
  const keys = CONTACT_KEYS.map(([key, does]) => html("div", {}, html("dt", {}, key), html("dd", {}, does)));
  return html("div", { class: "hints", id: `${id}-contactkeys` },
    html("p", { class: "note" }, "Drag each contact along the boundary; corners catch it. The hand is the polygon "
      + "of the contacts. Keys, with a contact in focus:"),
    html("dl", { class: "keys" }, ...keys));
}

/** Panels, one of which is seen: { element, current() }. */
function tabsOf({ id }, panels, chosen) {
  let current = panels[0][0];
  const buttons = panels.map(([key, words]) => html("button", { type: "button", role: "tab", id: `${id}-tab-${key}`,
    "data-key": key, "aria-controls": `${id}-${key}`, on: { click: () => choose(key), keydown: pressed } }, words));
  const bodies = panels.map(([key, , content]) => html("div", { role: "tabpanel", id: `${id}-${key}`,
    "aria-labelledby": `${id}-tab-${key}` }, content));
  mark();
  return { element: html("div", {}, html("div", { role: "tablist", class: "tabs", "aria-label": "Steps" }, ...buttons), ...bodies),
    current: () => current };

  function pressed(event) {
    const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (by === undefined) return;
    const next = buttons[(buttons.indexOf(event.target) + by + buttons.length) % buttons.length];
    choose(next.dataset.key);
    next.focus();
    event.preventDefault();
  }

  function choose(key) {
    current = key;
    mark();
    chosen(key);
  }

  function mark() {
    buttons.forEach((button, k) => {
      const on = button.dataset.key === current;
      setAll(button, { "aria-selected": String(on), tabindex: on ? 0 : -1 });
      bodies[k].hidden = !on;
    });
  }
}
