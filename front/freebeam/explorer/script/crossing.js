// The first loss of stability as the load grows from 0: flutter, divergence, or none. Section 3.2, Eqs. (24)-(25).
//
// Loads are stepped through; at each the growing eigenvalues are counted, and an interval whose ends are stable is
// halved where an eigenvalue could have crossed and come back within it. Newton's method on real equations, regular
// down to vanishing damping, then gives the load to rounding, and a count just below confirms that it is the first.

const LIGHTEST = 1e-7; // damping ratio of mode 1 below which growth is counted to first order
const LOAD_MAX = 1000;

/** Eigenvalues at a load with their slopes along it, and how many of them grow. */
function nodeAt(pencil, damping, P) {
  return damping.ratio < LIGHTEST ? lightNode(pencil, damping, P) : dampedNode(pencil, damping, P);
}

/** Inverse of the state matrix, Eq. (25), times ω₁, with the inverse of K: its eigenvalues are ω₁/λ, so that low
 * modes keep their digits under strong damping. Null where K is singular. */
function inverseState(pencil, damping, P) {
  const { N, e } = pencil;
  const first = Math.sqrt(e[0]);
  const solver = new LuDecomposition(undampedMatrix(pencil, P).div(e[0]));
  if (solver.isSingular()) return null;
  const inverse = solver.solve(Matrix.eye(N));
  const A = Matrix.zeros(2 * N, 2 * N);
  for (let i = 0; i < N; i++) {
    for (let j = 0; j < N; j++) {
      A.set(i, j, -inverse.get(i, j) * (damping.size / first) * damping.shape[j]);
      A.set(i, N + j, -inverse.get(i, j));
    }
    A.set(N + i, i, 1);
  }
  return { A, inverse, found: new EigenvalueDecomposition(A, { assumeSymmetric: false }), small: 1e-14 * A.norm() };
}

/** Whether an eigenvalue grows at a load. */
function isGrowing(pencil, damping, P) {
  if (damping.ratio < LIGHTEST) return lightNode(pencil, damping, P).unstable > 0;
  const state = inverseState(pencil, damping, P);
  return state === null || state.found.realEigenvalues.some((re) => re > state.small);
}

function dampedNode(pencil, damping, P) {
  const { N, e, H } = pencil;
  const first = Math.sqrt(e[0]);
  const state = inverseState(pencil, damping, P);
  if (state === null) return dampedNode(pencil, damping, P * (1 + 1e-13) + 1e-13);
  const { found, inverse, small } = state;
  const re = found.realEigenvalues;
  const im = found.imaginaryEigenvalues;
  const node = { load: P, re: [], im: [], slopeRe: [], slopeIm: [], unstable: 0 };
  const slopes = inverseSlopes(found, inverse, H, N, e[0]);
  for (let k = 0; k < 2 * N; k++) {
    const size = re[k] * re[k] + im[k] * im[k];
    const lambda = [(first * re[k]) / size, (-first * im[k]) / size];
    const [a, b] = slopes[k];
    node.re.push(lambda[0]);
    node.im.push(lambda[1]);
    node.slopeRe.push(lambda[0] * a - lambda[1] * b);
    node.slopeIm.push(lambda[0] * b + lambda[1] * a);
    if (re[k] > small) node.unstable++;
  }
  return node;
}

/** d ln λ / dP of each eigenvalue of the inverse state matrix: left vector · K⁻¹ H · right vector. */
function inverseSlopes(found, inverse, H, N, scale) {
  const V = found.eigenvectorMatrix;
  const im = found.imaginaryEigenvalues;
  const lu = new LuDecomposition(V);
  if (lu.isSingular()) return im.map(() => [0, 0]);
  const W = lu.solve(Matrix.eye(2 * N));
  const G = inverse.mmul(new Matrix(H));
  const product = W.subMatrix(0, 2 * N - 1, 0, N - 1).mmul(G).mmul(V.subMatrix(0, N - 1, 0, 2 * N - 1)).div(scale);
  return im.map((value, k) => {
    if (value === 0) return [product.get(k, k), 0];
    const a = value > 0 ? k : k - 1;
    const b = a + 1;
    const re = (product.get(a, a) + product.get(b, b)) / 2;
    const imaginary = (product.get(a, b) - product.get(b, a)) / 2;
    return [re, value > 0 ? imaginary : -imaginary];
  });
}

