// The first loss of stability as the load grows from 0: flutter, divergence, or none. Section 3.2, Eqs. (24), (25).
//
// The same decisions as in freebeam_sym/stability/crossings.py and the same operator as in proportional.py beside it,
// which derives it: flutter loads P are the real eigenvalues 1/P of T, found by Arnoldi's method and made exact by
// Newton's. A column is seen as a problem alone, { N, e, H, conservative, divergences } in the basis where M = I and
// E = diag(e), with its damping.

const LOAD_MAX = 1000;
const LIGHTEST = 1e-7; // damping ratio of mode 1 below which growth is counted to first order
const NEAR = 1e-6; // relative: two roots of a determinant are known apart from here on
const MARGIN = 1e-3; // relative: so far below a load it is confirmed that nothing grows, and so far above a touch
const RESIDUAL = 1e-13; // relative, of eigenvalues of T: close ones are off by its root
const STEPS = 400; // most steps of Arnoldi's method, as in the runtime

/**
 * The first crossing for 0 < P ≤ limit, null where there is none, and the touches below it, at which an eigenvalue
 * comes to the axis and goes back. The crossing is undefined where two modes have one frequency and hardly any damping:
 * T is infinite there.
 */
function firstLoss(pencil, damping, limit = LOAD_MAX) {
  const { e, conservative } = pencil;
  const touches = [];
  // one may stand at the load of the loss but for rounding
  const told = (crossing) => ({
    crossing,
    touches: touches.filter((touch) => !crossing || touch.load < crossing.load * (1 - NEAR)),
  });
  const isTwice = e.some((x, i) => i > 0 && x - e[i - 1] < 1e-8 * x);
  if (!conservative && isTwice && damping.size ** 2 < 1e-6 * e[0]) return told(undefined);
  const events = inOrder(pencil, damping, limit);
  let stable = 0;
  let event = events.next().value;
  while (event) {
    const below = event.load * (1 - Math.min(MARGIN, (1 - stable / event.load) / 2));
    if (!event.simple) {
      const following = events.next().value;
      const ahead = following ? following.load / event.load - 1 : Infinity;
      const beyond = event.load * (1 + Math.min(MARGIN, ahead / 2));
      if (ahead < 2 * NEAR || !isGrowing(pencil, damping, beyond)) {
        touches.push(event);
        if (ahead >= 2 * NEAR) stable = event.load;
        event = following;
        continue;
      }
    }
    if (isGrowing(pencil, damping, below)) return told(scan(pencil, damping, stable, below));
    return told(event.load <= limit ? event : null);
  }
  const top = limit * (1 - MARGIN);
  const isMissed = stable < top && isGrowing(pencil, damping, top);
  return told(isMissed ? scan(pencil, damping, stable, top) : null);
}

/** Divergences and flutters, ascending, up to the limit and the first simple divergence; found as they are asked for. */
function* inOrder(pencil, damping, limit) {
  const waiting = pencil.divergences.filter(({ load }) => load <= limit * (1 + NEAR));
  const last = waiting.find(({ simple }) => simple)?.load ?? limit;
  if (!pencil.conservative && pencil.N > 1) {
    const operator = operatorOf(pencil, damping);
    for (const group of realEigenvalues(operator, (1 - NEAR) / last)) {
      for (const flutter of toldApart(pencil, damping, operator, group)) {
        // what touches λ = 0 comes before a flutter that begins there, whichever rounding puts first
        while (waiting.length && waiting[0].load <= flutter.load * (1 + (waiting[0].simple ? 0 : NEAR))) {
          yield waiting.shift();
        }
        yield flutter;
      }
    }
  }
  yield* waiting;
}

/** Close eigenvalues of T as simple flutters where Newton's method tells them apart, else as one event. */
function toldApart(pencil, damping, operator, group) {
  const roots = group.map((one) => flutterAt(pencil, damping, operator, one));
  if (group.every(({ im }) => im === 0) && roots.every(Boolean)) {
    roots.sort((x, y) => x.load - y.load);
    const isApart = roots.every((x, k) => k === 0 || x.load - roots[k - 1].load > (NEAR / 10) * roots[k - 1].load);
    if (isApart) return roots.filter(({ omega }) => omega >= 0);
  }
  const mean = group.reduce((sum, { re }) => sum + re, 0) / group.length;
  const omega = Math.max(0, roots.find(Boolean)?.omega ?? 0);
  return [{ load: 1 / mean, omega, kind: "flutter", simple: false }];
}

