// The four plots. uPlot makes axes, grids and scales; what is no function of x is drawn over them.

function makePlot(place, { x, y, series = [], draw = () => {}, height = 290 }) {
  const axis = (options) => ({
    stroke: () => palette.ink,
    grid: { stroke: () => palette.grid, width: 1 },
    ticks: { stroke: () => palette.grid, width: 1, size: 5 },
    font: `12px ${palette.font}`,
    labelFont: `13px ${palette.font}`,
    labelSize: 22,
    labelGap: 2,
    ...options,
  });
  const options = {
    width: Math.max(200, place.clientWidth),
    height,
    legend: { show: false },
    cursor: { show: false },
    padding: [12, 14, 0, 4],
    scales: { x: { time: false, range: x.range }, y: { range: y.range } },
    axes: [
      axis({ size: 34, space: x.space ?? 50, ...(x.quantity ? inUnits(x) : x) }),
      axis({ size: 52, space: y.space ?? 34, ...(y.quantity ? inUnits(y) : y) }),
    ],
    series: [{}, ...(series.length ? series : [{ show: false }])],
    hooks: { draw: [(u) => clipped(u, () => draw(u))] },
  };
  const plot = new uPlot(options, [[0, 1], ...(series.length ? series : [0]).map(() => [null, null])], place);
  new ResizeObserver(() => {
    const width = Math.floor(place.clientWidth);
    if (width > 0 && width !== plot.width) plot.setSize({ width, height });
  }).observe(place);
  return plot;
}

/** Label and ticks of an axis in the units of its quantity: `quantity(largest)` is { factor, unit }. */
function inUnits({ label, quantity, size }) {
  const scaleOn = (u, k) => {
    const { min, max } = u.scales[k ? "y" : "x"];
    return quantity(Math.max(Math.abs(min ?? 0), Math.abs(max ?? 0)));
  };
  const named = (u, k) => {
    const { unit } = scaleOn(u, k);
    return unit ? `${label} (${unit})` : label;
  };
  const splits = (u, k, low, high) => {
    const { factor } = scaleOn(u, k);
    const most = k ? 7 : Math.max(2, Math.floor(u.bbox.width / uPlot.pxRatio / 62));
    return roundValues(low * factor, high * factor, most).map((value) => value / factor);
  };
  const values = (u, places, k) => places.map((place) => plain(place * scaleOn(u, k).factor));
  return { label: named, splits, values, ...(size ? { size } : {}) };
}

function plain(value) {
  return String(Number(value.toPrecision(6))).replace("-", "−");
}

/** Round values in a range, no more than so many. */
function roundValues(low, high, most = 7) {
  const power = 10 ** Math.floor(Math.log10((high - low) / most));
  const step = [1, 2, 2.5, 5, 10].map((x) => x * power).find((x) => (high - low) / x <= most) ?? 10 * power;
  const first = Math.ceil(low / step - 1e-9);
  const count = Math.max(0, Math.floor(high / step + 1e-9) - first + 1);
  return Array.from({ length: count }, (_, k) => (first + k) * step);
}

function clipped(u, paint) {
  const { ctx, bbox } = u;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  paint();
  ctx.restore();
}

/** Pixels of the canvas for a point. */
function pixel(u, x, y) {
  return [u.valToPos(x, "x", true), u.valToPos(y, "y", true)];
}

function polyline(u, xs, ys, { colour, width = 2, dash = [] }) {
  const { ctx } = u;
  ctx.strokeStyle = colour;
  ctx.lineWidth = width * uPlot.pxRatio;
  ctx.setLineDash(dash.map((x) => x * uPlot.pxRatio));
  ctx.lineJoin = "round";
  ctx.beginPath();
  xs.forEach((x, i) => {
    const [px, py] = pixel(u, x, ys[i]);
    ctx[i ? "lineTo" : "moveTo"](px, py);
  });
  ctx.stroke();
  ctx.setLineDash([]);
}

