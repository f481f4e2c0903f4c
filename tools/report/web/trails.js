"use strict";
// Where bodies were in the frames before, fading with age, in each body's colour.
carom.trails = (() => {
  const mostSegments = 60000; // a frame, so that drawing stays smooth
  const steps = 8; // of fading: segments of about one age share a path

  /** Frames a trail can have with so many bodies. */
  const longest = (bodies) => Math.floor(mostSegments / Math.max(1, bodies));

  const draw = (pen, index, length, colours, bodiesByColour) => {
    const frames = carom.frames, count = Math.min(length, longest(frames.bodies), index), nowhere = frames.nowhere;
    if (count < 1) return;
    const views = [];
    for (let age = 0; age <= count; ++age) views.push(frames.frame(index - age));
    const places = views.map(carom.view.ofFrame);
    pen.lineWidth = 2.5 * carom.view.sharpness();
    pen.lineCap = "butt";
    for (let step = Math.min(steps, count) - 1; step >= 0; --step) {
      const parts = Math.min(steps, count);
      const young = Math.floor((step * count) / parts), old = Math.floor(((step + 1) * count) / parts);
      pen.globalAlpha = 0.85 * (1 - (step + 0.5) / parts);
      bodiesByColour.forEach((bodies, colour) => {
        pen.strokeStyle = colours[colour];
        pen.beginPath();
        for (const body of bodies) {
          let drawing = false;
          for (let age = young; age <= old; ++age) {
            const { x, y } = views[age], place = places[age];
            if (x[body] === nowhere) { drawing = false; continue; }
            const px = place.x0 + place.dx * x[body], py = place.y0 + place.dy * y[body];
            if (drawing) pen.lineTo(px, py); else pen.moveTo(px, py);
            drawing = true;
          }
        }
        pen.stroke();
      });
    }
    pen.globalAlpha = 1;
  };

  return { draw, longest };
})();
