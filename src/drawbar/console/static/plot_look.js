// Colours of a plot's texts and axes as the page has them now, light or dark.
function plotLook() {
  const colour = (name) => getComputedStyle(document.body).getPropertyValue(name).trim();
  const axis = { axisLabel: { color: colour("--ink") }, splitLine: { lineStyle: { color: colour("--edge"), opacity: 0.4 } } };
  return { xAxis: axis, yAxis: axis, legend: { textStyle: { color: colour("--ink") }, pageTextStyle: { color: colour("--ink") }, pageIconColor: colour("--ink") } };
}
