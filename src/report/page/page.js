// Choices, the theme, and drawing anew when either or the window changes.
function draw() {
  drawFront();
  drawTotals();
  drawTable();
}

for (const name of ["place", "width", "kernel", "regime"]) {
  find(name).addEventListener("change", (event) => {
    const value = event.target.value;
    if (name === "place") chosen.every = value === "all";
    chosen[name] = Number(value === "all" ? 0 : value);
    draw();
  });
}

for (const svg of document.querySelectorAll(".key svg[data-shape]")) {
  svg.innerHTML = `<path d="${OUTLINES[svg.dataset.shape]}"/>`;
}

// The theme follows the system until it is chosen; where the browser keeps nothing for files, it is chosen again.
const THEMES = ["automatic", "light", "dark"];
function setTheme(theme) {
  if (theme === "automatic") delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = theme;
  find("theme").textContent = `theme: ${theme}`;
}
let theme = "automatic";
try {
  theme = localStorage.getItem("theme") ?? theme;
} catch {}
setTheme(THEMES.includes(theme) ? theme : "automatic");
find("theme").addEventListener("click", () => {
  theme = THEMES[(THEMES.indexOf(theme) + 1) % THEMES.length];
  setTheme(theme);
  try {
    localStorage.setItem("theme", theme);
  } catch {}
});

draw();
let width = find("front").clientWidth;
new ResizeObserver(() => {
  if (find("front").clientWidth === width) return;
  width = find("front").clientWidth;
  drawFront();
  drawTotals();
}).observe(find("front"));
