// Columns of any damping: M(P) q̈ + C(P) q̇ + K(P) q = 0, each matrix a polynomial in the load and none symmetric, as in
// freebeam_sym/stability/general.py. losses.js looks for their first loss of stability.

const GROWTH = 1e-13; // as in general.py: Re 1/λ, relative to the greatest |1/λ|, from which an eigenvalue grows
const SPLIT = 1e-7; // as there: relative, where eigenvalues stay on the axis and rounding splits two that meet by its root
const LIGHT = 1e-5; // damping ratio of the first modes below which growth is taken to first order: its square is below 1e-9
const BASES = [0, 0.01, 0.0371, 0.293]; // loads of which the first with a regular K is taken, as there

/** Everything of a column at N functions and own parameters that does not depend on load and damping. */
function generalOf(N, own) {
  try {
    return { sound: true, general: true, own, ...generalMatrices(N, own) };
  } catch (error) {
    if (error instanceof RangeError) return { sound: false, why: error.message };
    throw error;
  }
}

function generalMatrices(N, own) {
  const functions = kernel.basis(N);
  const all = functions.size;
  const split = (values) => Array.from({ length: values.length / all ** 2 }, (_, k) =>
    new Matrix(square(all, (i, j) => values[(k * all + i) * all + j])));
  const rates = (alpha, beta) => split(kernel.rate_terms(functions, alpha, beta, own));
  const given = { M: split(kernel.mass_terms(functions, own)), K: split(kernel.stiffness_terms(functions, own)) };
  const T = ownFrame(functions, own, given);
  const moved = (terms) => terms.map((X) => T.transpose().mmul(X).mmul(T));
  const [M, K, C] = [moved(given.M), moved(given.K), moved(rates(0, 0))];
  const of = (terms) => moved(terms).map((X, k) => X.sub(C[k]));
  const problem = { N, n: T.columns, functions, M, K, C, ofAlpha: of(rates(1, 0)), ofBeta: of(rates(0, 1)), basis: T };
  problem.massless = withoutMass(M[0]);
  inModes(problem);
  problem.basis = problem.basis.to2DArray();
  const { n } = problem;
  const base = BASES.find((P) => new SingularValueDecomposition(termsAt(problem.K, P, n)).condition < 1e13);
  if (base === undefined) throw new RangeError("the stiffness is singular at every load");
  const roots = rootsOf(problem.K, base, n);
  const sizes = roots.map(({ re, im }) => Math.hypot(re, im)).filter((size) => size > 1e-6 * base);
  problem.unit = Math.min(LOAD_MAX / 256, ...sizes);
  problem.divergences = roots.filter(({ re, im }) => Math.abs(im) <= CLOSE * re && re > 1e-7 * problem.unit)
    .map(({ re }) => polished(problem, re)).filter((load) => load !== null).sort((x, y) => x - y);
  problem.rest = base ? problem.unit / 4 : 0; // what nothing holds without load has its first mode under some
  problem.first = Math.sqrt(Math.min(...branchesAt(problem, problem.rest).s.map(({ re, im }) => Math.hypot(re, im))));
  problem.root ??= Array(n).fill(problem.first);
  if (problem.massless) reducedNode(problem, problem, problem.unit / 8); // refuses a motion that is not determined
  return problem;
}

/** To the modes of the unloaded column, where M = 1 and K₀ = diag(ω²), if there are such: M and K₀ are symmetric and positive. */
function inModes(problem) {
  const { M, K, C, ofAlpha, ofBeta, n } = problem;
  const isSymmetric = (X) => X.clone().sub(X.transpose()).norm() <= 1e-14 * X.norm();
  if (problem.massless || M.length > 1 || !isSymmetric(M[0]) || !isSymmetric(K[0])) return;
  const even = (X) => Matrix.add(X, X.transpose()).mul(0.5).to2DArray();
  const found = diagonalise(even(M[0]), even(K[0]));
  if (found === null) return;
  const V = new Matrix(found.basis);
  const moved = (terms) => terms.map((X) => V.transpose().mmul(X).mmul(V));
  Object.assign(problem, { C: moved(C), ofAlpha: moved(ofAlpha), ofBeta: moved(ofBeta), basis: problem.basis.mmul(V) });
  Object.assign(problem, { M: [Matrix.eye(n)], K: [Matrix.diag(found.e), ...moved(K.slice(1))], root: Array.from(found.e, Math.sqrt), numbered: true });
}

