// What the page holds, and what of it is chosen. Every figure comes from the data; here they are only shown.
const data = JSON.parse(document.getElementById("data").textContent);
const chosen = { place: 0, every: false, width: 0, kernel: 0, regime: 0 };

const find = (id) => document.getElementById(id);
const colour = (tree) => `var(--${tree.family})`;
const isShown = (tree) => !chosen.width || tree.width === chosen.width;

/** The trees of the chosen place that are shown, each with its entry. */
function shownEntries(place = data.places[chosen.place]) {
  return data.trees
    .map((tree, index) => ({ tree, index, place, entry: place.entries[index] }))
    .filter(({ tree, entry }) => entry && isShown(tree));
}

/** The scenes behind a mean, as "1 of 2", where they are not all. */
function fewer({ place, entry }) {
  const count = entry.scenes[chosen.kernel]?.[chosen.regime];
  return count ? `${count} of ${place.scenes}` : null;
}

/** Whether there are saved trees: they are loaded, not built, and compete with no builder. */
const hasSaved = data.trees.some((tree) => tree.is_saved);

/** Three digits, or all digits before the point, as in the tables of the command. */
function short(value) {
  const size = Math.abs(value);
  return value.toFixed(size >= 99.95 ? 0 : size >= 9.995 ? 1 : size >= 0.9995 || size === 0 ? 2 : 3);
}
const grouped = (count) => String(count).replace(/\B(?=(\d{3})+$)/g, "\u202f");

/** A ratio with two digits, and its interval. */
const ratio = (timed) => timed && timed[1] !== null ? timed[1].toFixed(2) : null;
const interval = (timed) => timed && timed[2] !== null && timed[2] !== timed[3] ? `[${timed[2].toFixed(2)}, ${timed[3].toFixed(2)}]` : "";

/** Rays as thousands, millions or billions. */
function rays(count) {
  const [unit, word] = count >= 1e9 ? [1e9, " billion"] : count >= 1e6 ? [1e6, " million"] : [1e3, " thousand"];
  return Number((count / unit).toPrecision(2)) + word;
}

/** Outlines of the shapes within 7 pixels around 0, of about the same area. */
const OUTLINES = {
  circle: "M5,0A5,5 0 1 1 -5,0A5,5 0 1 1 5,0Z",
  square: "M-4.4,-4.4H4.4V4.4H-4.4Z",
  diamond: "M0,-6.2L6.2,0L0,6.2L-6.2,0Z",
  up: "M0,-6L5.8,4.4H-5.8Z",
  down: "M0,6L5.8,-4.4H-5.8Z",
};
const SYMBOLS = {
  circle: "circle",
  square: "square",
  diamond: "diamond",
  up: "triangle",
  down: { draw: (context, size) => d3.symbolTriangle.draw({ moveTo: (x, y) => context.moveTo(x, -y), lineTo: (x, y) => context.lineTo(x, -y), closePath: () => context.closePath() }, size) },
};

/** An axis that shows ratios: ticks at 1, 2 and 5 of each power of ten within its ends. */
function ratioTicks([low, high]) {
  const all = d3.range(-4, 5).flatMap((power) => [1, 2, 5].map((digit) => digit * 10 ** power));
  const ticks = all.filter((tick) => low <= tick && tick <= high);
  return ticks.length > 2 ? ticks : d3.scaleLog([low, high], [0, 1]).ticks(4);
}
const ratioFormat = (value) => String(Number(value.toPrecision(3)));

/** Ends of an axis around some values and 1, with a margin. */
function ends(values, margin) {
  const [low, high] = d3.extent([1, ...values]);
  const more = Math.max((high / low) ** margin, 1.04);
  return [low / more, high * more];
}

/** Puts a drawing, or why there is none, into a figure; its points, if they are told, are within reach of the keyboard. */
function put(figure, drawing, label, columns = []) {
  if (!drawing) {
    figure.innerHTML = `<p class="empty"></p>`;
    figure.firstChild.textContent = label;
    return;
  }
  drawing.setAttribute("role", "img");
  drawing.setAttribute("aria-label", label);
  const told = document.createElement("output");
  told.className = "unseen";
  figure.replaceChildren(drawing, told);
  reach(drawing, told, columns);
}

