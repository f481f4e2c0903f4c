"use strict";
// One moment, shown as a line in every chart over time. Whoever sets it tells the others.
carom.cursor = (() => {
  let time = null;
  const listeners = [];
  const lines = new Map();

  const lineOf = (chart) => {
    const plot = chart.canvas.parentElement;
    if (!lines.has(plot)) {
      const line = document.createElement("div");
      line.className = "time-cursor";
      plot.append(line);
      lines.set(plot, line);
    }
    return lines.get(plot);
  };

  /** Puts a chart's line where it belongs, also after the chart was drawn anew. */
  const place = (chart) => {
    if (!chart.followsTime) return;
    const { left, right, top, bottom } = chart.chartArea;
    const line = lineOf(chart), x = chart.scales.x.getPixelForValue(time);
    line.hidden = time === null || !(x >= left - 1 && x <= right + 1);
    line.style.left = `${Math.min(Math.max(x, left), right)}px`;
    line.style.top = `${top}px`;
    line.style.height = `${bottom - top}px`;
  };

  const timeCharts = () => Object.values(carom.charts).filter((chart) => chart.followsTime);

  /** `by` is who set it, and is not told. */
  const set = (value, by) => {
    time = value;
    timeCharts().forEach(place);
    for (const { who, listener } of listeners) if (who !== by) listener(time);
  };

  /** Pressing or dragging in a chart sets the moment. */
  const follow = ({ canvas }) => {
    let pressed = false;
    const move = (event) => {
      const chart = Chart.getChart(canvas); // another one after a change of theme
      if (pressed) set(chart.scales.x.getValueForPixel(event.offsetX), chart);
    };
    canvas.addEventListener("pointerdown", (event) => { pressed = true; move(event); });
    canvas.addEventListener("pointermove", move);
    for (const end of ["pointerup", "pointerleave", "pointercancel"]) canvas.addEventListener(end, () => { pressed = false; });
  };

  timeCharts().forEach(follow);
  return { set, place, onSet: (who, listener) => listeners.push({ who, listener }), time: () => time, lines };
})();