/** Σ P^k X_k, (n, n). */
function termsAt(terms, P, n) {
  const sum = Matrix.zeros(n, n);
  for (let k = terms.length - 1; k >= 0; k--) sum.mul(P).add(terms[k]);
  return sum;
}

function slopeAt(terms, P, n) {
  return termsAt(terms.slice(1).map((X, k) => Matrix.mul(X, k + 1)), P, n);
}

/** The functions of a problem in those of the kernel: without the rigid motions and M-orthogonal to them, as
 * `Column.frame` has them, then scaled so that the diagonal of K is about 1. */
function ownFrame(functions, own, { M, K }) {
  const n = functions.size;
  let T = Matrix.eye(n);
  if (kernel.rigid_motions) {
    const values = kernel.rigid_motions(functions, own);
    const r = values.length / n;
    const R = new Matrix(square(n, (i) => 0).map((_, i) => [...values.subarray(i * r, (i + 1) * r)]));
    const dropped = pivotsOf(R);
    const others = new Matrix(square(n, (i, j) => (i === j ? 1 : 0))).subMatrixColumn(
      Array.from({ length: n }, (_, i) => i).filter((i) => !dropped.includes(i)));
    const RM = R.transpose().mmul(M[0]);
    T = others.sub(R.mmul(new LuDecomposition(RM.mmul(R)).solve(RM.mmul(others))));
  }
  const diagonal = (X) => Array.from({ length: T.columns }, (_, j) => {
    const column = T.subMatrixColumn([j]);
    return column.transpose().mmul(X).mmul(column).get(0, 0);
  });
  const mass = diagonal(M[0]).map(Math.abs);
  const stiff = K.map(diagonal).reduce((sum, values) => values.map((x, i) => sum[i] + Math.abs(x)), mass.map(() => 0));
  const rate = stiff.map((x, i) => (mass[i] > 0 ? x / mass[i] : Infinity));
  const largest = Math.max(0, ...rate.filter(Number.isFinite));
  const least = Math.min(...rate.filter((x) => x > 1e-13 * largest), Infinity);
  // a coordinate that only another restores has a diagonal of rounding alone
  const size = stiff.map((x, i) => (rate[i] < 1e-13 * largest || x === 0 ? mass[i] * (Number.isFinite(least) ? least : 1) : x));
  return T.mmul(Matrix.diag(size.map((x) => (x > 0 ? 1 / Math.sqrt(x) : 1))));
}

/** Rows that determine the columns of R, by elimination with the largest pivots. */
function pivotsOf(R) {
  const left = R.clone();
  const rows = [];
  for (let k = 0; k < R.columns; k++) {
    let best = [0, k];
    for (let i = 0; i < R.rows; i++) {
      for (let j = k; j < R.columns; j++) if (Math.abs(left.get(i, j)) > Math.abs(left.get(...best))) best = [i, j];
    }
    rows.push(best[0]);
    left.swapColumns(k, best[1]);
    for (let j = k + 1; j < R.columns; j++) {
      const factor = left.get(best[0], j) / left.get(best[0], k);
      for (let i = 0; i < R.rows; i++) left.set(i, j, left.get(i, j) - factor * left.get(i, k));
    }
  }
  return rows;
}

