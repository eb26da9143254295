// What a case looks like: words, the beam, the plots and the map's panel, and what is left where there is no first loss.

/** Controls that act on nothing now are not shown. */
function showWhatActs({ values, controls }) {
  const acts = { place: values.force !== "release", rate: values.force === "sine" };
  for (const [key, isShown] of Object.entries(acts)) if (controls[key]) controls[key].element.hidden = !isShown;
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
  const isEmpty = !view.response.t.length;
  part["response-note"].textContent = isEmpty ? NO_FORCE : responseNote(column, values, view.units, pencil);
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
