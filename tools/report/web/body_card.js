"use strict";
// The numbers of the body that was clicked, now.
carom.bodyCard = carom.frames && (() => {
  const card = document.getElementById("body-card");
  const { frames, view, painter } = carom;
  const reach = 8; // CSS pixels beside a body that still mean it

  const pick = (index, px, py) => {
    const frame = frames.frame(index), place = view.ofFrame(frame), scale = view.scale();
    let best = -1, least = reach * view.sharpness();
    for (let body = 0; body < frames.bodies; ++body) {
      if (frame.x[body] === frames.nowhere) continue;
      const dx = place.x0 + place.dx * frame.x[body] - px, dy = place.y0 + place.dy * frame.y[body] - py;
      const outside = Math.hypot(dx, dy) - frames.radius[body] * scale;
      if (outside < least) { least = outside; best = body; }
    }
    painter.wishes.chosen = best;
    return best;
  };

  const entry = (list, name, value, unit) => {
    const term = document.createElement("dt"), text = document.createElement("dd"), both = document.createElement("div");
    term.textContent = name;
    text.textContent = `${typeof value === "number" ? carom.numbers.short(value) : value} ${unit}`;
    both.append(term, text);
    list.append(both);
  };

  const show = (index) => {
    const body = painter.wishes.chosen;
    card.hidden = body < 0;
    if (body < 0) return;
    const { x, y, vx, vy, angle } = frames.state(index, body), list = document.createElement("dl");
    const title = document.createElement("strong");
    const name = frames.name(body);
    title.textContent = `Body ${frames.number(body)}${name ? `: ${name}` : ""}`;
    entry(list, "x", x, "m");
    entry(list, "y", y, "m");
    if (frames.data.velocity) {
      entry(list, "velocity x", vx, "m/s");
      entry(list, "velocity y", vy, "m/s");
      entry(list, "speed", Math.hypot(vx, vy), "m/s");
    }
    if (frames.data.angle) entry(list, "angle", angle, "rad");
    entry(list, "mass", frames.mass[body], "kg");
    entry(list, frames.shapeOf(body) ? "reach" : "radius", frames.radius[body], "m");
    card.replaceChildren(title, list);
  };

  return { pick, show };
})();
