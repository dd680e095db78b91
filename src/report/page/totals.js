// One build and its rays: total time relative to the base's over the number of rays, and the tree that takes least.
/** The curve of a tree: told for the mean; in a scene, build and rays by their measured times. */
function curve(place, index) {
  const { kernel, regime } = chosen;
  if (place.scenes > 1) return data.curves[kernel][regime][index];
  const line = (entry) => entry?.builds[regime] && entry.traces[kernel] && entry.rays ? (count) => entry.builds[regime][0] + (count * entry.traces[kernel][0]) / entry.rays : null;
  const own = line(place.entries[index]);
  const base = line(place.entries[data.base_tree]);
  return own && base ? data.budgets.map((count) => own(count) / base(count)) : null;
}

function drawTotals() {
  const figure = find("totals");
  const place = data.places[chosen.place];
  const curves = shownEntries(place)
    .map((shown) => ({ ...shown, values: curve(place, shown.index) }))
    .filter(({ tree, values }) => values && !tree.is_saved);
  find("totals-about").textContent =
    `Total time of a build and of the rays traced over its tree, relative to ${data.base}. At the left the build is nearly all, at the right the rays are. The band follows the least.${hasSaved ? " Saved trees, which were loaded and not built, are left out." : ""}`;
  if (!curves.length) return put(figure, null, "No tree has a build time and a trace time here: choose another width, kernel, regime or scene; a run of builds alone has no trace times.");

  const points = curves.flatMap((one) => one.values.map((value, step) => ({ ...one, count: data.budgets[step], value, step })));
  const least = data.budgets.map((count, step) => d3.least(points.filter((point) => point.step === step), (point) => point.value));
  const winners = new Set(least.map((point) => point.index));
  // A tree may win twice, with others between.
  const runs = [];
  for (const point of least) {
    if (runs.at(-1)?.[0].index === point.index) runs.at(-1).push(point);
    else runs.push([point]);
  }
  const stretches = runs.map((run) => ({ ...run[run.length >> 1], steps: run.length }));

  const width = Math.max(figure.clientWidth, 280);
  const isNarrow = width < 600;
  const height = Math.round(isNarrow ? width * 1.15 : Math.min(0.52 * width, 560));
  const margins = { left: 46, right: 14, top: 26, bottom: 44 };
  const domains = { x: d3.extent(data.budgets), y: ends(points.map((point) => point.value), 0.06) };
  // What takes more than twice the time is no choice; the room is for the others.
  domains.y[1] = Math.min(domains.y[1], 2.1);
  const x = d3.scaleLog(domains.x, [margins.left, width - margins.right]);
  const y = d3.scaleLog(domains.y, [height - margins.bottom, margins.top]);
  const ticks = data.budgets.filter((count) => Number.isInteger(Math.log10(count)) && (!isNarrow || Math.log10(count) % 3 === 0));
  const format = (count) => (count >= 1e9 ? `${count / 1e9} G` : count >= 1e6 ? `${count / 1e6} M` : `${count / 1e3} k`);
  // Below the least there is nothing. Who wins longest has the first choice.
  const labels = placeLabels(
    d3.sort(stretches, (point) => -point.steps).map((point) => ({ point, at: [x(point.count), y(point.value)], label: point.tree.name, must: true })),
    () => BELOW_RIGHT,
    { width, height, ...margins },
  );
  const line = (of) => ({ x: "count", y: "value", z: "index", curve: "monotone-x", stroke: of, clip: true });
  const of = (isWinner, wide) => points.filter((point) => winners.has(point.index) === isWinner && point.tree.width === wide);
  const dash = { 4: undefined, 8: "5 3" };
  const tip = (point) => `${point.tree.name}\n${rays(point.count)} rays: ${point.value.toFixed(2)}\nleast: ${least[point.step].tree.name}, ${least[point.step].value.toFixed(2)}`;
  const plot = Plot.plot({
    ...logarithmic(width, height, margins, domains),
    marks: [
      Plot.gridX(ticks, { stroke: "var(--line)", strokeOpacity: 1 }),
      Plot.gridY(ratioTicks(domains.y), { stroke: "var(--line)", strokeOpacity: 1 }),
      Plot.ruleY([1], { stroke: "var(--faint)" }),
      Plot.axisX(ticks, { tickFormat: format, tickSize: 0, label: "rays over one tree (thousand, million, billion) →", labelAnchor: "right", fill: "var(--soft)" }),
      Plot.axisY(ratioTicks(domains.y), { tickFormat: ratioFormat, tickSize: 0, label: "↑ total time, relative", labelAnchor: "top", fill: "var(--soft)" }),
      Plot.line(least, { x: "count", y: "value", curve: "monotone-x", stroke: "var(--band)", strokeWidth: 11, strokeLinecap: "round" }),
      ...[4, 8].map((wide) => Plot.line(of(false, wide), { ...line((point) => colour(point.tree)), strokeWidth: 1, strokeOpacity: 0.4, strokeDasharray: dash[wide] })),
      ...[4, 8].map((wide) => Plot.line(of(true, wide), { ...line((point) => colour(point.tree)), strokeWidth: 2.2, strokeDasharray: dash[wide] })),
      ...labels.map(({ point, dx, dy, anchor }) => Plot.text([point], { x: "count", y: "value", text: () => point.tree.name, dx, dy, textAnchor: anchor, fill: "var(--ink)", fontWeight: 600, stroke: "var(--paper)", strokeWidth: 4, paintOrder: "stroke" })),
      Plot.dot(points, Plot.pointer({ x: "count", y: "value", r: 4, fill: (point) => colour(point.tree), maxRadius: 60 })),
      Plot.tip(points, Plot.pointer({
        x: "count",
        y: "value",
        title: tip,
        fill: "var(--raised)",
        stroke: "var(--faint)",
        maxRadius: 60,
        textPadding: 9,
      })),
    ],
  });
  const shown = points.filter((point) => point.value <= domains.y[1]);
  const at = (step) => d3.sort(shown.filter((point) => point.step === step), (point) => point.value);
  const columns = data.budgets.map((_, step) => at(step).map((point) => ({ at: [x(point.count), y(point.value)], words: tip(point) }))).filter((column) => column.length);
  put(figure, plot, `Total time over rays. Least, from few rays to many: ${stretches.map((point) => point.tree.name).join(", ")}. Arrow keys go from one number of rays to the next, and up to the next tree.`, columns);
}
