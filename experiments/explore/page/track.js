// The closed way on which finger centres can be: places on it by their arclength.

const SHARP = Math.sin(0.17); // [1] a turn to the right by more than 10 degrees is a corner

/** { length, at(s), nearest(point), snapped(point, within), corners } of a counterclockwise ring. */
export function trackOf(ring) {
  const starts = [0];
  ring.forEach(([x, y], k) => {
    const [bx, by] = ring[(k + 1) % ring.length];
    starts.push(starts[k] + Math.hypot(bx - x, by - y));
  });
  const length = starts.at(-1);
  const corners = ring.flatMap((point, k) => (isCorner(ring, k) ? [{ s: starts[k], point }] : []));
  return { length, at, nearest, snapped, corners };

  /** The point at an arclength, which may run on round the ring. */
  function at(s) {
    const along = ((s % length) + length) % length;
    let low = 0, high = ring.length;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (starts[middle] <= along) low = middle;
      else high = middle;
    }
    const [ax, ay] = ring[low], [bx, by] = ring[(low + 1) % ring.length];
    const long = starts[low + 1] - starts[low], t = long > 0 ? (along - starts[low]) / long : 0;
    return [ax + t * (bx - ax), ay + t * (by - ay)];
  }

  /** { s, point, far }: the place on the ring that is nearest to a point. */
  function nearest([x, y]) {
    let best = { far: Infinity };
    for (let k = 0; k < ring.length; k++) {
      const [ax, ay] = ring[k], [bx, by] = ring[(k + 1) % ring.length];
      const sx = bx - ax, sy = by - ay, square = sx * sx + sy * sy;
      const t = square > 0 ? Math.min(1, Math.max(0, ((x - ax) * sx + (y - ay) * sy) / square)) : 0;
      const px = ax + t * sx, py = ay + t * sy, far = Math.hypot(x - px, y - py);
      if (far < best.far) best = { far, s: starts[k] + t * Math.sqrt(square), point: [px, py] };
    }
    return best;
  }

  /** The nearest place; a corner of the way, where a finger has two edges, takes what is near it. */
  function snapped(point, within) {
    const place = nearest(point);
    let best = null;
    for (const corner of corners) {
      const far = Math.hypot(corner.point[0] - place.point[0], corner.point[1] - place.point[1]);
      if (far <= within && (best === null || far < best.far)) best = { ...corner, far };
    }
    return best ?? place;
  }
}

function isCorner(ring, k) {
  const [ax, ay] = ring[(k + ring.length - 1) % ring.length], [x, y] = ring[k];
  const [bx, by] = ring[(k + 1) % ring.length];
  const ux = x - ax, uy = y - ay, vx = bx - x, vy = by - y;
  return ux * vy - uy * vx < -SHARP * Math.hypot(ux, uy) * Math.hypot(vx, vy);
}