/** All P with det K(P) = 0 but those far away, from 1/(P − base) as eigenvalues. */
function rootsOf(K, base, n) {
  const shifted = K.map((_, k) => K.slice(k).reduce((sum, X, j) => sum.add(Matrix.mul(X, binomial(k + j, k) * base ** j)), Matrix.zeros(n, n)));
  const degree = K.length - 1;
  if (degree < 1) return [];
  const lu = new LuDecomposition(shifted[0]);
  const A = Matrix.zeros(n * degree, n * degree);
  shifted.slice(1).forEach((X, k) => A.setSubMatrix(lu.solve(X).mul(-1), 0, k * n));
  for (let i = n; i < n * degree; i++) A.set(i, i - n, 1);
  const { realEigenvalues, imaginaryEigenvalues } = new EigenvalueDecomposition(A, { assumeSymmetric: false });
  const largest = Math.max(...realEigenvalues.map((re, k) => Math.hypot(re, imaginaryEigenvalues[k])));
  return realEigenvalues.flatMap((re, k) => {
    const im = imaginaryEigenvalues[k];
    const size = re * re + im * im;
    return Math.sqrt(size) > 1e-10 * largest ? [{ re: base + re / size, im: -im / size }] : [];
  });
}

function binomial(n, k) {
  let value = 1;
  for (let i = 0; i < k; i++) value = (value * (n - i)) / (i + 1);
  return value;
}

/** A root of det K by Newton's method on its null vectors; null where K is not singular there but for rounding. */
function polished({ K, n }, near) {
  let load = near;
  for (let turn = 0; turn < 4; turn++) {
    const found = new SingularValueDecomposition(termsAt(K, load, n));
    const [u, v] = [found.leftSingularVectors.getColumn(n - 1), found.rightSingularVectors.getColumn(n - 1)];
    const along = (X) => dot(u, times(X.to2DArray(), v));
    const change = along(termsAt(K, load, n)) / along(slopeAt(K, load, n));
    if (turn === 3) return found.diagonal[n - 1] <= 100 * SINGULAR * found.diagonal[0] ? load : null;
    if (Math.abs(change) < CLOSE * load) load -= change;
  }
  return load;
}

/** The damping of a case. size: 0 where there is none at all; ratio: of the first modes, Infinity where that says nothing;
 * below LIGHT growth is taken to first order. splits: share of an eigenvalue from which it grows. */
function generalDamping(problem, alpha, beta) {
  const { C, ofAlpha, ofBeta } = problem;
  const terms = C.map((X, k) => X.clone().add(Matrix.mul(ofAlpha[k], alpha)).add(Matrix.mul(ofBeta[k], beta)));
  const turns = C[0].clone().sub(C[0].transpose()).norm() > 1e-12 * C[0].norm(); // to first order rates that turn do nothing
  const moves = problem.massless || turns || terms.slice(1).some((X) => X.norm() > 0);
  const isDamped = moves || terms.some((X) => X.norm() > 0);
  const damping = { C: terms, size: isDamped ? 1 : 0, ratio: 0, splits: SPLIT };
  if (isDamped) {
    damping.ratio = moves ? Infinity : firstRatio((problem.rates ??= firstRates(problem)), [1, alpha, beta]) / problem.first;
    if (damping.ratio >= LIGHT) {
      const at = thetaAt(problem, damping, problem.unit * 1e-3);
      const isOnAxis = at.some(({ re, im }) => Math.abs(re) < 1e-10 * Math.hypot(re, im));
      damping.splits = isOnAxis ? SPLIT : 0;
    }
  }
  damping.grows = [1e-4, 1e-4 / 8].every((share) => isGrowing(problem, damping, problem.unit * share));
  return damping;
}

function firstRatio(rates, sizes) {
  const acting = rates.filter((_, k) => sizes[k]);
  const factors = sizes.filter((size) => size);
  return Math.max(...acting[0].map((_, i) => Math.abs(acting.reduce((sum, rate, k) => sum + factors[k] * rate[i], 0))));
}

/** Growth of the lowest branches at a small load to first order in the column's own damping, in α and in β. */
function firstRates(problem) {
  const { C, ofAlpha, ofBeta, unit } = problem;
  return [C, ofAlpha, ofBeta].map((terms) => branchesAt(problem, unit * 1e-4, terms).growth.slice(0, 4));
}

