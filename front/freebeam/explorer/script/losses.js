// The first loss of stability of a column of any damping, by the plainest search that is right: divergences are the roots of
// det K(P); flutter is looked for in steps of the load by eigenvalues, and the equations of a crossing end it. What begins and
// ends within a step is not seen. In maps a point's loss is followed from its neighbours' where counts confirm it.

const STEP = 1 / 16; // of the least |P| with det K(P) = 0: the first steps of the load
const GROWING = 1.04; // each further step is this factor at most
const NARROW = 1e-2; // relative width of a bracket from which on Newton's method is tried
const CLOSE_BY = 0.1; // relative change of the load up to which Newton's method has stayed with the crossing it began with
const BELOW = [0.5, 0.8, 1 - MARGIN]; // parts of a load at which nothing grows where it is taken for the first loss

/** The first loss for 0 < P ≤ limit, null where none is seen. close: relative width of the last bracket, where bisected. */
function generalLoss(problem, damping, limit = LOAD_MAX, close = 4e-16) {
  const end = problem.divergences.find((load) => load <= limit && isGrowing(problem, damping, load * (1 + MARGIN)));
  const top = (end ?? limit) * (1 - MARGIN);
  const stride = close > 1e-10 ? 2 : 1; // a map's cells are looked through in steps twice as long
  for (let low = 0, high; low < top; low = high) {
    high = Math.min(top, Math.max(low + stride * STEP * problem.unit, (1 + stride * (GROWING - 1)) * low));
    if (isGrowing(problem, damping, high)) return bracketed(problem, damping, low, high, close);
  }
  return end === undefined ? null : divergenceOf(end);
}

function divergenceOf(load) {
  return { load, omega: 0, kind: "divergence", simple: true };
}

/** The crossing between a stable load and one where something grows: by Newton's method where counts confirm it, else bisected. */
function bracketed(problem, damping, stable, unstable, close) {
  let [low, high] = [stable, unstable];
  let isNewton = true;
  for (let middle = (low + high) / 2; high - low > close * high && low < middle && middle < high; middle = (low + high) / 2) {
    if (isNewton && high - low < NARROW * high) {
      const found = flutterNear(problem, damping, high, fastestAt(problem, damping, high).omega);
      const isInside = found && low * (1 - 1e-9) < found.load && found.load < high * (1 + 1e-9);
      // growth of light damping is seen a little above alone, and just below nothing is yet
      const above = isInside && Math.min(Math.max(high / found.load - 1, 1e-6), MARGIN);
      if (isInside && isFirst(problem, damping, found.load, [Math.max(low / found.load, 1 - 1e-6)], above)) return found;
      isNewton = high - low > (NARROW / 100) * high; // once more, from nearer
    }
    if (isGrowing(problem, damping, middle)) high = middle;
    else low = middle;
  }
  const { omega } = fastestAt(problem, damping, high);
  return omega > 0 ? { load: high, omega, kind: "flutter", simple: true } : divergenceOf(high);
}

/** The loss that those of neighbours lead to; null where counts do not confirm it. near: { load, omega, kind }. */
function followedLoss(problem, damping, near, limit = LOAD_MAX) {
  const nearest = (x, y) => (Math.abs(y - near.load) < Math.abs(x - near.load) ? y : x);
  const found = near.kind === "flutter" ? flutterNear(problem, damping, near.load, near.omega)
    : problem.divergences.length ? divergenceOf(problem.divergences.reduce(nearest)) : null;
  if (!found || found.load > limit || !(Math.abs(found.load / near.load - 1) < CLOSE_BY)) return null;
  return isFirst(problem, damping, found.load, BELOW, MARGIN) ? found : null;
}

/** Whether nothing grows at parts of a load and something does just above it. */
function isFirst(problem, damping, load, parts, above) {
  return parts.every((part) => !isGrowing(problem, damping, part * load)) && isGrowing(problem, damping, load * (1 + above));
}

/** The flutter that Newton's method finds from the motion at a load whose frequency is nearest; null where there is none, and
 * where eigenvalues stay on the axis. */
function flutterNear(problem, damping, P, omega) {
  if (!(omega > 0) || (damping.ratio >= LIGHT && damping.splits)) return null;
  const start = damping.ratio < LIGHT ? meetingAt(problem, damping, P, omega) : crossingAt(problem, damping, P, omega);
  return start && generalNewton(problem, damping, { P, ...start });
}