/** Undamped branches s = ω² with slopes; with light damping, or in its limit, the growth of each to first order. */
function lightNode(pencil, damping, P) {
  const { N, H } = pencil;
  const found = new EigenvalueDecomposition(undampedMatrix(pencil, P), { assumeSymmetric: false });
  const s = found.realEigenvalues;
  const sIm = found.imaginaryEigenvalues;
  const V = found.eigenvectorMatrix;
  const lu = new LuDecomposition(V);
  const W = lu.isSingular() ? Matrix.zeros(N, N) : lu.solve(Matrix.eye(N));
  const product = W.mmul(new Matrix(H)).mmul(V);
  const node = { load: P, s: Array.from(s), sIm: Array.from(sIm), slope: [], slopeImag: [], growth: [], unstable: 0 };
  const damped = damping.size > 0 || damping.limit;
  for (let k = 0; k < N; k++) {
    const pair = sIm[k] > 0 ? k + 1 : k - 1;
    node.slope.push(sIm[k] === 0 ? product.get(k, k) : (product.get(k, k) + product.get(pair, pair)) / 2);
    node.slopeImag.push(sIm[k] === 0 ? 0 : (product.get(k, pair) - product.get(pair, k)) / 2);
    let growth = 0;
    for (let i = 0; i < N; i++) growth -= W.get(k, i) * damping.shape[i] * V.get(i, k);
    node.growth.push(growth);
    if (sIm[k] !== 0 || s[k] <= 0 || (damped && growth > 0)) node.unstable++;
  }
  return node;
}

/** Whether an eigenvalue could have crossed and come back between two stable loads. */
function mayHide(a, b) {
  const h = b.load - a.load;
  if (a.s) return meets(a.s, a.slope, h) || meets(b.s, b.slope, -h) || growthMayHide(a, b);
  const rises = (node, step) => node.re.some((x, k) => x + step * node.slopeRe[k] > 0);
  return (rises(a, h) && rises(b, -h)) || meetsUpper(a, h) || meetsUpper(b, -h);
}

function growthMayHide(a, b) {
  const order = (node) => node.s.map((x, k) => [x, node.growth[k]]).sort((x, y) => x[0] - y[0]);
  const [x, y] = [order(a), order(b)];
  // near the boundary, beside how much it changes over the interval
  return x.some(([, g], k) => Math.max(g, y[k][1]) + 0.5 * Math.abs(g - y[k][1]) > 0);
}

function meetsUpper(node, h) {
  const upper = node.im.map((x, k) => k).filter((k) => node.im[k] > 0);
  return meets(
    upper.map((k) => node.im[k]),
    upper.map((k) => node.slopeIm[k]),
    h,
  );
}

/** Whether neighbours come together, at the rates they have, within a step. */
function meets(values, slopes, h) {
  const order = values.map((x, k) => [x, x + h * slopes[k]]).sort((x, y) => x[0] - y[0]);
  return order.some((pair, k) => k > 0 && pair[1] <= order[k - 1][1]);
}

/** Loads to begin with: even steps over the range shown, then growing ones up to the limit. */
function* loadSteps(range, limit, count = 48) {
  let P = 0;
  while (P < limit) {
    P = Math.min(limit, P + Math.max(range / count, 0.06 * (P - range)));
    yield P;
  }
}