/** Undamped branches s = ω², ascending in size, with their vectors and their growth to first order in a damping. */
function branchesAt({ M, K, n }, P, C = []) {
  const mass = termsAt(M, P, n);
  const lu = new LuDecomposition(termsAt(K, P, n));
  if (lu.isSingular()) return { s: [{ re: 0, im: 0 }], vectors: [], growth: [Infinity] };
  const found = new EigenvalueDecomposition(lu.solve(mass), { assumeSymmetric: false });
  const { realEigenvalues: re, imaginaryEigenvalues: im, eigenvectorMatrix: V } = found;
  const largest = Math.max(...re.map((x, k) => Math.hypot(x, im[k])));
  const vectors = complexColumns(found, n);
  const growth = C.length ? firstOrder(mass.mmul(V), termsAt(C, P, n).mmul(V)) : re.map(() => 0);
  const all = re.map((x, k) => {
    const size = x * x + im[k] * im[k];
    const isSplit = Math.abs(im[k]) > Math.max(SPLIT * Math.sqrt(size), GROWTH * largest);
    return {
      s: { re: x / size, im: -im[k] / size }, vector: vectors[k], off: isSplit || x <= 0, growth: growth[k], size: Math.sqrt(size),
    };
  }).filter(({ size }) => size > 1e-15 * largest).sort((x, y) => y.size - x.size);
  const least = GROWTH * Math.max(...all.map((one) => Math.abs(one.growth)));
  return {
    s: all.map((one) => one.s),
    vectors: all.map((one) => one.vector),
    growth: all.map((one) => (one.off ? Infinity : Math.abs(one.growth) > least ? one.growth : 0)),
  };
}

/** −wᵀCv/2 of each branch, where wᵀMv = 1. */
function firstOrder(MV, CV) {
  const lu = new LuDecomposition(MV);
  return lu.isSingular() ? CV.diagonal().map(() => Infinity) : lu.solve(CV).diagonal().map((x) => -x / 2);
}

/** The inverse A of the state matrix times ω₁, so that the low modes have their own digits in its eigenvalues θ = ω₁/λ, with
 * what makes the motion q of its vectors; null where K is singular. */
function inverseState(problem, { C }, P) {
  const { M, K, n, first } = problem;
  const [m, c, k] = [M, C, K].map((terms) => termsAt(terms, P, n));
  if (problem.massless) {
    const { A, states } = reduced(m, c, k);
    const lu = new LuDecomposition(A);
    const shapes = states.subMatrix(0, n - 1, 0, A.rows - 1).to2DArray();
    return lu.isSingular() ? null : { A: lu.solve(Matrix.eye(A.rows)).mul(first), motion: (x) => times(shapes, x) };
  }
  const lu = new LuDecomposition(k);
  if (lu.isSingular()) return null;
  const A = Matrix.zeros(2 * n, 2 * n); // on (θv, v)
  A.setSubMatrix(lu.solve(c).mul(-first), 0, 0);
  A.setSubMatrix(lu.solve(m).mul(-(first ** 2)), 0, n);
  for (let i = 0; i < n; i++) A.set(n + i, i, 1);
  return { A, motion: (x) => x.subarray(n) };
}

/** θ = ω₁/λ of all motions at a load; none where K is singular. */
function thetaAt(problem, damping, P) {
  const inverse = inverseState(problem, damping, P);
  if (!inverse) return [];
  const { realEigenvalues, imaginaryEigenvalues: im } = new EigenvalueDecomposition(inverse.A, { assumeSymmetric: false });
  return realEigenvalues.map((re, k) => ({ re, im: im[k] }));
}

