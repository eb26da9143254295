// The state at one load: its modes, the one least stable, the shape of its motion and the sensor's response.

const PLACES = 121; // along the beam, for drawing

/** The trial functions at the places of a drawing, a list for each place. Eq. (22). */
function drawingShapes({ N, functions }) {
  const values = kernel.shapes(functions, Array.from({ length: PLACES }, (_, k) => k / (PLACES - 1)));
  return Array.from({ length: PLACES }, (_, k) => Float64Array.from({ length: N }, (_, i) => values[i * PLACES + k]));
}

/** Eigenvalues with Im λ ≥ 0, whether any grows, and the one that is least stable. */
function stateAt(pencil, damping, P) {
  const modes = spectrumOf(pencil, damping, P);
  const largest = Math.max(...modes.map((mode) => Math.hypot(mode.re, mode.im)));
  const upper = modes.filter((mode) => mode.im >= 0 && !(mode.im === 0 && damping.size === 0 && mode.re < 0));
  const rounding = 1e-9 * largest;
  const least = upper.reduce((x, y) => (y.re > x.re + (y.im > x.im ? rounding : 0) ? y : x));
  // close to the boundary the count decides that the critical load rests on
  const sure = damping.ratio >= LIGHTEST && Math.abs(least.re) > 1e-6 * largest;
  const growing = sure ? least.re > 0 : isGrowing(pencil, damping, P);
  return { upper, least, growing, number: numberOf(least) };
}

/** The mode of the unloaded beam that has the greatest part in a motion, numbered from 1. */
function numberOf({ q }) {
  const share = q.re.map((x, i) => Math.hypot(x, q.im[i]));
  return share.indexOf(Math.max(...share)) + 1;
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

/** The motion of a mode along the beam: real and imaginary part, the largest deflection 1. */
function motionOf(pencil, mode, shapes) {
  const q = aligned(mode.q);
  const re = times(pencil.basis, q.re);
  const im = times(pencil.basis, q.im);
  const along = (values) => shapes.map((shape) => dot(values, shape));
  const motion = { re: along(re), im: along(im) };
  const size = Math.max(...motion.re.map((x, i) => Math.hypot(x, motion.im[i])));
  const sign = motion.re[PLACES - 1] < 0 ? -1 : 1;
  const scaled = (values) => values.map((x) => (sign * x) / size);
  return { re: scaled(motion.re), im: scaled(motion.im), growth: mode.re, omega: mode.im };
}

/**
 * Deflection at a sensor after release from rest in the first mode of the unloaded beam, its largest coordinate 0.01.
 * Eqs. (9), (10).
 * The state is a sum of e^(λt) over the eigenvectors; it ends where it has grown a thousandfold.
 */
function responseAt(pencil, damping, P, place, duration, count = 700) {
  const { N, root, basis } = pencil;
  const found = stateDecomposition(pencil, damping, P);
  const V = new LuDecomposition(found.eigenvectorMatrix);
  // eigenvectors of a coalescence to the last digit are no basis; beside it they are
  if (V.isSingular()) return responseAt(pencil, damping, P * (1 + 1e-9) + 1e-9, place, duration, count);
  const first = Math.max(...basis.map((row) => Math.abs(row[0])));
  const initial = [(0.01 / first) * Math.sign(basis[0][0]) * root[0], ...Array(2 * N - 1).fill(0)];
  const c = V.solve(Matrix.columnVector(initial)).to1DArray();
  const sensor = kernel.shapes(pencil.functions, [place]);
  const weights = root.map((w, i) => dot(sensor, basis.map((row) => row[i])) / w);
  const parts = responseParts(found, c, weights);
  const growth = Math.max(...parts.map((part) => part.re));
  const end = growth > 0 ? Math.min(duration, Math.log(1000) / growth) : duration;
  const t = Float64Array.from({ length: count }, (_, i) => (end * i) / (count - 1));
  const y = new Float64Array(count);
  for (const part of parts) addPart(y, part, end / (count - 1));
  return { t, y };
}

/** Each real eigenvalue or conjugate pair as e^(re t) (cosine cos + sine sin)(im t) at the sensor. */
function responseParts(found, c, weights) {
  const V = found.eigenvectorMatrix;
  const seen = (k) => weights.reduce((sum, weight, i) => sum + weight * V.get(i, k), 0);
  const parts = [];
  found.imaginaryEigenvalues.forEach((im, k) => {
    const re = found.realEigenvalues[k];
    if (im === 0) parts.push({ re, im, cosine: c[k] * seen(k), sine: 0 });
    if (im <= 0) return;
    const [x, y] = [seen(k), seen(k + 1)];
    parts.push({ re, im, cosine: c[k] * x + c[k + 1] * y, sine: c[k + 1] * x - c[k] * y });
  });
  return parts;
}

/** Adds a part at even steps of time, each from the one before. */
function addPart(y, { re, im, cosine, sine }, step) {
  const size = Math.exp(re * step);
  const [a, b] = [size * Math.cos(im * step), size * Math.sin(im * step)];
  for (let i = 0; i < y.length; i++) {
    y[i] += cosine;
    [cosine, sine] = [a * cosine + b * sine, a * sine - b * cosine];
  }
}
