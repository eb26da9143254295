// Numbers and sentences as the page says them.

/** A number with so many digits, without an exponent where that is readable. */
function shown(value, digits = 4) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size < 1e-3 || size >= 1e6) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
    const short = mantissa.includes(".") ? mantissa.replace(/\.?0+$/, "") : mantissa;
    return `${short}e${Number(exponent)}`.replace(/-/g, "−");
  }
  return value.toPrecision(digits).replace("-", "−");
}

/** The shortest text that reads back as the number. */
function exact(value) {
  return String(value);
}

const KINDS = { flutter: "Flutter", divergence: "Divergence" };

/** The state of the beam in a plain sentence. */
function sentenceOf({ growing, least, number }, critical, P, damping, units) {
  const omega = `ω = ${said(units, "frequency", least.im)}`;
  const mode = number === null ? "a motion" : `mode ${number}`;
  const load = () => said(units, "load", critical.load);
  if (growing) {
    const kind = least.im > 0 ? "flutter" : "divergence";
    const how = kind === "flutter" ? `${mode} grows, ${omega}` : "a shape grows without oscillation";
    if (!critical || critical.load > P) return `${KINDS[kind]}; ${how}.`;
    const since = `since P = ${load()}`;
    if (critical.kind === kind) return `${KINDS[kind]} ${since}; ${how}.`;
    return `${KINDS[kind]} (${critical.kind} ${since}); ${how}.`;
  }
  const again = critical && critical.load < P ? ` again at this load, beyond P = ${load()}` : "";
  if (damping.size === 0) return `Stable${again}; nothing is damped: ${number === null ? "slowest motion" : `lowest mode ${number}`}, ${omega}.`;
  if (least.im === 0) return `Stable${again}; the slowest motion does not oscillate, decay ${said(units, "rate", -least.re)}.`;
  return `Stable${again}; least damped ${number === null ? "motion" : `mode ${number}`}, ${omega}, decay ${said(units, "rate", -least.re, 3)}.`;
}

/** Beyond the critical load: what the linear model is then worth. Below it: how far it is. */
function remarkOf({ growing }, critical, P, limit) {
  if (growing || (critical && critical.load < P)) {
    return (
      "Beyond the critical load the linear model holds only for small motion: " +
      "it says that a disturbance grows, not how far."
    );
  }
  if (critical === undefined) return "";
  if (critical === null) return `No loss of stability up to P = ${exact(limit)}.`;
  return `At ${shown((100 * P) / critical.load, 3)} % of the critical load, where ${critical.kind} begins.`;
}

/** What computes the critical load of a case in a terminal. */
function commandOf({ given, basis, damping, parameters, links }, { N, own, alpha, beta }) {
  const dampings = Object.entries({ alpha, beta }).filter(([key]) => damping.includes(key));
  return [
    `freebeam critical --column ${given} --basis ${basis}${links ? "" : ` --modes ${N}`}`,
    ...parameters.map(({ name }) => `--set ${name}=${exact(own[name])}`),
    ...dampings.map(([key, value]) => `--${key} ${exact(value)}`),
  ].join(" ");
}

function criticalOf(critical, limit, units) {
  if (critical === undefined) return "not computed: two modes have one frequency without load";
  if (!critical) return `none up to ${units.isSI ? said(units, "load", limit) : exact(limit)}`;
  if (critical.load === 0) return "none: something grows at the smallest loads";
  return units.isSI ? said(units, "load", critical.load, 6) : `${exact(Number(critical.load.toPrecision(10)))}`;
}

const NO_FORCE = "No force may act on what has no mass: choose another coordinate, or the motion after release.";

/** What the sensor's plot is of, in a sentence. */
function responseNote(column, { force, place, sensor, reads, rate }, units, problem) {
  const at = (x) => (units.isSI ? said(units, "length", x) : exact(x));
  const what = column.reads[Number(reads ?? 0)];
  const under = problem.rest ? `under P = ${said(units, "load", problem.rest, 3)}` : "without load";
  const seen = column.links ? `The ${what}` : `The ${what} at x = ${at(sensor)}`;
  if (force === "release") {
    const how = column.general ? "its largest deflection 0.01" : "q₁ = 0.01";
    return `${seen}, after release from rest in the first mode ${under}, ${how}; no force acts.`;
  }
  const size = units.isSI ? said(units, "force", SIZE) : exact(SIZE);
  const how = {
    step: "from t = 0 on",
    pulse: `for half a period of the first mode ${under}, ${said(units, "time", pulseLength(problem), 3)}`,
    sine: `as a sine of Ω = ${said(units, "frequency", rate)}`,
  }[force];
  const where = column.links ? `on the ${what}` : `at x = ${at(place)}`;
  const stated = column.forced ? "" : " The column states no force of its own: this one is the page's.";
  return `${seen}, from rest under a ${column.links ? "moment" : "transversal force"} F₀ = ${size} ${where}, ${how}.${stated}`;
}
