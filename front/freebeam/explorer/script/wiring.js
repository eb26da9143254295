// What is around a case: the address, the buttons, the theme, the beam's motion, and what others may ask of the page.

/** The case that the address names, or the start; says what of the address makes no sense. */
function followAddress(view) {
  if (location.hash === view.written) return;
  const { values, refused } = readHash(view.parameters, location.hash);
  view.part.address.textContent = refused.length ? `In the address: ${refused.join("; ")}.` : "";
  change(view, { ...startOf(view.parameters), ...values }, true);
}

/** The address follows the case, a little later: browsers bear only so many changes a second. */
function writeAddress(view) {
  clearTimeout(view.writing);
  view.writing = setTimeout(() => {
    view.written = hashOf(view.parameters, view.values);
    history.replaceState(null, "", view.written);
  }, 200);
}

function wireButtons(view) {
  const { part, beam } = view;
  const reduced = window.matchMedia("(prefers-reduced-motion: reduce)");
  const still = (value) => {
    beam.still = value;
    part.motion.textContent = value ? "Play" : "Pause";
    if (!value) animate(view);
    drawBeam(beam);
  };
  part.motion.addEventListener("click", () => still(!beam.still));
  reduced.addEventListener("change", () => still(reduced.matches));
  still(reduced.matches);
  part.near.addEventListener("click", () => {
    view.near = !view.near;
    part.near.setAttribute("aria-pressed", String(view.near));
    view.plots.frequency.setData(view.plots.frequency.data);
  });
  part.reset.addEventListener("click", () => {
    part.address.textContent = "";
    for (const control of Object.values(view.controls)) complain(control, "");
    change(view, startOf(view.parameters), true);
  });
  part.link.addEventListener("click", () => copyLink(view));
  part.theme.addEventListener("click", () => {
    const dark = getComputedStyle(document.documentElement).colorScheme.startsWith("dark");
    document.documentElement.dataset.theme = dark ? "light" : "dark";
    repaint(view);
  });
}

async function copyLink({ part, parameters, values }) {
  const link = `${location.href.split("#")[0]}${hashOf(parameters, values)}`;
  let said = "Link to this case copied.";
  try {
    await navigator.clipboard.writeText(link);
  } catch {
    said = "The address of this page is the link to this case.";
  }
  part.said.textContent = said;
  setTimeout(() => (part.said.textContent = ""), 4000);
}

function watchTheme(view) {
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => repaint(view));
}

function repaint(view) {
  readPalette();
  view.beam.colour = view.state?.growing ? palette.accent : palette.stable;
  for (const plot of Object.values(view.plots)) plot.redraw();
  if (view.beam.motion) drawBeam(view.beam);
}

/** One frame after another, with a record of the time between them and of the time that drawing takes. */
function animate(view) {
  if (view.isMoving) return;
  view.isMoving = true;
  let before = performance.now();
  const frame = (now) => {
    const gap = now - before;
    before = now;
    const { beam } = view;
    if (beam.still) {
      view.isMoving = false; // nothing is asked of the browser while the beam is held still
      return;
    }
    if (beam.motion) {
      beam.clock += Math.min(0.1, gap / 1000);
      const began = performance.now();
      drawBeam(beam);
      view.frames.push({ gap, work: performance.now() - began });
      if (view.frames.length > 600) view.frames.shift();
    }
    requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
}

/** What a lecturer's script, or a test, may ask of the page. */
function outside(view) {
  const pencil = (N, own) => problemAt(N, own);
  return {
    values: () => ({ ...view.values }),
    set: (values) => change(view, values, true),
    settled: () => view.answered === view.asked,
    analysis: () => view.analysis,
    map: () => view.map,
    state: () => view.state,
    view: () => view,
    response: () => view.response,
    steps: () => [...view.steps],
    frames: () => [...view.frames],
    firstLoss: (N, alpha, beta, own = {}, kappa = undefined) => {
      const found = pencil(N, own);
      if (found.general) return { crossing: lossOf(found, dampingAt(found, alpha, beta)), touches: [] };
      return firstLoss(found, dampingOf(found, alpha, beta, kappa));
    },
    spectrum: (N, P, alpha, beta, own = {}) => {
      const found = pencil(N, own);
      return modesAt(found, dampingAt(found, alpha, beta), P).map(({ re, im }) => [re, im]);
    },
  };
}
