// The beam in its least stable mode, with what acts on it. Deflections are enlarged; the load is drawn as the column's
// own virtual work has it: axial force at the ends, and the transversal parts −c y′ at the ends and along the beam.

const PERIOD = 1.8; // seconds on the screen for a period of the unloaded beam's first mode

function beamView(canvas, column) {
  const context = canvas.getContext("2d");
  const view = { canvas, context, column, motion: null, clock: 0, width: 0, height: 0, load: null, sensor: null, force: null, marks: [] };
  new ResizeObserver(() => fit(view)).observe(canvas);
  fit(view);
  return view;
}

function fit(view) {
  const { canvas, context } = view;
  const ratio = window.devicePixelRatio || 1;
  view.width = canvas.clientWidth;
  view.height = canvas.clientHeight;
  canvas.width = Math.round(view.width * ratio);
  canvas.height = Math.round(view.height * ratio);
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  if (view.motion) drawBeam(view);
}

/** Phase and size of the motion at a time on the screen, in seconds. */
function pace(motion, reference, clock) {
  const { growth, omega } = motion;
  // high modes are shown slower and low ones faster than they are, so that the eye can follow
  const turn = omega > 0 ? PERIOD * Math.min(2, Math.max(0.5, reference / omega)) : PERIOD;
  const nondimensional = ((2 * Math.PI) / (omega > 0 ? omega : reference)) * (1 / turn);
  const rate = growth * nondimensional; // per second on the screen
  const span = rate > 0 ? Math.min(14, Math.log(8) / rate + 1.2) : 12;
  const time = clock % span;
  const size = rate > 0 ? Math.min(1, Math.exp(rate * time) / 8) : Math.exp(rate * time);
  const fade = Math.min(1, time / 0.3, (span - time) / 0.3);
  return { phase: (2 * Math.PI * clock) / turn, size: size * fade };
}

function drawBeam(view) {
  const { context, width, height, motion, reference } = view;
  context.clearRect(0, 0, width, height);
  const { phase, size } = view.still ? { phase: 0, size: 1 } : pace(motion, reference, view.clock);
  const frame = frameOf(view);
  drawRest(view, frame);
  drawEnvelope(view, frame);
  if (view.still) for (const k of [1, 2, 3]) drawShape(view, frame, deflections(motion, (k * Math.PI) / 3, 1), 1.2, 0.45);
  const y = deflections(motion, motion.omega > 0 ? phase : 0, size);
  drawSupports(view, frame, y);
  drawShape(view, frame, y, frame.thick, 1);
  drawMarks(view, frame, y);
  if (view.sensor !== null) drawSensor(view, frame, y);
  if (view.force !== null) drawForce(view, frame, y);
  drawLoads(view, frame, y);
}

function frameOf({ width, height, column }) {
  const left = column.ends[0] === "free" ? Math.max(26, width * 0.06) : Math.max(34, width * 0.07);
  const right = Math.max(86, width * 0.15);
  const length = width - left - right;
  return { left, length, middle: height * 0.52, swing: Math.min(height * 0.33, length * 0.2), thick: width < 500 ? 5 : 7 };
}

function deflections(motion, phase, size) {
  const [c, s] = [size * Math.cos(phase), size * Math.sin(phase)];
  return motion.re.map((x, i) => c * x - s * motion.im[i]);
}

function placeOf(frame, y, share) {
  const at = share * (PLACES - 1);
  const k = Math.min(PLACES - 2, Math.floor(at));
  const value = y[k] + (at - k) * (y[k + 1] - y[k]);
  const slope = ((y[k + 1] - y[k]) * (PLACES - 1) * frame.swing) / frame.length; // as drawn, upward positive
  return { x: frame.left + share * frame.length, y: frame.middle - frame.swing * value, slope };
}

function trace(context, frame, y) {
  for (let i = 0; i < PLACES; i++) {
    const x = frame.left + (frame.length * i) / (PLACES - 1);
    context[i ? "lineTo" : "moveTo"](x, frame.middle - frame.swing * y[i]);
  }
}

function drawRest({ context, width }, frame) {
  context.strokeStyle = palette.grid;
  context.lineWidth = 1;
  context.setLineDash([4, 5]);
  context.beginPath();
  context.moveTo(Math.max(4, frame.left - 20), frame.middle);
  context.lineTo(Math.min(width - 4, frame.left + frame.length + 20), frame.middle);
  context.stroke();
  context.setLineDash([]);
}

