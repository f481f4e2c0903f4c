"use strict";
// From the page's data to the datasets of Chart.js. Series differ in colour, and in dashes and marks too.
carom.series = (() => {
  const dashes = [[], [6, 3], [2, 2], [8, 3, 2, 3], [12, 4], [4, 4], [1, 3], [10, 2, 2, 2, 2, 2]];
  const marks = ["circle", "rect", "triangle", "rectRot", "crossRot", "star", "rectRounded", "cross"];
  const mostPointsWithMarks = 60;

  const points = (series) =>
    series.x.map((x, i) => ({
      x, y: series.y[i] === null ? NaN : series.y[i],
      low: series.low ? series.low[i] : null, high: series.high ? series.high[i] : null,
      label: series.label ? series.label[i] : "",
    }));

  const translucent = (colour) => `${colour}99`;
  const colourIndex = (series, index) => (series.colour >= 0 ? series.colour : index);

  /** Where an area ends below: the series before it in its stack, or zero. */
  const floor = (all, index) => {
    for (let below = index - 1; below >= 0; --below) if (all[below].stack === all[index].stack) return below;
    return "origin";
  };

  const dataset = (series, index, all) => {
    const place = colourIndex(series, index);
    const data = points(series);
    const shown = !series.line || data.length <= mostPointsWithMarks;
    return {
      label: series.name, data, showLine: series.line, caromColour: place, caromArea: series.area, inLegend: series.in_legend,
      ...(series.stack && { stack: series.stack }),
      fill: series.area ? (series.stack ? floor(all, index) : "origin") : false,
      borderDash: series.area ? [] : dashes[index % dashes.length], borderWidth: series.area ? 1 : 2,
      pointStyle: marks[index % marks.length], pointRadius: series.area || !shown ? 0 : 4, pointHitRadius: 8,
    };
  };

  const bars = (series, index) => ({
    label: series.name, data: series.y, caromColour: colourIndex(series, index), inLegend: series.in_legend,
    caromPoints: points(series), ...(series.stack && { stack: series.stack }),
  });

  /** Colours are set apart from the rest, because they change with the theme. */
  const paint = (datasets) => {
    for (const set of datasets) {
      const colour = carom.theme.colour(set.caromColour);
      set.borderColor = colour;
      set.backgroundColor = set.caromArea ? translucent(colour) : colour;
    }
  };

  return { dataset, bars, paint };
})();
