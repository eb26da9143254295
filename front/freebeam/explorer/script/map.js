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
  const [n, m] = axes.map((axis) => axis.values.length);
  let [last, problem] = [null, null];
  for (const stride of [8, 4, 2, 1]) {
    for (let j = 0; j < m; j += stride) {
      for (let i = 0; i < n; i += stride) {
        if (!Number.isNaN(cells[j * n + i])) continue;
        const at = { P: 0, alpha, beta, [axes[0].key]: axes[0].values[i], [axes[1].key]: axes[1].values[j] };
        const here = Object.fromEntries(owned.map(({ key, name }) => [name, at[key] ?? own[name]]));
        const key = JSON.stringify(here);
        if (key !== last) [last, problem] = [key, problemAt(N, here)];
        cells[j * n + i] = cellOf(problem, at, axes.some((axis) => axis.key === "P"));
        yield;
      }
    }
  }
}

function cellOf(problem, { alpha, beta, P }, isLoad) {
  if (!problem.sound) return UNSOUND;
  const damping = dampingAt(problem, alpha, beta);
  if (damping.grows) return UNSOUND;
  if (isLoad) {
    const fastest = P > 0 ? fastestAt(problem, damping, P) : { growth: 0 };
    return fastest.growth > 0 ? (fastest.omega > 0 ? 1 : 2) : 0;
  }
  const crossing = lossOf(problem, damping, 1e-7);
  return crossing === null ? Infinity : (crossing?.load ?? NaN);
}
