// What the page asks of a column, whichever form its kernel has: the textbook's pencil with C = c_M M + c_E E, answered by
// search.js, or matrices of any damping with loads of any degree, answered by general.js.

const GENERAL = "mass_terms" in kernel;

/** Everything of a column at N functions and own parameters; `sound` where it is stable without load and damping. */
function problemAt(N, own) {
  if (GENERAL) return generalOf(N, own);
  const pencil = pencilOf(N, own);
  return pencil.sound ? { ...pencil, n: N, first: pencil.root[0] } : pencil;
}

function dampingAt(problem, alpha, beta) {
  return problem.general ? generalDamping(problem, alpha, beta) : dampingOf(problem, alpha, beta);
}

/** The first loss of stability: { load, omega, kind }, null for none, undefined where it cannot be told. close: as of `generalLoss`. */
function lossOf(problem, damping, close = undefined) {
  return problem.general ? generalLoss(problem, damping, LOAD_MAX, close) : firstLoss(problem, damping).crossing;
}

function modesAt(problem, damping, P) {
  return problem.general ? generalSpectrum(problem, damping, P) : spectrumOf(problem, damping, P);
}

/** The branches along the load with their slopes, for `follow`. */
function nodesOf(problem, damping) {
  if (problem.general) return generalNode(problem, damping);
  return damping.size === 0 ? undampedNode(problem) : dampedNode(problem, damping);
}

/** The state matrix on (Ωq, q̇), Ω = diag(root), at a load. */
function stateMatrixAt(problem, damping, P) {
  if (!problem.general) return stateMatrix(problem, damping, P);
  return stateOf(problem, byMass(problem, problem.K, P)[0], byMass(problem, damping.C, P)[0]);
}

/** Values of the problem's coordinates q at places, a list for each place; reads: number of the field or coordinate. */
function seenAt({ general, functions, basis, own }, places, reads) {
  const values = general ? kernel.shapes(functions, places, reads, 0, 0, own) : kernel.shapes(functions, places);
  const count = places.length;
  return places.map((_, k) => turned(basis, (i) => values[i * count + k]));
}

/** The generalised force of a unit force at a place: as the column states it, else one on the field or coordinate of a number. */
function forceAt({ general, functions, basis, own, M }, place, number) {
  const values = !general ? kernel.force(functions, place) : kernel.force ? kernel.force(functions, place, own)
    : kernel.shapes(functions, [place], number, 0, 0, own);
  const Q = turned(basis, (i) => values[i]);
  return general ? new LuDecomposition(M[0]).solve(Matrix.columnVector(Q)).to1DArray() : Q;
}

/** Values of the kernel's functions as those of the problem's coordinates. */
function turned(basis, value) {
  return Float64Array.from(basis[0], (_, j) => basis.reduce((sum, row, i) => sum + row[j] * value(i), 0));
}
