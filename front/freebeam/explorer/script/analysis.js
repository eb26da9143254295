// What the page asks of a case, beside its state at one load; done in a worker where there are workers.

const SHOWN = 4; // branches in the plots

let lastPencil = { key: "", pencil: null, undamped: null };

function pencilKept(column, N, own) {
  const key = JSON.stringify([N, own]);
  if (lastPencil.key !== key) lastPencil = { key, pencil: pencilOf(column, N, own), undamped: null };
  return lastPencil;
}

/** Remembers nodes by their load, so that the search and the plots share them. */
function remembered(compute) {
  const known = new Map();
  return (P) => {
    if (!known.has(P)) known.set(P, compute(P));
    return known.get(P);
  };
}

/** Undamped: curves ω²(P), their first loss of stability, and the spectrum along the load. */
function undampedPart(kept, range) {
  if (!kept.undamped) {
    const { pencil } = kept;
    const none = { size: 0, ratio: 0, shape: pencil.e.map(() => 1), limit: false };
    const at = remembered((P) => lightNode(pencil, none, P));
    const crossing = brief(firstCrossing(pencil, none, range, LOAD_MAX, at));
    const states = follow(at, range, crossing);
    const curves = frequencyCurves(states, SHOWN);
    kept.undamped = { range, curves, crossing, locus: rootLocus(states, true, SHOWN) };
  }
  if (kept.undamped.range !== range) {
    kept.undamped = null;
    return undampedPart(kept, range);
  }
  return kept.undamped;
}

function brief(crossing) {
  return crossing && { load: crossing.load, omega: crossing.omega, kind: crossing.kind };
}

/** The limit of vanishing damping at the ratio of this case: where P s′ − s = κ. Without damping, κ = 0. */
function tangentOf(pencil, column, alpha, beta, range) {
  if (!column.damping.includes("alpha")) return null;
  const [cM, cE] = dampingFactors(pencil, alpha, beta);
  if (cM > 0 && cE === 0) return null;
  const kappa = cE > 0 ? cM / cE : 0;
  const [zeroM, zeroE] = dampingFactors(pencil, 0, 0);
  if (zeroM || zeroE) return null;
  const found = firstCrossing(pencil, dampingOf(pencil, 0, 0, kappa), range);
  return found && found.kind === "flutter" ? { ...brief(found), kappa } : null;
}

/** Critical load, curves and root locus of a case. */
function analyse(column, { N, own, alpha, beta, range }) {
  const kept = pencilKept(column, N, own);
  const { pencil } = kept;
  if (!pencil.sound) return { sound: false };
  const { curves, crossing, locus } = undampedPart(kept, range);
  const damping = dampingOf(pencil, alpha, beta);
  const light = damping.ratio < LIGHTEST;
  const at = remembered((P) => nodeAt(pencil, damping, P));
  const found = damping.size === 0 ? crossing : firstCrossing(pencil, damping, range, LOAD_MAX, at);
  return {
    sound: true,
    critical: brief(found),
    solution: found?.a ? found : null,
    undamped: crossing,
    tangent: tangentOf(pencil, column, alpha, beta, range),
    curves,
    locus: light ? locus : rootLocus(follow(at, range, found), false, SHOWN),
  };
}