/** First crossing for 0 < P ≤ limit; null where there is none. `range`: the scale of the steps; `at`: gives nodes. */
function firstCrossing(pencil, damping, range, limit = LOAD_MAX, at = (P) => nodeAt(pencil, damping, P)) {
  const divergence = pencil.divergence.length ? pencil.divergence[0] : Infinity;
  const known = divergence <= limit ? { load: divergence, omega: 0, kind: "divergence" } : null;
  if (pencil.conservative) return known;
  const bound = known ? known.load * (1 - 1e-9) : limit;
  const finest = range / 48 / 256;
  let low = at(0);
  for (const P of loadSteps(range, bound)) {
    const high = at(P);
    const bracket = firstBracket(at, low, high, finest);
    if (bracket) return refine(pencil, damping, ...bracket);
    low = high;
  }
  return known;
}

/** A stable and an unstable load between two, the first there are; null where nothing grows in between. */
function firstBracket(at, low, high, finest) {
  const width = high.load - low.load;
  const hidden = width > finest && mayHide(low, high);
  if (!hidden) return high.unstable ? [low, high] : null;
  const middle = at((low.load + high.load) / 2);
  return (
    firstBracket(at, low, middle, finest) ?? (middle.unstable ? [low, middle] : firstBracket(at, middle, high, finest))
  );
}

/** The crossing between a stable and an unstable load, to rounding. */
function refine(pencil, damping, low, high) {
  let a = low.load;
  let b = high.load;
  for (let round = 0; b - a > 4e-16 * b; round++) {
    const middle = (a + b) / 2;
    if (!(middle > a && middle < b)) break;
    if (isGrowing(pencil, damping, middle)) b = middle;
    else a = middle;
    if (round < 3 || round % 2) continue;
    const found = polish(pencil, damping, b);
    if (!found || !(found.load > a - 1e-9 * b && found.load < b + 1e-9 * b)) continue;
    const below = found.load * (1 - 1e-7);
    if (below <= a || !isGrowing(pencil, damping, below)) return found;
    b = below;
  }
  return { load: b, omega: Math.sqrt(Math.max(0, nearest(pencil, damping, b).w)), kind: "flutter" };
}

/** What is known of the crossing near a load that is unstable: w = ω² and the motion a + iω·size·b. */
function nearest(pencil, damping, P) {
  if (damping.ratio >= LIGHTEST) {
    const modes = spectrumOf(pencil, damping, P);
    const worst = modes.reduce((x, y) => (y.re > x.re ? y : x));
    const omega = Math.abs(worst.im);
    const { re, im } = aligned(worst.im < 0 ? conjugate(worst.q) : worst.q);
    return { w: omega * omega, P, a: re, b: im.map((x) => x / (omega * damping.size)) };
  }
  const found = new EigenvalueDecomposition(undampedMatrix(pencil, P), { assumeSymmetric: false });
  const node = lightNode(pencil, damping, P);
  const bad = (k) => (node.sIm[k] !== 0 || node.s[k] <= 0 ? Infinity : node.growth[k]);
  const worst = node.s.reduce((x, _, k) => (bad(k) > bad(x) ? k : x), 0);
  const vector = complexColumns(found, pencil.N)[worst];
  const { re } = aligned(vector);
  return { w: node.s[worst], P, a: re, b: companion(pencil, damping, node.s[worst], P, re) };
}

function conjugate(v) {
  return { re: v.re, im: v.im.map((x) => -x) };
}

/** v turned so that its real part is as large as can be, and of length 1. */
function aligned(v) {
  const re = dot(v.re, v.re) - dot(v.im, v.im);
  const im = 2 * dot(v.re, v.im);
  const angle = -0.5 * Math.atan2(im, re);
  const size = Math.sqrt(dot(v.re, v.re) + dot(v.im, v.im));
  const [c, s] = [Math.cos(angle) / size, Math.sin(angle) / size];
  return { re: v.re.map((x, i) => c * x - s * v.im[i]), im: v.im.map((x, i) => s * x + c * v.im[i]) };
}

