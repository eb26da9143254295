// What the page asks of a case, beside its state at one load; done in a worker where there are workers.

const SHOWN = 4; // branches in the plots

let lastPencil = { key: "", pencil: null, undamped: null };

function pencilKept(N, own) {
  const key = JSON.stringify([N, own]);
  if (lastPencil.key !== key) lastPencil = { key, pencil: pencilOf(N, own), undamped: null };
  return lastPencil;
}

/** Undamped: curves ω²(P), their first loss of stability, and the spectrum along the load. */
function undampedPart(kept, range) {
  if (kept.undamped?.range !== range) {
    const { pencil } = kept;
    const { crossing } = firstLoss(pencil, undamped(pencil));
    const states = follow(undampedNode(pencil), range, crossing);
    kept.undamped = { range, crossing, curves: frequencyCurves(states, SHOWN), locus: rootLocus(states, true, SHOWN) };
  }
  return kept.undamped;
}

/** The limit of vanishing damping at the ratio of this case: where P s′ − s = κ. Without damping, κ = 0. */
function tangentOf(pencil, column, alpha, beta) {
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
  const { curves, crossing, locus } = undampedPart(kept, range);
  const damping = dampingOf(pencil, alpha, beta);
  const critical = damping.size === 0 ? crossing : firstLoss(pencil, damping).crossing;
  const isLight = damping.ratio < LIGHTEST;
  return {
    sound: true,
    critical,
    undamped: crossing,
    tangent: tangentOf(pencil, column, alpha, beta),
    curves,
    locus: isLight ? locus : rootLocus(follow(dampedNode(pencil, damping), range, critical), false, SHOWN),
  };
}
