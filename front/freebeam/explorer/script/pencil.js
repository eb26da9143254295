// The pencil E + P H − s M of the column at its own parameters, in the basis where M = I and E = diag(e). `kernel` is the
// column's emitted one; what it computes is brought here into the form that the search and the pictures take.
// Matrices are rows of numbers; ml-matrix factorises them.

const { Matrix, EigenvalueDecomposition, LuDecomposition, CholeskyDecomposition, SingularValueDecomposition } = mlMatrix;

const CLOSE = 1e-4; // relative: roots nearer than this are looked at together
const SINGULAR = 1e-14; // least singular value of E + P H, relative to its norm, up to which it is singular but for rounding

function square(n, entry) {
  const rows = [];
  for (let i = 0; i < n; i++) {
    rows.push(new Float64Array(n));
    for (let j = 0; j < n; j++) rows[i][j] = entry(i, j);
  }
  return rows;
}

function dot(a, b) {
  let sum = 0;
  for (let i = 0; i < a.length; i++) sum += a[i] * b[i];
  return sum;
}

function times(A, x) {
  return Float64Array.from(A, (row) => dot(row, x));
}

/** e ascending and B, rows of numbers, with Bᵀ M B = I and Bᵀ E B = diag(e); null where E is not positive. */
function diagonalise(M, E) {
  const n = M.length;
  const isDiagonal = (A) =>
    A.every((row, i) => row.every((x, j) => i === j || Math.abs(x) <= 1e-13 * Math.sqrt(Math.abs(A[i][i] * A[j][j]))));
  if (!E.every((row, i) => row[i] > 0) || !M.every((row, i) => row[i] > 0)) return null;
  if (isDiagonal(M) && isDiagonal(E)) {
    // a scaling, with no rounding of the lowest mode by the highest
    const order = E.map((row, i) => [row[i] / M[i][i], i]).sort((a, b) => a[0] - b[0]);
    return {
      e: Float64Array.from(order, (pair) => pair[0]),
      basis: square(n, (i, j) => (order[j][1] === i ? 1 / Math.sqrt(M[i][i]) : 0)),
    };
  }
  // 1/e from the side of the elastic energy: the low modes, which decide, keep their relative accuracy
  const factor = new CholeskyDecomposition(new Matrix(E));
  if (!factor.isPositiveDefinite()) return null;
  const solve = new LuDecomposition(factor.lowerTriangularMatrix);
  const half = solve.solve(new Matrix(M));
  const full = solve.solve(half.transpose());
  const found = new EigenvalueDecomposition(full.add(full.transpose()).mul(0.5), { assumeSymmetric: true });
  const back = new LuDecomposition(factor.lowerTriangularMatrix.transpose()).solve(found.eigenvectorMatrix);
  const order = found.realEigenvalues.map((value, i) => [1 / value, i]).sort((a, b) => a[0] - b[0]);
  if (!order.every((pair) => pair[0] > 0 && Number.isFinite(pair[0]))) return null;
  return {
    e: Float64Array.from(order, (pair) => pair[0]),
    basis: square(n, (i, j) => back.get(i, order[j][1]) * Math.sqrt(order[j][0])),
  };
}

/** Everything of a column at N functions and own parameters that does not depend on load and damping. */
function pencilOf(N, own) {
  const functions = kernel.basis(N);
  const matrix = (values) => square(N, (i, j) => values[i * N + j]);
  const [M, E, H] = [kernel.mass, kernel.stiffness_elastic, kernel.stiffness_load].map((of) => matrix(of(functions, false, own)));
  const problem = problemOf(M, E, H);
  return problem ? { sound: true, ...problem, own, functions, load: loadOf(own) } : { sound: false };
}

/**
 * What acts on the beam per unit of P, read from the load's bilinear form H: the transversal parts −c y′ of forces at the
 * ends (of a follower force c is the axial force there, of a dead load 0); ascending in powers of x the axial force
 * (compression), and the transversal part of a load along the beam.
 */
