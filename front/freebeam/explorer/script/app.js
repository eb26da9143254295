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
    units: unitsOf({}),
    measure: "length",
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
  if (view.values.across) {
    view.plots.map = mapPlot(view.part.map, view, (wanted) => change(view, wanted, true));
  } else {
    view.part["map-panel"].hidden = true; // over the load alone there is no map
    view.part.plots.dataset.map = "none";
  }
  view.part.units.hidden = !column.si;
  followAddress(view);
  watchMap(view);
  window.addEventListener("hashchange", () => followAddress(view));
  wireButtons(view);
  watchTheme(view);
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
  view.units = unitsOf(values);
  if (view.units.isSI) view.part.units.open = true;
  for (const { key } of view.parameters) showValue(controls[key], values[key], view.range, view.units);
  showWhatActs(view);
  const own = ownOf(view.parameters, values);
  const N = values.N ?? column.start.N;
  const question = { N, own, alpha: values.alpha ?? 0, beta: values.beta ?? 0, range: view.range };
  view.part.command.textContent = commandOf(column, question);
  const keys = { pencil: JSON.stringify([N, own]), question: JSON.stringify(question) };
  if (keys.pencil !== view.pencilKey) {
    view.pencil = problemAt(N, own);
    if (view.pencil.sound) view.shapes = drawingShapes(view.pencil, column);
    view.pencilKey = keys.pencil;
  }
  askForMap(view, question);
  if (!view.pencil.sound) return refuse(view);
  view.damping = dampingAt(view.pencil, question.alpha, question.beta);
  if (view.damping.grows) return refuse(view);
  if (keys.question !== view.questionKey) {
    view.questionKey = keys.question;
    // a search of the pencil takes less than a frame; the other is left to the worker
    view.critical = view.pencil.general ? PENDING : lossOf(view.pencil, view.damping);
    view.compute({ kind: "case", id: ++view.asked, ...question });
  }
  view.state = stateAt(view.pencil, view.damping, values.P);
  show(view);
}

/** What stands for a critical load that is still being searched. */
const PENDING = Object.freeze({ kind: "pending" });

/** Controls that act on nothing now are not shown. */
function showWhatActs({ values, controls }) {
  const acts = { place: values.force !== "release", rate: values.force === "sine" };
  for (const [key, isShown] of Object.entries(acts)) if (controls[key]) controls[key].element.hidden = !isShown;
}

/** The map takes some seconds of computing: it is begun at once where it is in view, else when the page has rested. */
function askForMap(view, { N, own, alpha, beta, range }) {
  if (!view.plots.map) return;
  const { values, parameters, column } = view;
  const keys = [values.across, values.up];
  const axes = keys.map((key) => axisOf(parameters.find((parameter) => parameter.key === key), range, column.general, keys.includes("P")));
  const owned = parameters.filter((parameter) => parameter.own).map(({ key, own: name }) => ({ key, name }));
  const fixed = Object.fromEntries(Object.entries(values).filter(([key]) => owned.some((one) => one.key === key) && !keys.includes(key)));
  const dampings = [["alpha", alpha], ["beta", beta]].filter(([key]) => !keys.includes(key));
  const key = JSON.stringify([N, keys, fixed, dampings, keys.includes("P") ? range : 0]);
  if (key === view.mapKey) return;
  view.mapKey = key;
  view.askMap = () => view.compute({ kind: "map", id: key, N, own, alpha, beta, axes, owned });
  clearTimeout(view.resting);
  if (view.seen) view.askMap();
  else view.resting = setTimeout(view.askMap, 2000);
}

function watchMap(view) {
  const watch = new IntersectionObserver((entries) => {
    const before = view.seen;
    view.seen = entries[entries.length - 1].isIntersecting;
    if (view.seen && !before && view.map?.id !== view.mapKey) view.askMap?.();
  });
  watch.observe(view.part.map);
}

function receive(view, answer) {
  if (answer.kind === "map") {
    if (answer.id !== view.mapKey) return;
    const keys = answer.axes.map(({ key }) => key);
    view.map = { ...answer, isLoad: keys.includes("P") };
    // a map over other parameters has other ranges
    if (keys.join() !== view.mapped) view.plots.map.setData(view.plots.map.data);
    view.mapped = keys.join();
    drawMapPanel(view);
    return;
  }
  if (answer.id !== view.asked) return;
  view.answered = answer.id;
  if (!answer.sound) return;
  view.analysis = answer;
  view.critical = answer.critical;
  showWords(view);
  showPlots(view);
}

