// The widget of notebooks, as anywidget loads it: a canvas that shows the frames which the kernel sends, and sends
// gestures back. One gesture is under way at a time: what is done meanwhile adds up to the next one. All coordinates
// are pixels of the view.

const TURN_OF_KEY = 20; // pixels of a drag
const ZOOM_OF_WHEEL = 0.0015; // per unit of the wheel
const KEYS = {
  ArrowLeft: { kind: "orbit", dx: -TURN_OF_KEY, dy: 0 },
  ArrowRight: { kind: "orbit", dx: TURN_OF_KEY, dy: 0 },
  ArrowUp: { kind: "orbit", dx: 0, dy: -TURN_OF_KEY },
  ArrowDown: { kind: "orbit", dx: 0, dy: TURN_OF_KEY },
  "+": { kind: "zoom", factor: 1.25 },
  "-": { kind: "zoom", factor: 0.8 },
  f: { kind: "fit" },
};

/** Adds a gesture to those that wait: successive ones of one kind become one. */
function add(waiting, gesture) {
  const last = waiting[waiting.length - 1];
  if (last === undefined || last.kind !== gesture.kind || !("dx" in gesture || "factor" in gesture)) {
    waiting.push({ ...gesture });
  } else if ("dx" in gesture) {
    last.dx += gesture.dx;
    last.dy += gesture.dy;
  } else {
    last.factor *= gesture.factor;
  }
}

/** Sends gestures one after another, each when the kernel has taken the one before. */
function gestures(model) {
  const waiting = [];
  let underWay = false;
  const next = () => {
    const gesture = waiting.shift();
    underWay = gesture !== undefined;
    if (underWay) model.send(gesture);
  };
  return {
    send(gesture) {
      add(waiting, gesture);
      if (!underWay) next();
    },
    taken: next,
  };
}

/** The pointers that are down: one turns, two move and pinch. */
function followPointers(canvas, place, send) {
  const down = new Map();
  let dragged = 0;
  const middle = () => {
    const [a, b] = [...down.values()];
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.hypot(a.x - b.x, a.y - b.y) };
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture?.(event.pointerId);
    canvas.focus();
    if (down.size === 0) dragged = 0;
    down.set(event.pointerId, place(event));
    event.preventDefault();
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = down.get(event.pointerId);
    if (before === undefined) return;
    const now = place(event);
    const [dx, dy] = [now.x - before.x, now.y - before.y];
    dragged += Math.abs(dx) + Math.abs(dy);
    if (down.size === 2) {
      const was = middle();
      down.set(event.pointerId, now);
      const is = middle();
      send({ kind: "pan", dx: is.x - was.x, dy: is.y - was.y });
      if (was.apart > 0 && is.apart > 0) send({ kind: "zoom", factor: is.apart / was.apart });
    } else {
      down.set(event.pointerId, now);
      const moves = event.buttons === 2 || event.shiftKey;
      send({ kind: moves ? "pan" : "orbit", dx, dy });
    }
  });
  const up = (event) => {
    if (!down.delete(event.pointerId) || down.size > 0) return;
    if (dragged < 4 && event.type === "pointerup") send({ kind: "pick", ...place(event) });
    else send({ kind: "rest" });
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("dblclick", (event) => send({ kind: "focus", ...place(event) }));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
}

/** Draws frames in their order, and tells the kernel when each is painted. */
function painter(model, canvas) {
  let last = Promise.resolve();
  const paint = async (frame, data) => {
    try {
      const bitmap = await createImageBitmap(new Blob([data], { type: frame.type }));
      canvas.getContext("2d").drawImage(bitmap, 0, 0, canvas.width, canvas.height);
      bitmap.close();
    } finally {
      model.send({ kind: "painted", frame: frame.frame });
    }
  };
  return (frame, data) => {
    last = last.then(() => paint(frame, data)).catch((error) => console.error("surfcast:", error));
  };
}

function render({ model, el }) {
  const canvas = document.createElement("canvas");
  const text = document.createElement("div");
  canvas.tabIndex = 0;
  canvas.style.cssText = "max-width: 100%; touch-action: none; outline: none; display: block";
  text.style.cssText = "font: 12px monospace; min-height: 1.5em; white-space: pre-wrap";
  el.append(canvas, text);

  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    const scale = box.width > 0 ? canvas.width / box.width : 1;
    return { x: (event.clientX - box.left) * scale, y: (event.clientY - box.top) * scale };
  };
  const { send, taken } = gestures(model);
  const paint = painter(model, canvas);
  followPointers(canvas, place, send);

  let resting = 0;
  const rest = () => {
    clearTimeout(resting);
    resting = setTimeout(() => send({ kind: "rest" }), 200);
  };
  canvas.addEventListener(
    "wheel",
    (event) => {
      send({ kind: "zoom", factor: Math.exp(-event.deltaY * ZOOM_OF_WHEEL) });
      rest();
      event.preventDefault();
    },
    { passive: false },
  );
  canvas.addEventListener("keydown", (event) => {
    const gesture = KEYS[event.key];
    if (gesture === undefined || event.ctrlKey || event.metaKey) return;
    send(gesture);
    rest();
    event.preventDefault();
    event.stopPropagation(); // a notebook has keys of its own
  });

  const receive = (message, buffers) => {
    if (message.kind === "size") {
      canvas.width = message.width;
      canvas.height = message.height;
    } else if (message.kind === "frame") {
      paint(message, buffers[0]);
    } else if (message.kind === "taken") {
      taken();
    } else if (message.kind === "text") {
      text.textContent = message.text;
    }
  };
  model.on("msg:custom", receive);
  model.send({ kind: "open" });
  return () => {
    clearTimeout(resting);
    model.off?.("msg:custom", receive);
    model.send({ kind: "close" });
  };
}

export default { render };