/** The flutter at an eigenvalue of T; null where Newton's method does not settle there. */
function flutterAt(pencil, damping, operator, { re, z }) {
  const { e, H } = pencil;
  const { S, Y } = operator.matrices(z);
  // S ~ a aᵀ + ω² size² b bᵀ with a and b at right angles, and Y ~ a bᵀ − b aᵀ
  const { realEigenvalues: sizes, eigenvectorMatrix } = new EigenvalueDecomposition(new Matrix(S), { assumeSymmetric: true });
  const top = sizes.reduce((best, x, k) => (Math.abs(x) > Math.abs(sizes[best]) ? k : best), 0);
  const a = eigenvectorMatrix.getColumn(top);
  const b = Array.from(times(Y, a), (x) => -x / sizes[top]);
  const Ka = times(H, a).map((x, i) => e[i] * a[i] + x / re);
  const weight = a.map((x, i) => x + damping.size ** 2 * damping.shape[i] * b[i]);
  const root = newton(pencil, damping, { w: dot(a, Ka) / dot(a, weight), P: 1 / re, a, b });
  return root && Math.abs(root.load * re - 1) < NEAR ? root : null;
}

/** T. A vector holds Y and q = S Hᵀ − H S, scaled so that the lowest modes do not drown in the rounding of the others. */
function operatorOf({ N, e, H }, { size, shape: D }) {
  const root = e.map(Math.sqrt);
  const scale = Float64Array.from({ length: 2 * N * N }, (_, k) => {
    const [i, j] = [Math.floor(k / N) % N, k % N];
    return (root[i] * root[j]) / (k < N * N ? 1 : Math.max(e[i], e[j]));
  });
  const matrices = (z) => {
    const [Y, S] = [square(N, (i, j) => z[i * N + j] / scale[i * N + j]), square(N, () => 0)];
    const HY = square(N, (i, j) => -dot(H[i], Y[j])); // Yᵀ = −Y
    for (let i = 0; i < N; i++) {
      for (let j = 0; j < N; j++) {
        const k = N * N + i * N + j;
        const [gap, both] = [e[j] - e[i], D[i] + D[j]];
        const half = (size * size * both) / 2;
        // both S + gap Y = first and slope S − weight Y = second, as the pair of modes answers at P = 0
        const first = HY[i][j] + HY[j][i];
        const second = half * (HY[i][j] - HY[j][i]) - z[k] / scale[k];
        const determinant = i === j ? both : gap * gap + 2 * half * (e[i] * D[j] + e[j] * D[i]);
        S[i][j] = ((i === j ? 1 : half * (e[i] + e[j])) * first + gap * second) / determinant;
        Y[i][j] = ((gap - half * (D[j] - D[i])) * first - both * second) / determinant;
      }
    }
    return { S, Y };
  };
  const apply = (z) => {
    const { S, Y } = matrices(z);
    const HS = square(N, (i, j) => dot(H[i], S[j]));
    const entry = (k, i, j) => (k < N * N ? Y[i][j] : HS[j][i] - HS[i][j]);
    return scale.map((x, k) => x * entry(k, Math.floor(k / N) % N, k % N));
  };
  return { N, matrices, apply };
}

/**
 * Real eigenvalues of T above `floor` with their vectors, { re, im, z }, descending, in groups that rounding cannot
 * tell apart: Arnoldi's method, taken as many steps as are asked for.
 */
function* realEigenvalues({ N, apply }, floor) {
  const most = Math.min(N * (N - 1), STEPS);
  const mirrored = (k) => k - (k % (N * N)) + (k % N) * N + (Math.floor(k / N) % N);
  const some = Float64Array.from({ length: 2 * N * N }, (_, k) => Math.cos(k + 0.3) - Math.cos(mirrored(k) + 0.3));
  const basis = [some.map((x) => x / Math.sqrt(dot(some, some)))];
  const h = []; // columns of the Hessenberg matrix
  let [look, after, isDone] = [9, Infinity, false];
  while (true) {
    while (!isDone && h.length < look) isDone = arnoldiStep(apply, basis, h) || h.length === most;
    look = Math.floor(1.25 * h.length) + 1;
    const values = ritzValues(h);
    const real = values.filter(({ re, im }) => Math.abs(im) <= NEAR * re && re > floor && re < after);
    const top = real.reduce((best, { re }) => Math.max(best, re), floor);
    const isOpen = ({ size, left }) => size + left >= top * (1 - 1e-3) && left > RESIDUAL * size;
    if (!isDone && values.some(isOpen)) continue;
    if (!real.length) return;
    const group = real.filter(({ re }) => re >= top * (1 - 2 * NEAR)).sort((x, y) => y.re - x.re);
    yield group.map(({ re, im, s }) => ({ re, im, z: some.map((_, i) => s.reduce((sum, x, k) => sum + x * basis[k][i], 0)) }));
    after = group[group.length - 1].re * (1 - NEAR / 10);
  }
}