/** A column that is not stable at the smallest loads has no first loss of stability: say so, and show nothing wrong. */
function refuse(view) {
  const { part, pencil, plots } = view;
  Object.assign(view, { state: null, analysis: null, critical: undefined, questionKey: "", answered: ++view.asked, response: { t: [], y: [] } });
  const why = pencil.why ? ` (${pencil.why})` : "";
  part.sentence.textContent = `At the smallest loads this column is not stable here${why}: there is no first loss of stability.`;
  part.sentence.dataset.state = "unstable";
  for (const name of ["remark", "critical", "kind", "undamped"]) part[name].textContent = "";
  part.critical.dataset.value = "";
  part.eigenvalues.replaceChildren();
  view.beam.motion = null;
  view.beam.context.clearRect(0, 0, view.beam.width, view.beam.height);
  plots.response.setData([[], []]);
  for (const plot of [plots.frequency, plots.locus]) plot.setData(plot.data);
}

function show(view) {
  showWords(view);
  showBeam(view);
  showResponse(view);
  showPlots(view);
}

function showWords({ part, state, values, critical, analysis, damping, column, units }) {
  const isPending = critical === PENDING;
  if (isPending) critical = undefined;
  const sentence = sentenceOf(state, critical, values.P, damping, units);
  if (part.sentence.textContent !== sentence && !isPending) part.sentence.textContent = sentence;
  const verdict = state.growing ? "unstable" : "stable";
  part.sentence.dataset.state = verdict;
  document.documentElement.dataset.verdict = verdict;
  const remark = remarkOf(state, critical, values.P, column.load_max);
  if (part.remark.textContent !== remark && !isPending) part.remark.textContent = remark;
  part.critical.textContent = isPending ? "searching" : criticalOf(critical, column.load_max, units);
  part.critical.dataset.value = critical ? exact(critical.load) : "";
  part.kind.textContent = critical ? ` ${critical.kind}${critical.omega ? `, ω = ${said(units, "frequency", critical.omega, 5)}` : ""}` : "";
  if (analysis) {
    part.undamped.textContent = criticalOf(analysis.undamped, column.load_max, units);
    part["curves-bare"].hidden = !analysis.isBare;
    part["curves-damped"].hidden = analysis.isBare;
    const { tangent } = analysis;
    part["tangent-row"].hidden = !tangent;
    part["tangent-note"].hidden = !tangent;
    if (tangent) {
      part.vanishing.textContent = criticalOf(tangent, column.load_max, units);
      part.kappa.textContent = ` at β = ${tangent.kappa ? `${shown(tangent.kappa, 3)} α` : "0"}`;
    }
  }
  showEigenvalues(part, state, units);
}

function showEigenvalues(part, { upper, least }, units) {
  const size = (mode) => Math.hypot(mode.re, mode.im);
  const lowest = [...upper].sort((x, y) => size(x) - size(y)).slice(0, 4);
  const rows = lowest.map((mode) => {
    const row = make("tr", mode === least ? { class: "least" } : {});
    row.append(make("td", {}, said(units, "frequency", mode.im, 6)), make("td", {}, said(units, "rate", mode.re, 4)));
    return row;
  });
  part.eigenvalues.replaceChildren(...rows);
}

function showBeam(view) {
  const { beam, pencil, state, values, shapes, range, column } = view;
  beam.motion = motionOf(state.least, shapes);
  beam.reference = pencil.first;
  beam.sensor = column.links ? null : values.sensor;
  beam.force = column.links || values.force === "release" ? null : values.place;
  beam.load = { P: values.P, range, ...(pencil.general ? generalLoad(column.drawn, pencil.own) : loadOf(pencil.own)) };
  const isThere = ([, , name]) => !name || pencil.own[name] !== 0;
  beam.marks = column.drawn.marks.filter(isThere).map(([kind, place]) => [kind, placeAt(place, pencil.own)]);
  beam.colour = state.growing ? palette.accent : palette.stable;
  if (beam.still) drawBeam(beam);
}

