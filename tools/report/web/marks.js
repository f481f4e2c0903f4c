"use strict";
// What is drawn beside the bodies themselves: walls, marks of rotation, velocities, impacts.
carom.marks = (() => {
  const arrowSeconds = 0.15; // an arrow is the way a body goes in that time ...
  const longestArrow = 0.12; // ... but the fastest is so much of the picture's width
  const smallestMark = 4; // pixels of radius
  const mostFlashes = 1500, smallestFlash = 1.5; // pixels
  const flashFrames = 5; // a flash fades over so many frames, where bodies are few
  const fewBodies = 3000;
  const weakest = 0.05; // of the scene's speed: below, an impact is not seen

  const walls = (pen) => {
    const box = carom.frames.data.walls;
    if (!box) return;
    const { x, y } = carom.view, half = carom.view.sharpness();
    const left = x(box.min[0]) - half, right = x(box.max[0]) + half, bottom = y(box.min[1]) + half, top = y(box.max[1]) - half;
    const ends = { left: [left, bottom, left, top], right: [right, bottom, right, top],
                   bottom: [left, bottom, right, bottom], top: [left, top, right, top] };
    pen.strokeStyle = carom.theme.named("--text");
    pen.lineWidth = 2 * half;
    pen.lineCap = "square";
    pen.beginPath();
    for (const side of box.sides) {
      const [x0, y0, x1, y1] = ends[side];
      pen.moveTo(x0, y0);
      pen.lineTo(x1, y1);
    }
    pen.stroke();
  };

  /** Segments and chains, where their bodies are. */
  const edges = (pen, frame) => {
    const place = carom.view.ofFrame(frame), scale = carom.view.scale();
    pen.strokeStyle = carom.theme.named("--text");
    pen.lineWidth = 2 * carom.view.sharpness();
    pen.lineCap = pen.lineJoin = "round";
    pen.beginPath();
    for (const { body, x, y } of carom.frames.data.edges) {
      if (frame.x[body] === carom.frames.nowhere) continue;
      const px = place.x0 + place.dx * frame.x[body], py = place.y0 + place.dy * frame.y[body];
      const angle = frame.angle ? frame.angle[body] * carom.frames.turn : 0, cos = Math.cos(angle) * scale, sin = Math.sin(angle) * scale;
      for (let i = 0; i < x.length; ++i) {
        const toX = px + cos * x[i] - sin * y[i], toY = py - sin * x[i] - cos * y[i];
        if (i === 0) pen.moveTo(toX, toY); else pen.lineTo(toX, toY);
      }
    }
    pen.stroke();
  };

  /** Joints as lines between their anchors. */
  const joints = (pen, frame) => {
    const list = carom.frames.data.joints || [];
    if (list.length === 0) return;
    const place = carom.view.ofFrame(frame), scale = carom.view.scale();
    const ends = (body, x, y) => {
      if (body < 0) return [carom.view.x(x), carom.view.y(y)];
      if (frame.x[body] === carom.frames.nowhere) return null;
      const angle = frame.angle ? frame.angle[body] * carom.frames.turn : 0, cos = Math.cos(angle) * scale, sin = Math.sin(angle) * scale;
      return [place.x0 + place.dx * frame.x[body] + cos * x - sin * y, place.y0 + place.dy * frame.y[body] - sin * x - cos * y];
    };
    pen.strokeStyle = carom.theme.named("--text");
    pen.globalAlpha = 0.6;
    pen.lineWidth = 1.25 * carom.view.sharpness();
    pen.beginPath();
    for (const [a, ax, ay, b, bx, by, until] of list) {
      if (frame.time >= until) continue; // it broke
      const from = ends(a, ax, ay), to = ends(b, bx, by);
      if (!from || !to) continue;
      pen.moveTo(...from);
      pen.lineTo(...to);
    }
    pen.stroke();
    pen.globalAlpha = 1;
  };

  /** Calls `draw` with the place of every body of the frame that is on the canvas. */
  const each = (frame, draw) => {
    const place = carom.view.ofFrame(frame), { width, height } = carom.view.canvas, scale = carom.view.scale();
    const { radius, nowhere } = carom.frames;
    for (let body = 0; body < carom.frames.bodies; ++body) {
      if (frame.x[body] === nowhere) continue;
      const px = place.x0 + place.dx * frame.x[body], py = place.y0 + place.dy * frame.y[body], r = radius[body] * scale;
      if (px >= -r && py >= -r && px <= width + r && py <= height + r) draw(body, px, py, r);
    }
  };

  /** A line from the centre along the body's x: of a disc to its rim. */
  const rotation = (pen, frame) => {
    if (!frame.angle) return;
    pen.strokeStyle = carom.theme.named("--ground");
    pen.lineWidth = 1.5 * carom.view.sharpness();
    pen.lineCap = "butt";
    pen.beginPath();
    each(frame, (body, px, py, reach) => {
      const shape = carom.frames.shapeOf(body), r = shape ? shape.mark * carom.view.scale() : reach;
      if (r < smallestMark) return;
      const angle = frame.angle[body] * carom.frames.turn;
      pen.moveTo(px, py);
      pen.lineTo(px + r * Math.cos(angle), py - r * Math.sin(angle));
    });
    pen.stroke();
  };

  const arrows = (pen, frame) => {
    if (!frame.vx) return;
    const { scale, canvas, sharpness } = carom.view, fastest = carom.frames.data.speed_rms * 2;
    const length = Math.min(arrowSeconds * scale(), (longestArrow * canvas.width) / Math.max(fastest, 1e-9)) * frame.speedStep;
    const head = 3 * sharpness();
    pen.strokeStyle = carom.theme.named("--text");
    pen.lineWidth = 1.25 * sharpness();
    pen.lineCap = "butt";
    pen.beginPath();
    each(frame, (body, px, py) => {
      const dx = frame.vx[body] * length, dy = -frame.vy[body] * length, size = Math.hypot(dx, dy);
      if (size < 1) return;
      const ux = dx / size, uy = dy / size, tipX = px + dx, tipY = py + dy;
      pen.moveTo(px, py);
      pen.lineTo(tipX, tipY);
      pen.moveTo(tipX - head * (ux + uy), tipY - head * (uy - ux));
      pen.lineTo(tipX, tipY);
      pen.lineTo(tipX - head * (ux - uy), tipY - head * (uy + ux));
    });
    pen.stroke();
  };

  /** What gravity and drag change a velocity by between two frames: all else was impacts. */
  const flight = (seconds) => {
    const gravity = carom.frames.data.gravity || [0, 0], drag = (carom.frames.data.drag || {}).linear || 0;
    const kept = Math.exp(-drag * seconds);
    const fallen = drag > 0 ? (1 - kept) / drag : seconds;
    return { kept, x: gravity[0] * fallen, y: gravity[1] * fallen };
  };

  /** A burst where a body was hit, as strong as its velocity jumped since the frame before. */
  const impactsOf = (pen, index, fade) => {
    const now = carom.frames.frame(index), before = carom.frames.frame(index - 1);
    const free = flight(now.time - before.time), reference = Math.max(carom.frames.data.speed_rms, 1e-12);
    const size = 3 * carom.view.sharpness();
    let drawn = 0;
    each(now, (body, px, py, r) => {
      const jumpX = now.vx[body] * now.speedStep - before.vx[body] * before.speedStep * free.kept - free.x;
      const jumpY = now.vy[body] * now.speedStep - before.vy[body] * before.speedStep * free.kept - free.y;
      const jump = Math.hypot(jumpX, jumpY), strength = Math.min(1, jump / reference);
      if (strength < weakest || ++drawn > mostFlashes) return;
      pen.globalAlpha = fade * Math.min(1, 0.25 + strength);
      pen.beginPath();
      const width = Math.max(Math.min(size * (0.5 + 1.5 * strength), r), smallestFlash);
      pen.arc(px - (r * jumpX) / jump, py + (r * jumpY) / jump, width, 0, 2 * Math.PI);
      pen.fill();
    });
  };

  const impacts = (pen, index) => {
    if (!carom.frames.data.velocity) return;
    pen.fillStyle = carom.theme.isDark() ? "#fff3b0" : "#d00000";
    const ages = carom.frames.bodies <= fewBodies ? flashFrames : 1;
    for (let age = Math.min(ages, index) - 1; age >= 0; --age) impactsOf(pen, index - age, 1 - age / ages);
    pen.globalAlpha = 1;
  };

  return { walls, edges, joints, rotation, arrows, impacts, smallest: smallestMark };
})();
