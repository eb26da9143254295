// Eigenvalues followed along the load, for the root locus and the frequency-load curves.
//
// A branch goes on where the trapezoid rule with its slopes says; an interval is halved where that is not clear.

const DEEPEST = 6; // halvings of a step before a match is taken as it stands

/** The undamped branches s = ω² along the load, with slopes. */
function undampedNode(pencil) {
  return (P) => nodeOf(undampedMatrix(pencil, P), new Matrix(pencil.H), P);
}

/** The branches of λ along the load, with slopes. */
function dampedNode(pencil, damping) {
  const change = stateMatrix(pencil, damping, 1).sub(stateMatrix(pencil, damping, 0));
  return (P) => nodeOf(stateMatrix(pencil, damping, P), change, P);
}

/** Eigenvalues of A with their slopes, where A changes by `change` per unit of load: left vector · change · right. */
function nodeOf(A, change, load) {
  const found = new EigenvalueDecomposition(A, { assumeSymmetric: false });
  const { realEigenvalues: re, imaginaryEigenvalues: im, eigenvectorMatrix: V } = found;
  const lu = new LuDecomposition(V);
  const G = lu.isSingular() ? Matrix.zeros(A.rows, A.rows) : lu.solve(change.mmul(V));
  const slopes = im.map((value, k) => {
    if (value === 0) return [G.get(k, k), 0];
    const other = value > 0 ? k + 1 : k - 1; // the columns of a pair are real and imaginary part
    return [(G.get(k, k) + G.get(other, other)) / 2, (G.get(k, other) - G.get(other, k)) / 2];
  });
  return { load, re, im, dRe: slopes.map((slope) => slope[0]), dIm: slopes.map((slope) => slope[1]) };
}

function reordered(state, order) {
  const take = (values) => order.map((k) => values[k]);
  return { load: state.load, re: take(state.re), im: take(state.im), dRe: take(state.dRe), dIm: take(state.dIm) };
}

/** States from load 0 to `range`, place k the same branch in each, ascending in |s| or |λ| at load 0; close to a
 * crossing there are states on both sides of it. */
function follow(at, range, crossing, count = 48) {
  const first = at(0);
  const size = first.re.map((re, k) => Math.hypot(re, first.im[k]));
  const order = size.map((_, k) => k).sort((j, k) => size[j] - size[k] || first.im[k] - first.im[j]);
  const states = [reordered(first, order)];
  const loads = Array.from({ length: count }, (_, k) => (range * (k + 1)) / count);
  if (crossing && crossing.load < range) loads.push(crossing.load * (1 - 1e-7), crossing.load * (1 + 1e-7));
  for (const load of loads.sort((a, b) => a - b)) advance(states, at, at(load), 0);
  return states;
}

function advance(states, at, b, depth) {
  const a = states[states.length - 1];
  const order = match(a, b, depth >= DEEPEST);
  if (order) {
    states.push(reordered(b, order));
    return;
  }
  advance(states, at, at((a.load + b.load) / 2), depth + 1);
  advance(states, at, b, depth + 1);
}

/** For each branch its place in b; null where that is not clear and need not yet be settled. */
function match(a, b, last) {
  const h = (b.load - a.load) / 2;
  const gap = a.re.map((_, j) =>
    b.re.map((_, k) =>
      Math.hypot(b.re[k] - a.re[j] - h * (a.dRe[j] + b.dRe[k]), b.im[k] - a.im[j] - h * (a.dIm[j] + b.dIm[k])),
    ),
  );
  const order = gap.map((row) => row.indexOf(Math.min(...row)));
  const good = order.map((k, j) => gap[j][k] <= 0.1 * room(a, j) && order.indexOf(k) === j && order.lastIndexOf(k) === j);
  if (good.every(Boolean)) return order;
  if (!last) return null;
  const free = new Set(b.re.map((_, k) => k));
  order.forEach((k, j) => good[j] && free.delete(k));
  // of two that meet and part, the growing one goes on with the smaller number
  for (let j = 0; j < order.length; j++) {
    if (good[j]) continue;
    const distance = (k) => Math.hypot(b.re[k] - a.re[j], b.im[k] - a.im[j]);
    const nearest = [...free].sort((k, m) => distance(k) - distance(m))[0];
    const ties = [...free].filter((k) => distance(k) <= distance(nearest) * (1 + 1e-6));
    order[j] = ties.sort((k, m) => b.im[k] - b.im[m])[0];
    free.delete(order[j]);
  }
  return order;
}

function room(state, j) {
  let least = Infinity;
  for (let k = 0; k < state.re.length; k++) {
    if (k !== j) least = Math.min(least, Math.hypot(state.re[k] - state.re[j], state.im[k] - state.im[j]));
  }
  return least;
}

/** Branch k as a smooth line: cubic between states with their slopes where the branch is smooth. */
function line(states, k, pieces = 3) {
  const found = { load: [], re: [], im: [] };
  const push = (P, re, im) => {
    found.load.push(P);
    found.re.push(re);
    found.im.push(im);
  };
  states.forEach((b, i) => {
    if (i) {
      const a = states[i - 1];
      const h = b.load - a.load;
      const smooth = (ya, yb, da, db) => Math.abs(h * da) + Math.abs(h * db) < 4 * Math.abs(yb - ya) + 1e-3;
      const re = hermite(a.re[k], b.re[k], h * a.dRe[k], h * b.dRe[k], smooth(a.re[k], b.re[k], a.dRe[k], b.dRe[k]));
      const im = hermite(a.im[k], b.im[k], h * a.dIm[k], h * b.dIm[k], smooth(a.im[k], b.im[k], a.dIm[k], b.dIm[k]));
      for (let p = 1; p < pieces; p++) push(a.load + (h * p) / pieces, re(p / pieces), im(p / pieces));
    }
    push(b.load, b.re[k], b.im[k]);
  });
  return found;
}

function hermite(a, b, da, db, smooth) {
  if (!smooth) return (t) => a + (b - a) * t;
  return (t) => a + t * (da + t * (3 * (b - a) - 2 * da - db + t * (2 * (a - b) + da + db)));
}

/** The lowest frequency-load curves: s = ω² of the undamped beam along the load. */
function frequencyCurves(states, most) {
  const count = Math.min(most, states[0].re.length);
  return Array.from({ length: count }, (_, k) => line(states, k));
}

/** The lowest branches of λ in the upper half plane along the load. */
function rootLocus(states, undamped, most) {
  if (undamped) {
    return frequencyCurves(states, most).map(({ load, re, im }) => {
      const roots = re.map((s, i) => upperRoot(s, im[i]));
      return { load, re: roots.map((root) => root[0]), im: roots.map((root) => root[1]) };
    });
  }
  const upper = states[0].re.map((_, k) => k).filter((k) => states[0].im[k] >= 0);
  return upper.slice(0, most).map((k) => line(states, k));
}

/** The root λ of λ² = −s with Im λ ≥ 0, growing where s is real and negative. */
function upperRoot(s, sIm) {
  const [re, im] = squareRoot(-s, -sIm);
  return im < 0 || (im === 0 && re < 0) ? [-re, -im] : [re, im];
}
