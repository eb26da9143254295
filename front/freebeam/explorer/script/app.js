// The page: a case, what follows from it, and where that is shown.

function startPage() {
  const column = JSON.parse(document.getElementById("column").textContent);
  const parameters = parametersOf(column);
  const view = {
    column,
    parameters,
    values: startOf(parameters),
    range: column.load_range,
    shapes: null,
    pencil: null,
    state: null,
    analysis: null,
    map: null,
    near: false, // the frequency plot about the coalescence alone
    seen: false, // the map
    asked: 0,
    answered: 0,
    steps: [],
    frames: [],
  };
  readPalette();
  view.part = Object.fromEntries([...document.querySelectorAll("[id]")].map((element) => [element.id, element]));
  view.compute = startComputer(column, (answer) => receive(view, answer));
  view.controls = buildControls(view.part.controls, parameters, (key, value, typed) => change(view, { [key]: value }, typed));
  view.beam = beamView(view.part.beam, column);
  view.plots = {
    frequency: frequencyPlot(view.part.frequency, view),
    locus: locusPlot(view.part.locus, view),
    response: responsePlot(view.part.response, view),
  };
  if (column.damping.length) {
    view.plots.map = mapPlot(view.part.map, view, (alpha, beta) => {
      const wanted = { alpha, beta };
      change(view, Object.fromEntries(Object.entries(wanted).filter(([key]) => key in view.values)), true);
    });
  } else {
    view.part["map-panel"].hidden = true; // no damping is no map
    view.part.plots.dataset.map = "none";
  }
  followAddress(view);
  watchMap(view);
  window.addEventListener("hashchange", () => followAddress(view));
  wireButtons(view);
  watchTheme(view);
  animate(view);
  window.freebeam = outside(view);
}

/** A worker made of the page's own scripts; without workers the same in slices here. */
function startComputer(column, receive) {
  try {
    const text = (id) => document.getElementById(id).textContent;
    const start = `const answer = computer(${text("column")}, (found) => postMessage(found)); onmessage = (event) => answer(event.data);`;
    const source = [text("algebra"), text("kernel"), text("numerics"), start].join("\n;\n");
    const worker = new Worker(URL.createObjectURL(new Blob([source], { type: "text/javascript" })));
    worker.onmessage = (event) => receive(event.data);
    return (question) => worker.postMessage(question);
  } catch {
    return computer(column, receive);
  }
}

/** The case that the address names, or the start; says what of the address makes no sense. */
function followAddress(view) {
  if (location.hash === view.written) return;
  const { values, refused } = readHash(view.parameters, location.hash);
  view.part.address.textContent = refused.length ? `In the address: ${refused.join("; ")}.` : "";
  change(view, { ...startOf(view.parameters), ...values }, true);
}

/** Takes new values; all that needs no search is computed and drawn at once. */
function change(view, values, typed) {
  const began = performance.now();
  Object.assign(view.values, values);
  const fits = rangeFor(view.column, view.values.P);
  if (typed || fits > view.range) view.range = fits;
  settle(view);
  writeAddress(view);
  // the plots draw themselves in tasks that stand before this one
  queueMicrotask(() => {
    view.steps.push(performance.now() - began);
    if (view.steps.length > 500) view.steps.shift();
  });
}

function settle(view) {
  const { values, column, controls } = view;
  for (const { key } of view.parameters) showValue(controls[key], values[key], view.range);
  const own = ownOf(view.parameters, values);
  const question = { N: values.N, own, alpha: values.alpha ?? 0, beta: values.beta ?? 0, range: view.range };
  view.part.command.textContent = commandOf(column, question);
  const keys = { map: JSON.stringify([values.N, own]), question: JSON.stringify(question) };
  if (keys.map !== view.mapKey) {
    view.pencil = pencilOf(values.N, own);
    if (view.pencil.sound) view.shapes = drawingShapes(view.pencil);
    view.mapKey = keys.map;
    askForMap(view);
  }
  if (!view.pencil.sound) return refuse(view);
  view.damping = dampingOf(view.pencil, question.alpha, question.beta);
  if (keys.question !== view.questionKey) {
    view.questionKey = keys.question;
    view.critical = firstLoss(view.pencil, view.damping).crossing;
    view.compute({ kind: "case", id: ++view.asked, ...question });
  }
  view.state = stateAt(view.pencil, view.damping, values.P);
  show(view);
}

/** The map takes some seconds of computing: it is begun at once where it is in view, else when the page has rested. */
function askForMap(view) {
  const { mapKey, values, parameters } = view;
  const ask = () => view.compute({ kind: "map", id: mapKey, N: values.N, own: ownOf(parameters, values) });
  clearTimeout(view.resting);
  if (!view.plots.map) return;
  if (view.seen) ask();
  else view.resting = setTimeout(ask, 2000);
}

