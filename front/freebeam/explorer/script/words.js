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
function sentenceOf({ growing, least, number }, critical, P, damping) {
  const omega = `ω = ${shown(least.im)}`;
  if (growing) {
    const kind = least.im > 0 ? "flutter" : "divergence";
    const how = kind === "flutter" ? `mode ${number} grows, ${omega}` : "a shape grows without oscillation";
    if (!critical || critical.load > P) return `${KINDS[kind]}; ${how}.`;
    const since = `since P = ${shown(critical.load)}`;
    if (critical.kind === kind) return `${KINDS[kind]} ${since}; ${how}.`;
    return `${KINDS[kind]} (${critical.kind} ${since}); ${how}.`;
  }
  const again = critical && critical.load < P ? ` again at this load, beyond P = ${shown(critical.load)}` : "";
  if (damping.size === 0) return `Stable${again}; nothing is damped: lowest mode ${number}, ${omega}.`;
  if (least.im === 0) return `Stable${again}; the slowest motion does not oscillate, decay ${shown(-least.re)}.`;
  return `Stable${again}; least damped mode ${number}, ${omega}, decay ${shown(-least.re, 3)}.`;
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
function commandOf({ given, basis, damping, parameters }, { N, own, alpha, beta }) {
  const dampings = Object.entries({ alpha, beta }).filter(([key]) => damping.includes(key));
  return [
    `freebeam critical --column ${given} --basis ${basis} --modes ${N}`,
    ...parameters.map(({ name }) => `--set ${name}=${exact(own[name])}`),
    ...dampings.map(([key, value]) => `--${key} ${exact(value)}`),
  ].join(" ");
}

function criticalOf(critical, limit) {
  if (critical === undefined) return "not computed: two modes have one frequency without load";
  if (!critical) return `none up to ${limit}`;
  return `${exact(Number(critical.load.toPrecision(10)))}`;
}
