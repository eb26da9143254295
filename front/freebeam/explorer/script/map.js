// The stability map: critical load over the dampings, cell by cell, coarse first, each from a neighbour's solution.

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

/** Fills `loads` (alpha fastest; Infinity: none up to the limit), and yields after each cell. */
function* mapCells(pencil, axes, range, loads) {
  const [n, m] = [axes.alpha.length, axes.beta.length];
  const solved = new Array(n * m);
  for (const stride of [8, 4, 2, 1]) {
    for (let j = 0; j < m; j += stride) {
      for (let i = 0; i < n; i += stride) {
        if (solved[j * n + i] !== undefined) continue;
        const damping = dampingOf(pencil, axes.alpha[i], axes.beta[j]);
        const near = neighbours(solved, i, j, n, m, stride);
        solved[j * n + i] = cell(pencil, damping, range, near);
        loads[j * n + i] = solved[j * n + i]?.load ?? Infinity;
        yield;
      }
    }
  }
}

function neighbours(solved, i, j, n, m, stride) {
  const found = [];
  for (const reach of [stride, 2 * stride]) {
    for (const [x, y] of [[i - reach, j], [i + reach, j], [i, j - reach], [i, j + reach], [i - reach, j - reach]]) {
      if (x > 0 && y > 0 && x < n && y < m && solved[y * n + x]?.a) found.push(solved[y * n + x]);
    }
  }
  return found.slice(0, 2);
}

/** Crossing of a cell: Newton's method from a neighbour where nothing grows below, else the search. */
function cell(pencil, damping, range, near) {
  if (!pencil.conservative && damping.size > 0) {
    for (const start of near) {
      const found = newton(pencil, damping, start);
      if (found && isFirst(pencil, damping, found.load)) return found;
    }
  }
  return firstCrossing(pencil, damping, range);
}

function isFirst(pencil, damping, load, checks = [1 - 1e-6, 0.97, 0.9, 0.75, 0.5]) {
  if (load > LOAD_MAX || load >= (pencil.divergence[0] ?? Infinity)) return false;
  return checks.every((share) => !isGrowing(pencil, damping, share * load));
}
