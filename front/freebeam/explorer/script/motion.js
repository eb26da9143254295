// The state at one load: its modes, the one least stable and the shape of its motion.

const PLACES = 121; // along the beam, for drawing

/** What the problem's coordinates are at the places of a drawing, a list for each place. Eq. (22). */
function drawingShapes(problem, column) {
  const places = Array.from({ length: PLACES }, (_, k) => k / (PLACES - 1));
  if (!column.links) return seenAt(problem, places, 0);
  // a chain of equal rigid links, each coordinate the angle of one
  const angles = Array.from({ length: column.links }, (_, k) => seenAt(problem, [0], k)[0]);
  const part = (x, k) => Math.min(1 / column.links, Math.max(0, x - k / column.links));
  return places.map((x) => angles.reduce((sum, q, k) => sum.map((y, i) => y + part(x, k) * q[i]), new Float64Array(problem.n)));
}

/** Eigenvalues with Im λ ≥ 0, whether any grows, and the one that is least stable. */
function stateAt(pencil, damping, P) {
  const modes = modesAt(pencil, damping, P);
  const largest = Math.max(...modes.map((mode) => Math.hypot(mode.re, mode.im)));
  const upper = modes.filter((mode) => mode.im >= 0 && !(mode.im === 0 && damping.size === 0 && mode.re < 0));
  const rounding = 1e-9 * largest;
  const least = upper.reduce((x, y) => (y.re > x.re + (y.im > x.im ? rounding : 0) ? y : x));
  // close to the boundary the count decides that the critical load rests on
  const sure = damping.ratio >= LIGHTEST && Math.abs(least.re) > 1e-6 * largest;
  // at smaller loads than the smallest that are looked at, K may be singular
  const isSmallest = pencil.general && P <= (1e-4 / 8) * pencil.unit;
  const growing = isSmallest ? false : sure ? least.re > 0 : isGrowing(pencil, damping, P);
  return { upper, least, growing, number: pencil.general && !pencil.numbered ? null : numberOf(least) };
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
function motionOf(mode, shapes) {
  const q = aligned(mode.q);
  const along = (values) => shapes.map((shape) => dot(values, shape));
  const motion = { re: along(q.re), im: along(q.im) };
  const size = Math.max(...motion.re.map((x, i) => Math.hypot(x, motion.im[i]))) || 1;
  const sign = motion.re[PLACES - 1] < 0 ? -1 : 1;
  const scaled = (values) => values.map((x) => (sign * x) / size);
  return { re: scaled(motion.re), im: scaled(motion.im), growth: mode.re, omega: mode.im };
}
