// Colours of a plot's texts and axes as the page has them now, light or dark, and room for the names above it, which
// stand one below the other on a phone.
function plotLook(names) {
  const colour = (name) => getComputedStyle(document.body).getPropertyValue(name).trim();
  const number = (value) => value.toLocaleString(document.documentElement.lang, { maximumFractionDigits: 6, useGrouping: false }).replace("-", "−");
  const axis = { nameTextStyle: { color: colour("--ink"), fontSize: 14 }, axisLabel: { color: colour("--ink"), formatter: number }, splitLine: { lineStyle: { color: colour("--edge"), opacity: 0.4 } } };
  const top = window.innerWidth < 600 ? 16 + 24 * names : 48;
  return { color: COLOURS[document.body.classList.contains("body--dark") ? "dark" : "light"], grid: { top }, xAxis: axis, yAxis: axis, legend: { textStyle: { color: colour("--ink") }, pageTextStyle: { color: colour("--ink") }, pageIconColor: colour("--ink") } };
}

const SPAN = 60; // s
const COLOURS = { // of curves, on the ground of each look
  light: ["#0072b2", "#c04a00", "#00795a", "#a8437f", "#8a6500", "#6a4a96"],
  dark: ["#56b4e9", "#ff9d5c", "#57d9a3", "#f0a6cf", "#ffc857", "#bfa3e6"],
};

const plots = new Map(); // lines and steps of each live plot, by its element's number

// Adds new steps to a live plot, slides it to `age` s after the newest one, and says when that is drawn (live_plot.py).
function plotSteps(number, { lines, rows, age }) {
  const plot = getElement(number);
  if (!plot) return;
  if (lines) plots.set(number, { lines, rows: [], look: null });
  const kept = plots.get(number);
  kept.rows.push(...rows);
  const now = kept.rows.length ? kept.rows[kept.rows.length - 1][0] + age : 0;
  kept.rows = kept.rows.filter(([time]) => now - time <= SPAN);
  const drawn = () => requestAnimationFrame(() => plot.$emit("plotted"));
  if (!plot.chart) return drawn(); // it comes with the next picture
  const series = kept.lines.map(({ id }, i) => ({ id, data: kept.rows.map((row) => [row[0] - now, row[i + 1]]) }));
  const look = `${document.body.className} ${window.innerWidth}`;
  if (kept.look === look) plot.chart.setOption({ series });
  else {
    const names = new Set(kept.lines.map(({ name }) => name)).size;
    const looks = plotLook(names), colours = looks.color;
    const whole = kept.lines.map(({ colour, lineStyle, ...line }, i) => {
      const color = colours[colour % colours.length];
      return { ...line, ...series[i], itemStyle: { color }, lineStyle: { ...lineStyle, color } };
    });
    plot.chart.setOption({ ...looks, series: whole }, { replaceMerge: ["series"] });
    kept.look = look;
  }
  drawn();
}