function spot(u, x, y, { colour, size = 4.5, hollow = false }) {
  const { ctx } = u;
  const [px, py] = pixel(u, x, y);
  ctx.beginPath();
  ctx.arc(px, py, size * uPlot.pxRatio, 0, 2 * Math.PI);
  ctx.fillStyle = hollow ? palette.panel : colour;
  ctx.fill();
  ctx.lineWidth = 1.6 * uPlot.pxRatio;
  ctx.strokeStyle = hollow ? colour : palette.panel;
  ctx.stroke();
}

/** Text beside a point, on the side where there is room. */
function note(u, text, x, y, { colour = palette.ink, below = false } = {}) {
  const { ctx, bbox } = u;
  const [px, py] = pixel(u, x, y);
  ctx.font = `${12 * uPlot.pxRatio}px ${palette.font}`;
  const gap = 8 * uPlot.pxRatio;
  const wide = ctx.measureText(text).width;
  const left = px + gap + wide > bbox.left + bbox.width;
  ctx.textAlign = "left";
  ctx.textBaseline = "middle";
  const at = [left ? Math.max(bbox.left + gap / 2, px - gap - wide) : px + gap, py + (below ? 14 : -13) * uPlot.pxRatio];
  at[1] = Math.min(bbox.top + bbox.height - gap, Math.max(bbox.top + gap, at[1]));
  ctx.lineWidth = 3.5 * uPlot.pxRatio;
  ctx.lineJoin = "round";
  ctx.strokeStyle = palette.panel;
  ctx.strokeText(text, ...at);
  ctx.fillStyle = colour;
  ctx.fillText(text, ...at);
}

/** Stretches of a line for which a test of its points is the same, ends joined. */
function stretches(count, test) {
  const found = [];
  for (let i = 0; i < count; i++) {
    const kind = test(i);
    const last = found[found.length - 1];
    if (last && last.kind === kind) last.to = i;
    else {
      if (last) last.to = i;
      found.push({ kind, from: i, to: i });
    }
  }
  return found.filter(({ from, to }) => to > from);
}

/** Frequency-load curves ω²(P) of the undamped beam with the tangent construction. */
function frequencyPlot(place, view) {
  const top = () => {
    const curves = view.analysis?.curves;
    if (!curves) return 1;
    const second = curves[Math.min(1, curves.length - 1)].re;
    const met = view.analysis.undamped?.omega ?? 0;
    const all = 1.12 * Math.max(...second, met ** 2);
    return view.near && met > 0 ? Math.min(all, 2.2 * met ** 2) : all;
  };
  const bottom = () => {
    const kappa = view.analysis?.tangent?.kappa ?? 0;
    return -Math.max(0.04 * top(), kappa < 0.3 * top() ? 1.15 * kappa : 0);
  };
  return makePlot(place, {
    x: { range: () => [0, view.range], label: "load P", quantity: (most) => scaleOf(view.units, "load", most) },
    y: { range: () => [bottom(), top()], label: "ω²", size: 62, quantity: () => squaredRate(view.units) },
    draw: (u) => drawFrequencies(u, view),
  });
}

function squaredRate({ isSI, size }) {
  return { factor: size.frequency ** 2, unit: isSI ? "rad²/s²" : "" };
}

function drawFrequencies(u, { analysis, values, state, range, units }) {
  polyline(u, [values.P, values.P], [u.scales.y.min, u.scales.y.max], { colour: palette.muted, width: 1 });
  if (!analysis) return;
  analysis.curves.forEach(({ load, re, im }, k) => {
    for (const { kind, from, to } of stretches(load.length, (i) => im[i] === 0 && re[i] > 0)) {
      const cut = (numbers) => numbers.slice(from, to + 1);
      polyline(u, cut(load), cut(re), { colour: palette.modes[k], dash: kind ? [] : [6, 4] });
    }
  });
  drawTangent(u, analysis, range, units);
  for (const mode of state?.upper ?? []) {
    if (mode.im > 0) spot(u, values.P, mode.im ** 2 - mode.re ** 2, { colour: palette.ink, size: 3.5 });
  }
}

