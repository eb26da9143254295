// Colours from the style sheet, which knows light and dark; and the colour map of loads.

let palette = {};

function readPalette() {
  const style = getComputedStyle(document.documentElement);
  const names = ["ink", "muted", "grid", "panel", "accent", "stable", "mode-1", "mode-2", "mode-3", "mode-4"];
  palette = Object.fromEntries(names.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
  palette.modes = [1, 2, 3, 4].map((k) => palette[`mode-${k}`]);
  palette.font = getComputedStyle(document.body).fontFamily;
}

// cividis at nine even places: its lightness rises throughout, so that it reads in grey and without red and green
const CIVIDIS = [
  [0, 34, 78], [18, 53, 112], [59, 73, 108], [87, 93, 109], [112, 113, 115], [138, 134, 120], [165, 156, 116],
  [195, 179, 105], [254, 232, 56],
];

const MAP_COLOURS = { none: [128, 128, 128], unsound: [70, 70, 70], stable: [158, 202, 225], flutter: [213, 94, 0], divergence: [123, 50, 148] };

/** Colour of a share 0 … 1. */
function cividis(share) {
  const place = Math.min(1, Math.max(0, share)) * (CIVIDIS.length - 1);
  const k = Math.min(CIVIDIS.length - 2, Math.floor(place));
  return CIVIDIS[k].map((low, i) => Math.round(low + (place - k) * (CIVIDIS[k + 1][i] - low)));
}