/** One more vector of the basis; whether there are no more. */
function arnoldiStep(apply, basis, h) {
  const w = apply(basis[basis.length - 1]);
  const column = new Float64Array(basis.length + 1);
  for (let round = 0; round < 2; round++) { // twice, so that the basis stays orthogonal to rounding
    basis.forEach((v, k) => {
      const c = dot(v, w);
      for (let i = 0; i < w.length; i++) w[i] -= c * v[i];
      column[k] += c;
    });
  }
  const left = Math.sqrt(dot(w, w));
  column[basis.length] = left;
  h.push(column);
  basis.push(w.map((x) => x / left));
  return left < 1e-14 * Math.max(...h.map((values) => Math.max(...values.map(Math.abs))));
}

/** Eigenvalues of T as far as they are known, with the norms of their residuals and their vectors in the basis. */
function ritzValues(h) {
  const n = h.length;
  const hessenberg = new Matrix(square(n, (i, j) => (i <= j + 1 ? h[j][i] : 0)));
  const found = new EigenvalueDecomposition(hessenberg, { assumeSymmetric: false });
  return complexColumns(found, n).map(({ re: s, im: t }, k) => {
    const [re, im] = [found.realEigenvalues[k], found.imaginaryEigenvalues[k]];
    const share = Math.hypot(s[n - 1], t[n - 1]) / Math.sqrt(dot(s, s) + dot(t, t));
    return { re, im, s, size: Math.hypot(re, im), left: h[n - 1][n] * share };
  });
}

/**
 * The flutter near (w = ω², P, a, b), to rounding; null where the iteration does not settle. Its omega is −1 where
 * ω² < 0: two real eigenvalues add up to zero, which is no crossing.
 *
 * With v = a + iω·size·b and A = diag(e − w) + P H the equation (A + iω·size·D) v = 0 reads A a − w size² D b = 0,
 * A b + D a = 0, normalised by c·a = 1, c·b = 0: real, and regular where the damping vanishes.
 */
function newton({ N, e, H }, { size, shape: D }, { w, P, a, b }) {
  const m = 2 * N;
  const c = a.map((x) => x / dot(a, a));
  const shift = dot(c, b);
  let x = Float64Array.from([...a, ...b.map((y, i) => y - shift * a[i]), 0, 0]);
  const scale = e.map((y) => 1 / (y + Math.abs(w))); // rows in the size of their mode
  const tiny = 1e-7 * e[0]; // where ω goes to zero its square is judged beside that of mode 1
  for (let step = 0, before = Infinity, astray = 0; step < 25 && astray < 4; step++) {
    const J = square(m + 2, () => 0);
    for (let i = 0; i < N; i++) {
      for (let j = 0; j < N; j++) J[i][j] = J[N + i][N + j] = scale[i] * ((i === j ? e[i] - w : 0) + P * H[i][j]);
      J[i][N + i] -= scale[i] * w * size * size * D[i];
      J[N + i][i] += scale[i] * D[i];
      J[m][i] = J[m + 1][N + i] = c[i];
    }
    const r = times(J, x);
    r[m] -= 1;
    const [Ha, Hb] = [times(H, x.subarray(0, N)), times(H, x.subarray(N, m))];
    for (let i = 0; i < N; i++) {
      J[i].set([-scale[i] * (x[i] + size * size * D[i] * x[N + i]), scale[i] * Ha[i]], m);
      J[N + i].set([-scale[i] * x[N + i], scale[i] * Hb[i]], m);
    }
    const lu = new LuDecomposition(new Matrix(J));
    if (lu.isSingular()) return null;
    const change = lu.solve(Matrix.columnVector(r)).to1DArray();
    x = x.map((y, i) => (i < m ? y - change[i] : 0));
    w -= change[m];
    P -= change[m + 1];
    astray = w > -tiny && P > 0 ? 0 : astray + 1;
    const moved = Math.abs(change[m]) / (Math.abs(w) + tiny) + Math.abs(change[m + 1] / P);
    if (!(moved < 1e6)) return null;
    if (moved < 1e-9 && (moved * (moved / before) ** 2 < 1e-16 || moved > before / 4)) {
      const omega = Math.abs(w) <= 1e-13 * e[0] ? 0 : w > 0 ? Math.sqrt(w) : -1;
      return { load: P, omega, kind: "flutter", simple: true };
    }
    before = moved;
  }
  return null;
}

