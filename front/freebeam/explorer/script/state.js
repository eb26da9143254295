// The case that the page shows: its parameters, their limits, and its form in the address.

const BUILT_IN = ["P", "alpha", "beta", "N", "sensor"];

/** The parameters of the page, in the order of its controls. */
function parametersOf(column) {
  const own = column.parameters.map((p) => ({
    key: BUILT_IN.includes(p.name) ? `own.${p.name}` : p.name,
    own: p.name,
    symbol: p.symbol,
    meaning: p.meaning,
    start: p.default,
    low: p.low,
    high: p.high,
    scale: "linear",
  }));
  const { start } = column;
  const damping = (key, symbol, meaning, low, high, most) =>
    column.damping.includes(key)
      ? [{ key, symbol, meaning, start: start[key], low: 0, high: most, scale: "decades", decades: [low, high] }]
      : [];
  return [
    { key: "P", symbol: "P", meaning: "load", start: start.P, low: 0, high: column.load_max, scale: "load" },
    ...damping("alpha", "α", "internal damping", -6, 0, 100),
    ...damping("beta", "β", "external damping", -3, 2, 1e4),
    { key: "N", symbol: "N", meaning: "Ritz terms", start: start.N, low: 1, high: column.modes, scale: "whole" },
    ...own,
    { key: "sensor", symbol: "xₛ", meaning: "sensor", start: start.sensor, low: 0, high: 1, scale: "linear" },
  ];
}

/** The value that a text says, or why it says none. */
function readValue(parameter, text) {
  const cleaned = text.trim().replace("−", "-");
  const { symbol, low, high, scale } = parameter;
  const said = cleaned === "" ? "nothing" : `“${cleaned.length > 24 ? `${cleaned.slice(0, 23)}…` : cleaned}”`;
  const range = `from ${exact(low)} to ${exact(high)}`;
  if (!/^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(cleaned)) {
    return { why: `${symbol} = ${said}: is not a number; it must be one ${range}, such as ${exact(parameter.start)}` };
  }
  const value = Number(cleaned);
  if (scale === "whole" && !Number.isInteger(value)) {
    return { why: `${symbol} = ${said}: must be a whole number ${range}` };
  }
  if (!(value >= low && value <= high)) return { why: `${symbol} = ${said}: must be ${range}` };
  return { value: value === 0 ? 0 : value };
}

/** Every parameter at its start. */
function startOf(parameters) {
  return Object.fromEntries(parameters.map((parameter) => [parameter.key, parameter.start]));
}

/** A case as the end of an address; what is at its start is said too, so that a link means the same for ever. */
function hashOf(parameters, values) {
  return `#${parameters.map(({ key }) => `${encodeURIComponent(key)}=${exact(values[key])}`).join("&")}`;
}

/** The values that an address names, and why others of it are not taken. */
function readHash(parameters, hash) {
  const values = {};
  const refused = [];
  for (const pair of hash.replace(/^#/, "").split("&").filter(Boolean)) {
    const cut = pair.indexOf("=");
    const [key, text] = [cut < 0 ? pair : pair.slice(0, cut), cut < 0 ? "" : pair.slice(cut + 1)].map(decoded);
    const parameter = parameters.find((known) => known.key === key);
    const read = parameter ? readValue(parameter, text) : { why: `${key.slice(0, 24)}: this page has no such parameter` };
    if (read.why) refused.push(read.why);
    else values[key] = read.value;
  }
  return { values, refused };
}

function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

function ownOf(parameters, values) {
  return Object.fromEntries(parameters.filter((p) => p.own).map((p) => [p.own, values[p.key]]));
}

/** The range of loads that plots show: the column's, or a round one that holds a greater load. */
function rangeFor(column, P) {
  if (P <= column.load_range) return column.load_range;
  const power = 10 ** Math.floor(Math.log10(P));
  return Math.min(column.load_max, [1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10].find((step) => step * power >= P) * power);
}

/** Where a slider stands for a value, and the value where it stands. */
function sliderOf(parameter, range) {
  if (parameter.scale === "whole") return { min: parameter.low, max: parameter.high, step: 1, to: (v) => v, from: (s) => s };
  if (parameter.scale === "decades") return decadeSlider(parameter.decades);
  const [low, high] = parameter.scale === "load" ? [0, range] : [parameter.low, parameter.high];
  const step = parameter.scale === "load" ? range / 1000 : (high - low) / 200;
  const digits = Math.max(0, 2 - Math.floor(Math.log10(step)));
  // the place nearest to the start is the start itself, which even steps may miss
  const from = (s) => (Math.abs(s - parameter.start) < step / 2 ? parameter.start : Number(s.toFixed(digits)));
  return { min: low, max: high, step, to: (v) => v, from };
}

/** Zero at the left end, then 60 places a decade. */
function decadeSlider([low, high]) {
  const places = 60 * (high - low);
  return {
    min: 0,
    max: places + 1,
    step: 1,
    to: (v) => (v === 0 ? 0 : Math.min(places + 1, Math.max(1, 1 + 60 * (Math.log10(v) - low)))),
    from: (s) => (s <= 0 ? 0 : Number((10 ** (low + (s - 1) / 60)).toPrecision(3))),
  };
}