function loadOf(own) {
  const { along, points } = kernel.forms(own).H;
  const at = (end) => points.find(([a, p, b, q]) => a === end && p === 0 && b === end && q === 1)?.[4] ?? 0;
  const powers = Array.from({ length: 1 + Math.max(0, ...along.map(([k]) => k)) }, (_, k) => k);
  const factor = (k, p, q) => along.find((term) => term[0] === k && term[1] === p && term[2] === q)?.[3] ?? 0;
  return {
    ends: [at(0), at(1)],
    axial: powers.map((k) => -factor(k, 1, 1)),
    along: powers.map((k) => factor(k, 0, 1)),
  };
}

/** What the search sees of M, E and H, rows of numbers; null where M or E is not positive. */
function problemOf(M, E, load) {
  const found = diagonalise(M, E);
  if (found === null) return null;
  const { e, basis } = found;
  const N = e.length;
  const columns = square(N, (i, j) => basis[j][i]);
  const HB = columns.map((b) => times(load, b));
  const H = square(N, (i, j) => dot(columns[i], HB[j]));
  const relative = square(N, (i, j) => H[i][j] / Math.sqrt(e[i] * e[j])); // beside the elastic energies
  const most = (entry) => Math.max(...relative.map((row, i) => Math.max(...row.map((x, j) => Math.abs(entry(x, i, j))))));
  const conservative = most((x, i, j) => x - relative[j][i]) <= 1e-13 * most((x) => x);
  return { N, e, root: e.map(Math.sqrt), basis, H, conservative, divergences: divergencesOf(relative, conservative) };
}

/** Where det(E + P H) = 0 for real P > 0, ascending. Two roots are one event where E + P H between them is singular but
 * for rounding: a touch of λ = 0. */
function divergencesOf(relative, conservative) {
  const n = relative.length;
  const A = square(n, (i, j) => (conservative ? -(relative[i][j] + relative[j][i]) / 2 : -relative[i][j]));
  const found = new EigenvalueDecomposition(new Matrix(A), { assumeSymmetric: conservative });
  const all = found.realEigenvalues.map((re, k) => ({ re, im: found.imaginaryEigenvalues[k] }));
  const rounding = 1e-14 * Math.max(...all.map(({ re, im }) => Math.hypot(re, im)));
  const mu = all.filter(({ re, im }) => Math.abs(im) <= CLOSE * re && re > rounding).sort((x, y) => y.re - x.re);
  const norm = new SingularValueDecomposition(new Matrix(relative)).diagonal[0];
  const events = [];
  while (mu.length) {
    const [first, second] = mu;
    const isClose = second?.re > (1 - CLOSE) * first.re;
    const middle = isClose ? divergenceAt(relative, 2 / (first.re + second.re)) : null;
    const isTouch = isClose && middle.least <= SINGULAR * (1 + middle.load * norm);
    if (isTouch) events.push({ ...middle, simple: false });
    else if (first.im === 0) events.push({ ...divergenceAt(relative, 1 / first.re), simple: true });
    mu.splice(0, isTouch ? 2 : 1);
  }
  return events;
}

/** The divergence near a load, by one step of Newton's method: the eigenvalue knew it to the norm of H only. */
function divergenceAt(relative, near) {
  const A = new Matrix(square(relative.length, (i, j) => (i === j ? 1 : 0) + near * relative[i][j]));
  const { leftSingularVectors: U, rightSingularVectors: V, diagonal } = new SingularValueDecomposition(A);
  const last = diagonal.length - 1;
  const [u, v] = [U.getColumn(last), V.getColumn(last)];
  const least = diagonal[last];
  const slope = dot(u, times(relative, v));
  const load = least < CLOSE * Math.abs(slope * near) ? near - least / slope : near;
  return { load, omega: 0, kind: "divergence", least };
}

/** c_M and c_E of C = c_M M + c_E E, Eq. (12). */
function dampingFactors(pencil, alpha, beta) {
  return kernel.damping_factors(alpha, beta, pencil.own);
}

/** C = size · diag(shape). Without damping the limit at β = κα still has a shape; κ = Infinity is that of none. */
function dampingOf(pencil, alpha, beta, kappa = Infinity) {
  const [cM, cE] = dampingFactors(pencil, alpha, beta);
  const { e } = pencil;
  if (cM || cE) {
    const size = cE * e[0] + cM;
    return { size, ratio: size / Math.sqrt(e[0]), shape: e.map((x) => (cE * x + cM) / size), limit: false };
  }
  if (kappa === Infinity) return undamped(pencil);
  return { size: 0, ratio: 0, shape: e.map((x) => (x + kappa) / (e[0] + kappa)), limit: true };
}

