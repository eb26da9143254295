// The motion at a sensor in time, exact for the series but for rounding: a matrix exponential carries the state over a step.

const DRIVES = ["release", "step", "pulse", "sine"];
const SIZE = 0.01; // of a force, of the first coordinate or deflection released

/**
 * Deflection at the sensor after release from rest in the first mode of the unloaded column, or from rest under a force.
 *
 * drive: { kind, place, rate }: one of DRIVES, where the force acts, the frequency of a sine. seen, force: values of the
 * problem's coordinates at the sensor, and of a unit force; growth: the greatest Re λ. It ends where it has grown a thousandfold; it is
 * empty where the force would act on what has no mass. Eqs. (9), (10).
 */
function responseAt(problem, damping, P, { kind, rate, seen, force, release, growth }, duration, count = 700) {
  const { A: own, input, start, seen: weights } = statesAt(problem, damping, P, force);
  if (force && !input) return { t: [], y: [] };
  const m = own.rows;
  const A = Matrix.zeros(m + 2, m + 2);
  A.setSubMatrix(own, 0, 0);
  const end = growth > 0 ? Math.min(duration, Math.log(1000) / growth) : duration;
  const step = end / (count - 1);
  // the force is sin(rate t), or 1: the first of two states that turn at that rate, or rest
  if (force) input.forEach((x, i) => A.set(i, m, x));
  if (kind === "sine") A.setSubMatrix([[0, rate], [-rate, 0]], m, m);
  const carry = exponential(A.mul(step));
  let [state, next] = [new Float64Array(m + 2), new Float64Array(m + 2)];
  if (release) state.set(start(release));
  else state[m + (kind === "sine" ? 1 : 0)] = SIZE;
  const off = kind === "pulse" ? Math.round(pulseLength(problem) / step) : Infinity;
  const sensor = weights(seen);
  const t = Float64Array.from({ length: count }, (_, k) => k * step);
  const y = new Float64Array(count);
  for (let k = 0; k < count; k++) {
    if (k === off) state[m] = 0;
    for (let i = 0; i < m; i++) y[k] += sensor[i] * state[i];
    for (let i = 0, at = 0; i < m + 2; i++) {
      let sum = 0;
      for (let j = 0; j < m + 2; j++) sum += carry[at++] * state[j];
      next[i] = sum;
    }
    [state, next] = [next, state];
  }
  return { t, y };
}

/** A pulse lasts half a period of the first mode of the unloaded column. */
function pulseLength({ first }) {
  return Math.PI / first;
}

/** The first mode of the unloaded column: of a beam's modes its largest coordinate 0.01, else its largest deflection. */
function releasedFrom(problem, shapes) {
  if (!problem.general) {
    const first = problem.basis.map((row) => row[0]);
    const size = Math.max(...first.map(Math.abs));
    return Float64Array.from({ length: problem.n }, (_, i) => (i ? 0 : (SIZE / size) * Math.sign(first[0])));
  }
  const { vectors } = branchesAt(problem, problem.rest);
  const q = vectors.length ? vectors[0].re : new Float64Array(problem.n);
  const along = shapes.map((shape) => dot(shape, q));
  const largest = along.reduce((x, y) => (Math.abs(y) > Math.abs(x) ? y : x), 0);
  return largest ? q.map((x) => (SIZE * x) / largest) : q;
}

/** e^A by the Padé approximant of degree (6, 6), halved until it is small and squared again; row by row. */
function exponential(A) {
  const n = A.rows;
  const largest = Math.max(...A.to2DArray().map((row) => row.reduce((sum, x) => sum + Math.abs(x), 0)));
  const halvings = Math.max(0, Math.ceil(Math.log2(largest)) + 2);
  const X = Float64Array.from(A.to1DArray(), (x) => x * 2 ** -halvings);
  const unit = Float64Array.from(X, (_, k) => (k % (n + 1) ? 0 : 1));
  let [c, power] = [1, unit];
  const [over, under] = [unit.slice(), unit.slice()];
  for (let k = 1; k <= 6; k++) {
    c *= (7 - k) / (k * (13 - k));
    power = product(power, X, n);
    for (let i = 0; i < power.length; i++) {
      over[i] += c * power[i];
      under[i] += (k % 2 ? -c : c) * power[i];
    }
  }
  const full = (values) => Matrix.from1DArray(n, n, values);
  let found = Float64Array.from(new LuDecomposition(full(under)).solve(full(over)).to1DArray());
  for (let k = 0; k < halvings; k++) found = product(found, found, n);
  return found;
}

/** A product of two matrices that are stored row by row. */
function product(A, B, n) {
  const found = new Float64Array(n * n);
  for (let i = 0; i < n; i++) {
    for (let k = 0; k < n; k++) {
      const a = A[i * n + k];
      for (let j = 0; j < n; j++) found[i * n + j] += a * B[k * n + j];
    }
  }
  return found;
}
