// The stability map over two parameters, with a cross-hair at the case.
//
// Its axes count cells: on a logarithmic one place 0 is no damping, then even steps of the logarithm, as the sliders have them.

function mapPlot(place, view, choose) {
  const named = (k) => () => axisName(view, k);
  const plot = makePlot(place, {
    x: { range: () => mapRange(view, 0), label: named(0), ...ticksOf(view, 0) },
    y: { range: () => mapRange(view, 1), label: named(1), size: 58, ...ticksOf(view, 1) },
    draw: (u) => drawMap(u, view),
  });
  const pick = (event) => {
    if (!view.map || (event.type === "pointermove" && event.buttons !== 1)) return;
    const box = plot.over.getBoundingClientRect();
    const x = plot.posToVal(event.clientX - box.left, "x");
    const y = plot.posToVal(event.clientY - box.top, "y");
    const [across, up] = view.map.axes;
    choose({ [across.key]: valueAt(across, x), [up.key]: valueAt(up, y) });
  };
  plot.over.addEventListener("pointerdown", pick);
  plot.over.addEventListener("pointermove", pick);
  return plot;
}

function axisName({ map, parameters }, k) {
  const parameter = parameters.find(({ key }) => key === map?.axes[k].key);
  if (!parameter) return "";
  return parameter.name.length < 30 ? `${parameter.name} ${parameter.symbol}` : parameter.symbol;
}

function mapRange({ map }, k) {
  return [-0.5, (map?.axes[k].values.length ?? 2) - 0.5];
}

/** A tick at zero and at each decade, or at round values. */
function ticksOf(view, which) {
  const axisAt = () => view.map?.axes[which] ?? { log: false, values: [0] };
  const splits = () => {
    const axis = axisAt();
    const { values } = axis;
    if (!axis.log) return roundValues(values[0], values[values.length - 1]).map((value) => cellPlace(axis, value));
    return values.map((_, k) => k).filter((k) => k === 0 || Math.abs(Math.log10(values[k]) % 1) < 1e-6);
  };
  const name = (value) => {
    if (value === 0) return "0";
    const power = Math.round(Math.log10(value));
    const raised = [...String(power)].map((c) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[c] ?? "⁻").join("");
    return power >= -2 && power <= 2 ? String(10 ** power) : `10${raised}`;
  };
  const values = (_, places) => {
    const axis = axisAt();
    if (!axis.log) return places.map((place) => plain(valueAt(axis, place)));
    // the first decade stands beside zero, where two names would not fit
    return places.map((k) => (k === 1 ? "" : name(axis.values[k] ?? 0)));
  };
  return { splits, values };
}

/** Place of a value on an axis of the map, between cells too. */
function cellPlace({ log, values }, value) {
  const last = values.length - 1;
  if (!log) return Math.min(last, Math.max(0, ((value - values[0]) / (values[last] - values[0])) * last));
  if (value <= 0) return 0;
  const [low, high] = [Math.log10(values[1]), Math.log10(values[last])];
  return Math.min(last, Math.max(1, 1 + ((Math.log10(value) - low) / (high - low)) * (last - 1)));
}

function valueAt({ log, values }, place) {
  const last = values.length - 1;
  if (!log) return Number((values[0] + (Math.min(last, Math.max(0, place)) / last) * (values[last] - values[0])).toPrecision(3));
  if (place < 0.5) return 0;
  const [low, high] = [Math.log10(values[1]), Math.log10(values[last])];
  const share = Math.min(1, Math.max(0, (place - 1) / (last - 1)));
  return Number((10 ** (low + share * (high - low))).toPrecision(3));
}

/** The least and greatest load of a map, for its colours. */
function mapSpan(loads) {
  let [low, high] = [Infinity, 0];
  for (const load of loads) {
    if (!Number.isFinite(load) || load <= 0) continue;
    low = Math.min(low, load);
    high = Math.max(high, load);
  }
  return low <= high ? { low, high, even: high - low < 1e-6 * high } : null;
}

/** Share of the colour scale, which is logarithmic. */
function shareOf(load, { low, high, even }) {
  return even ? 0.5 : Math.log(load / low) / Math.log(high / low);
}

function drawMap(u, { map, values }) {
  if (!map) return;
  const [x, y] = map.axes;
  const span = map.isLoad ? null : mapSpan(map.loads);
  const [n, m] = [x.values.length, y.values.length];
  drawCells(u, map, span, n, m);
  if (span) drawBoundary(u, map, values.P, n, m);
  drawCross(u, cellPlace(x, values[x.key] ?? 0), cellPlace(y, values[y.key] ?? 0));
}

/** Colour of a cell: of its critical load, or of what the motion does. */
function colourOf(load, { isLoad }, span) {
  if (load === UNSOUND) return MAP_COLOURS.unsound;
  if (isLoad) return MAP_COLOURS[VERDICTS[load]] ?? MAP_COLOURS.none;
  return Number.isFinite(load) && span ? cividis(shareOf(load, span)) : MAP_COLOURS.none;
}

