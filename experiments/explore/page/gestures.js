// How the hand is taken: one pointer moves it or turns it by its knob, two move, turn and open it;
// the wheel over it turns it; keys do all of that.

import { fingersAt, middleOf, moved, reshaped } from "./hand.js";
import { radians } from "./words.js";

const WHEEL = 0.0015; // [rad] a step of the wheel

/** Keys, for whoever explains them. */
export const KEYS = [
  ["Arrow keys", "move the hand"],
  ["[ and ]", "turn it"],
  ["+ and −", "open and close it"],
  ["Shift", "with arrows and brackets: a tenth as far"],
  ["Home", "back to the target"],
];

/**
 * Listens to a drawing; `asked.wanted(at)` is told of every placement that somebody asks for.
 * `asked.view()` and `asked.at()` are what is shown now.
 */
export function listenToHand(asked) {
  const { drawing, hand, unit, wanted, view } = asked;
  const pointers = new Map();
  let grab = null; // what was taken, where, and how the hand stood then

  const pixelOf = (event) => {
    const box = drawing.getBoundingClientRect();
    return [((event.clientX - box.left) * view().wide) / box.width,
      ((event.clientY - box.top) * view().tall) / box.height];
  };
  drawing.addEventListener("pointerdown", taken);
  drawing.addEventListener("pointermove", dragged);
  for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) {
    drawing.addEventListener(name, released);
  }
  drawing.addEventListener("wheel", wheeled, { passive: false });
  drawing.addEventListener("keydown", pressed);

  function taken(event) {
    const onHand = hand.element.contains(event.target);
    if ((!onHand && pointers.size === 0) || event.button !== 0 || pointers.size === 2) return;
    drawing.setPointerCapture(event.pointerId);
    drawing.focus({ preventScroll: true });
    pointers.set(event.pointerId, pixelOf(event));
    begin(pointers.size === 1 && hand.knob.contains(event.target) ? "turn" : "move");
    event.preventDefault();
  }

  /** From here on movements are counted, with the hand as it stands now. */
  function begin(kind) {
    const places = [...pointers.values()];
    grab = { kind: places.length === 2 ? "pinch" : kind, places, at: asked.at(), middle: hand.middle() };
    hand.holdKnob(grab.kind === "turn");
    drawing.classList.toggle("taken", true);
  }

  function dragged(event) {
    if (!pointers.has(event.pointerId)) return;
    pointers.set(event.pointerId, pixelOf(event));
    const now = [...pointers.values()];
    if (grab.kind === "turn") turn(now[0]);
    else if (grab.kind === "pinch") pinch(now);
    else shift(now[0], grab.places[0], grab.at);
  }

  function shift([x, y], [x0, y0], at) {
    wanted(keptInView(moved(at, (x - x0) / view().zoom, (y0 - y) / view().zoom)));
  }

  function turn(place) {
    const angle = angleAt(place, grab.middle) - angleAt(grab.places[0], grab.middle);
    wanted(reshaped(unit, grab.at, grab.at.theta + angle, grab.at.sigma));
  }

  function pinch([a, b]) {
    const [a0, b0] = grab.places;
    const angle = angleAt(b, a) - angleAt(b0, a0);
    const factor = Math.hypot(b[0] - a[0], b[1] - a[1]) / Math.hypot(b0[0] - a0[0], b0[1] - a0[1]);
    const at = reshaped(unit, grab.at, grab.at.theta + angle, grab.at.sigma * factor);
    shift(middleOf([a, b]), middleOf([a0, b0]), at);
  }

  function released(event) {
    if (!pointers.delete(event.pointerId)) return;
    if (pointers.size > 0) begin("move");
    else {
      grab = null;
      hand.holdKnob(false);
      drawing.classList.toggle("taken", false);
    }
  }

  function wheeled(event) {
    if (!hand.element.contains(event.target)) return; // elsewhere the page scrolls
    event.preventDefault();
    const at = asked.at(), lines = event.deltaMode === 0 ? 1 : 30;
    wanted(reshaped(unit, at, at.theta - WHEEL * lines * event.deltaY, at.sigma));
  }

  function pressed(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const at = asked.at(), fine = event.shiftKey ? 0.1 : 1;
    const step = 0.01 * fine * asked.diameter, angle = radians(2) * fine, size = 0.005 * asked.sigma0;
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const turns = { "[": 1, "{": 1, "]": -1, "}": -1 };
    const openings = { "+": 1, "=": 1, "-": -1, "_": -1 };
    if (event.key in arrows) {
      const [dx, dy] = arrows[event.key];
      wanted(keptInView(moved(at, dx * step, dy * step)));
    } else if (event.key in turns) {
      wanted(reshaped(unit, at, at.theta + turns[event.key] * angle, at.sigma));
    } else if (event.key in openings) {
      wanted(reshaped(unit, at, at.theta, Math.max(0, at.sigma + openings[event.key] * size)));
    } else if (event.key === "Home") wanted(null);
    else return;
    event.preventDefault();
  }

  /** The same placement with its middle inside the drawing, so that the hand can be taken again. */
  function keptInView(at) {
    const [x, y] = view().to(middleOf(fingersAt(unit, at)));
    const dx = Math.min(view().wide - 20, Math.max(20, x)) - x;
    const dy = Math.min(view().tall - 20, Math.max(20, y)) - y;
    return dx === 0 && dy === 0 ? at : moved(at, dx / view().zoom, -dy / view().zoom);
  }
}

function angleAt([x, y], [mx, my]) {
  return Math.atan2(my - y, x - mx);
}
