// Table 1: a row for each tree of the chosen scene, or of every scene. Rows are made as they are asked for: all those of
// hundreds of scenes at once would take seconds.
const PAGE = 100;
const sorted = { by: null, descending: false };
/** The table's rows in their order, the HTML of one, and how many of them are in the document. */
const listed = { rows: [], html: null, shown: 0 };

/** The columns: what a row has there, and how that is written. Columns without any figure are left out. */
function columns() {
  const { kernel, regime } = chosen;
  const figure = (group, name, value, text = short) => ({ group, name, value, text: (row) => (value(row) === null ? "" : text(value(row))) });
  const relative = (group, of) => ({
    group,
    name: "relative",
    value: (row) => of(row.entry)?.[1] ?? null,
    text: (row) => ratio(of(row.entry)) ?? "",
    more: (row) => interval(of(row.entry)),
    isRatio: true,
  });
  const build = (entry) => entry.builds[regime];
  const trace = (entry) => entry.traces[kernel];
  return [
    chosen.every ? { group: "", name: "scene", value: (row) => row.place.name, text: (row) => row.place.name, isText: true } : null,
    { group: "", name: "tree", value: (row) => row.index, text: (row) => row.tree.name, isText: true, isTree: true },
    figure("build", "ms", (row) => build(row.entry)?.[0] ?? null),
    relative("build", build),
    figure("SAH cost", "cost", (row) => row.entry.cost?.[0] ?? null),
    relative("SAH cost", (entry) => entry.cost),
    figure("trace", "ms", (row) => trace(row.entry)?.[0] ?? null),
    figure("trace", "Mrays/s", (row) => row.entry.speeds[kernel] ?? null),
    relative("trace", trace),
    figure("memory", "B/triangle", (row) => row.entry.peak),
  ].filter(Boolean);
}

function tableRows() {
  const places = chosen.every ? data.places.filter((place) => place.scenes === 1) : [data.places[chosen.place]];
  const words = find("filter").value.toLowerCase().split(/\s+/).filter(Boolean);
  const all = places.flatMap((place) => shownEntries(place));
  return all.filter((row) => words.every((word) => `${row.place.name} ${row.tree.name}`.toLowerCase().includes(word)));
}

const mark = (tree) => `<svg class="mark${tree.width === 4 ? "" : " hollow"}" viewBox="-7 -7 14 14" style="color:${colour(tree)}" aria-hidden="true"><path d="${OUTLINES[tree.shape]}"/></svg>`;
const escaped = (text) => text.replace(/[&<>"]/g, (sign) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[sign]);

function drawTable() {
  const rows = tableRows();
  const used = columns().filter((column) => column.isText || rows.some((row) => column.value(row) !== null));
  const by = used.findIndex((column) => `${column.group} ${column.name}` === sorted.by);
  if (by >= 0) {
    // Rows without the figure come last either way.
    for (const row of rows) row.key = used[by].value(row);
    const order = sorted.descending ? d3.descending : d3.ascending;
    rows.sort((a, b) => (a.key === null) - (b.key === null) || order(a.key, b.key));
  }
  // A mean over fewer scenes is another mean; ratios of several scenes have no least; saved trees were not built.
  const best = used.map((column) => (column.isRatio && !chosen.every ? d3.min(rows.filter((row) => !fewer(row) && !row.tree.is_saved), column.value) : null));
  const groups = d3.rollups(used, (all) => all.length, (column) => column.group);
  const heads = used.map((column, index) => {
    const order = index === by ? (sorted.descending ? "descending" : "ascending") : "none";
    return `<th scope="col" class="${column.isText ? "text" : column.isRatio ? "ratio" : ""}" aria-sort="${order}"><button type="button" data-by="${column.group} ${column.name}">${column.name}</button></th>`;
  });
  const cell = (row, column, index) => {
    if (column.isTree) {
      const few = fewer(row) ? ` <small>${fewer(row)} scenes</small>` : "";
      const failed = row.entry.error ? ` <small class="failed" title="${escaped(row.entry.error)}">failed</small>` : "";
      return `<td class="text">${mark(row.tree)}${escaped(row.tree.name).replace(" / ", "&nbsp;/&nbsp;")}${few}${failed}</td>`;
    }
    if (column.isText) return `<td class="text">${escaped(column.text(row))}</td>`;
    const more = column.more?.(row);
    const isBest = column.isRatio && !chosen.every && !fewer(row) && !row.tree.is_saved && column.value(row) === best[index] && rows.length > 1;
    return `<td${isBest ? ' class="best"' : ""}>${column.text(row)}${more === undefined ? "" : ` <small>${more}</small>`}</td>`;
  };
  const table = find("table");
  table.tHead.innerHTML =
    `<tr>${groups.map(([group, count]) => `<th class="group" colspan="${count}" scope="colgroup">${group}</th>`).join("")}</tr><tr>${heads.join("")}</tr>`;
  table.tBodies[0].replaceChildren();
  Object.assign(listed, { rows, html: (row) => `<tr>${used.map((column, index) => cell(row, column, index)).join("")}</tr>`, shown: 0 });
  show(PAGE);
  find("table-about").textContent =
    `relative: to ${data.base}; in brackets 95 % intervals, over scenes and rounds for means, over rounds for a scene. Builds: ${data.regimes[chosen.regime].about}. Traces, medians of all recorded rays: ${data.kernels[chosen.kernel].about}. memory: bytes at the peak of the build.${chosen.every ? "" : " The least of what is relative is bold."}`;
}

/** Shows the first `count` rows, or all; those that are there stay, since to lay them out anew takes longest. */
function show(count) {
  const { rows, html, shown } = listed;
  const body = find("table").tBodies[0];
  body.insertAdjacentHTML("beforeend", rows.slice(shown, count).map(html).join(""));
  for (const row of [...body.rows].slice(count)) row.remove();
  listed.shown = Math.min(count, rows.length);
  const left = rows.length - listed.shown;
  find("count").textContent = (left ? `${grouped(listed.shown)} of ` : "") + `${grouped(rows.length)} ${rows.length === 1 ? "row" : "rows"}`;
  find("more").hidden = !left;
  find("more").textContent = `Show ${Math.min(PAGE, left)} more`;
}

find("table").tHead.addEventListener("click", (event) => {
  const by = event.target.closest("button")?.dataset.by;
  if (by === undefined) return;
  sorted.descending = sorted.by === by && !sorted.descending;
  sorted.by = by;
  drawTable();
  // The button was drawn anew: who pressed it by key stays on it.
  find("table").tHead.querySelector(`button[data-by="${by}"]`).focus();
});
find("filter").addEventListener("input", drawTable);
find("more").addEventListener("click", () => show(listed.shown + PAGE));

// Paper has no button for more.
addEventListener("beforeprint", () => {
  const onScreen = listed.shown;
  show(Infinity);
  addEventListener("afterprint", () => show(onScreen), { once: true });
});