function drawCells(u, map, span, n, m) {
  const { ctx } = u;
  const wide = Math.abs(pixel(u, 1, 0)[0] - pixel(u, 0, 0)[0]);
  const tall = Math.abs(pixel(u, 0, 1)[1] - pixel(u, 0, 0)[1]);
  // four parts, so that nothing is smoothed between no damping and some
  const parts = (axis, count) => (axis.log ? [[0, 1], [1, count - 1]] : [[0, count]]);
  for (const [i, columns] of parts(map.axes[0], n)) {
    for (const [j, rows] of parts(map.axes[1], m)) {
      const [x, y] = pixel(u, i, j + rows - 1);
      ctx.imageSmoothingEnabled = !map.isLoad; // there is nothing between stable and flutter
      ctx.drawImage(keptImage(map, span, n, i, j, columns, rows), x - wide / 2, y - tall / 2, wide * columns, tall * rows);
    }
  }
  // a gap sets the cells without damping apart: they are no limit of those beside them
  const gap = { colour: palette.panel, width: 3 };
  if (map.axes[0].log) polyline(u, [0.5, 0.5], [u.scales.y.min, u.scales.y.max], gap);
  if (map.axes[1].log) polyline(u, [u.scales.x.min, u.scales.x.max], [0.5, 0.5], gap);
}

function keptImage(map, ...rest) {
  map.images ??= {};
  return (map.images[rest.slice(2)] ??= imageOf(map, ...rest));
}

/** A rectangle of cells as a picture, a pixel each. */
function imageOf(map, span, n, i, j, columns, rows) {
  const { loads } = map;
  const canvas = document.createElement("canvas");
  Object.assign(canvas, { width: columns, height: rows });
  const context = canvas.getContext("2d");
  const image = context.createImageData(columns, rows);
  for (let row = 0; row < rows; row++) {
    for (let k = 0; k < columns; k++) {
      const load = nearestKnown(loads, i + k, j + rows - 1 - row, n);
      const colour = colourOf(load, map, span);
      image.data.set([...colour, Number.isNaN(load) ? 0 : 255], 4 * (row * columns + k));
    }
  }
  context.putImageData(image, 0, 0);
  return canvas;
}

/** The load of a cell; while the map is coarse, of the cell computed before it. */
function nearestKnown(loads, i, j, n) {
  for (const stride of [1, 2, 4, 8]) {
    const load = loads[(j - (j % stride)) * n + (i - (i % stride))];
    if (!Number.isNaN(load)) return load;
  }
  return NaN;
}

/** Where the critical load is the present load: between stable and not. */
function drawBoundary(u, map, P, n, m) {
  const { ctx } = u;
  map.logs ??= map.loads.map((_, k) => Math.log(Math.max(1e-9, nearestKnown(map.loads, k % n, Math.floor(k / n), n))));
  const [across, up] = map.axes.map((axis) => (axis.log ? 1 : 0)); // a strip without damping is no part of the field
  const level = Math.log(Math.max(P, 1e-9));
  const excess = (i, j) => Math.min(5, map.logs[j * n + i] - level); // no critical load: far above
  const edges = [];
  for (let j = 0; j < m; j++) {
    for (let i = 0; i < n; i++) {
      if (i >= across && j >= up && i + 1 < n && j + 1 < m) edges.push(...crossings(excess, i, j));
      if (across && i === 0 && j + 1 < m && j >= up) edges.push(...steps(excess(0, j), excess(0, j + 1), [-0.5, j + 0.5, 0.5, j + 0.5]));
      if (up && j === 0 && i + 1 < n && i >= across) edges.push(...steps(excess(i, 0), excess(i + 1, 0), [i + 0.5, -0.5, i + 0.5, 0.5]));
    }
  }
  for (const [colour, width] of [["#ffffff", 4.5], [palette.accent, 2.2]]) {
    ctx.strokeStyle = colour;
    ctx.lineWidth = width * uPlot.pxRatio;
    ctx.lineCap = "round";
    ctx.beginPath();
    for (const [x, y, X, Y] of edges) {
      ctx.moveTo(...pixel(u, x, y));
      ctx.lineTo(...pixel(u, X, Y));
    }
    ctx.stroke();
  }
}

function steps(before, after, edge) {
  return before > 0 !== after > 0 ? [edge] : [];
}

/** Zero line of a function within a square of four places, by linear interpolation along its sides. */
function crossings(value, i, j) {
  const corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
  const values = corners.map((corner) => value(...corner));
  if (values.every((x) => x > 0) || !values.some((x) => x > 0)) return [];
  const points = [];
  corners.forEach(([x, y], k) => {
    const [X, Y] = corners[(k + 1) % 4];
    const [a, b] = [values[k], values[(k + 1) % 4]];
    if (a > 0 === b > 0 || Number.isNaN(a + b)) return;
    const t = a / (a - b);
    points.push([x + t * (X - x), y + t * (Y - y)]);
  });
  const edges = [];
  for (let k = 0; k + 1 < points.length; k += 2) edges.push([...points[k], ...points[k + 1]]);
  return edges;
}

function drawCross(u, x, y) {
  const lines = [
    [[x, x], [u.scales.y.min, u.scales.y.max]],
    [[u.scales.x.min, u.scales.x.max], [y, y]],
  ];
  for (const [colour, width] of [["#000000", 3], ["#ffffff", 1.2]]) {
    for (const [xs, ys] of lines) polyline(u, xs, ys, { colour, width });
  }
  spot(u, x, y, { colour: "#000000", size: 5 });
}
