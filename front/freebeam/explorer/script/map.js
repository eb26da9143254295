// The stability map: over any two parameters the critical load, or, where one of them is the load, what the motion does.
// Cell by cell, coarse first.

const VERDICTS = ["stable", "flutter", "divergence"]; // of a map whose axis is the load, by their numbers
const UNSOUND = -1; // no first loss: the column is not stable at the smallest loads

/** The values of an axis: of a damping zero, then even steps of its logarithm; else even steps. */
function axisOf({ key, scale, decades, low, high }, range, isGeneral, isLoad) {
  if (scale === "decades") {
    const [first, last] = decades;
    const steps = Math.round((last - first) * (isLoad ? 8 : isGeneral ? 3 : 6));
    return { key, log: true, values: [0, ...Array.from({ length: steps + 1 }, (_, k) => 10 ** (first + ((last - first) * k) / steps))] };
  }
  const [from, to] = key === "P" ? [0, range] : [low, high];
  const steps = isLoad ? 48 : isGeneral ? 16 : 24; // a cell is one set of eigenvalues, or a search
  return { key, log: false, values: Array.from({ length: steps + 1 }, (_, k) => from + ((to - from) * k) / steps) };
}

/** Fills `cells` (x fastest; Infinity: no loss up to the limit, NaN: not computed, UNSOUND), and yields after each cell. */
function* mapCells({ N, own, alpha, beta }, axes, owned, cells) {
  const counts = axes.map((axis) => axis.values.length);
  const isLoad = axes.some((axis) => axis.key === "P");
  const losses = [];
  const caseAt = casesKept(N, own, owned);
  const inner = axes[1].key === "P" ? 1 : 0; // along the load the column stays the same
  for (const stride of [8, 4, 2, 1]) {
    for (let j = 0; j < counts[1 - inner]; j += stride) {
      for (let i = 0; i < counts[inner]; i += stride) {
        const [x, y] = inner ? [j, i] : [i, j];
        const cell = y * counts[0] + x;
        if (!Number.isNaN(cells[cell])) continue;
        const at = { P: 0, alpha, beta, [axes[0].key]: axes[0].values[x], [axes[1].key]: axes[1].values[y] };
        const { problem, damping } = caseAt(at);
        if (!damping || damping.grows) cells[cell] = UNSOUND;
        else if (isLoad) cells[cell] = verdictAt(problem, damping, at.P);
        else {
          const near = stride < 8 && problem.general ? between(losses, [x, y], stride, counts) : null;
          losses[cell] = (near && followedLoss(problem, damping, near)) ?? lossOf(problem, damping, 1e-7);
          cells[cell] = losses[cell] === null ? Infinity : (losses[cell]?.load ?? NaN);
        }
        yield;
      }
    }
  }
}

/** The problem and the damping of a case of the map, where the problem is sound; the last of each column are kept. */
function casesKept(N, own, owned) {
  const problems = new Map();
  return ({ alpha, beta, ...at }) => {
    const here = Object.fromEntries(owned.map(({ key, name }) => [name, at[key] ?? own[name]]));
    const keys = [JSON.stringify(here), JSON.stringify([alpha, beta])];
    if (!problems.has(keys[0])) problems.set(keys[0], { problem: problemAt(N, here), key: "", damping: null });
    const kept = problems.get(keys[0]);
    if (kept.problem.sound && kept.key !== keys[1]) Object.assign(kept, { key: keys[1], damping: dampingAt(kept.problem, alpha, beta) });
    return kept;
  };
}

/** The mean of the losses of neighbours known from the stride before, where they are of one kind; else null. */
function between(losses, [x, y], stride, [n, m]) {
  const beside = (k, count) => (k % (2 * stride) ? [k - stride, k + stride] : [k]).filter((place) => place < count);
  const near = beside(y, m).flatMap((j) => beside(x, n).map((i) => losses[j * n + i]));
  if (!near.every((loss) => loss && loss.kind === near[0].kind)) return null;
  const mean = (key) => near.reduce((sum, loss) => sum + loss[key], 0) / near.length;
  return { kind: near[0].kind, load: mean("load"), omega: mean("omega") };
}

/** What the motion does at a load, as a number of VERDICTS. */
function verdictAt(problem, damping, P) {
  const fastest = P > 0 ? fastestAt(problem, damping, P) : { growth: 0 };
  return fastest.growth > 0 ? (fastest.omega > 0 ? 1 : 2) : 0;
}