function drawEnvelope({ context, motion, colour }, frame) {
  const outer = motion.re.map((x, i) => Math.hypot(x, motion.im[i]));
  context.globalAlpha = 0.1;
  context.fillStyle = colour;
  context.beginPath();
  trace(context, frame, outer);
  for (let i = PLACES - 1; i >= 0; i--) {
    context.lineTo(frame.left + (frame.length * i) / (PLACES - 1), frame.middle + frame.swing * outer[i]);
  }
  context.fill();
  context.globalAlpha = 1;
}

function drawShape({ context, colour }, frame, y, thick, alpha) {
  context.globalAlpha = alpha;
  context.strokeStyle = colour;
  context.lineWidth = thick;
  context.lineCap = "round";
  context.lineJoin = "round";
  context.beginPath();
  trace(context, frame, y);
  context.stroke();
  context.globalAlpha = 1;
}

function drawSensor({ context, sensor }, frame, y) {
  const place = placeOf(frame, y, sensor);
  context.fillStyle = palette.panel;
  context.strokeStyle = palette.ink;
  context.lineWidth = 1.6;
  context.beginPath();
  context.arc(place.x, place.y, frame.thick * 0.75, 0, 2 * Math.PI);
  context.fill();
  context.stroke();
  if (sensor > 0.1 && sensor < 0.9) return write(context, "sensor", place.x, place.y - frame.thick - 8, "center");
  // near an end the word lies along the beam, inward: outside are the load's arrow and the support
  context.save();
  context.translate(place.x, place.y);
  context.rotate(-Math.atan(place.slope));
  write(context, "sensor", 0, -frame.thick - 8, sensor < 0.5 ? "left" : "right");
  context.restore();
}

/** The transversal force of the sensor's plot. */
function drawForce({ context, force }, frame, y) {
  const place = placeOf(frame, y, force);
  drawArrow(context, place, { x: 0, y: 1 }, 34, frame.thick, false);
  write(context, "F₀", place.x, place.y + frame.thick + 42, "center");
}

/** Masses filled, joints hollow, springs and dampers as short lines to the ground. */
function drawMarks({ context, marks }, frame, y) {
  for (const [kind, share] of marks) {
    const place = placeOf(frame, y, share);
    context.fillStyle = kind === "mass" ? palette.ink : palette.panel;
    context.strokeStyle = palette.ink;
    context.lineWidth = 1.5;
    context.beginPath();
    if (kind === "ground") {
      for (let k = 0; k <= 7; k++) {
        const x = place.x + (k === 0 || k === 7 ? 0 : k % 2 ? 5 : -5);
        context[k ? "lineTo" : "moveTo"](x, place.y + frame.thick / 2 + (k * frame.swing) / 8);
      }
      context.moveTo(place.x - 12, place.y + frame.thick / 2 + (7 * frame.swing) / 8);
      context.lineTo(place.x + 12, place.y + frame.thick / 2 + (7 * frame.swing) / 8);
    } else {
      context.arc(place.x, place.y, kind === "mass" ? frame.thick * 1.25 : frame.thick * 0.7, 0, 2 * Math.PI);
      context.fill();
    }
    context.stroke();
  }
}

/** A place as the page is told it: a number, or the number of a break, which a parameter moves. */
function placeAt(place, own) {
  return typeof place === "number" ? place : kernel.places(own)[place.break];
}

/** What acts on a column of segments, for the drawing: forces that turn with the slope, or the load along its axis. */
function generalLoad({ followers, axial, along }, own) {
  return { ends: [0, 0], axial, along, followers: followers.map((place) => placeAt(place, own)) };
}

function write(context, text, x, y, align) {
  context.font = `12px ${palette.font}`;
  context.textAlign = align;
  context.textBaseline = "middle";
  context.lineWidth = 3;
  context.strokeStyle = palette.panel;
  context.strokeText(text, x, y);
  context.fillStyle = palette.muted;
  context.fillText(text, x, y);
}

