// What the page asks of a case, beside its state at one load; done in a worker where there are workers.

const SHOWN = 4; // branches in the plots

let lastPencil = { key: "", pencil: null, undamped: null };

function pencilKept(N, own) {
  const key = JSON.stringify([N, own]);
  if (lastPencil.key !== key) lastPencil = { key, pencil: problemAt(N, own), undamped: null };
  return lastPencil;
}

/** Without α and β: curves ω²(P), their first loss of stability, and the spectrum along the load. */
function undampedPart(kept, range) {
  if (kept.undamped?.range !== range) {
    const { pencil } = kept;
    const bare = pencil.general ? dampingAt(pencil, 0, 0) : undamped(pencil);
    const crossing = bare.grows ? { load: 0, omega: 0, kind: "at once" } : lossOf(pencil, bare);
    const isBare = bare.size === 0;
    const states = follow(nodesOf(pencil, bare), range, crossing);
    const locus = rootLocus(states, isBare, SHOWN);
    const curves = isBare ? frequencyCurves(states, SHOWN) : locus.map(squared);
    kept.undamped = { range, crossing, isBare, bare, curves, locus };
  }
  return kept.undamped;
}

/** −λ² of a branch λ, its real part, with `im` 0 where it decays. */
function squared({ load, re, im }) {
  return { load, re: re.map((x, k) => im[k] ** 2 - x ** 2), im: re.map((x, k) => (x > 1e-9 * Math.hypot(x, im[k]) ? 1 : 0)) };
}

/** The limit of vanishing damping at the ratio of this case: where P s′ − s = κ. Without damping, κ = 0. */
function tangentOf(pencil, column, alpha, beta) {
  if (pencil.general) return null; // its rule is that of C = αE + βM
  if (!column.damping.includes("alpha")) return null;
  const [cM, cE] = dampingFactors(pencil, alpha, beta);
  if (cM > 0 && cE === 0) return null;
  const kappa = cE > 0 ? cM / cE : 0;
  const [zeroM, zeroE] = dampingFactors(pencil, 0, 0);
  if (zeroM || zeroE) return null;
  const { crossing } = firstLoss(pencil, dampingOf(pencil, 0, 0, kappa));
  return crossing?.kind === "flutter" ? { ...crossing, kappa } : null;
}

/** Critical load, curves and root locus of a case. */
function analyse(column, { N, own, alpha, beta, range }) {
  const kept = pencilKept(N, own);
  const { pencil } = kept;
  if (!pencil.sound) return { sound: false };
  const damping = dampingAt(pencil, alpha, beta);
  if (damping.grows) return { sound: false };
  const { curves, crossing, locus, isBare } = undampedPart(kept, range);
  const isUndamped = damping.size === 0 || (pencil.general && !(alpha || beta));
  const critical = isUndamped ? crossing : lossOf(pencil, damping);
  const isLight = isUndamped || damping.ratio < LIGHTEST;
  return {
    sound: true,
    critical,
    undamped: crossing,
    isBare,
    tangent: tangentOf(pencil, column, alpha, beta),
    curves,
    locus: isLight ? locus : rootLocus(follow(nodesOf(pencil, damping), range, critical), false, SHOWN),
  };
}
