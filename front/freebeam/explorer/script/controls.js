// Sliders and number boxes.

/** Builds the controls; `change(key, value, typed)` is called with each value that makes sense. */
function buildControls(place, parameters, change) {
  const controls = {};
  for (const parameter of parameters) {
    const control = (parameter.scale === "choice" ? buildChoice : buildControl)(parameter, change);
    (document.getElementById(parameter.panel) ?? place).append(control.element);
    controls[parameter.key] = control;
  }
  return controls;
}

function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

/** The words of a control: its label, and the tip that a pointer shows and a screen reader says. */
function wordsOf({ key, symbol, name, tip }) {
  const id = key.replace(/\W/g, "-");
  const label = make("label", { for: `box-${id}`, title: tip }, ...(symbol ? [make("i", {}, symbol), " "] : []), name);
  return { id, label, told: make("span", { id: `tip-${id}`, class: "aside" }, tip) };
}

/** A parameter that is one of a few. */
function buildChoice(parameter, change) {
  const { id, label, told } = wordsOf(parameter);
  const box = make("select", { id: `box-${id}`, name: parameter.key, title: parameter.tip, "aria-describedby": `tip-${id}` });
  box.append(...parameter.choices.map(([value, text]) => make("option", { value }, text)));
  box.addEventListener("change", () => change(parameter.key, box.value, true));
  return { parameter, element: make("div", { class: "control choice", "data-key": parameter.key }, label, box, told), box };
}

function buildControl(parameter, change) {
  const { key, symbol, name, hint, tip } = parameter;
  const { id, label, told } = wordsOf(parameter);
  const box = make("input", {
    id: `box-${id}`, name: key, type: "text", inputmode: "decimal", autocomplete: "off", spellcheck: "false", title: tip,
    "aria-describedby": `tip-${id} why-${id}`,
  });
  const slider = make("input", { id: `slider-${id}`, type: "range", title: tip, "aria-label": `${symbol}, ${name}`, "aria-describedby": `tip-${id}` });
  const why = make("p", { id: `why-${id}`, class: "why", role: "alert" });
  const si = make("small", { class: "si" });
  label.append(si);
  const element = make("div", { class: "control", "data-key": key }, label, box, slider, told, why);
  if (parameter.scale === "optional") slider.remove();
  if (hint) slider.after(make("p", { class: "hint", "aria-hidden": "true" }, hint));
  const control = { parameter, element, box, slider, why, si, change, scale: null, value: NaN };
  slider.addEventListener("input", () => {
    complain(control, "");
    change(key, control.scale.from(Number(slider.value)), false);
  });
  box.addEventListener("input", () => {
    const read = readValue(parameter, box.value);
    if (!read.why && read.value !== control.value && parameter.scale !== "optional") {
      complain(control, "");
      change(key, read.value, true);
    }
  });
  box.addEventListener("change", () => settleBox(control));
  box.addEventListener("keydown", (event) => stepBox(event, control, change));
  return control;
}

/** Where the text makes no sense: say why, and show the last good value again. */
function settleBox(control) {
  const read = readValue(control.parameter, control.box.value);
  if (!read.why && read.value !== control.value) control.change(control.parameter.key, read.value, true);
  const kept = control.value === null ? "" : exact(control.value);
  complain(control, read.why ? `${read.why}. Kept ${kept ? `at ${kept}` : "empty"}.` : "");
  control.box.value = kept;
}

function complain(control, why) {
  if (!control.why) return;
  if (control.why.textContent !== why) control.why.textContent = why;
  control.box.setAttribute("aria-invalid", why ? "true" : "false");
}

/** Arrow keys in a box move by a step of the slider. */
function stepBox(event, control, change) {
  const turn = { ArrowUp: 1, ArrowDown: -1 }[event.key];
  if (!turn || control.parameter.scale === "optional") return;
  event.preventDefault();
  const { scale, parameter } = control;
  const moved = scale.from(Math.min(scale.max, Math.max(scale.min, scale.to(control.value) + turn * scale.step)));
  complain(control, "");
  change(parameter.key, Math.min(parameter.high, Math.max(parameter.low, moved)), false);
}

/** Shows a value, in SI units too where there are; a box in which somebody types is left as it is. */
function showValue(control, value, range, units) {
  const { parameter, box, slider } = control;
  control.value = value;
  if (parameter.scale === "choice") {
    box.value = value;
    return;
  }
  const text = value === null ? "" : exact(value);
  const typing = document.activeElement === box && (Number(box.value) === value || parameter.scale === "optional");
  if (!typing) box.value = text;
  if (parameter.scale === "optional") return;
  control.scale = sliderOf(parameter, range);
  const { min, max, step, to } = control.scale;
  if (Number(slider.max) !== max || slider.step === "") Object.assign(slider, { min, max, step });
  slider.value = to(value);
  const si = units.isSI && parameter.quantity ? said(units, parameter.quantity, value, 4) : "";
  slider.setAttribute("aria-valuetext", si ? `${text}, ${si}` : text);
  control.si.textContent = si ? ` = ${si}` : "";
}
