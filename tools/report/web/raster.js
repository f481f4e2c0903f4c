"use strict";
// Very many small discs: pixels are set one by one from masks made once, which is several times faster than paths.
carom.raster = (() => {
  const largest = 8; // pixels of radius; larger ones are drawn as paths
  const radiusSteps = 4, placeSteps = 4, levels = 4; // a pixel is cut into, and shades of an edge
  const masks = new Map();

  /** Which pixels a disc covers, and how much of each, for a radius and a place within a pixel. */
  const makeMask = (radius, fx, fy) => {
    const reach = Math.ceil(radius) + 1, samples = 4;
    const dx = [], dy = [], level = [];
    for (let py = -reach; py <= reach; ++py)
      for (let px = -reach; px <= reach; ++px) {
        let inside = 0;
        for (let s = 0; s < samples * samples; ++s) {
          const sx = px + ((s % samples) + 0.5) / samples - fx, sy = py + (Math.floor(s / samples) + 0.5) / samples - fy;
          if (sx * sx + sy * sy <= radius * radius) ++inside;
        }
        const shade = Math.round((levels * inside) / (samples * samples));
        if (shade > 0) { dx.push(px); dy.push(py); level.push(shade); }
      }
    return { dx: Int8Array.from(dx), dy: Int8Array.from(dy), level: Uint8Array.from(level), reach };
  };

  const mask = (radius, fx, fy) => {
    const key = (radius * placeSteps + fy) * placeSteps + fx;
    let found = masks.get(key);
    if (!found) {
      found = makeMask(Math.max(radius, 2) / radiusSteps, (fx + 0.5) / placeSteps, (fy + 0.5) / placeSteps);
      masks.set(key, found);
    }
    return found;
  };

  const channels = (colour) => [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
  const pack = ([r, g, b]) => ((255 << 24) | (b << 16) | (g << 8) | r) >>> 0;

  /** Each colour's shades over the ground, from none to all of it. */
  const shadesOf = (colours, ground) => {
    const base = channels(ground), shades = new Uint32Array(colours.length * (levels + 1));
    colours.forEach((colour, i) => {
      const full = channels(colour);
      for (let level = 0; level <= levels; ++level)
        shades[i * (levels + 1) + level] = pack(full.map((c, k) => Math.round(base[k] + ((c - base[k]) * level) / levels)));
    });
    return shades;
  };

  let image = null, pixels = null, offsets = null, offsetsWidth = 0;
  const prepare = (pen) => {
    const { width, height } = pen.canvas;
    if (image && image.width === width && image.height === height) return;
    image = pen.createImageData(width, height);
    pixels = new Uint32Array(image.data.buffer);
  };

  /** A mask's pixels as steps in the image, for its width. */
  const stepsOf = (shape, width) => {
    if (offsetsWidth !== width) { offsets = new Map(); offsetsWidth = width; }
    let steps = offsets.get(shape);
    if (!steps) {
      steps = Int32Array.from(shape.dx, (dx, i) => dx + shape.dy[i] * width);
      offsets.set(shape, steps);
    }
    return steps;
  };

  /** Fills the canvas with the ground and the frame's small discs. Larger ones are returned: their numbers. */
  const draw = (pen, frame, place, scale, colours, colourOf, ground) => {
    prepare(pen);
    const { width, height } = image, { x, y } = frame, radii = carom.frames.radius, nowhere = carom.frames.nowhere;
    const shades = shadesOf(colours, ground), large = [];
    pixels.fill(pack(channels(ground)));
    for (let i = 0; i < x.length; ++i) {
      if (x[i] === nowhere || carom.frames.shapeOf(i)) continue; // shapes are paths, always
      const px = place.x0 + place.dx * x[i], py = place.y0 + place.dy * y[i], r = radii[i] * scale;
      if (px < -r || py < -r || px > width + r || py > height + r) continue;
      if (r > largest) { large.push(i); continue; }
      const ix = Math.floor(px), iy = Math.floor(py);
      const shape = mask(Math.round(r * radiusSteps), Math.floor((px - ix) * placeSteps), Math.floor((py - iy) * placeSteps));
      const { dx, dy, level, reach } = shape, shade = colourOf[i] * (levels + 1);
      if (ix >= reach && iy >= reach && ix + reach < width && iy + reach < height) {
        const steps = stepsOf(shape, width), centre = iy * width + ix;
        for (let k = 0; k < steps.length; ++k) pixels[centre + steps[k]] = shades[shade + level[k]];
      } else {
        for (let k = 0; k < dx.length; ++k) {
          const qx = ix + dx[k], qy = iy + dy[k];
          if (qx >= 0 && qy >= 0 && qx < width && qy < height) pixels[qy * width + qx] = shades[shade + level[k]];
        }
      }
    }
    pen.putImageData(image, 0, 0);
    return large;
  };

  return { draw, largest };
})();