/** b of (diag(e) − w + P H) b = −D a with a·b = 0, where that matrix is all but singular. */
function companion(pencil, damping, w, P, a) {
  const { N, e, H } = pencil;
  const A = Matrix.zeros(N + 1, N + 1);
  for (let i = 0; i < N; i++) {
    for (let j = 0; j < N; j++) A.set(i, j, (i === j ? e[i] - w : 0) + P * H[i][j]);
    A.set(i, N, a[i] * e[0]);
    A.set(N, i, a[i]);
  }
  const right = Matrix.columnVector([...a.map((x, i) => -damping.shape[i] * x), 0]);
  const lu = new LuDecomposition(A);
  if (lu.isSingular()) return a.map(() => 0);
  const found = lu.solve(right);
  return a.map((_, i) => found.get(i, 0));
}

function polish(pencil, damping, P) {
  const start = nearest(pencil, damping, P);
  return start.w > 0 ? newton(pencil, damping, start) : null;
}

/**
 * Root of the boundary equations near (w, P, a, b), to rounding; null where the iteration does not settle.
 *
 * With v = a + iω·size·b and A = diag(e − w) + P H the equation (A + iω·size·D) v = 0 reads A a − w size² D b = 0,
 * A b + D a = 0, normalised by c·a = 1, c·b = 0: real, and regular where the damping vanishes. There it is the
 * coalescence (D = I) or the tangent rule P s′ − s = κ.
 */
function newton(pencil, damping, start) {
  const { N, e, H } = pencil;
  const D = damping.shape;
  const m = 2 * N;
  let { w, P } = start;
  let a = Float64Array.from(start.a);
  let b = Float64Array.from(start.b);
  const length = dot(a, a);
  const c = a.map((x) => x / length);
  const shift = dot(c, b);
  b = b.map((x, i) => x - shift * a[i]);
  const scale = e.map((x) => 1 / (x + Math.abs(w)));
  let before = Infinity;
  for (let step = 0; step < 25; step++) {
    const J = Matrix.zeros(m + 2, m + 2);
    const r = Matrix.zeros(m + 2, 1);
    const Ha = times(H, a);
    const Hb = times(H, b);
    const square2 = damping.size * damping.size;
    for (let i = 0; i < N; i++) {
      for (let j = 0; j < N; j++) {
        const A = scale[i] * ((i === j ? e[i] - w : 0) + P * H[i][j]);
        J.set(i, j, A);
        J.set(N + i, N + j, A);
      }
      J.set(i, N + i, J.get(i, N + i) - scale[i] * w * square2 * D[i]);
      J.set(N + i, i, J.get(N + i, i) + scale[i] * D[i]);
      J.set(i, m, -scale[i] * (a[i] + square2 * D[i] * b[i]));
      J.set(N + i, m, -scale[i] * b[i]);
      J.set(i, m + 1, scale[i] * Ha[i]);
      J.set(N + i, m + 1, scale[i] * Hb[i]);
      J.set(m, i, c[i]);
      J.set(m + 1, N + i, c[i]);
      r.set(i, 0, scale[i] * ((e[i] - w) * a[i] + P * Ha[i] - w * square2 * D[i] * b[i]));
      r.set(N + i, 0, scale[i] * ((e[i] - w) * b[i] + P * Hb[i] + D[i] * a[i]));
    }
    r.set(m, 0, dot(c, a) - 1);
    r.set(m + 1, 0, dot(c, b));
    const lu = new LuDecomposition(J);
    if (lu.isSingular()) return null;
    const change = lu.solve(r).to1DArray();
    if (!isFiniteAll(change)) return null;
    a = a.map((x, i) => x - change[i]);
    b = b.map((x, i) => x - change[N + i]);
    w -= change[m];
    P -= change[m + 1];
    const size = Math.abs(change[m] / w) + Math.abs(change[m + 1] / P);
    if (!(size < 1e6)) return null;
    if (size < 1e-9 && (size * (size / before) ** 2 < 1e-16 || size > before / 4)) {
      return w > 0 && P > 0 ? { load: P, omega: Math.sqrt(w), kind: "flutter", w, P, a, b } : null;
    }
    before = size;
  }
  return null;
}