/**
 * Arrow keys take the tooltip from point to point, as the pointer would, and what it says is told to those who do not see
 * it. Left and right go from column to column, up and down within one; each point has its place and its words.
 */
function reach(drawing, told, columns) {
  if (!columns.length) return;
  const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1], Home: [-Infinity, 0], End: [Infinity, 0] };
  const within = (index, list) => Math.max(0, Math.min(index, list.length - 1));
  const send = (type, [x, y]) => {
    const { x: clientX, y: clientY } = new DOMPoint(x, y).matrixTransform(drawing.getScreenCTM());
    drawing.dispatchEvent(new PointerEvent(type, { pointerType: "mouse", clientX, clientY }));
  };
  let [column, row] = [-1, 0];
  const leave = () => {
    if (column < 0) return;
    send("pointerleave", columns[column][row].at);
    [column, row] = [-1, 0];
    told.textContent = "";
  };
  drawing.tabIndex = 0;
  drawing.addEventListener("blur", leave);
  drawing.addEventListener("keydown", (event) => {
    if (event.key === "Escape") return leave();
    const step = steps[event.key];
    if (!step || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    column = within(column + step[0], columns);
    row = within(row + step[1], columns[column]);
    const { at, words } = columns[column][row];
    send("pointermove", at);
    told.textContent = words.replaceAll("\n", ", ");
  });
}

/** What the plots have in common: a size and two logarithmic axes. */
function logarithmic(width, height, margins, domains) {
  const margin = { marginLeft: margins.left, marginRight: margins.right, marginTop: margins.top, marginBottom: margins.bottom };
  const axis = (domain) => ({ type: "log", domain, label: null });
  return { width, height, ...margin, style: { background: "none", color: "inherit" }, x: axis(domains.x), y: axis(domains.y) };
}

/** Where a text may stand, first choice first: beside a point, below a falling front, or below a rising curve. */
const BESIDE = [[10, 0, "start"], [8, -11, "start"], [0, -14, "middle"], [-10, 0, "end"], [8, 12, "start"], [0, 15, "middle"], [-8, -11, "end"], [-8, 12, "end"]];
const BELOW_RIGHT = [[10, 14, "start"], [0, 17, "middle"], [-2, 17, "end"], [10, 30, "start"], [0, 33, "middle"], [-2, 33, "end"], [10, 46, "start"], [0, -14, "middle"]];
const BELOW = [[-8, 12, "end"], [0, 16, "middle"], [-11, 0, "end"], [10, 12, "start"], [11, 0, "start"], [0, -14, "middle"]];

/**
 * Places for texts beside points, so that none covers a point or another text: the first that is free. Texts without a
 * free place are left out, those that must be shown excepted.
 */
function placeLabels(points, preferred, { width, height, left, right, top, bottom }) {
  const pen = document.createElement("canvas").getContext("2d");
  pen.font = `12px ${getComputedStyle(document.body).fontFamily}`;
  const taken = points.map(({ at: [x, y] }) => [x - 6, y - 6, x + 6, y + 6]);
  const placed = [];
  for (const point of points.filter((point) => point.label)) {
    const [x, y] = point.at;
    const long = pen.measureText(point.label).width + 4;
    let least = null;
    for (const [dx, dy, anchor] of preferred(point)) {
      const from = x + dx - (anchor === "start" ? 2 : anchor === "end" ? long - 2 : long / 2);
      const box = [from, y + dy - 7, from + long, y + dy + 7];
      const isInside = box[0] >= left && box[2] <= width - right + 2 && box[1] >= top && box[3] <= height - bottom;
      const covered = taken.filter((other) => box[0] < other[2] && other[0] < box[2] && box[1] < other[3] && other[1] < box[3]).length;
      const faults = covered + (isInside ? 0 : 20);
      if (!least || faults < least.faults) least = { faults, box, dx, dy, anchor };
    }
    if (least.faults === 0 || point.must && least.faults < 3) {
      taken.push(least.box);
      placed.push({ ...point, ...least });
    }
  }
  return placed;
}
