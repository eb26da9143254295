// The case that the page shows: its parameters, their limits, and its form in the address.

const BUILT_IN = [
  "P", "alpha", "beta", "N", "sensor", "reads", "force", "place", "rate", "across", "up", "length", "bending_stiffness", "mass_per_length",
];
const FORCES = { release: "released", step: "step force", pulse: "pulse", sine: "sine force" };

/** The parameters of the page, in the order of its controls; panel: where a control stands that is not with the others. */
function parametersOf(column) {
  const { start } = column;
  const own = column.parameters.map((p) => {
    const [name, hint] = p.meaning.split(/[:;] (.*)/);
    return {
      key: BUILT_IN.includes(p.name) ? `own.${p.name}` : p.name,
      own: p.name, symbol: p.symbol, name, hint, tip: p.meaning, start: p.default, low: p.low, high: p.high, scale: "linear",
    };
  });
  const damping = (key, symbol, name, tip, low, high, most) =>
    column.damping.includes(key)
      ? [{ key, symbol, name, tip, start: start[key], low: 0, high: most, scale: "decades", decades: [low, high], quantity: key }]
      : [];
  const shown = [
    { key: "P", symbol: "P", name: "load", tip: "The load on the column, nondimensional", start: start.P, low: 0, high: column.load_max, scale: "load", quantity: "load" },
    ...damping("alpha", "α", "internal damping", "Damping of the material: it resists the rate of bending", -6, 0, 100),
    ...damping("beta", "β", "external damping", "Damping by the medium around: it resists the velocity", -3, 2, 1e4),
    ...(column.links ? [] : [{
      key: "N", symbol: "N", name: column.general ? "functions a segment" : "Ritz terms", start: start.N, low: column.least, high: column.modes, scale: "whole",
      tip: "Number of functions that the motion is a sum of; more are more exact and slower",
    }]),
    ...own,
  ];
  const axes = shown.filter(({ key }) => key !== "N").map(({ key, symbol, name }) => [key, `${symbol} ${name}`]);
  return [...shown, ...responseParameters(column), ...mapParameters(axes), ...(column.si ? unitParameters() : [])];
}

/** What the sensor's plot is of. */
function responseParameters({ start, reads, links }) {
  const panel = "response-controls";
  const seen = reads.map((name, k) => [String(k), name]);
  return [
    { key: "force", symbol: "", name: "motion", tip: "What sets the column in motion", start: "release", scale: "choice", choices: Object.entries(FORCES), panel },
    ...(links ? [] : [
      { key: "sensor", symbol: "xₛ", name: "sensor", tip: "Place of the sensor along the column, in units of its length", start: start.sensor, low: 0, high: 1, scale: "linear", panel },
      { key: "place", symbol: "x_F", name: "place of the force", tip: "Where the transversal force acts, in units of the length", start: start.place, low: 0, high: 1, scale: "linear", panel },
    ]),
    ...(seen.length > 1 ? [{ key: "reads", symbol: "", name: "sensor reads", tip: links ? "What is drawn, and what the force acts on" : "What is drawn", start: "0", scale: "choice", choices: seen, panel }] : []),
    { key: "rate", symbol: "Ω", name: "frequency of the sine", tip: "Circular frequency of the sine force", start: start.rate, low: 0, high: 10 * start.rate, scale: "linear", quantity: "frequency", panel },
  ];
}

/** The two parameters that the map is over; none where there is only the load. */
function mapParameters(axes) {
  if (axes.length < 2) return [];
  const keys = axes.map(([key]) => key);
  const [across, up] = keys.includes("alpha") && keys.includes("beta") ? ["alpha", "beta"] : [keys.find((key) => key !== "P"), "P"];
  const one = (key, name, start) => ({ key, symbol: "", name, tip: `The parameter that the map has ${name}`, start, scale: "choice", choices: axes, panel: "map-controls" });
  return [one("across", "across", across), one("up", "up", up)];
}

/** The beam in SI units; nothing where all is nondimensional. */
function unitParameters() {
  const one = (key, symbol, name, tip) => ({ key, symbol, name, tip, start: null, low: 0, high: 1e30, scale: "optional", panel: "unit-controls" });
  return [
    one("length", "L", "length, m", "Length of the beam in m"),
    one("bending_stiffness", "EI", "bending stiffness, N m²", "Bending stiffness of the beam in N m²"),
    one("mass_per_length", "m", "mass per length, kg/m", "Mass per length of the beam in kg/m"),
  ];
}

/** The value that a text says, or why it says none. */
function readValue(parameter, text) {
  const cleaned = text.trim().replace("−", "-");
  const { name, low, high, scale, choices } = parameter;
  const symbol = parameter.symbol || name;
  if (scale === "choice") {
    const isKnown = choices.some(([key]) => key === cleaned);
    return isKnown ? { value: cleaned } : { why: `${symbol} = “${cleaned.slice(0, 24)}”: must be one of ${choices.map(([key]) => key).join(", ")}` };
  }
  if (scale === "optional" && cleaned === "") return { value: null };
  const said = cleaned === "" ? "nothing" : `“${cleaned.length > 24 ? `${cleaned.slice(0, 23)}…` : cleaned}”`;
  const range = `from ${exact(low)} to ${exact(high)}`;
  if (!/^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(cleaned)) {
    return { why: `${symbol} = ${said}: is not a number; it must be one ${range}${parameter.start === null ? "" : `, such as ${exact(parameter.start)}`}` };
  }
  const value = Number(cleaned);
  if (scale === "whole" && !Number.isInteger(value)) {
    return { why: `${symbol} = ${said}: must be a whole number ${range}` };
  }
  if (scale === "optional" && value === 0) return { why: `${symbol} = 0: must be above 0, or nothing` };
  if (!(value >= low && value <= high)) return { why: `${symbol} = ${said}: must be ${range}` };
  return { value: value === 0 ? 0 : value };
}

/** Every parameter at its start. */
function startOf(parameters) {
  return Object.fromEntries(parameters.map((parameter) => [parameter.key, parameter.start]));
}

/** A case as the end of an address; what is at its start is said too, so that a link means the same for ever. */
function hashOf(parameters, values) {
  const said = parameters.filter(({ key }) => values[key] !== null);
  return `#${said.map(({ key }) => `${encodeURIComponent(key)}=${exact(values[key])}`).join("&")}`;
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
