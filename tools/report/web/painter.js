"use strict";
// Draws one frame: ground, trails, bodies, walls, marks.
carom.painter = carom.frames && (() => {
  const few = 1500; // bodies up to which each is a path with an outline
  const { frames, view } = carom;
  const pen = view.canvas.getContext("2d", { alpha: false });
  const wishes = { trails: false, trailLength: 0, marks: true, arrows: false, impacts: true, chosen: -1 };
  let colours = [], colourOf = new Uint16Array(frames.bodies), bodiesByColour = [];

  const hex = (number) => `#${number.toString(16).padStart(6, "0")}`;

  /** The scene's colours; bodies without one take the page's, one each where they are few. */
  const chooseColours = () => {
    const own = frames.data.colour ? frames.data.colour.palette.map(hex) : [];
    const palette = carom.theme.palette();
    const several = frames.bodies <= 50;
    colours = [...own, ...palette];
    for (let body = 0; body < frames.bodies; ++body) {
      const number = frames.colourNumber ? frames.colourNumber[body] : 0;
      colourOf[body] = number > 0 ? number - 1 : own.length + (several ? body % palette.length : 0);
    }
    bodiesByColour = colours.map(() => []);
    for (let body = 0; body < frames.bodies; ++body) bodiesByColour[colourOf[body]].push(body);
  };

  const discs = (frame, bodies, colour) => {
    const place = view.ofFrame(frame), scale = view.scale(), { x, y } = frame;
    const { width, height } = view.canvas;
    pen.fillStyle = colour;
    pen.beginPath();
    for (const body of bodies) {
      if (x[body] === frames.nowhere || frames.radius[body] === 0 || frames.shapeOf(body)) continue;
      const px = place.x0 + place.dx * x[body], py = place.y0 + place.dy * y[body], r = Math.max(frames.radius[body] * scale, 0.5);
      if (px < -r || py < -r || px > width + r || py > height + r) continue;
      pen.moveTo(px + r, py);
      pen.arc(px, py, r, 0, 2 * Math.PI);
    }
    pen.fill();
  };

  /** Boxes, capsules and polygons, turned; an outline in the ground's colour tells those apart that touch. */
  const shapes = (frame, ground) => {
    if (!frames.data.shapes) return;
    const place = view.ofFrame(frame), scale = view.scale(), { width, height } = view.canvas;
    pen.lineWidth = view.sharpness();
    pen.lineJoin = "round";
    pen.strokeStyle = ground;
    bodiesByColour.forEach((bodies, colour) => {
      const fine = new Path2D(), outlined = new Path2D();
      for (const body of bodies) {
        const shape = frames.shapeOf(body);
        if (!shape || frame.x[body] === frames.nowhere) continue;
        const px = place.x0 + place.dx * frame.x[body], py = place.y0 + place.dy * frame.y[body], r = frames.radius[body] * scale;
        if (px < -r || py < -r || px > width + r || py > height + r) continue;
        const path = r < carom.marks.smallest ? fine : outlined;
        const angle = frame.angle ? frame.angle[body] * frames.turn : 0, cos = Math.cos(angle) * scale, sin = Math.sin(angle) * scale;
        for (let i = 0; i < shape.x.length; ++i) {
          const toX = px + cos * shape.x[i] - sin * shape.y[i], toY = py - sin * shape.x[i] - cos * shape.y[i];
          if (shape.starts.includes(i)) { if (i > 0) path.closePath(); path.moveTo(toX, toY); } else path.lineTo(toX, toY);
        }
        path.closePath();
      }
      pen.fillStyle = colours[colour];
      pen.fill(fine);
      pen.fill(outlined);
      pen.stroke(outlined);
    });
  };

  const byColour = (bodies) => {
    const groups = new Map();
    for (const body of bodies) {
      if (!groups.has(colourOf[body])) groups.set(colourOf[body], []);
      groups.get(colourOf[body]).push(body);
    }
    return groups;
  };

  const chosenRing = (frame) => {
    const body = wishes.chosen;
    if (body < 0 || frame.x[body] === frames.nowhere) return;
    const place = view.ofFrame(frame), r = Math.max(frames.radius[body] * view.scale(), 2) + 2 * view.sharpness();
    pen.strokeStyle = carom.theme.named("--text");
    pen.lineWidth = 2 * view.sharpness();
    pen.beginPath();
    pen.arc(place.x0 + place.dx * frame.x[body], place.y0 + place.dy * frame.y[body], r, 0, 2 * Math.PI);
    pen.stroke();
  };

  const draw = (index) => {
    const frame = frames.frame(index), ground = carom.theme.named("--panel");
    if (frames.bodies > few) {
      const large = carom.raster.draw(pen, frame, view.ofFrame(frame), view.scale(), colours, colourOf, ground);
      if (wishes.trails) carom.trails.draw(pen, index, wishes.trailLength, colours, bodiesByColour);
      for (const [colour, bodies] of byColour(large)) discs(frame, bodies, colours[colour]);
    } else {
      pen.fillStyle = ground;
      pen.fillRect(0, 0, view.canvas.width, view.canvas.height);
      if (wishes.trails) carom.trails.draw(pen, index, wishes.trailLength, colours, bodiesByColour);
      bodiesByColour.forEach((bodies, colour) => discs(frame, bodies, colours[colour]));
    }
    shapes(frame, ground);
    carom.marks.walls(pen);
    carom.marks.edges(pen, frame);
    carom.marks.joints(pen, frame);
    if (wishes.marks) carom.marks.rotation(pen, frame);
    if (wishes.arrows) carom.marks.arrows(pen, frame);
    if (wishes.impacts) carom.marks.impacts(pen, index);
    chosenRing(frame);
  };

  chooseColours();
  return { draw, wishes, chooseColours };
})();
