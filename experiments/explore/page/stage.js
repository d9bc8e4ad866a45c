// The drawing: regions, object, other hands as ghosts, and the hand that is moved by mouse, touch
// or keys. It draws what it is told, and tells the page where somebody wants the hand to be.

import { listenToHand } from "./gestures.js";
import { fingersAt, middleOf } from "./hand.js";
import { sliceOf } from "./slice.js";
import { html, setAll, svg } from "./svg.js";
import { boxesOf, pairs, ringsPath, roundLength, viewOf } from "./view.js";

const KNOB = 30; // [px] from the outermost finger to the knob that turns the hand
const LEAST = 4.5; // [px] least radius of a finger
const NUMBER_FITS = 8; // [px] a finger from this radius on carries its number inside
const GRIP = 30; // [px] the hand can be taken this near to its middle, however small it is

/** { element, show(at, answer, ghosts), showRoute(rows), focus() }; `wanted(at)` asks for a place, `ask(at)` answers. */
export function stageOf(page, ask, wanted) {
  const { plan } = page, boxes = boxesOf(page), unit = plan.hand.unit_fingers;
  const regions = svg("g"), object = svg("g"), route = svg("g"), others = svg("g");
  const hand = handDrawing(unit.length);
  const choice = viewChoice(boxes, () => laidOut()), slice = sliceOf(page, ask, (on) => drawing.classList.toggle("slicing", on));
  const drawing = svg("svg", {
    class: "drawing", tabindex: 0, role: "application", "aria-label": "Hand round the object",
    "aria-roledescription": "hand that can be moved", "aria-describedby": `${page.id}-keys`,
  }, regions, object, slice.element, route, others, hand.element);
  const element = html("div", { class: "stage" },
    html("div", { class: "tools" }, choice.element, slice.toggle, slice.note), drawing);
  let view = null, state = null, rows = null;
  new ResizeObserver(laidOut).observe(element);
  listenToHand({
    drawing, hand, unit, wanted, view: () => view, at: () => state[0],
    diameter: plan.diameter, sigma0: plan.sigma_0,
  });
  return { element, show, showRoute, focus: () => drawing.focus({ preventScroll: true }) };

  function laidOut() {
    const wide = Math.max(240, Math.floor(element.clientWidth)), box = choice.box();
    if (view && view.box === box && view.wide === wide) return;
    const shape = (box[3] - box[1]) / (box[2] - box[0]);
    const tall = Math.round(Math.min(Math.max(wide * shape, 0.6 * wide, 280), 620, 1.1 * wide));
    view = { ...viewOf(box, wide, tall), box };
    setAll(drawing, { viewBox: `0 0 ${wide} ${tall}`, height: tall });
    regions.replaceChildren(...regionPaths(page, view));
    object.replaceChildren(outlinePath(plan, view), ...scaleBar(view, plan.unit));
    drawRoute();
    if (state) show(...state);
  }

  function showRoute(found) {
    rows = found;
    if (view) drawRoute();
  }

  function drawRoute() {
    const ways = (rows ?? []).map(([x, y, theta, sigma]) => fingersAt(unit, { x, y, theta, sigma }));
    route.replaceChildren(...(rows ? unit : []).map((_, k) => svg("polyline", {
      points: pairs(view, ways.map((fingers) => fingers[k])), class: `way f${k + 1}` })));
  }

  function show(at, answer, ghosts) {
    state = [at, answer, ghosts];
    if (!view) return;
    slice.show(at, view);
    const r = plan.finger_radius * view.zoom;
    hand.show(fingersAt(unit, at).map(view.to), r, at.theta, answer, view);
    others.replaceChildren(...ghosts.flatMap(({ contacts, kind }) => (
      ghostOf(contacts.map(view.to), Math.max(LEAST - 0.5, r), kind))));
  }
}

/** Buttons for all of the object or what is round the grasp, where the two differ. */
function viewChoice(boxes, chosen) {
  const ratio = (boxes.all[2] - boxes.all[0]) / (boxes.near[2] - boxes.near[0]);
  let current = ratio > 1.8 ? "near" : "all";
  if (ratio < 1.15) return { element: "", box: () => boxes.all };
  const buttons = [["all", "Whole object"], ["near", "Round the grasp"]].map(([key, words]) => (
    html("button", { type: "button", "data-key": key, on: { click: () => choose(key) } }, words)));
  const press = () => buttons.forEach((button) => (
    setAll(button, { "aria-pressed": String(button.dataset.key === current) })));
  press();
  const element = html("div", { class: "choice", role: "group", "aria-label": "View" }, ...buttons);
  return { element, box: () => boxes[current] };

  function choose(key) {
    current = key;
    press();
    chosen();
  }
}

/** The object as it is drawn. */
export function outlinePath(plan, view) {
  return svg("path", { d: ringsPath(view, [plan.outline.vertices]), class: "object" });
}

