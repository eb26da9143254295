// Sliders and number boxes.

/** Builds the controls; `change(key, value, typed)` is called with each value that makes sense. */
function buildControls(place, parameters, change) {
  const controls = {};
  for (const parameter of parameters) {
    const control = buildControl(parameter, change);
    place.append(control.element);
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

function buildControl(parameter, change) {
  const { key, symbol, meaning } = parameter;
  const id = key.replace(/\W/g, "-");
  const [name, hint] = meaning.split(/[:;] (.*)/);
  const label = make("label", { for: `box-${id}`, title: meaning }, make("i", {}, symbol), ` ${name}`);
  const box = make("input", {
    id: `box-${id}`, name: key, type: "text", inputmode: "decimal", autocomplete: "off", spellcheck: "false",
    "aria-describedby": `why-${id}`,
  });
  const slider = make("input", { id: `slider-${id}`, type: "range", "aria-label": `${symbol}, ${name}` });
  const why = make("p", { id: `why-${id}`, class: "why", role: "alert" });
  const element = make("div", { class: "control", "data-key": key }, label, box, slider, why);
  if (hint) slider.after(make("p", { class: "hint" }, hint));
  const control = { parameter, element, box, slider, why, scale: null, value: NaN };
  slider.addEventListener("input", () => {
    complain(control, "");
    change(key, control.scale.from(Number(slider.value)), false);
  });
  box.addEventListener("input", () => {
    const read = readValue(parameter, box.value);
    if (!read.why && read.value !== control.value) {
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
  complain(control, read.why ? `${read.why}. Kept at ${exact(control.value)}.` : "");
  control.box.value = exact(control.value);
}

function complain(control, why) {
  if (control.why.textContent !== why) control.why.textContent = why;
  control.box.setAttribute("aria-invalid", why ? "true" : "false");
}

/** Arrow keys in a box move by a step of the slider. */
function stepBox(event, control, change) {
  const turn = { ArrowUp: 1, ArrowDown: -1 }[event.key];
  if (!turn) return;
  event.preventDefault();
  const { scale, parameter } = control;
  const moved = scale.from(Math.min(scale.max, Math.max(scale.min, scale.to(control.value) + turn * scale.step)));
  complain(control, "");
  change(parameter.key, Math.min(parameter.high, Math.max(parameter.low, moved)), false);
}

/** Shows a value; a box in which somebody types is left as it is. */
function showValue(control, value, range) {
  const { parameter, box, slider } = control;
  control.value = value;
  control.scale = sliderOf(parameter, range);
  const { min, max, step, to } = control.scale;
  if (Number(slider.max) !== max || slider.step === "") Object.assign(slider, { min, max, step });
  slider.value = to(value);
  slider.setAttribute("aria-valuetext", exact(value));
  const typing = document.activeElement === box && Number(box.value) === value;
  if (!typing) box.value = exact(value);
}
