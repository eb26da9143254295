// The stability map: critical load over both dampings, with a cross-hair at the case.
//
// Its axes count cells: place 0 is no damping, then even steps of the logarithm, as the sliders have them.

function mapPlot(place, view, choose) {
  const plot = makePlot(place, {
    x: { range: () => mapRange(view, "alpha"), label: "internal damping α", ...ticksOf(view, "alpha") },
    y: { range: () => mapRange(view, "beta"), label: "external damping β", size: 58, ...ticksOf(view, "beta") },
    draw: (u) => drawMap(u, view),
  });
  const pick = (event) => {
    if (!view.map || (event.type === "pointermove" && event.buttons !== 1)) return;
    const box = plot.over.getBoundingClientRect();
    const x = plot.posToVal(event.clientX - box.left, "x");
    const y = plot.posToVal(event.clientY - box.top, "y");
    choose(dampingAt(view.map.axes.alpha, x), dampingAt(view.map.axes.beta, y));
  };
  plot.over.addEventListener("pointerdown", pick);
  plot.over.addEventListener("pointermove", pick);
  return plot;
}

function mapRange({ map }, key) {
  return [-0.5, (map?.axes[key].length ?? 2) - 0.5];
}

/** A tick at zero and at each decade. */
function ticksOf(view, key) {
  const splits = () => {
    const axis = view.map?.axes[key] ?? [0];
    return axis.map((_, k) => k).filter((k) => k === 0 || Math.abs(Math.log10(axis[k]) % 1) < 1e-6);
  };
  const name = (value) => {
    if (value === 0) return "0";
    const power = Math.round(Math.log10(value));
    const raised = [...String(power)].map((c) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[c] ?? "⁻").join("");
    return power >= -2 && power <= 2 ? String(10 ** power) : `10${raised}`;
  };
  // the first decade stands beside zero, where two names would not fit
  const values = (_, places) => places.map((k) => (k === 1 ? "" : name(view.map?.axes[key][k] ?? 0)));
  return { splits, values };
}

/** Place of a damping on an axis of the map, between cells too. */
function cellOf(axis, value) {
  if (value <= 0 || axis.length < 2) return 0;
  const [low, high] = [Math.log10(axis[1]), Math.log10(axis[axis.length - 1])];
  return Math.min(axis.length - 1, Math.max(1, 1 + ((Math.log10(value) - low) / (high - low)) * (axis.length - 2)));
}

function dampingAt(axis, place) {
  if (axis.length < 2 || place < 0.5) return 0;
  const [low, high] = [Math.log10(axis[1]), Math.log10(axis[axis.length - 1])];
  const share = Math.min(1, Math.max(0, (place - 1) / (axis.length - 2)));
  return Number((10 ** (low + share * (high - low))).toPrecision(3));
}

/** The least and greatest load of a map, for its colours. */
function mapSpan(loads) {
  let [low, high] = [Infinity, 0];
  for (const load of loads) {
    if (!Number.isFinite(load)) continue;
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
  const span = mapSpan(map.loads);
  const [n, m] = [map.axes.alpha.length, map.axes.beta.length];
  drawCells(u, map, span, n, m);
  if (span) drawBoundary(u, map, values.P, n, m);
  drawCross(u, cellOf(map.axes.alpha, values.alpha ?? 0), cellOf(map.axes.beta, values.beta ?? 0));
}

function drawCells(u, map, span, n, m) {
  const { ctx } = u;
  const wide = Math.abs(pixel(u, 1, 0)[0] - pixel(u, 0, 0)[0]);
  const tall = Math.abs(pixel(u, 0, 1)[1] - pixel(u, 0, 0)[1]);
  // four parts, so that nothing is smoothed between no damping and some
  for (const [i, columns] of [[0, 1], [1, n - 1]]) {
    for (const [j, rows] of [[0, 1], [1, m - 1]]) {
      if (!columns || !rows) continue;
      const [x, y] = pixel(u, i, j + rows - 1);
      ctx.drawImage(keptImage(map, span, n, i, j, columns, rows), x - wide / 2, y - tall / 2, wide * columns, tall * rows);
    }
  }
  // a gap sets the cells without damping apart: they are no limit of those beside them
  const gap = { colour: palette.panel, width: 3 };
  if (n > 1) polyline(u, [0.5, 0.5], [u.scales.y.min, u.scales.y.max], gap);
  if (m > 1) polyline(u, [u.scales.x.min, u.scales.x.max], [0.5, 0.5], gap);
}

function keptImage(map, ...rest) {
  map.images ??= {};
  return (map.images[rest.slice(2)] ??= imageOf(map, ...rest));
}

/** A rectangle of cells as a picture, a pixel each. */
function imageOf({ loads }, span, n, i, j, columns, rows) {
  const canvas = document.createElement("canvas");
  Object.assign(canvas, { width: columns, height: rows });
  const context = canvas.getContext("2d");
  const image = context.createImageData(columns, rows);
  for (let row = 0; row < rows; row++) {
    for (let k = 0; k < columns; k++) {
      const load = nearestKnown(loads, i + k, j + rows - 1 - row, n);
      const colour = Number.isFinite(load) && span ? cividis(shareOf(load, span)) : [128, 128, 128];
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
  map.logs ??= map.loads.map((_, k) => Math.log(nearestKnown(map.loads, k % n, Math.floor(k / n), n)));
  const level = Math.log(Math.max(P, 1e-9));
  const excess = (i, j) => Math.min(5, map.logs[j * n + i] - level); // no critical load: far above
  const edges = [];
  for (let j = 0; j < m; j++) {
    for (let i = 0; i < n; i++) {
      if (i >= 1 && j >= 1 && i + 1 < n && j + 1 < m) edges.push(...crossings(excess, i, j));
      if (i === 0 && j + 1 < m && j > 0) edges.push(...steps(excess(0, j), excess(0, j + 1), [-0.5, j + 0.5, 0.5, j + 0.5]));
      if (j === 0 && i + 1 < n && i > 0) edges.push(...steps(excess(i, 0), excess(i + 1, 0), [i + 0.5, -0.5, i + 0.5, 0.5]));
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