function undamped({ e }) {
  return { size: 0, ratio: 0, shape: e.map(() => 1), limit: false };
}

/** Complex eigenvectors from the real columns of ml-matrix: a pair of columns is real and imaginary part. */
function complexColumns(found, rows) {
  const im = found.imaginaryEigenvalues;
  const V = found.eigenvectorMatrix;
  return im.map((value, k) => {
    const re = value < 0 ? k - 1 : k;
    const sign = value > 0 ? 1 : value < 0 ? -1 : 0;
    const other = value > 0 ? k + 1 : k;
    return {
      re: Float64Array.from({ length: rows }, (_, i) => V.get(i, re)),
      im: Float64Array.from({ length: rows }, (_, i) => (sign ? sign * V.get(i, other) : 0)),
    };
  });
}

function undampedMatrix(pencil, P) {
  const { N, e, H } = pencil;
  const A = Matrix.zeros(N, N);
  for (let i = 0; i < N; i++) for (let j = 0; j < N; j++) A.set(i, j, (i === j ? e[i] : 0) + P * H[i][j]);
  return A;
}

/** State matrix of (Ω q, q̇), Eq. (25), with Ω = √diag(e): nearly skew, so that no balancing is needed. */
function stateMatrix(pencil, damping, P) {
  const { N, root, H } = pencil;
  const A = Matrix.zeros(2 * N, 2 * N);
  for (let i = 0; i < N; i++) {
    A.set(i, N + i, root[i]);
    for (let j = 0; j < N; j++) A.set(N + i, j, -((i === j ? root[i] : 0) + (P * H[i][j]) / root[j]));
    A.set(N + i, N + i, -damping.size * damping.shape[i]);
  }
  return A;
}

let lastState = { pencil: null, damping: null, P: NaN, found: null };

/** Eigenvalues and eigenvectors of the state matrix; the last ones are kept, since modes and response share them. */
function stateDecomposition(pencil, damping, P) {
  if (lastState.pencil !== pencil || lastState.damping !== damping || lastState.P !== P) {
    const found = new EigenvalueDecomposition(stateMatrix(pencil, damping, P), { assumeSymmetric: false });
    lastState = { pencil, damping, P, found };
  }
  return lastState.found;
}

/** λ (2N) with their motions q in the basis of the pencil, sorted by |Im|, then falling Re, then falling Im. */
function spectrumOf(pencil, damping, P) {
  const { N, root } = pencil;
  const modes = [];
  if (damping.size === 0) {
    const found = new EigenvalueDecomposition(undampedMatrix(pencil, P), { assumeSymmetric: false });
    const vectors = complexColumns(found, N);
    found.realEigenvalues.forEach((s, k) => {
      const [re, im] = squareRoot(-s, -found.imaginaryEigenvalues[k]);
      modes.push({ re, im, q: vectors[k] }, { re: -re, im: -im, q: vectors[k] });
    });
  } else {
    const found = stateDecomposition(pencil, damping, P);
    complexColumns(found, N).forEach((u, k) => {
      const q = { re: u.re.map((x, i) => x / root[i]), im: u.im.map((x, i) => x / root[i]) };
      modes.push({ re: found.realEigenvalues[k], im: found.imaginaryEigenvalues[k], q });
    });
  }
  const size = Math.max(...modes.map((mode) => Math.hypot(mode.re, mode.im)));
  const step = (mode) => Math.round(Math.abs(mode.im) / (size * 1e-13));
  return modes.sort((a, b) => step(a) - step(b) || b.re - a.re || b.im - a.im);
}

function squareRoot(re, im) {
  const size = Math.hypot(re, im);
  if (size === 0) return [0, 0];
  const a = Math.sqrt((size + Math.abs(re)) / 2);
  const b = im / (2 * a);
  if (re >= 0) return [a, b];
  return [Math.abs(b), im < 0 ? -a : a];
}
