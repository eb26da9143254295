// The page: a case, what follows from it, and where that is shown.

function startPage() {
  const column = JSON.parse(document.getElementById("column").textContent);
  SI.load = column.load_unit;
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
    if (!view.seen || before || view.map?.id === view.mapKey) return;
    clearTimeout(view.resting); // it would begin the same map again
    view.askMap?.();
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
