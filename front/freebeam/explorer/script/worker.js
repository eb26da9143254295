// The computing side of the page: answers the latest question of each kind, the map in slices between them.

const SLICE = 12; // milliseconds of the map at a time

function computer(column, send) {
  let question = null;
  let map = null;
  let awake = false;

  function wake() {
    if (awake) return;
    awake = true;
    setTimeout(turn, 0);
  }

  function turn() {
    awake = false;
    if (question) {
      const asked = question;
      question = null;
      send({ kind: "case", id: asked.id, ...analyse(column, asked) });
    } else if (map) {
      const end = performance.now() + SLICE;
      let done = false;
      while (!done && performance.now() < end) done = map.cells.next().done;
      if (done || performance.now() > map.shown + 150) {
        map.shown = performance.now();
        send({ kind: "map", id: map.id, axes: map.axes, loads: map.loads.slice(), done });
      }
      if (done) map = null;
    }
    if (question || map) wake();
  }

  return (message) => {
    if (message.kind === "case") question = message;
    if (message.kind === "map") {
      const { id, axes, owned } = message;
      const loads = new Float64Array(axes[0].values.length * axes[1].values.length).fill(NaN);
      map = { id, axes, loads, shown: 0, cells: mapCells(message, axes, owned, loads) };
    }
    wake();
  };
}
