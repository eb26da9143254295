// Coordinates without mass, such as the state of a controller: M is singular and there are fewer than 2n states, as in
// freebeam_sym/massless.py. A combination of rows without accelerations is a relation of the states; its derivative
// takes the place of one of these rows, until all accelerations are known.

const NOTHING = 1e-12; // relative: what is left of a relation after elimination that is zero but for rounding

/** Whether some motion has no mass: M, symmetric, with 1 on its diagonal, is not positive definite but for rounding. */
function withoutMass(M) {
  const sizes = M.diagonal().map(Math.sqrt);
  if (!sizes.every((size) => size > 0)) return true;
  const factor = new CholeskyDecomposition(new Matrix(square(M.rows, (i, j) => (M.get(i, j) + M.get(j, i)) / (2 * sizes[i] * sizes[j]))));
  return !factor.isPositiveDefinite() || factor.lowerTriangularMatrix.diagonal().some((pivot) => pivot ** 2 < SINGULAR);
}

/**
 * A system with a singular M in the m states x that it has: x′ = A x + input(Q) F, and `states` (2n, m), (q, q̇) of x.
 *
 * free: which of (q, q̇) the states are. input: null where the force would act on a relation. Throws a RangeError where
 * the motion is not determined.
 */
function reduced(M, C, K) {
  const n = M.rows;
  const whole = Matrix.zeros(n, 4 * n); // M, C, K, and what of the rows given makes these
  [M, C, K, Matrix.eye(n)].forEach((part, k) => whole.setSubMatrix(part, 0, k * n));
  const [relations, idle] = [[], []];
  for (let u = noneOf(M); u; u = noneOf(whole.subMatrix(0, n - 1, 0, n - 1))) {
    const sum = Matrix.rowVector(u).mmul(whole).to1DArray();
    const [c, k] = [sum.slice(n, 2 * n), sum.slice(2 * n, 3 * n)];
    const terms = u.reduce((most, x, i) => Math.max(most, ...whole.getRow(i).slice(n, 3 * n).map((y) => Math.abs(x * y))), 0);
    if (relations.length === 2 * n || !(Math.max(...[...c, ...k].map(Math.abs)) > SINGULAR * terms)) {
      throw new RangeError("nothing moves or holds some coordinate without mass");
    }
    relations.push([...k, ...c]);
    idle.push(sum.slice(3 * n));
    const size = u.map(Math.abs);
    whole.setRow(size.indexOf(Math.max(...size)), [...c, ...k, ...Array(2 * n).fill(0)]);
  }
  const known = new LuDecomposition(whole.subMatrix(0, n - 1, 0, n - 1)).solve(whole.subMatrix(0, n - 1, n, 4 * n - 1));
  const { free, states } = statesOf(relations, M.diagonal().map((mass) => mass === 0));
  const rates = Matrix.zeros(2 * n, 2 * n); // (q̇, q̈) of (q, q̇)
  rates.setSubMatrix(Matrix.eye(n), 0, n);
  rates.setSubMatrix(known.subMatrix(0, n - 1, n, 2 * n - 1).mul(-1), n, 0);
  rates.setSubMatrix(known.subMatrix(0, n - 1, 0, n - 1).mul(-1), n, n);
  const input = (Q) => {
    const most = Math.max(...Q.map(Math.abs));
    if (idle.some((row) => Math.abs(dot(row, Q)) > NOTHING * Math.max(...row.map(Math.abs)) * most)) return null;
    const acceleration = times(known.subMatrix(0, n - 1, 2 * n, 3 * n - 1).to2DArray(), Q);
    return free.map((k) => (k < n ? 0 : acceleration[k - n]));
  };
  return { A: rates.mmul(states).subMatrixRow(free), states, free, input };
}

/** u with uᵀM = 0, its rows and columns brought to one size before; null where M is regular. */
function noneOf(M) {
  const largest = (values) => Math.max(...values.map(Math.abs)) || 1;
  const rows = M.to2DArray().map(largest);
  const even = Matrix.diag(rows.map((size) => 1 / size)).mmul(M);
  const columns = even.transpose().to2DArray().map(largest);
  const { leftSingularVectors: U, diagonal } = new SingularValueDecomposition(even.mmul(Matrix.diag(columns.map((size) => 1 / size))));
  const last = M.rows - 1;
  return diagonal[last] < SINGULAR * diagonal[0] ? U.getColumn(last).map((x, i) => x / rows[i]) : null;
}

/** Relations N (q, q̇) = 0 solved, what has no mass first, rates before q: which of (q, q̇) stay free, and all of these. */
function statesOf(relations, isMassless) {
  const n = isMassless.length;
  const left = relations.map((row) => row.map((x) => x / Math.max(...row.map(Math.abs))));
  const all = [...Array(n).keys()];
  const parts = [true, false].flatMap((bare) => [n, 0].map((from) => all.filter((k) => isMassless[k] === bare).map((k) => from + k)));
  const held = new Map(); // column to the row that tells it
  for (const part of parts) {
    for (;;) {
      let best = [NOTHING, -1, -1];
      left.forEach((row, i) => [...held.values()].includes(i) || part.forEach((k) => {
        if (Math.abs(row[k]) > best[0]) best = [Math.abs(row[k]), i, k];
      }));
      const [, pivot, column] = best;
      if (pivot < 0) break;
      held.set(column, pivot);
      left[pivot] = left[pivot].map((x) => x / left[pivot][column]);
      left.forEach((row, i) => {
        if (i !== pivot && row[column] !== 0) left[i] = row.map((x, k) => x - row[column] * left[pivot][k]);
      });
    }
  }
  const free = [...Array(2 * n).keys()].filter((k) => !held.has(k));
  const states = Matrix.zeros(2 * n, free.length);
  free.forEach((k, j) => states.set(k, j, 1));
  for (const [column, row] of held) free.forEach((k, j) => states.set(column, j, -left[row][k]));
  return { free, states };
}
