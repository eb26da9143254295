// The column's matrices, loads and damping at its own parameters, from their series; see content.py.

/** Chebyshev polynomials T_0 … T_degree at u. */
function chebyshev(degree, u) {
  const T = [1, u];
  for (let k = 2; k <= degree; k++) T.push(2 * u * T[k - 1] - T[k - 2]);
  return T.slice(0, degree + 1);
}

/** The embedded quantities at own parameters: a series in Chebyshev polynomials of each parameter. */
function atParameters(column, own) {
  let weights = [1];
  column.parameters.forEach((parameter, k) => {
    const u = (2 * own[parameter.name] - parameter.low - parameter.high) / (parameter.high - parameter.low);
    const T = chebyshev(column.degrees[k], u);
    weights = weights.flatMap((weight) => T.map((value) => weight * value));
  });
  const sum = new Float64Array(column.series[0].length);
  column.series.forEach((term, k) => {
    for (let i = 0; i < sum.length; i++) sum[i] += weights[k] * term[i];
  });
  return sum;
}

/** M, E, H of N functions (leading blocks), the coefficients of the damping and of the load. */
function matricesOf(column, N, own) {
  const values = atParameters(column, own);
  const most = column.modes;
  const block = (which) => square(N, (i, j) => values[which * most * most + i * most + j]);
  const rest = Array.from(values.slice(3 * most * most));
  const axial = column.axial_terms;
  return {
    M: block(0),
    E: block(1),
    H: block(2),
    damping: [rest.slice(0, 3), rest.slice(3, 6)],
    ends: rest.slice(6, 8),
    axial: rest.slice(8, 8 + axial),
    along: rest.slice(8 + axial),
  };
}