function watchMap(view) {
  const watch = new IntersectionObserver((entries) => {
    const before = view.seen;
    view.seen = entries[entries.length - 1].isIntersecting;
    if (view.seen && !before && view.map?.id !== view.mapKey) askForMap(view);
  });
  watch.observe(view.part.map);
}

function receive(view, answer) {
  if (answer.kind === "map") {
    if (answer.id !== view.mapKey) return;
    view.map = answer;
    drawMapPanel(view);
    return;
  }
  if (answer.id !== view.asked) return;
  view.answered = answer.id;
  if (!answer.sound) return;
  view.analysis = answer;
  showWords(view);
  showPlots(view);
}

/** A column that is not stable without load has no first loss of stability: say so, and show nothing wrong. */
function refuse(view) {
  view.state = null;
  view.part.sentence.textContent = "Without load this column is not stable: its elastic energy is not positive here.";
  view.part.sentence.dataset.state = "unstable";
}

function show(view) {
  showWords(view);
  showBeam(view);
  showResponse(view);
  showPlots(view);
}

function showWords({ part, state, values, critical, analysis, damping, column }) {
  const sentence = sentenceOf(state, critical, values.P, damping);
  if (part.sentence.textContent !== sentence) part.sentence.textContent = sentence;
  const verdict = state.growing ? "unstable" : "stable";
  part.sentence.dataset.state = verdict;
  document.documentElement.dataset.verdict = verdict;
  const remark = remarkOf(state, critical, values.P, column.load_max);
  if (part.remark.textContent !== remark) part.remark.textContent = remark;
  part.critical.textContent = criticalOf(critical, column.load_max);
  part.critical.dataset.value = critical ? exact(critical.load) : "";
  part.kind.textContent = critical ? ` ${critical.kind}${critical.omega ? `, ω = ${shown(critical.omega, 5)}` : ""}` : "";
  if (analysis) {
    part.undamped.textContent = criticalOf(analysis.undamped, column.load_max);
    const { tangent } = analysis;
    part["tangent-row"].hidden = !tangent;
    part["tangent-note"].hidden = !tangent;
    if (tangent) {
      part.vanishing.textContent = criticalOf(tangent, column.load_max);
      part.kappa.textContent = ` at β = ${tangent.kappa ? `${shown(tangent.kappa, 3)} α` : "0"}`;
    }
  }
  showEigenvalues(part, state);
}

function showEigenvalues(part, { upper, least }) {
  const size = (mode) => Math.hypot(mode.re, mode.im);
  const lowest = [...upper].sort((x, y) => size(x) - size(y)).slice(0, 4);
  const rows = lowest.map((mode) => {
    const row = make("tr", mode === least ? { class: "least" } : {});
    row.append(make("td", {}, shown(mode.im, 6)), make("td", {}, shown(mode.re, 4)));
    return row;
  });
  part.eigenvalues.replaceChildren(...rows);
}

function showBeam(view) {
  const { beam, pencil, state, values, shapes, range } = view;
  beam.motion = motionOf(pencil, state.least, shapes);
  beam.reference = pencil.root[0];
  beam.sensor = values.sensor;
  beam.load = { P: values.P, range, ...pencil.load };
  beam.colour = state.growing ? palette.accent : palette.stable;
  if (beam.still) drawBeam(beam);
}

function showResponse(view) {
  const { plots, pencil, damping, values } = view;
  const duration = (30 * 2 * Math.PI) / pencil.root[0];
  view.response = responseAt(pencil, damping, values.P, values.sensor, duration);
  plots.response.setData([view.response.t, view.response.y]);
}

function showPlots(view) {
  const { plots } = view;
  const scaled = JSON.stringify([view.range, view.answered]);
  for (const plot of [plots.frequency, plots.locus]) {
    if (scaled !== view.scaled) plot.setData(plot.data);
    else plot.redraw(false, false);
  }
  view.scaled = scaled;
  if (plots.map && view.map) plots.map.redraw(false, false);
  describe(view);
}

/** What the plots show, in words, for those who do not see them. */
function describe({ part, values, state, critical, response }) {
  const load = critical ? `critical load ${shown(critical.load, 5)}` : "no critical load found";
  part.frequency.setAttribute("aria-label", `Frequency-load curves; present load ${exact(values.P)}, ${load}`);
  part.locus.setAttribute(
    "aria-label",
    `Root locus; least stable eigenvalue ${shown(state.least.re)} + ${shown(state.least.im)} i, ${load}`,
  );
  part.map.setAttribute("aria-label", `Stability map; at alpha ${exact(values.alpha ?? 0)}, beta ${exact(values.beta ?? 0)}: ${load}`);
  const last = response.y.reduce((size, y) => Math.max(size, Math.abs(y)), 0);
  part.response.setAttribute("aria-label", `Response at the sensor, largest deflection ${shown(last, 3)}`);
}