function isGrowing(pencil, damping, P) {
  return fastestAt(pencil, damping, P).growth > 0;
}

/** Growth, up to a positive factor, and frequency of what grows most at a load. */
function fastestAt(pencil, damping, P) {
  if (pencil.general) return generalGrowth(pencil, damping, P).reduce((x, y) => (y.growth > x.growth ? y : x));
  const all = damping.ratio < LIGHTEST ? lightGrowth(pencil, damping, P) : dampedGrowth(pencil, damping, P);
  return all.reduce((x, y) => (y.growth > x.growth ? y : x));
}

/** From the inverse of the state matrix, Eq. (25), times ω₁: its eigenvalues are ω₁/λ, so that low modes keep their
 * digits under strong damping. */
function dampedGrowth(pencil, damping, P) {
  const { N, e } = pencil;
  const first = Math.sqrt(e[0]);
  const solver = new LuDecomposition(undampedMatrix(pencil, P).div(e[0]));
  if (solver.isSingular()) return [{ growth: Infinity, omega: 0 }];
  const inverse = solver.solve(Matrix.eye(N));
  const A = Matrix.zeros(2 * N, 2 * N);
  for (let i = 0; i < N; i++) {
    for (let j = 0; j < N; j++) {
      A.set(i, j, -inverse.get(i, j) * (damping.size / first) * damping.shape[j]);
      A.set(i, N + j, -inverse.get(i, j));
    }
    A.set(N + i, i, 1);
  }
  const rounding = 1e-14 * A.norm();
  const { realEigenvalues, imaginaryEigenvalues } = new EigenvalueDecomposition(A, { assumeSymmetric: false });
  return realEigenvalues.map((re, k) => {
    const im = imaginaryEigenvalues[k];
    return { growth: re - rounding, omega: (first * Math.abs(im)) / (re * re + im * im) };
  });
}

/** Of each undamped branch to first order in the damping; infinite where ω² is not real and positive. */
function lightGrowth(pencil, damping, P) {
  const found = new EigenvalueDecomposition(undampedMatrix(pencil, P), { assumeSymmetric: false });
  const V = found.eigenvectorMatrix;
  const lu = new LuDecomposition(V);
  if (lu.isSingular()) return [{ growth: Infinity, omega: Math.sqrt(Math.max(0, ...found.realEigenvalues)) }];
  const W = lu.solve(Matrix.diag(Array.from(damping.shape)).mmul(V));
  const isDamped = damping.size > 0 || damping.limit;
  return found.realEigenvalues.map((s, k) => {
    const isStable = s > 0 && found.imaginaryEigenvalues[k] === 0;
    return { growth: !isStable ? Infinity : isDamped ? -W.get(k, k) : 0, omega: Math.sqrt(Math.max(0, s)) };
  });
}

/** A crossing between a stable load and one where something grows, by equal steps and bisection, as well as growth is
 * known: what is left where Arnoldi's method has missed a crossing. */
function scan(pencil, damping, low, high) {
  const step = (high - low) / 256;
  while (low + step < high && !isGrowing(pencil, damping, low + step)) low += step;
  high = Math.min(high, low + step);
  for (let middle = (low + high) / 2; low < middle && middle < high; middle = (low + high) / 2) {
    if (isGrowing(pencil, damping, middle)) high = middle;
    else low = middle;
  }
  const { omega } = fastestAt(pencil, damping, high);
  return { load: high, omega, kind: omega > 0 ? "flutter" : "divergence", simple: true };
}
