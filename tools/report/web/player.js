"use strict";
// The controls, and the clock that moves through the frames.
carom.player = carom.frames && (() => {
  const { frames, view, painter, bodyCard, cursor } = carom;
  const element = (id) => document.getElementById(id);
  const slider = element("slider"), clock = element("clock"), play = element("play"), speed = element("speed");
  const times = frames.data.time, last = frames.count - 1;
  let index = 0, time = times[0], playing = false, stamp = null, waiting = false, drawn = 0;

  const draw = () => {
    waiting = false;
    painter.draw(index);
    ++drawn;
  };
  /** Draws once, however often it was asked for. */
  const redraw = () => {
    if (!waiting) requestAnimationFrame(draw);
    waiting = true;
  };

  const show = (by) => {
    slider.value = index;
    clock.textContent = `${times[index].toFixed(decimals)} s, frame ${index}`;
    slider.setAttribute("aria-valuetext", clock.textContent);
    bodyCard.show(index);
    cursor.set(times[index], by);
    redraw();
  };

  const seekFrame = (frame, by = "player") => {
    index = Math.min(Math.max(frame, 0), last);
    time = times[index];
    show(by);
  };
  const seekTime = (value, by) => seekFrame(frames.at(value), by);

  const setPlaying = (wish) => {
    playing = wish;
    play.textContent = playing ? "Pause" : "Play";
    stamp = null;
    if (playing && index === last) seekFrame(0);
    if (playing) requestAnimationFrame(advance);
  };

  const advance = (now) => {
    if (!playing) return;
    if (stamp !== null) time += ((now - stamp) / 1000) * Number(speed.value);
    stamp = now;
    const next = frames.at(time);
    if (next !== index) {
      index = next;
      show("player");
    }
    if (index === last) setPlaying(false); else requestAnimationFrame(advance);
  };

  const decimals = (() => {
    const step = last > 0 ? (times[last] - times[0]) / last : 1;
    return Math.min(6, Math.max(2, 1 - Math.floor(Math.log10(step || 1) + 1e-6)));
  })();

  const step = (by) => { setPlaying(false); seekFrame(index + by); };
  const zoom = (factor) => { view.zoom(factor); redraw(); };
  const fit = () => { view.fit(); redraw(); };
  const wish = (id, name) => {
    const box = element(id);
    painter.wishes[name] = box.checked;
    box.addEventListener("change", () => { painter.wishes[name] = box.checked; redraw(); });
  };

  const prepareTrails = () => {
    const length = element("trail-length"), box = element("show-trails"), longest = carom.trails.longest(frames.bodies);
    const asked = frames.data.trail || 0;
    if (longest < 1) { element("wish-trails").hidden = true; return; }
    length.max = Math.min(longest, 999);
    length.value = Math.min(asked || 20, length.max);
    box.checked = asked > 0;
    painter.wishes.trailLength = Number(length.value);
    length.addEventListener("change", () => {
      painter.wishes.trailLength = Math.min(Math.max(1, Math.round(Number(length.value)) || 1), Number(length.max));
      length.value = painter.wishes.trailLength;
      redraw();
    });
    wish("show-trails", "trails");
  };

  const keys = {
    " ": () => setPlaying(!playing), ArrowLeft: () => step(-1), ArrowRight: () => step(1), Home: () => seekFrame(0), End: () => seekFrame(last),
    "+": () => zoom(1.25), "=": () => zoom(1.25), "-": () => zoom(0.8), 0: fit,
  };
  document.addEventListener("keydown", (event) => {
    // Space and arrows belong to a control that does something with them itself.
    const own = event.key === " " ? "button, select, a, input:not([type=range])" : "select, input, .scroll";
    if (event.target.closest(own) || event.ctrlKey || event.altKey || event.metaKey || !keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  });

  slider.max = last;
  slider.addEventListener("input", () => { setPlaying(false); seekFrame(Number(slider.value)); });
  play.addEventListener("click", () => setPlaying(!playing));
  speed.addEventListener("change", () => { stamp = null; });
  element("step-back").addEventListener("click", () => step(-1));
  element("step-on").addEventListener("click", () => step(1));
  element("zoom-in").addEventListener("click", () => zoom(1.25));
  element("zoom-out").addEventListener("click", () => zoom(0.8));
  element("fit").addEventListener("click", fit);
  prepareTrails();
  wish("show-marks", "marks");
  wish("show-arrows", "arrows");
  wish("show-impacts", "impacts");
  if (!frames.data.velocity) for (const label of document.querySelectorAll(".needs-velocity")) label.hidden = true;
  if (!frames.data.angle) element("show-marks").parentElement.hidden = true;
  if (frames.data.lost) element("player-note").textContent += ` Bodies too far off to be drawn: up to ${frames.data.lost}.`;

  carom.pointer(redraw, (px, py) => { bodyCard.pick(index, px, py); bodyCard.show(index); redraw(); });
  cursor.onSet("player", (value) => { setPlaying(false); seekTime(value, "player"); });
  carom.theme.onChange(() => { painter.chooseColours(); redraw(); });
  window.addEventListener("resize", () => { view.resize(); redraw(); });
  seekFrame(0);
  painter.draw(0);
  return { seekFrame, seekTime, play: () => setPlaying(true), pause: () => setPlaying(false), redraw, step,
           index: () => index, isPlaying: () => playing, drawn: () => drawn };
})();