function drawSupports({ context, column }, frame, y) {
  column.ends.forEach((kind, end) => {
    if (kind === "free") return;
    const side = end ? 1 : -1;
    const at = placeOf(frame, y, end);
    context.strokeStyle = palette.muted;
    context.fillStyle = palette.muted;
    context.lineWidth = 1.5;
    if (kind === "pinned") drawPin(context, at, end === 1);
    else drawWall(context, at.x + (side * frame.thick) / 2, kind === "sliding" ? frame.middle : at.y, side, kind, frame);
  });
}

function drawPin(context, { x, y }, rolls) {
  context.beginPath();
  context.moveTo(x, y + 3);
  context.lineTo(x - 9, y + 19);
  context.lineTo(x + 9, y + 19);
  context.closePath();
  context.stroke();
  const base = rolls ? y + 25 : y + 19;
  context.beginPath();
  context.moveTo(x - 15, base);
  context.lineTo(x + 15, base);
  context.stroke();
}

function drawWall(context, x, y, side, kind, frame) {
  const half = kind === "sliding" ? frame.swing * 1.05 : 26;
  context.beginPath();
  context.moveTo(x, y - half);
  context.lineTo(x, y + half);
  for (let h = -half; h < half; h += 9) {
    context.moveTo(x, y + h + 9);
    context.lineTo(x + side * 8, y + h);
  }
  context.stroke();
}

/** Forces: at the ends, and where the load is spread along the beam. Directions as they act at this moment. */
function drawLoads(view, frame, y) {
  const { context, column, load } = view;
  if (!load || load.P === 0) return;
  const size = 26 + 50 * Math.min(1.2, Math.abs(load.P) / load.range);
  const axial = (x) => load.axial.reduceRight((sum, c) => sum * x + c, 0);
  for (const end of [1, 0]) {
    const compression = axial(end);
    if (Math.abs(compression) < 1e-12 || (end === 0 && column.ends[0] !== "free")) continue;
    const at = placeOf(frame, y, end);
    const force = { x: end ? -compression : compression, y: -load.ends[end] * at.slope };
    drawArrow(context, at, force, size, frame.thick, true);
  }
  for (const place of load.followers ?? []) {
    const at = placeOf(frame, y, place);
    drawArrow(context, at, { x: -1, y: -at.slope }, size, frame.thick, true);
  }
  drawSpread(view, frame, y, axial, size);
}

function drawSpread({ context, load }, frame, y, axial, size) {
  const slope = (x) => (axial(x + 1e-4) - axial(x - 1e-4)) / 2e-4;
  const follower = (x) => load.along.reduceRight((sum, c) => sum * x + c, 0);
  for (let k = 0; k < 12; k++) {
    const x = (k + 0.5) / 12;
    // an axial force that grows along the beam is the inertia of a beam that a force pushes, and no load
    const pressing = Math.max(0, -slope(x));
    if (pressing < 1e-9 && Math.abs(follower(x)) < 1e-9) continue;
    const at = placeOf(frame, y, x);
    const force = { x: -pressing, y: -follower(x) * at.slope };
    drawArrow(context, { x: at.x, y: at.y - 14 }, force, (size * Math.hypot(force.x, force.y)) / 4, 0, false);
  }
}

/** An arrow whose head is at a place and whose direction is a force's. */
function drawArrow(context, at, force, length, gap, labelled) {
  const norm = Math.hypot(force.x, force.y);
  if (!(norm > 0) || length < 3) return;
  const [ux, uy] = [force.x / norm, -force.y / norm]; // the screen's y grows downward
  const head = Math.min(11, length * 0.6);
  const tip = { x: at.x - gap * ux, y: at.y - gap * uy };
  const tail = { x: tip.x - length * ux, y: tip.y - length * uy };
  context.strokeStyle = palette.ink;
  context.fillStyle = palette.ink;
  context.lineWidth = labelled ? 3 : 1.4;
  context.lineCap = "butt";
  context.beginPath();
  context.moveTo(tail.x, tail.y);
  context.lineTo(tip.x - head * 0.8 * ux, tip.y - head * 0.8 * uy);
  context.stroke();
  context.beginPath();
  context.moveTo(tip.x, tip.y);
  context.lineTo(tip.x - head * ux - head * 0.45 * uy, tip.y - head * uy + head * 0.45 * ux);
  context.lineTo(tip.x - head * ux + head * 0.45 * uy, tip.y - head * uy - head * 0.45 * ux);
  context.fill();
  if (labelled) write(context, "P", tail.x - 9 * ux, tail.y - 9 * uy, "center");
}
