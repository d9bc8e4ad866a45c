// The object with its contacts: each is dragged along the boundary by mouse, touch or keys. The
// hand is the polygon of the contacts, however many there are.

import { outlinePath, regionPaths, scaleBar } from "./stage.js";
import { html, setAll, svg } from "./svg.js";
import { middleOf } from "./hand.js";
import { boxOf, pairs, viewOf, widened } from "./view.js";

const SNAP = 7; // [px] a corner takes a finger that is dragged this near to it
const LEAST_CONTACT = 6; // [px] least radius of a finger
const STEP = 0.002; // [track] of an arrow key; Shift: a tenth; Page Up and Down: ten times

/** Keys, for whoever explains them. */
export const CONTACT_KEYS = [
  ["Tab", "the next contact"],
  ["Arrow keys", "move it along the boundary"],
  ["Shift", "with arrows: a tenth as far"],
  ["Page Up, Page Down", "ten times as far"],
  ["Home, End", "to the corner before, the next one"],
];

/**
 * { element, show(state), focus() } of a live page { data, id, length }. `moved(contacts, held)` is
 * told of other contacts; `held` while one is being dragged. A state has contacts, track, radius,
 * standing, levels, document and `fresh`, whether the document is of these contacts.
 */
export function contactStage(live, moved) {
  const { data } = live;
  const regions = svg("g"), object = svg("g"), way = svg("path", { class: "track" });
  const ghost = svg("g"), fill = svg("polygon", { class: "grip" }), fingers = svg("g");
  const drawing = svg("svg", { class: "drawing contacts", role: "group",
    "aria-label": "The object and its contacts", "aria-describedby": `${live.id}-contactkeys` },
  regions, object, way, ghost, fill, fingers);
  const element = html("div", { class: "stage" }, drawing);
  let view = null, state = null, drawn = null, grabbed = null;
  new ResizeObserver(laidOut).observe(element);
  for (const [name, heard] of [["pointerdown", taken], ["pointermove", dragged], ["pointerup", released],
    ["pointercancel", released], ["lostpointercapture", released], ["keydown", pressed]]) drawing.addEventListener(name, heard);
  return { element, show, focus: (k) => fingers.children[k]?.focus({ preventScroll: true }) };

  function laidOut() {
    if (!state || element.clientWidth === 0) return; // hidden behind another tab
    const wide = Math.max(240, Math.floor(element.clientWidth));
    const outline = boxOf([...data.outline.vertices, ...state.track.ring]);
    const box = widened(outline, 0.15 * data.diameter + state.radius);
    if (view && view.wide === wide && view.box.join() === box.join()) return;
    const shape = (box[3] - box[1]) / (box[2] - box[0]);
    const tall = Math.round(Math.min(Math.max(wide * shape, 0.6 * wide, 280), 620, 1.1 * wide));
    view = { ...viewOf(box, wide, tall), box };
    setAll(drawing, { viewBox: `0 0 ${wide} ${tall}`, height: tall });
    object.replaceChildren(outlinePath({ outline: data.outline }, view), ...scaleBar(view, data.unit));
    setAll(way, { d: state.radius > 0 ? `M${pairs(view, state.track.ring)}Z` : null });
    drawn = null;
    show(state);
  }

  function show(now) {
    state = now;
    const before = view;
    laidOut();
    if (!view || view !== before) return; // laying out has shown it
    if (drawn !== state.document) {
      drawn = state.document;
      regions.replaceChildren(...(drawn ? regionPaths({ plan: drawn.plan, document: drawn }, view) : []));
    }
    regions.classList.toggle("old", !state.fresh);
    const { contacts } = state, standing = state.standing ?? {};
    drawing.dataset.verdict = state.verdict;
    setAll(fill, { points: pairs(view, contacts) });
    const grasp = standing.holds ? null : standing.grasp;
    ghost.replaceChildren(...(grasp ? ghostHand(grasp.contacts) : []));
    drawContacts(contacts);
  }

  function ghostHand(contacts) {
    const r = Math.max(LEAST_CONTACT - 1, state.radius * view.zoom);
    return [svg("polygon", { points: pairs(view, contacts), class: "ghost near" }),
      ...contacts.map(view.to).map(([cx, cy], k) => svg("circle", { cx, cy, r, class: `ghost f${k + 1}` }))];
  }

  function drawContacts(contacts) {
    while (fingers.children.length > contacts.length) fingers.lastChild.remove();
    while (fingers.children.length < contacts.length) fingers.append(contactHandle(fingers.children.length));
    const middle = view.to(middleOf(contacts)), r = Math.max(LEAST_CONTACT, state.radius * view.zoom);
    contacts.forEach((contact, k) => {
      const [reach, disc, number] = fingers.children[k].children;
      const [x, y] = view.to(contact), away = Math.hypot(x - middle[0], y - middle[1]) || 1;
      const off = r >= 9 ? 0 : r + 9, { s } = state.track.nearest(contact);
      setAll(reach, { cx: x, cy: y });
      setAll(disc, { cx: x, cy: y, r });
      setAll(number, { x: x + (off * (x - middle[0])) / away, y: y + (off * (y - middle[1])) / away + 4.5,
        class: off === 0 ? "in" : "out" });
      setAll(fingers.children[k], { "aria-valuemax": state.track.length, "aria-valuenow": s,
        "aria-valuetext": `${live.length(s)} ${data.unit} along the boundary` });
    });
  }

  function contactHandle(k) {
    return svg("g", { class: `finger handle f${k + 1}`, tabindex: 0, role: "slider", "aria-valuemin": 0,
      "aria-label": `Contact ${k + 1}`, "data-contact": k }, svg("circle", { class: "reach", r: 24 }),
    svg("circle", { class: "disc" }), svg("text", {}, String(k + 1)));
  }

  function place(k, point, held) {
    moved(state.contacts.map((contact, j) => (j === k ? point : contact)), held);
  }

  function pointOf(event) {
    const box = drawing.getBoundingClientRect();
    return view.from([((event.clientX - box.left) * view.wide) / box.width,
      ((event.clientY - box.top) * view.tall) / box.height]);
  }

  function taken(event) {
    const handle = event.target.closest?.("[data-contact]");
    if (!handle || event.button !== 0 || grabbed !== null) return;
    const k = Number(handle.dataset.contact), at = pointOf(event);
    // the finger keeps its distance from the pointer, so that a touch alone moves nothing
    grabbed = { k, pointer: event.pointerId, off: [state.contacts[k][0] - at[0], state.contacts[k][1] - at[1]] };
    drawing.setPointerCapture(event.pointerId);
    handle.focus({ preventScroll: true });
    drawing.classList.toggle("taken", true);
    event.preventDefault();
  }

  function dragged(event) {
    if (grabbed === null || event.pointerId !== grabbed.pointer) return;
    const [x, y] = pointOf(event), to = [x + grabbed.off[0], y + grabbed.off[1]];
    place(grabbed.k, state.track.snapped(to, SNAP / view.zoom).point, true);
  }

  function released(event) {
    if (grabbed === null || event.pointerId !== grabbed.pointer) return;
    grabbed = null;
    drawing.classList.toggle("taken", false);
    moved(state.contacts, false);
  }

  function pressed(event) {
    const handle = event.target.closest?.("[data-contact]");
    if (!handle || event.ctrlKey || event.altKey || event.metaKey) return;
    const k = Number(handle.dataset.contact), { s } = state.track.nearest(state.contacts[k]);
    const steps = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 };
    if (event.key in steps) {
      const by = steps[event.key] * STEP * (event.shiftKey ? 0.1 : 1) * state.track.length;
      place(k, state.track.at(s + by), false);
    } else if (event.key === "Home" || event.key === "End") {
      const corner = cornerFrom(s, event.key === "End");
      if (corner) place(k, corner.point, false);
    } else return;
    event.preventDefault();
  }

  function cornerFrom(s, forwards) {
    const { corners, length } = state.track, least = 1e-6 * length;
    const way = (corner) => (((forwards ? corner.s - s : s - corner.s) % length) + length) % length;
    return corners.filter((corner) => way(corner) > least && way(corner) < length - least)
      .sort((a, b) => way(a) - way(b))[0];
  }
}