/** The regions, the lower level on top. */
export function regionPaths({ plan, document: data }, view) {
  // where sigma_first and sigma_max are one, the region is that of the guarantee
  const whole = plan.sigma_max !== null && plan.sigma_first === plan.sigma_max ? "sure" : "whole";
  const sorted = ["sigma_max", "all", "sigma_first"].flatMap((level) => (
    data.drawn_regions.filter((region) => region.level === level)));
  return sorted.map(({ finger, level, rings }) => svg("path", {
    d: ringsPath(view, rings), class: `region f${finger} ${level === "sigma_first" ? "sure" : whole}`,
  }));
}

/** A round length and its name, in the lower right corner. */
export function scaleBar(view, unit) {
  const long = roundLength((0.22 * view.wide) / view.zoom), px = long * view.zoom;
  const x = view.wide - 14 - px, y = view.tall - 14;
  return [
    svg("path", { d: `M${x} ${y - 4}v4h${px}v-4`, class: "ruler" }),
    svg("text", { x: x + px / 2, y: y - 7, class: "ruler" }, `${Number(long.toPrecision(6))} ${unit}`),
  ];
}

function ghostOf(places, r, kind) {
  return [
    svg("polygon", { points: inPixels(places), class: `ghost ${kind}` }),
    ...places.map(([cx, cy], k) => svg("circle", { cx, cy, r, class: `ghost f${k + 1} ${kind}` })),
  ];
}

function inPixels(places) {
  return places.map((place) => place.map((v) => v.toFixed(2)).join()).join(" ");
}

/**
 * The hand itself: { element, knob, middle(), holdKnob(held), show(places, r, theta, answer, view) }.
 * While the knob is held it stays on its side of the hand.
 */
function handDrawing(count) {
  const fill = svg("polygon", { class: "grip" }), reach = svg("circle", { class: "reach", r: GRIP });
  const fingers = Array.from({ length: count }, (_, k) => (
    svg("g", { class: `finger f${k + 1}` }, svg("circle"), svg("text"))));
  const stem = svg("line", { class: "stem" }), cross = svg("path", { class: "cross", d: "M-6 0H6M0 -6V6" });
  const knob = svg("g", { class: "knob" }, svg("circle", { r: 22, class: "reach" }),
    svg("circle", { r: 10 }), svg("path", { d: "M-4.2 1.8A4.6 4.6 0 1 1 .8 4.5M3.6 1.9L.6 4.6L3.4 7" }));
  const element = svg("g", { class: "hand" }, stem, reach, fill, cross, ...fingers, knob);
  let side = -0.5, held = false, middle = [0, 0];
  return { element, knob, middle: () => middle, holdKnob: (now) => { held = now; }, show };

  function show(places, trueRadius, theta, answer, view) {
    const r = Math.max(LEAST, trueRadius);
    middle = middleOf(places);
    element.dataset.verdict = answer.verdict;
    setAll(fill, { points: inPixels(places) });
    setAll(reach, { cx: middle[0], cy: middle[1] });
    setAll(cross, { transform: `translate(${middle[0].toFixed(2)} ${middle[1].toFixed(2)})` });
    places.forEach((place, k) => {
      fingers[k].classList.toggle("inside", answer.inside.includes(k + 1));
      drawFinger(k, place, r);
    });
    drawKnob(places, r, theta, view);
  }

  function drawFinger(k, [x, y], r) {
    const [disc, number] = fingers[k].children;
    const away = Math.hypot(x - middle[0], y - middle[1]) || 1, off = r >= NUMBER_FITS ? 0 : r + 9;
    setAll(disc, { cx: x, cy: y, r });
    setAll(number, {
      x: x + (off * (x - middle[0])) / away, y: y + (off * (y - middle[1])) / away + 4.5,
      class: off === 0 ? "in" : "out",
    });
    number.textContent = k + 1;
  }

  function drawKnob(places, r, theta, view) {
    const spotAt = (quarter) => {
      const ahead = theta + quarter * Math.PI, ux = Math.cos(ahead), uy = -Math.sin(ahead);
      const far = Math.max(...places.map(([x, y]) => (x - middle[0]) * ux + (y - middle[1]) * uy));
      const reach = Math.max(far + r, GRIP - 8) + KNOB;
      return [middle[0] + reach * ux, middle[1] + reach * uy];
    };
    const seen = ([x, y]) => x > 16 && y > 16 && x < view.wide - 16 && y < view.tall - 16;
    if (!held) side = [-0.5, 0.5, 1, 0].find((quarter) => seen(spotAt(quarter))) ?? -0.5;
    const spot = spotAt(side);
    const x = Math.min(view.wide - 16, Math.max(16, spot[0]));
    const y = Math.min(view.tall - 16, Math.max(16, spot[1]));
    setAll(knob, { transform: `translate(${x.toFixed(2)} ${y.toFixed(2)})` });
    setAll(stem, { x1: middle[0], y1: middle[1], x2: x, y2: y });
  }
}