function showResponse(view) {
  const { plots, pencil, damping, values, column, shapes, part } = view;
  const reads = Number(values.reads ?? 0);
  const place = values.sensor ?? 0;
  const drive = {
    kind: values.force,
    rate: values.rate,
    seen: seenAt(pencil, [place], reads)[0],
    force: values.force === "release" ? null : forceAt(pencil, values.place ?? 0, column.links ? reads : 0),
    release: values.force === "release" ? (pencil.release ??= releasedFrom(pencil, shapes)) : null,
    growth: Math.max(...view.state.upper.map(({ re }) => re)),
  };
  view.measure = column.reads[reads] === "deflection y" ? "length" : "";
  view.response = responseAt(pencil, damping, values.P, drive, (30 * 2 * Math.PI) / pencil.first);
  part["response-note"].textContent = responseNote(column, values, view.units, pencil);
  plots.response.setData([view.response.t, view.response.y]);
}

function showPlots(view) {
  const { plots } = view;
  const scaled = JSON.stringify([view.range, view.answered, view.units]);
  for (const plot of [plots.frequency, plots.locus]) {
    if (scaled !== view.scaled) plot.setData(plot.data);
    else plot.redraw(false, false);
  }
  view.scaled = scaled;
  if (plots.map && view.map) plots.map.redraw(false, false);
  describe(view);
}

/** What the plots show, in words, for those who do not see them. */
function describe({ part, values, state, critical, response, map, parameters, units }) {
  const load = critical?.load ? `critical load ${said(units, "load", critical.load, 5)}` : "no critical load found";
  part.frequency.setAttribute("aria-label", `Frequency-load curves; present load ${said(units, "load", values.P)}, ${load}`);
  part.locus.setAttribute(
    "aria-label",
    `Root locus; least stable eigenvalue: growth rate ${said(units, "rate", state.least.re)}, frequency ${said(units, "frequency", state.least.im)}, ${load}`,
  );
  const over = (map?.axes ?? []).map(({ key }) => `${parameters.find((one) => one.key === key).name} ${exact(values[key])}`);
  part.map.setAttribute("aria-label", `Stability map; at ${over.join(", ")}: ${load}`);
  const last = response.y.reduce((size, y) => Math.max(size, Math.abs(y)), 0);
  part.response.setAttribute("aria-label", `Response at the sensor, largest deflection ${shown(last, 3)}`);
}

function drawMapPanel(view) {
  const { map, plots, part } = view;
  const span = map.isLoad ? null : mapSpan(map.loads);
  part["map-scale"].hidden = !span;
  part["map-verdicts"].hidden = !map.isLoad;
  part["map-about"].textContent = map.isLoad ? "What the motion does over two parameters" : "Critical load over two parameters";
  part["map-line"].hidden = map.isLoad;
  part["map-strips"].hidden = !map.axes.some((axis) => axis.log);
  part["map-unsound"].hidden = !map.loads.includes(UNSOUND);
  if (span) {
    part["map-low"].textContent = said(view.units, "load", span.low, 4);
    part["map-scale"].querySelector("i").hidden = span.even;
    part["map-high"].textContent = span.even ? "everywhere" : said(view.units, "load", span.high, 4);
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
    if (!value) animate(view);
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
  if (view.beam.motion) drawBeam(view.beam);
}

/** One frame after another, with a record of the time between them and of the time that drawing takes. */
function animate(view) {
  if (view.isMoving) return;
  view.isMoving = true;
  let before = performance.now();
  const frame = (now) => {
    const gap = now - before;
    before = now;
    const { beam } = view;
    if (beam.still) {
      view.isMoving = false; // nothing is asked of the browser while the beam is held still
      return;
    }
    if (beam.motion) {
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
  const pencil = (N, own) => problemAt(N, own);
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
      if (found.general) return { crossing: lossOf(found, dampingAt(found, alpha, beta)), touches: [] };
      return firstLoss(found, dampingOf(found, alpha, beta, kappa));
    },
    spectrum: (N, P, alpha, beta, own = {}) => {
      const found = pencil(N, own);
      return modesAt(found, dampingAt(found, alpha, beta), P).map(({ re, im }) => [re, im]);
    },
  };
}
