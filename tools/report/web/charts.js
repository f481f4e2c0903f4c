"use strict";
// Every <figure class="chart"> becomes a chart of the data beside it. carom.charts has them by id.
carom.charts = (() => {
  const charts = {};
  const barHeight = 22, barMargin = 90; // pixels

  const narrow = 500, longestName = 16; // pixels; characters of a bar's name where it is narrow

  const shortened = (name) =>
    window.innerWidth < narrow && name.length > longestName ? `${name.slice(0, longestName - 1)}\u2026` : name;

  /** Room for error bars too. */
  const limits = (all, log) => {
    const ends = all.flatMap((series) => [...(series.low || []), ...(series.high || [])])
      .filter((end) => Number.isFinite(end) && (!log || end > 0));
    return ends.length ? { suggestedMin: Math.min(...ends), suggestedMax: Math.max(...ends) } : {};
  };

  /** Charts over time begin at the start and end with the data. */
  const wholeTime = (all) => ({ min: 0, max: Math.max(...all.map((series) => series.x[series.x.length - 1] ?? 0)) || 1 });

  const axis = (title, log, extra = {}) => ({
    ...extra,
    type: log ? "logarithmic" : "linear",
    title: { display: Boolean(title), text: title },
    ticks: {
      maxRotation: 0, autoSkipPadding: 12,
      callback: (value) => {
        if (!log) return carom.numbers.short(value);
        const mantissa = value / 10 ** Math.floor(Math.log10(value) + 1e-9);
        return mantissa < 1.01 ? carom.numbers.power(value) : "";
      },
    },
    grid: {},
  });

  const names = {
    type: "category", title: { display: false }, grid: {},
    ticks: { autoSkip: false, callback(value) { return shortened(this.getLabelForValue(value)); } },
  };

  const span = (point) =>
    Number.isFinite(point.low) || Number.isFinite(point.high)
      ? ` (${carom.numbers.short(point.low)} ... ${carom.numbers.short(point.high)})` : "";

  const tooltip = (description) => ({
    filter: (item) => !item.dataset.caromArea || item.parsed.y !== 0,
    callbacks: {
      title: (items) => {
        if (!items.length) return "";
        if (description.bars) return items[0].label;
        return items[0].raw.label || `${description.x_label}: ${carom.numbers.short(items[0].parsed.x, 6)}`;
      },
      label: (item) => {
        const point = item.dataset.caromPoints ? item.dataset.caromPoints[item.dataIndex] : item.raw;
        return `${item.dataset.label}: ${carom.numbers.short(point.y, 6)}${span(point)}`;
      },
    },
  });

  const options = (description) => ({
    animation: false, responsive: true, maintainAspectRatio: false, normalized: true,
    indexAxis: description.bars ? "y" : "x",
    interaction: description.bars ? { mode: "nearest", intersect: true }
      : { mode: description.follows_time ? "index" : "nearest", axis: description.follows_time ? "x" : "xy", intersect: false },
    scales: description.bars
      ? { x: axis(description.y_label, description.log_y, { suggestedMax: limits(description.series).suggestedMax }), y: names }
      : { x: axis(description.x_label, description.log_x, description.follows_time ? wholeTime(description.series) : {}),
          y: axis(description.y_label, description.log_y,
                  { stacked: description.series.some((series) => series.stack), ...limits(description.series, description.log_y) }) },
    plugins: {
      legend: {
        display: description.series.length > 1, position: "bottom",
        labels: { usePointStyle: true, boxHeight: 7, filter: (item, data) => data.datasets[item.datasetIndex].inLegend },
      },
      tooltip: tooltip(description),
      slopeGuides: { guides: description.slopes },
      events: { x: description.marks.x },
    },
  });

  /** Colours of the theme, in place. */
  const paint = (chart) => {
    carom.series.paint(chart.data.datasets);
    const text = carom.theme.named("--text"), line = carom.theme.named("--line");
    for (const scale of Object.values(chart.options.scales)) {
      scale.ticks.color = text;
      scale.title.color = text;
      scale.grid.color = line;
    }
    chart.options.plugins.legend.labels.color = text;
  };

  const make = (figure) => {
    const id = figure.id.replace(/^chart-/, "");
    const description = JSON.parse(document.getElementById(`data-${id}`).textContent);
    const all = description.series;
    const data = description.bars
      ? { labels: all.length ? all[0].label || all[0].x : [], datasets: all.map(carom.series.bars) }
      : { datasets: all.map(carom.series.dataset) };
    const plot = figure.querySelector(".plot");
    if (description.bars) plot.style.height = `${barMargin + barHeight * data.labels.length * Math.max(1, stacks(all))}px`;
    const config = { type: description.bars ? "bar" : "line", data, options: options(description), plugins: carom.chartMarks };
    paint(config);
    charts[id] = new Chart(figure.querySelector("canvas"), config);
    charts[id].followsTime = description.follows_time;
  };

  const stacks = (all) => new Set(all.map((series, i) => series.stack || i)).size;

  const makeAll = () => {
    for (const figure of document.querySelectorAll("figure.chart")) make(figure);
  };
  makeAll();
  carom.theme.onChange(() => {
    for (const chart of Object.values(charts)) chart.destroy();
    makeAll();
  });
  return charts;
})();
