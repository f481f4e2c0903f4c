"use strict";
// What Chart.js does not draw itself: error bars, guides of a given slope, marks of events on the x axis.
carom.chartMarks = (() => {
  const whisker = 4; // pixels to each side
  const tickHeight = 8; // pixels

  const errorBars = {
    id: "errorBars",
    afterDatasetDraw: (chart, { index }) => {
      const set = chart.data.datasets[index];
      const points = set.caromPoints || set.data;
      if (!points.some((point) => Number.isFinite(point.low) || Number.isFinite(point.high))) return;
      const isBars = Boolean(set.caromPoints);
      const values = isBars ? chart.scales.x : chart.scales.y;
      const pen = chart.ctx;
      pen.save();
      pen.strokeStyle = isBars ? carom.theme.named("--text") : set.borderColor;
      pen.lineWidth = 1;
      chart.getDatasetMeta(index).data.forEach((element, i) => {
        const at = isBars ? element.y : element.x;
        const ends = [points[i].low ?? points[i].y, points[i].high ?? points[i].y].map((end) => values.getPixelForValue(end));
        if (!ends.every(Number.isFinite)) return;
        pen.beginPath();
        const line = (along, across, toAlong, toAcross) => {
          pen.moveTo(...(isBars ? [along, across] : [across, along]));
          pen.lineTo(...(isBars ? [toAlong, toAcross] : [toAcross, toAlong]));
        };
        line(ends[0], at, ends[1], at);
        for (const end of ends) line(end, at - whisker, end, at + whisker);
        pen.stroke();
      });
      pen.restore();
    },
  };

  const middle = (values) => {
    const logs = values.filter((value) => value > 0).map(Math.log);
    return logs.length ? Math.exp((Math.min(...logs) + Math.max(...logs)) / 2) : NaN;
  };

  const slopeGuides = {
    id: "slopeGuides",
    afterDatasetsDraw: (chart) => {
      const guides = chart.options.plugins.slopeGuides.guides || [];
      if (!guides.length) return;
      const points = chart.data.datasets.flatMap((set) => set.data);
      const centre = { x: middle(points.map((point) => point.x)), y: middle(points.map((point) => point.y)) };
      const { left, right, top, bottom } = chart.chartArea;
      const { x, y } = chart.scales;
      const pen = chart.ctx;
      pen.save();
      pen.beginPath();
      pen.rect(left, top, right - left, bottom - top);
      pen.clip();
      pen.strokeStyle = carom.theme.named("--faint");
      pen.fillStyle = carom.theme.named("--text");
      pen.setLineDash([4, 4]);
      pen.font = "12px sans-serif";
      for (const { slope, name } of guides) {
        const at = (value) => y.getPixelForValue(centre.y * (value / centre.x) ** slope);
        pen.beginPath();
        pen.moveTo(left, at(x.min));
        pen.lineTo(right, at(x.max));
        pen.stroke();
        const inside = [0.95, 0.85, 0.7, 0.55].map((part) => x.min ** (1 - part) * x.max ** part)
          .find((value) => at(value) > top + 14 && at(value) < bottom - 4);
        if (inside === undefined) continue;
        pen.textAlign = "right";
        pen.save();
        pen.setLineDash([]);
        pen.strokeStyle = carom.theme.named("--panel");
        pen.lineWidth = 3;
        pen.strokeText(name, x.getPixelForValue(inside), at(inside) - 4);
        pen.restore();
        pen.fillText(name, x.getPixelForValue(inside), at(inside) - 4);
      }
      pen.restore();
    },
  };

  const events = {
    id: "events",
    afterDatasetsDraw: (chart) => {
      const times = chart.options.plugins.events.x || [];
      if (!times.length) return;
      const { bottom, left, right } = chart.chartArea;
      const pen = chart.ctx;
      pen.save();
      pen.strokeStyle = carom.theme.named("--text");
      pen.lineWidth = 1;
      pen.beginPath();
      let last = -1;
      for (const time of times) {
        const x = Math.round(chart.scales.x.getPixelForValue(time)) + 0.5;
        if (x === last || x < left || x > right) continue;
        pen.moveTo(x, bottom);
        pen.lineTo(x, bottom - tickHeight);
        last = x;
      }
      pen.stroke();
      pen.restore();
    },
  };

  const timeCursor = {
    id: "timeCursor",
    afterRender: (chart) => { if (carom.cursor) carom.cursor.place(chart); },
  };

  return [errorBars, slopeGuides, events, timeCursor];
})();
