"use strict";
// The recorded frames: columns of 16 bits in base64, decoded by blocks when they are first shown. A position is
// base + step * bits; 65535 stands for a body that is nowhere.
carom.frames = (() => {
  const source = document.getElementById("player-data");
  if (!source) return null;
  const data = JSON.parse(source.textContent);
  const elements = [...document.querySelectorAll("script.frames")];
  const blocks = new Array(elements.length);
  const bodies = data.bodies;
  const columns = 2 + (data.velocity ? 2 : 0) + (data.angle ? 1 : 0);

  const bytesOf = (text) => {
    if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
    return Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
  };

  const block = (index) => {
    if (!blocks[index]) {
      blocks[index] = bytesOf(elements[index].textContent).buffer;
      elements[index].remove();
    }
    return blocks[index];
  };

  const made = new Map(); // views of the frames used last
  const mostMade = 1000;
  const frame = (index) => {
    if (made.has(index)) return made.get(index);
    const buffer = block(Math.floor(index / data.frames_a_block));
    let at = (index % data.frames_a_block) * columns * bodies * 2;
    const next = (Type) => {
      const column = new Type(buffer, at, bodies);
      at += 2 * bodies;
      return column;
    };
    const view = {
      index, time: data.time[index], x: next(Uint16Array), y: next(Uint16Array),
      xBase: data.x_base[index], xStep: data.x_step[index], yBase: data.y_base[index], yStep: data.y_step[index],
      speedStep: data.speed_step[index],
      vx: data.velocity ? next(Int16Array) : null, vy: data.velocity ? next(Int16Array) : null,
      angle: data.angle ? next(Uint16Array) : null,
    };
    if (made.size >= mostMade) made.clear();
    made.set(index, view);
    return view;
  };

  const radius = new Float32Array(bytesOf(data.radius).buffer);
  const mass = new Float32Array(bytesOf(data.mass).buffer);
  const colourNumber = data.colour ? new Uint16Array(bytesOf(data.colour.index).buffer) : null;
  const shapeNumber = data.shapes ? new Uint32Array(bytesOf(data.shapes.index).buffer) : null;
  /** The outline of a box, capsule or polygon; null for discs. */
  const shapeOf = (body) => (shapeNumber && shapeNumber[body] > 0 ? data.shapes.outlines[shapeNumber[body] - 1] : null);
  const nowhere = 65535, turn = 2 * Math.PI / 65536;

  /** The frame shown at a time: the last one that is not later. */
  const at = (time) => {
    let low = 0, high = data.time.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (data.time[middle] <= time) low = middle; else high = middle - 1;
    }
    return low;
  };

  /** One body's numbers in SI units. */
  const state = (index, body) => {
    const f = frame(index);
    return {
      x: f.x[body] === nowhere ? NaN : f.xBase + f.xStep * f.x[body], y: f.y[body] === nowhere ? NaN : f.yBase + f.yStep * f.y[body],
      vx: f.vx ? f.vx[body] * f.speedStep : NaN, vy: f.vy ? f.vy[body] * f.speedStep : NaN,
      angle: f.angle ? f.angle[body] * turn : 0,
    };
  };

  return {
    data, bodies, count: data.time.length, frame, at, state, radius, mass, colourNumber, shapeOf, nowhere, turn,
    name: (body) => data.names[body] || "",
    number: (body) => (data.body ? data.body[body] : body),
  };
})();
