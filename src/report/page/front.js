// Build time against trace time: a point for each tree, the fronts, and what a point stands for.
function drawFront() {
  const figure = find("front");
  const { kernel, regime } = chosen;
  const place = data.places[chosen.place];
  const points = shownEntries(place)
    .filter(({ entry }) => ratio(entry.builds[regime]) && ratio(entry.traces[kernel]))
    .map((shown) => ({ ...shown, build: shown.entry.builds[regime][1], trace: shown.entry.traces[kernel][1] }));
  const where = place.scenes > 1 ? `Geometric means over ${place.scenes} scenes` : place.name + (place.triangles ? `, ${grouped(place.triangles)} triangles` : "");
  find("front-about").textContent =
    `${where}, relative to ${data.base}. Down and to the left is better; no tree beats those on a front in both times. Traces: ${data.kernels[kernel].about}. Builds: ${data.regimes[regime].about}.${hasSaved ? " Saved trees, which were loaded and not built, are on no front." : ""}`;
  if (!points.length) return put(figure, null, "No tree has a build time and a trace time here: choose another width, kernel, regime or scene; a run of builds alone has no trace times.");

  const width = Math.max(figure.clientWidth, 280);
  const isNarrow = width < 600;
  const height = Math.round(isNarrow ? width * 1.12 : Math.min(0.6 * width, 600));
  const margins = { left: 46, right: 14, top: 26, bottom: 44 };
  const domains = { x: ends(points.map((point) => point.build), 0.07), y: ends(points.map((point) => point.trace), 0.09) };
  const x = d3.scaleLog(domains.x, [margins.left, width - margins.right]);
  const y = d3.scaleLog(domains.y, [height - margins.bottom, margins.top]);

  const byIndex = new Map(points.map((point) => [point.index, point]));
  const [both, four, eight] = place.fronts[kernel][regime].map((front) => front.map((index) => byIndex.get(index)).filter(Boolean));
  const front = chosen.width === 4 ? four : chosen.width === 8 ? eight : both;
  const name = (point) => point.tree.name + (fewer(point) ? ` (${fewer(point)})` : "");
  const order = (point) => (front.includes(point) ? 0 : four.includes(point) || eight.includes(point) ? 1 : 2);
  const labels = placeLabels(
    d3.sort(points, order).map((point) => ({
      point,
      at: [x(point.build), y(point.trace)],
      label: isNarrow && order(point) > 0 ? "" : name(point),
      must: front.includes(point),
    })),
    (point) => (point.must ? BELOW : BESIDE),
    { width, height, ...margins },
  );

  const at = { x: "build", y: "trace" };
  const stroke = (point) => colour(point.tree);
  const tip = ({ tree, entry, build, trace }) =>
    [
      tree.name,
      `build ${build.toFixed(2)} ${interval(entry.builds[regime])}`,
      `trace ${trace.toFixed(2)} ${interval(entry.traces[kernel])}`,
      entry.cost && entry.cost[1] !== null ? `SAH cost ${entry.cost[1].toFixed(2)}` : null,
      entry.builds[regime][0] === null ? null : `${short(entry.builds[regime][0])} ms` + (entry.speeds[kernel] === null ? "" : `, ${short(entry.speeds[kernel])} million rays/s`),
    ].filter(Boolean).join("\n");
  const cross = { stroke, strokeWidth: 1.5 };
  const plot = Plot.plot({
    ...logarithmic(width, height, margins, domains),
    symbol: { type: "identity" },
    marks: [
      Plot.gridX(ratioTicks(domains.x), { stroke: "var(--line)", strokeOpacity: 1 }),
      Plot.gridY(ratioTicks(domains.y), { stroke: "var(--line)", strokeOpacity: 1 }),
      Plot.ruleX([1], { stroke: "var(--faint)" }),
      Plot.ruleY([1], { stroke: "var(--faint)" }),
      Plot.axisX(ratioTicks(domains.x), { tickFormat: ratioFormat, tickSize: 0, label: `build time relative to ${data.base} →`, labelAnchor: "right", fill: "var(--soft)" }),
      Plot.axisY(ratioTicks(domains.y), { tickFormat: ratioFormat, tickSize: 0, label: "↑ trace time, likewise", labelAnchor: "top", fill: "var(--soft)" }),
      chosen.width ? null : Plot.line(both, { ...at, stroke: "var(--band)", strokeWidth: 10, strokeLinejoin: "round", strokeLinecap: "round" }),
      Plot.line(four.filter(() => chosen.width !== 8), { ...at, stroke: "var(--ink)", strokeWidth: 1.25 }),
      Plot.line(eight.filter(() => chosen.width !== 4), { ...at, stroke: "var(--ink)", strokeWidth: 1.25, strokeDasharray: "4 3" }),
      Plot.ruleY(points, Plot.pointer({ px: "build", py: "trace", y: "trace", x1: (point) => point.entry.builds[regime][2], x2: (point) => point.entry.builds[regime][3], ...cross, maxRadius: 60 })),
      Plot.ruleX(points, Plot.pointer({ px: "build", py: "trace", x: "build", y1: (point) => point.entry.traces[kernel][2], y2: (point) => point.entry.traces[kernel][3], ...cross, maxRadius: 60 })),
      Plot.dot(points, { ...at, r: isNarrow ? 4.2 : 5, symbol: (point) => SYMBOLS[point.tree.shape], stroke, fill: (point) => (point.tree.width === 4 ? colour(point.tree) : "var(--paper)"), strokeWidth: 1.5 }),
      ...labels.map(({ point, dx, dy, anchor }) =>
        Plot.text([point], { ...at, text: () => name(point), dx, dy, textAnchor: anchor, fill: order(point) === 0 ? "var(--ink)" : "var(--soft)", fontWeight: order(point) === 0 ? 600 : 400, stroke: "var(--paper)", strokeWidth: 4, paintOrder: "stroke" })),
      Plot.tip(points, Plot.pointer({ ...at, title: tip, fill: "var(--raised)", stroke: "var(--faint)", maxRadius: 60, textPadding: 9 })),
    ],
  });
  const columns = d3.sort(points, (point) => point.build).map((point) => [{ at: [x(point.build), y(point.trace)], words: tip(point) }]);
  put(figure, plot, `Build time against trace time of ${points.length} trees. On the front: ${front.map((point) => point.tree.name).join(", ")}. The table below has all figures; arrow keys go from tree to tree.`, columns);
}
