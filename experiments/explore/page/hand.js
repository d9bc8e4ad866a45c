// Where the hand stands, and how it is moved: a placement is { x, y, theta, sigma }.
// Turning and opening keep the middle of the fingers where it is.

import { fingersOf } from "./query.js";

/** Fingers of a placement in the object's frame. */
export function fingersAt(unitFingers, at) {
  return fingersOf(unitFingers, at.x, at.y, at.theta, at.sigma);
}

/** The middle of some points. */
export function middleOf(points) {
  const sum = points.reduce(([a, b], [x, y]) => [a + x, b + y], [0, 0]);
  return [sum[0] / points.length, sum[1] / points.length];
}

/** The placement whose fingers 1 and 2 are the first two of these. */
export function placementOf(contacts) {
  const [[ax, ay], [bx, by]] = contacts;
  return { x: ax, y: ay, theta: Math.atan2(by - ay, bx - ax), sigma: Math.hypot(bx - ax, by - ay) };
}

export function moved(at, dx, dy) {
  return { ...at, x: at.x + dx, y: at.y + dy };
}

/** The same hand with another angle and size round its middle. */
export function reshaped(unitFingers, at, theta, sigma) {
  const [mx, my] = middleOf(fingersAt(unitFingers, at));
  const [[fx, fy]] = [middleOf(fingersOf(unitFingers, 0, 0, theta, sigma))];
  return { x: mx - fx, y: my - fy, theta: withinHalfTurns(theta), sigma };
}

/** The same angle in (-pi, pi]; one that lies there keeps every digit. */
export function withinHalfTurns(angle) {
  if (angle > -Math.PI && angle <= Math.PI) return angle;
  const turns = Math.ceil((angle - Math.PI) / (2 * Math.PI));
  return angle - 2 * Math.PI * turns;
}

/** A way along rows [x, y, theta, sigma]: between neighbours d and w move in straight lines. */
export function wayAlong(unitFingers, rows) {
  const corners = rows.map(([x, y, theta, sigma]) => (
    { x, y, theta, sigma, wx: sigma * Math.cos(theta), wy: sigma * Math.sin(theta) }));
  const steps = [0];
  for (let k = 1; k < corners.length; k++) {
    const before = fingersAt(unitFingers, corners[k - 1]), after = fingersAt(unitFingers, corners[k]);
    const far = Math.max(...before.map(([x, y], f) => Math.hypot(after[f][0] - x, after[f][1] - y)));
    steps.push(steps[k - 1] + far);
  }
  const length = steps.at(-1);
  return {
    corners,
    length,
    /** Share of the way at which a corner lies. */
    shareOf: (k) => (length > 0 ? steps[k] / length : 0),
    /** The placement at a share 0..1 of the way of the finger that goes furthest. */
    at(share) {
      const want = share * length;
      let k = 1;
      while (k < steps.length - 1 && steps[k] < want) k++;
      if (corners.length === 1) return corners[0];
      const a = corners[k - 1], b = corners[k];
      const step = steps[k] - steps[k - 1];
      const t = step > 0 ? Math.min(1, Math.max(0, (want - steps[k - 1]) / step)) : 1;
      if (t === 0) return a;
      if (t === 1) return b;
      const wx = a.wx + t * (b.wx - a.wx), wy = a.wy + t * (b.wy - a.wy);
      return {
        x: a.x + t * (b.x - a.x), y: a.y + t * (b.y - a.y),
        theta: Math.atan2(wy, wx), sigma: Math.hypot(wx, wy),
      };
    },
  };
}