function drawMapPanel(view) {
  const { map, plots, part } = view;
  const span = mapSpan(map.loads);
  part["map-scale"].hidden = !span;
  if (span) {
    part["map-low"].textContent = shown(span.low, 4);
    part["map-scale"].querySelector("i").hidden = span.even;
    part["map-high"].textContent = span.even ? "everywhere" : shown(span.high, 4);
  }
  part["map-none"].hidden = !map.loads.includes(Infinity);
  const known = map.loads.reduce((count, load) => count + !Number.isNaN(load), 0);
  part["map-progress"].textContent = map.done ? "" : `computing, ${Math.round((100 * known) / map.loads.length)} %`;
  plots.map.setData(plots.map.data);
}

/** The address follows the case, a little later: browsers bear only so many changes a second. */
function writeAddress(view) {
  clearTimeout(view.writing);
  view.writing = setTimeout(() => {
    view.written = hashOf(view.parameters, view.values);
    history.replaceState(null, "", view.written);
  }, 200);
}

function wireButtons(view) {
  const { part, beam } = view;
  const reduced = window.matchMedia("(prefers-reduced-motion: reduce)");
  const still = (value) => {
    beam.still = value;
    part.motion.textContent = value ? "Play" : "Pause";
    drawBeam(beam);
  };
  part.motion.addEventListener("click", () => still(!beam.still));
  reduced.addEventListener("change", () => still(reduced.matches));
  still(reduced.matches);
  part.near.addEventListener("click", () => {
    view.near = !view.near;
    part.near.setAttribute("aria-pressed", String(view.near));
    view.plots.frequency.setData(view.plots.frequency.data);
  });
  part.reset.addEventListener("click", () => {
    part.address.textContent = "";
    for (const control of Object.values(view.controls)) complain(control, "");
    change(view, startOf(view.parameters), true);
  });
  part.link.addEventListener("click", () => copyLink(view));
  part.theme.addEventListener("click", () => {
    const dark = getComputedStyle(document.documentElement).colorScheme.startsWith("dark");
    document.documentElement.dataset.theme = dark ? "light" : "dark";
    repaint(view);
  });
}

async function copyLink({ part, parameters, values }) {
  const link = `${location.href.split("#")[0]}${hashOf(parameters, values)}`;
  let said = "Link to this case copied.";
  try {
    await navigator.clipboard.writeText(link);
  } catch {
    said = "The address of this page is the link to this case.";
  }
  part.said.textContent = said;
  setTimeout(() => (part.said.textContent = ""), 4000);
}

function watchTheme(view) {
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => repaint(view));
}

function repaint(view) {
  readPalette();
  view.beam.colour = view.state?.growing ? palette.accent : palette.stable;
  for (const plot of Object.values(view.plots)) plot.redraw();
  drawBeam(view.beam);
}

/** One frame after another, with a record of the time between them and of the time that drawing takes. */
function animate(view) {
  let before = performance.now();
  const frame = (now) => {
    const gap = now - before;
    before = now;
    const { beam } = view;
    if (!beam.still && beam.motion) {
      beam.clock += Math.min(0.1, gap / 1000);
      const began = performance.now();
      drawBeam(beam);
      view.frames.push({ gap, work: performance.now() - began });
      if (view.frames.length > 600) view.frames.shift();
    }
    requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
}

/** What a lecturer's script, or a test, may ask of the page. */
function outside(view) {
  const pencil = (N, own) => pencilOf(N, own);
  return {
    values: () => ({ ...view.values }),
    set: (values) => change(view, values, true),
    settled: () => view.answered === view.asked,
    analysis: () => view.analysis,
    map: () => view.map,
    state: () => view.state,
    view: () => view,
    response: () => view.response,
    steps: () => [...view.steps],
    frames: () => [...view.frames],
    firstLoss: (N, alpha, beta, own = {}, kappa = undefined) => {
      const found = pencil(N, own);
      return firstLoss(found, dampingOf(found, alpha, beta, kappa));
    },
    spectrum: (N, P, alpha, beta, own = {}) => {
      const found = pencil(N, own);
      return spectrumOf(found, dampingOf(found, alpha, beta), P).map(({ re, im }) => [re, im]);
    },
  };
}

startPage();
