// A window onto the object's frame, in pixels of the drawing, y downwards.

/** The smallest box [x0, y0, x1, y1] round some points. */
export function boxOf(points) {
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  for (const [x, y] of points) {
    box[0] = Math.min(box[0], x);
    box[1] = Math.min(box[1], y);
    box[2] = Math.max(box[2], x);
    box[3] = Math.max(box[3], y);
  }
  return box;
}

/** A box with room all round it. */
export function widened([x0, y0, x1, y1], by) {
  return [x0 - by, y0 - by, x1 + by, y1 + by];
}

/** How a box is shown in a drawing of so many pixels. */
export function viewOf([x0, y0, x1, y1], wide, tall) {
  const zoom = Math.min(wide / (x1 - x0), tall / (y1 - y0));
  const mx = x0 + 0.5 * (x1 - x0), my = y0 + 0.5 * (y1 - y0);
  return {
    zoom, wide, tall,
    to: ([x, y]) => [0.5 * wide + zoom * (x - mx), 0.5 * tall - zoom * (y - my)],
    from: ([px, py]) => [mx + (px - 0.5 * wide) / zoom, my - (py - 0.5 * tall) / zoom],
  };
}

/** Two boxes to choose from: all of the object, and what is round the grasp. */
export function boxesOf(page) {
  const { plan } = page, regions = page.document.drawn_regions;
  const hands = [plan.contacts, ...plan.grasps.map((grasp) => grasp.contacts),
    ...plan.punctures.map((puncture) => puncture.contacts)].flat();
  const r = plan.finger_radius;
  const near = widened(boxOf([...hands, ...regions.flatMap((region) => region.rings.flat())]), r);
  const span = Math.max(near[2] - near[0], near[3] - near[1]);
  const outline = boxOf(plan.outline.vertices);
  const all = boxOf([[near[0], near[1]], [near[2], near[3]], [outline[0], outline[1]],
    [outline[2], outline[3]]]);
  return { near: widened(near, 0.18 * span), all: widened(all, 0.18 * span) };
}

/** A path of closed rings. */
export function ringsPath(view, rings) {
  return rings.map((ring) => `M${pairs(view, ring)}Z`).join("");
}

/** Points as SVG takes them. */
export function pairs(view, points) {
  return points.map((point) => view.to(point).map((v) => v.toFixed(2)).join()).join(" ");
}

/** The largest of 1, 2, 5 times a power of ten that is not above a length. */
export function roundLength(longest) {
  const power = 10 ** Math.floor(Math.log10(longest));
  return power * ([5, 2].find((step) => step * power <= longest) ?? 1);
}
