// Quantities in SI units, Eq. (5), where the beam's length, stiffness and mass per length are given; else nondimensional.

const QUANTITIES = ["length", "time", "load", "force", "alpha", "beta", "frequency"]; // in the order of the kernel's `scales`
const SI = { length: "m", time: "s", load: "N", force: "N", alpha: "s", beta: "kg/(m s)", frequency: "rad/s", rate: "1/s" };
const PREFIXES = [[1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"]];
const PREFIXED = ["load", "force", "length"];

function unitsOf({ bending_stiffness: EI, mass_per_length: m, length: L }) {
  const isSI = SI.load && [EI, m, L].every((x) => x > 0); // a load without a unit has none of the others
  const sizes = isSI ? kernel.scales(EI, m, L) : QUANTITIES.map(() => 1);
  const size = Object.fromEntries(QUANTITIES.map((name, k) => [name, sizes[k]]));
  size.rate = size.frequency;
  const sound = Object.values(size).every((x) => x > 1e-60 && x < 1e60);
  return isSI && sound ? { isSI, size } : { isSI: false, size: Object.fromEntries(Object.keys(size).map((name) => [name, 1])) };
}

/** Factor of a quantity's numbers and the unit they are then in, for numbers up to a nondimensional size. */
function scaleOf({ isSI, size }, name, most) {
  if (!isSI || !(name in size)) return { factor: 1, unit: "" };
  const [part, prefix] = PREFIXED.includes(name) ? (PREFIXES.find(([x]) => x <= Math.abs(most) * size[name]) ?? PREFIXES[3]) : [1, ""];
  return { factor: size[name] / part, unit: prefix + SI[name] };
}

/** A nondimensional value of a quantity as text, in SI units where there are. */
function said(units, name, value, digits = 4) {
  const { factor, unit } = scaleOf(units, name, value);
  return unit ? `${shown(value * factor, digits)} ${unit}` : shown(value, digits);
}