function drawTangent(u, { tangent, undamped, isBare }, range, units) {
  if (tangent) {
    const { load, omega, kappa } = tangent;
    const slope = (omega ** 2 + kappa) / load;
    polyline(u, [0, range], [-kappa, slope * range - kappa], { colour: palette.accent, width: 1.3 });
    spot(u, load, omega ** 2, { colour: palette.accent });
    note(u, `tangent: ${said(units, "load", load, 5)}`, load, omega ** 2, { colour: palette.accent, below: true });
  }
  if (!undamped || undamped.load > range) return;
  spot(u, undamped.load, undamped.omega ** 2, { colour: palette.accent, hollow: true });
  const what = undamped.kind === "flutter" && isBare ? "coalescence" : undamped.kind;
  note(u, `${what}: ${said(units, "load", undamped.load, 5)}`, undamped.load, undamped.omega ** 2, { colour: palette.accent });
}

/** Eigenvalues in the complex plane as the load goes over its range. */
function locusPlot(place, view) {
  return makePlot(place, {
    x: { range: () => locusRange(view).x, label: "growth rate Re λ", quantity: (most) => scaleOf(view.units, "rate", most) },
    y: { range: () => locusRange(view).y, label: "frequency Im λ", quantity: (most) => scaleOf(view.units, "frequency", most) },
    draw: (u) => drawLocus(u, view),
  });
}

/** The part of the plane in which the two lowest branches are up to a little beyond the critical or present load. */
function locusRange({ analysis, values, range }) {
  const branches = analysis?.locus ?? [];
  if (!branches.length) return { x: [-1, 1], y: [0, 1] };
  const reach = Math.max(1.2 * Math.min(analysis.critical?.load ?? range, analysis.undamped?.load ?? range), values.P);
  const two = branches.slice(0, 2).flatMap(({ re, load }) => re.filter((_, i) => load[i] <= reach));
  const low = Math.min(0, ...two);
  const high = Math.max(0, ...two);
  const pad = Math.max(0.1 * (high - low), 0.02 * Math.abs(branches[0].im[0]), 1e-3);
  const top = 1.15 * Math.max(...branches.slice(0, 2).flatMap((branch) => branch.im));
  return { x: [low - pad, high + pad], y: [0, top > 0 ? top : 1] };
}

function drawLocus(u, { analysis, state, units }) {
  polyline(u, [0, 0], [u.scales.y.min, u.scales.y.max], { colour: palette.muted, width: 1 });
  if (!analysis) return;
  analysis.locus.forEach(({ re, im }, k) => {
    const small = 1e-9 * Math.hypot(re[0], im[0]);
    for (const { kind, from, to } of stretches(re.length, (i) => re[i] <= small)) {
      const cut = (numbers) => numbers.slice(from, to + 1);
      polyline(u, cut(re), cut(im), { colour: palette.modes[k], dash: kind ? [] : [6, 4] });
    }
    spot(u, re[0], im[0], { colour: palette.modes[k], size: 3, hollow: true });
  });
  const { critical } = analysis;
  if (critical) {
    spot(u, 0, critical.omega, { colour: palette.accent, hollow: true });
    note(u, `P = ${said(units, "load", critical.load, 5)}`, 0, critical.omega, { colour: palette.accent });
  }
  for (const mode of state?.upper ?? []) {
    const least = mode === state.least;
    spot(u, mode.re, mode.im, { colour: least && state.growing ? palette.accent : palette.ink, size: least ? 6 : 4 });
  }
}

/** Deflection at the sensor in time. */
function responsePlot(place, view) {
  return makePlot(place, {
    x: { range: (_, low, high) => [low, high], label: "time t", quantity: (most) => scaleOf(view.units, "time", most) },
    y: { range: (_, low, high) => evenRange(low, high), label: "at the sensor", size: 66, quantity: (most) => scaleOf(view.units, view.measure, most) },
    series: [{ stroke: () => (view.state?.growing ? palette.accent : palette.stable), width: 1.4, points: { show: false } }],
  });
}

function evenRange(low, high) {
  const size = 1.08 * Math.max(Math.abs(low ?? 0), Math.abs(high ?? 0));
  return size > 0 ? [-size, size] : [-1, 1];
}
