// The stability map: critical load over the dampings, cell by cell, coarse first.

/** The dampings of a map's cells: zero, then even steps on a logarithmic scale. */
function dampingAxis(known, { low, high, decade }) {
  if (!known) return [0];
  const steps = Math.round((high - low) * decade);
  return [0, ...Array.from({ length: steps + 1 }, (_, k) => 10 ** (low + ((high - low) * k) / steps))];
}

function mapAxes(column) {
  return {
    alpha: dampingAxis(column.damping.includes("alpha"), { low: -6, high: 0, decade: 6 }),
    beta: dampingAxis(column.damping.includes("beta"), { low: -3, high: 2, decade: 6 }),
  };
}

/** Fills `loads` (alpha fastest; Infinity: none up to the limit, NaN: not computed), and yields after each cell. */
function* mapCells(pencil, axes, loads) {
  const [n, m] = [axes.alpha.length, axes.beta.length];
  for (const stride of [8, 4, 2, 1]) {
    for (let j = 0; j < m; j += stride) {
      for (let i = 0; i < n; i += stride) {
        if (!Number.isNaN(loads[j * n + i])) continue;
        const { crossing } = firstLoss(pencil, dampingOf(pencil, axes.alpha[i], axes.beta[j]));
        loads[j * n + i] = crossing === null ? Infinity : (crossing?.load ?? NaN);
        yield;
      }
    }
  }
}
