"use strict";
// What part of the world the canvas shows. Pixels here are those of the canvas; y points up in the world.
carom.view = carom.frames && (() => {
  const canvas = document.getElementById("scene");
  const margin = 0.03; // of the world's size, around it
  const tallest = 0.72; // of the window
  const lowest = 220, sharpest = 2; // CSS pixels; device pixels a CSS pixel
  let centre = { x: 0, y: 0 }, scale = 1, fitted = true;

  /** Points of a shape or of edges in the world, from those in the frame of their body. */
  const turned = (points, x, y, angle) => {
    const cos = Math.cos(angle), sin = Math.sin(angle);
    return points.x.map((_, i) => [x + cos * points.x[i] - sin * points.y[i], y + sin * points.x[i] + cos * points.y[i]]);
  };

  /** Points of a shape's outline in the world, if the body stays where it is from the first frame to the last. */
  const placeOfFloor = (body) => {
    const { frames } = carom, shape = frames.shapeOf(body);
    if (!shape) return null;
    const { x, y, angle } = frames.state(0, body), end = frames.state(frames.count - 1, body);
    if (!(Math.hypot(end.x - x, end.y - y) < 1e-3 * frames.radius[body])) return null;
    return turned(shape, x, y, angle);
  };

  /** The walls, or all that bodies reach: the largest radius around, but of shapes that stay the room they need. */
  const world = (() => {
    const { walls, view } = carom.frames.data;
    if (walls) return { min: walls.min, max: walls.max };
    let largest = 0;
    const floors = [];
    carom.frames.radius.forEach((radius, body) => {
      const floor = placeOfFloor(body);
      if (floor) floors.push(...floor); else largest = Math.max(largest, radius);
    });
    const [x0, y0, x1, y1] = view.every(Number.isFinite) ? view : [0, 0, 1, 1];
    const box = { min: [x0 - largest, y0 - largest], max: [x1 + largest, y1 + largest] };
    const add = (x, y) => {
      box.min = [Math.min(box.min[0], x), Math.min(box.min[1], y)];
      box.max = [Math.max(box.max[0], x), Math.max(box.max[1], y)];
    };
    for (const [x, y] of floors) add(x, y);
    for (const edges of carom.frames.data.edges) {
      const { frames } = carom, { x, y, angle } = frames.state(0, edges.body), end = frames.state(frames.count - 1, edges.body);
      if (!Number.isFinite(x)) continue;
      const moved = Math.max(Math.hypot(end.x - x, end.y - y), Math.abs(end.angle - angle) * edges.reach);
      if (moved > 1e-3 * edges.reach) { // room all around
        add(x - edges.reach, y - edges.reach);
        add(x + edges.reach, y + edges.reach);
      } else for (const [px, py] of turned(edges, x, y, angle)) add(px, py);
    }
    return box;
  })();
  const width = Math.max(world.max[0] - world.min[0], 1e-9), height = Math.max(world.max[1] - world.min[1], 1e-9);

  const fit = () => {
    centre = { x: (world.min[0] + world.max[0]) / 2, y: (world.min[1] + world.max[1]) / 2 };
    scale = Math.min(canvas.width / width, canvas.height / height) / (1 + 2 * margin);
    fitted = true;
  };

  /** Takes the width of its place; the height follows the world's. */
  const resize = () => {
    const sharpness = Math.min(window.devicePixelRatio || 1, sharpest);
    const cssWidth = canvas.parentElement.clientWidth - 2;
    const cssHeight = Math.round(Math.min(Math.max(cssWidth * height / width, lowest), window.innerHeight * tallest));
    canvas.style.height = `${cssHeight}px`;
    canvas.width = Math.round(cssWidth * sharpness);
    canvas.height = Math.round(cssHeight * sharpness);
    if (fitted) fit();
  };

  const x = (worldX) => (worldX - centre.x) * scale + canvas.width / 2;
  const y = (worldY) => (centre.y - worldY) * scale + canvas.height / 2;
  const toWorld = (px, py) => ({ x: (px - canvas.width / 2) / scale + centre.x, y: centre.y - (py - canvas.height / 2) / scale });

  const zoom = (factor, px = canvas.width / 2, py = canvas.height / 2) => {
    const fixed = toWorld(px, py);
    scale *= factor;
    const now = toWorld(px, py);
    centre = { x: centre.x + fixed.x - now.x, y: centre.y + fixed.y - now.y };
    fitted = false;
  };
  const pan = (dx, dy) => {
    centre = { x: centre.x - dx / scale, y: centre.y + dy / scale };
    fitted = false;
  };

  /** Pixels of a frame's bits: first + step * bits. */
  const ofFrame = (frame) => ({
    x0: x(frame.xBase), dx: frame.xStep * scale, y0: y(frame.yBase), dy: -frame.yStep * scale,
  });

  resize();
  return { canvas, fit, resize, zoom, pan, x, y, toWorld, ofFrame, scale: () => scale, isFitted: () => fitted,
           sharpness: () => canvas.width / Math.max(1, canvas.clientWidth) };
})();