/** ω² and the motion a + iωb of the eigenvalue next to iω. */
function crossingAt(problem, damping, P, omega) {
  const far = ({ re, im }) => Math.hypot(re, im - omega);
  const { im, q } = generalSpectrum(problem, damping, P).reduce((x, y) => (far(y) < far(x) ? y : x));
  if (!(im > 0)) return null;
  const v = aligned(q);
  return { w: im * im, a: v.re, b: v.im.map((x) => x / im) };
}

/** Where damping vanishes, to first order: ω² and the motion of the branch next to it; without damping of the two that meet,
 * with (K − wM) b = −M a. */
function meetingAt(problem, damping, P, omega) {
  const { s, vectors } = branchesAt(problem, P, damping.size ? damping.C : []);
  const far = ({ re, im }) => Math.hypot(re - omega ** 2, im);
  const [first, second] = s.map((_, k) => k).sort((j, k) => far(s[j]) - far(s[k]));
  if (damping.size) return { w: s[first].re, a: aligned(vectors[first]).re, b: new Float64Array(problem.n) };
  if (second === undefined) return null;
  const v = aligned(vectors[first]);
  if (s[first].im !== 0) return { w: s[first].re, a: v.re, b: v.im.map((x) => -x / s[first].im) };
  const other = aligned(vectors[second]);
  const sign = dot(v.re, other.re) < 0 ? -1 : 1;
  const half = (s[first].re - s[second].re) / 2;
  return {
    w: (s[first].re + s[second].re) / 2,
    a: v.re.map((x, i) => (x + sign * other.re[i]) / 2),
    b: v.re.map((x, i) => -(x - sign * other.re[i]) / 2 / half),
  };
}

/**
 * The flutter near (w = ω², P, a, b), to rounding; null where the iteration does not settle. As `_newton` of general.py:
 * (K − wM) a − w f² D b = 0, (K − wM) b + D a = 0, c·a = 1, c·b = 0, with C = f D, so that light damping is as any; f = 0
 * and M for D where there is none.
 */
function generalNewton({ M, K, n, first }, damping, start) {
  const factor = damping.size ? Math.max(...damping.C.map((X) => X.norm())) : 1;
  const all = [M, damping.size ? damping.C.map((X) => Matrix.div(X, factor)) : M, K];
  const share = damping.size ? factor ** 2 : 0;
  let { w, P, a, b } = start;
  const size = dot(a, a);
  const c = a.map((x) => x / size);
  b = b.map((x, i) => (x - dot(c, start.b) * start.a[i]) / factor);
  // both parts of the equation for matrices at a load, or their slopes
  const parts = (m, d, k) => {
    const G = square(n, (i, j) => k.get(i, j) - w * m.get(i, j));
    const D = d.to2DArray();
    const [Ga, Gb, Da, Db] = [times(G, a), times(G, b), times(D, a), times(D, b)];
    return { G, D, Db, both: [...Ga.map((x, i) => x - share * w * Db[i]), ...Gb.map((x, i) => x + Da[i])] };
  };
  for (let step = 0, before = Infinity; step < 25; step++) {
    const at = all.map((X) => termsAt(X, P, n));
    const { G, D, Db, both } = parts(...at);
    const byLoad = parts(...all.map((X) => slopeAt(X, P, n))).both;
    const mass = at[0].to2DArray();
    const [Ma, Mb] = [times(mass, a), times(mass, b)];
    const J = square(2 * n + 2, () => 0);
    for (let i = 0; i < n; i++) {
      J[i].set(G[i]);
      J[i].set(D[i].map((x) => -share * w * x), n);
      J[n + i].set(D[i]);
      J[n + i].set(G[i], n);
      J[i].set([-Ma[i] - share * Db[i], byLoad[i]], 2 * n);
      J[n + i].set([-Mb[i], byLoad[n + i]], 2 * n);
      J[2 * n][i] = J[2 * n + 1][n + i] = c[i];
    }
    const lu = new LuDecomposition(new Matrix(J));
    if (lu.isSingular()) return null;
    const change = lu.solve(Matrix.columnVector([...both, dot(c, a) - 1, dot(c, b)])).to1DArray();
    a = a.map((x, i) => x - change[i]);
    b = b.map((x, i) => x - change[n + i]);
    w -= change[2 * n];
    P -= change[2 * n + 1];
    const moved = Math.abs(change[2 * n]) / (Math.abs(w) + 1e-7 * first ** 2) + Math.abs(change[2 * n + 1] / P);
    if (!(moved < 1e3 && w > 0 && P > 0)) return null;
    if (moved < 1e-9 && (moved * (moved / before) ** 2 < 1e-16 || moved > before / 4)) {
      return { load: P, omega: Math.sqrt(w), kind: "flutter", simple: true };
    }
    before = moved;
  }
  return null;
}
