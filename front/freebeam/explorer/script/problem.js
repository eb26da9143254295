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

/** x′ = A x + input F of the states x at a load, for a generalised force Q of F = 1. start(q): the states at rest; seen(values):
 * what reads Σ values q of x. Without Q there is no input; input is null where a force would act on what has no mass. */
function statesAt(problem, damping, P, Q) {
  const { n, root, M } = problem;
  if (problem.massless) {
    const { A, states, free, input } = reduced(...[M, damping.C, problem.K].map((terms) => termsAt(terms, P, n)));
    const shapes = states.subMatrix(0, n - 1, 0, A.rows - 1).transpose().to2DArray();
    return { A, input: Q && input(Q), start: (q) => free.map((k) => q[k] ?? 0), seen: (values) => times(shapes, values) };
  }
  const A = problem.general ? stateOf(problem, byMass(problem, problem.K, P)[0], byMass(problem, damping.C, P)[0]) : stateMatrix(problem, damping, P);
  const push = Q && (problem.general ? new LuDecomposition(termsAt(M, P, n)).solve(Matrix.columnVector(Q)).to1DArray() : Q);
  const still = Array(n).fill(0);
  return {
    A, input: push && [...still, ...push],
    start: (q) => [...Array.from(q, (x, i) => x * root[i]), ...still], // (Ωq, q̇), Ω = diag(root)
    seen: (values) => [...Array.from(values, (x, i) => x / root[i]), ...still],
  };
}

/** Values of the problem's coordinates q at places, a list for each place; reads: number of the field or coordinate. */
function seenAt({ general, functions, basis, own }, places, reads) {
  const values = general ? kernel.shapes(functions, places, reads, 0, 0, own) : kernel.shapes(functions, places);
  const count = places.length;
  return places.map((_, k) => turned(basis, (i) => values[i * count + k]));
}

/** The generalised force of a unit force at a place: as the column states it, else one on the field or coordinate of a number. */
function forceAt({ general, functions, basis, own }, place, number) {
  const values = !general ? kernel.force(functions, place) : kernel.force ? kernel.force(functions, place, own)
    : kernel.shapes(functions, [place], number, 0, 0, own);
  return turned(basis, (i) => values[i]);
}

/** Values of the kernel's functions as those of the problem's coordinates. */
function turned(basis, value) {
  return Float64Array.from(basis[0], (_, j) => basis.reduce((sum, row, i) => sum + row[j] * value(i), 0));
}