/** Growth, up to a positive factor and 0 where there is none but rounding, and frequency of each motion. */
function generalGrowth(problem, damping, P) {
  if (damping.ratio < LIGHT) {
    const { s, growth } = branchesAt(problem, P, damping.size ? damping.C : []);
    return growth.map((x, k) => ({ growth: x, omega: Math.sqrt(Math.max(0, s[k].re)) }));
  }
  const all = thetaAt(problem, damping, P);
  if (!all.length) return [{ growth: Infinity, omega: 0 }];
  const largest = Math.max(...all.map(({ re, im }) => Math.hypot(re, im)));
  return all.map((theta) => {
    const size = Math.hypot(theta.re, theta.im);
    const isGrowth = theta.re > Math.max(damping.splits * size, GROWTH * largest);
    return { growth: isGrowth ? theta.re : Math.min(0, theta.re), omega: (problem.first * Math.abs(theta.im)) / size ** 2, theta };
  });
}

/** λ with their motions q, as `spectrumOf` gives them. */
function generalSpectrum(problem, damping, P) {
  if (damping.size === 0) {
    const at = branchesAt(problem, P);
    const { s, vectors } = at.vectors.length ? at : branchesAt(problem, P * (1 + 1e-9) + 1e-9); // K is singular at P
    return s.flatMap(({ re: a, im: b }, k) => {
      const [re, im] = squareRoot(-a, -b);
      return [{ re, im, q: vectors[k] }, { re: -re, im: -im, q: vectors[k] }];
    });
  }
  const { first } = problem;
  const { A, motion } = inverseState(problem, damping, P) ?? inverseState(problem, damping, P * (1 + 1e-9) + 1e-9);
  const found = new EigenvalueDecomposition(A, { assumeSymmetric: false });
  const [a, b] = [found.realEigenvalues, found.imaginaryEigenvalues];
  return complexColumns(found, A.rows).map(({ re, im }, k) => {
    const size = a[k] ** 2 + b[k] ** 2;
    return { re: (first * a[k]) / size, im: (-first * b[k]) / size, q: { re: motion(re), im: motion(im) } };
  });
}

/** M⁻¹X at a load, and its slope there. */
function byMass({ M, n, numbered }, X, P) {
  if (numbered) return [termsAt(X, P, n), slopeAt(X, P, n)]; // M = 1
  const lu = new LuDecomposition(termsAt(M, P, n));
  const A = lu.solve(termsAt(X, P, n));
  return [A, lu.solve(slopeAt(X, P, n).sub(slopeAt(M, P, n).mmul(A)))];
}

/** The branches along the load with their slopes: s = ω² without damping, else λ. */
function generalNode(problem, damping) {
  if (damping.size === 0) return (P) => nodeOf(...byMass(problem, problem.K, P), P);
  if (problem.massless) return (P) => nodeOf(...reducedNode(problem, damping, P), P);
  return (P) => {
    const [k, c] = [byMass(problem, problem.K, P), byMass(problem, damping.C, P)];
    return nodeOf(stateOf(problem, k[0], c[0]), stateOf(problem, k[1], c[1], 0), P);
  };
}

/** The matrix of the states where some coordinate has no mass, and its slope by a difference quotient. */
function reducedNode({ M, K, n, unit }, { C }, P) {
  const at = (load) => reduced(...[M, C, K].map((terms) => termsAt(terms, load, n)));
  const step = 1e-6 * (P + unit);
  const [here, ahead] = [at(P), at(P + step)];
  const isSame = here.free.join() === ahead.free.join(); // else the slope says nothing, and steps are halved
  return [here.A, isSame ? Matrix.sub(ahead.A, here.A).div(step) : Matrix.zeros(here.A.rows, here.A.rows)];
}

/** The state matrix on (Ωq, q̇), Ω = diag(root), of k = M⁻¹K and c = M⁻¹C; or its slope, with unit = 0. */
function stateOf({ n, root }, k, c, unit = 1) {
  const A = Matrix.zeros(2 * n, 2 * n);
  for (let i = 0; i < n; i++) {
    A.set(i, n + i, unit * root[i]);
    for (let j = 0; j < n; j++) {
      A.set(n + i, j, -k.get(i, j) / root[j]);
      A.set(n + i, n + j, -c.get(i, j));
    }
  }
  return A;
}
