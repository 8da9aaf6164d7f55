// Colours of a plot's texts and axes as the page has them now, light or dark, and room for the names above it, which
// stand one below the other on a phone.
function plotLook(names) {
  const colour = (name) => getComputedStyle(document.body).getPropertyValue(name).trim();
  const axis = { axisLabel: { color: colour("--ink") }, splitLine: { lineStyle: { color: colour("--edge"), opacity: 0.4 } } };
  const top = window.innerWidth < 600 ? 16 + 24 * names : 48;
  return { grid: { top }, xAxis: axis, yAxis: axis, legend: { textStyle: { color: colour("--ink") }, pageTextStyle: { color: colour("--ink") }, pageIconColor: colour("--ink") } };
}
