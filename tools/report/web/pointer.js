"use strict";
// Mouse and fingers on the scene: dragging moves the view, the wheel and two fingers zoom, a click picks a body.
carom.pointer = carom.frames && ((onView, onPick) => {
  const { view } = carom, canvas = view.canvas;
  const stillness = 4; // CSS pixels a click may move
  const down = new Map();
  let moved = 0, spread = 0;

  const place = (event) => ({ x: event.offsetX * view.sharpness(), y: event.offsetY * view.sharpness() });
  const distance = () => {
    const [a, b] = [...down.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  /** While all is shown one finger scrolls the page; zoomed in it moves the view. */
  const touch = () => { canvas.style.touchAction = view.isFitted() ? "pan-x pan-y" : "none"; };

  canvas.addEventListener("pointerdown", (event) => {
    down.set(event.pointerId, place(event));
    moved = 0;
    if (down.size === 2) spread = distance();
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!down.has(event.pointerId)) return;
    const before = down.get(event.pointerId), now = place(event);
    down.set(event.pointerId, now);
    moved += Math.hypot(now.x - before.x, now.y - before.y);
    if (down.size === 1 && moved <= stillness * view.sharpness()) return;
    if (down.size === 1) view.pan(now.x - before.x, now.y - before.y);
    if (down.size === 2) {
      view.zoom(distance() / Math.max(spread, 1), now.x, now.y);
      spread = distance();
    }
    touch();
    onView();
  });
  canvas.addEventListener("pointerup", (event) => {
    const at = down.get(event.pointerId);
    down.delete(event.pointerId);
    if (at && moved <= stillness * view.sharpness()) onPick(at.x, at.y);
  });
  canvas.addEventListener("pointercancel", (event) => down.delete(event.pointerId));
  canvas.addEventListener("wheel", (event) => {
    if (document.activeElement !== canvas && !event.ctrlKey) return; // the page scrolls until the scene was clicked
    event.preventDefault();
    const { x, y } = place(event);
    view.zoom(Math.exp(-event.deltaY / 500), x, y);
    touch();
    onView();
  }, { passive: false });
  touch();
});
