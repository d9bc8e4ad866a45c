// The query: exactly what `icage query` answers, from tables that the planner has left.
// The rules are those of icage/cells/membership.py, in its order.

/** The typed array that the page carries as { type, data }. */
function decoded({ type, data }) {
  const types = { Float64Array, Uint16Array, Uint32Array };
  const bytes = Uint8Array.from(atob(data), (character) => character.charCodeAt(0));
  return new types[type](bytes.buffer);
}

/**
 * A function from a placement { x, y, theta, sigma } to its answer, with the keys of
 * `icage-query/1` and with `inside`, the fingers (1, 2, ...) that stand in the object.
 */
export function queryOf({ plan, query }) {
  const hand = plan.hand.unit_fingers;
  const ring = plan.outline.vertices.map(([x, y]) => [x - query.frame_at[0], y - query.frame_at[1]]);
  const pieceAt = pointLocation(query);
  const cage = cageTables(query);
  const outside = outsideTable(query);
  const escape = plan.sigma_max ?? Infinity;
  const first = query.first ?? escape;
  const same = 1.0 + query.same_level;

  return ({ x, y, theta, sigma }) => {
    const fingers = fingersOf(hand, x - query.frame_at[0], y - query.frame_at[1], theta, sigma);
    const cell = fingers.map((finger) => pieceAt(finger, query.held));
    const inside = [];
    fingers.forEach((finger, k) => {
      // a point finger in a piece is clear; the pieces round an inner polygon say nothing of a disc
      if (plan.finger_radius === 0 && cell[k] >= 0) return;
      if (plan.finger_radius + depthIn(ring, finger) > query.collision) inside.push(k + 1);
    });
    const answer = {
      verdict: "escapes", sigma, margin: 0, target_margin: null, grasps: [], in_cage: false, inside,
    };
    if (inside.length > 0) return { ...answer, verdict: "collision" };
    if (cell.includes(-1)) {
      // a finger lies a hair inside the object
      fingers.forEach((finger, k) => { cell[k] = pieceAt(finger, query.held_lost); });
    }
    if (cell.includes(-1)) return answer;
    const node = cage.nodeOf(cell);
    if (node !== undefined) {
      if (sigma >= escape) return answer;
      answer.in_cage = true;
      answer.margin = escape === Infinity ? null : escape - sigma;
      answer.verdict = sigma < first ? "target" : "caged";
      if (!joined(cage.level[node], sigma)) answer.verdict = "other";
      if (answer.verdict === "target" && first !== Infinity) answer.target_margin = first - sigma;
      answer.grasps = graspsAt(answer.verdict, node, sigma * same);
      return answer;
    }
    const level = outside(cell);
    if (level !== undefined && sigma < query.cap && level > sigma * same) {
      answer.verdict = "other";
      answer.margin = level === Infinity ? null : level - sigma;
    }
    return answer;
  };

  /** Whether a cell that joins the target's at a level does so at sigma. */
  function joined(level, sigma) {
    const reached = level <= sigma * same;
    if (query.polygon_first === null) return reached;
    // chords may have minima of their own below sigma_first, and join others a hair too early
    const beyond = level >= query.polygon_first * (1.0 - query.same_level);
    return !beyond || (reached && sigma >= first);
  }

  function graspsAt(verdict, node, level) {
    // on the true curve there is no other, whatever minima chords have
    if (query.polygon_first !== null && verdict === "target") return [0];
    const here = cage.componentAt(node, level);
    return plan.grasps.map((grasp) => grasp.id).filter((id, k) =>
      query.grasp_sigmas[k] <= level && cage.componentAt(query.grasp_nodes[k], level) === here);
  }
}

/** Positions of the fingers of a placement: finger k at d + w z_k, w = sigma e^(i theta). */
export function fingersOf(unitFingers, x, y, theta, sigma) {
  const wx = sigma * Math.cos(theta), wy = sigma * Math.sin(theta);
  return unitFingers.map(([zx, zy]) => [x + (wx * zx - wy * zy), y + (wx * zy + wy * zx)]);
}

/** The piece that holds a point best, or -1 if none does to within a tolerance. */
function pointLocation(query) {
  const start = decoded(query.piece_start);
  const corners = decoded(query.corners), normals = decoded(query.normals);
  return ([px, py], tolerance) => {
    const x = px - query.pieces_at[0], y = py - query.pieces_at[1];
    let best = -tolerance, found = -1;
    for (let piece = 0; piece + 1 < start.length; piece++) {
      let slack = Infinity;
      for (let slot = 2 * start[piece]; slot < 2 * start[piece + 1] && slack >= best; slot += 2) {
        const gap = normals[slot] * (x - corners[slot]) + normals[slot + 1] * (y - corners[slot + 1]);
        if (gap < slack) slack = gap;
      }
      if (slack >= best) {
        best = slack;
        found = piece;
      }
    }
    return found;
  };
}

/** The cells of the cage: which is which, when each joins the target, what joins what. */
function cageTables(query) {
  const level = decoded(query.level), parent = decoded(query.parent), stamp = decoded(query.stamp);
  const numbers = numbered(query, query.cells);
  return {
    level,
    nodeOf: (cell) => numbers.get(cell.join()),
    componentAt(node, sigma) {
      while (parent[node] !== node && stamp[node] <= sigma) node = parent[node];
      return node;
    },
  };
}

/** A function from a cell outside the cage to its escape level; undefined: it holds nothing. */
function outsideTable(query) {
  const levels = decoded(query.outside_level);
  const numbers = numbered(query, query.outside);
  return (cell) => {
    const row = numbers.get(cell.join());
    return row === undefined ? undefined : levels[row];
  };
}

/** Rows of cells by their pieces, written one after the other. */
function numbered(query, table) {
  const cells = decoded(table), rows = new Map();
  for (let at = 0, row = 0; at < cells.length; at += query.fingers, row++) {
    rows.set(cells.subarray(at, at + query.fingers).join(), row);
  }
  return rows;
}

/** How far a point is inside a polygon; negative outside. */
function depthIn(ring, [x, y]) {
  let nearest = Infinity, odd = false;
  for (let a = 0; a < ring.length; a++) {
    const [ax, ay] = ring[a], [bx, by] = ring[a + 1 < ring.length ? a + 1 : 0];
    const sx = bx - ax, sy = by - ay;
    const along = ((x - ax) * sx + (y - ay) * sy) / (sx * sx + sy * sy);
    const t = Math.min(1, Math.max(0, along));
    const gx = x - ax - t * sx, gy = y - ay - t * sy;
    nearest = Math.min(nearest, gx * gx + gy * gy);
    if ((ay > y) !== (by > y) && x < ax + (y - ay) / sy * sx) odd = !odd;
  }
  return odd ? Math.sqrt(nearest) : -Math.sqrt(nearest);
}
