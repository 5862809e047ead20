// ---- main: controls to state, state to controls
let keyed = false;
const fillSelects = () => {
  const option = (p, name) => make("option", { value: p.id }, name);
  for (const side of ["left", "right"]) {
    const renderers = make("optgroup", { label: "renderers" }), rungs = make("optgroup", { label: "rungs of the ladder" });
    for (const p of index.pictures) {
      if (p.rung === undefined) renderers.append(option(p, p.name));
      else rungs.append(option(p, "rung " + p.rung + ": " + p.name));
    }
    for (const [rung, name] of [[5, "cast"], [9, "trace"]]) {
      const found = index.pictures.find((p) => p.rung === rung);
      if (found) renderers.append(option(found, name));
    }
    if (index.layers) renderers.append(option({ id: "mix" }, "mix (term mixer)"));
    by(side).append(rungs, renderers);
    by(side).oninput = (e) => change({ [side]: e.target.value });
  }
};
const controls = () => {
  by("swap").onclick = () => change({ left: state.right, right: state.left });
  for (const radio of document.querySelectorAll("[name=look]")) radio.oninput = () => change({ look: radio.value });
  by("tell").onclick = () => by("pixel").scrollIntoView({ behavior: "smooth" });
  by("hatch").oninput = (e) => change({ hatch: e.target.checked });
  by("exposure").oninput = (e) => change({ exposure: Number(e.target.value) });
  by("telling").oninput = (e) => e.target.value && change({ pixel: e.target.value.split(",").map(Number) });
  for (const axis of ["x", "y"]) {
    by(axis).max = (axis === "x" ? width : height) - 1;
    by(axis).onchange = () => {
      const inside = (id, size) => Math.min(Math.max(Math.round(Number(by(id).value)) || 0, 0), size - 1);
      change({ pixel: [inside("x", width), inside("y", height)] });
    };
  }
  by("copy").onclick = async () => {
    const text = by("command").textContent;
    try {
      await navigator.clipboard.writeText(text);
    } catch {
      // Pages opened as files may not use the clipboard everywhere: select the line and ask the old way.
      getSelection().selectAllChildren(by("command"));
      document.execCommand("copy");
    }
    by("copied").textContent = "copied";
    by("copy").textContent = "copied";
    setTimeout(() => (by("copy").textContent = "copy"), 1500);
  };
  for (const card of document.querySelectorAll("[data-cause]")) {
    card.onclick = () => {
      const k = Number(card.dataset.cause), has = (id) => index.pictures.some((p) => p.id === id);
      if (!has("r" + k) || !has("r" + (k + 1))) return;
      const exposure = Math.min(Math.max(Math.floor(-2 * Math.log2(index.causes[k].max)) / 2, -3), 6);
      change({ left: "r" + k, right: "r" + (k + 1), look: "signed", exposure });
      by("viewer").scrollIntoView({ behavior: "smooth" });
    };
  }
  for (const card of document.querySelectorAll("[data-grow]")) {
    card.disabled = !index.layers;
    card.onclick = () => {
      setMix({ terms: growSteps[card.dataset.grow], lights: index.groups.map(freshLight) });
      by("viewer").scrollIntoView({ behavior: "smooth" });
    };
  }
};

// ---- pointer and keys on the stage
const pixelAt = (event) => {
  const box = stage.getBoundingClientRect();
  const at = (part, size) => Math.min(Math.max(Math.floor(part * size), 0), size - 1);
  return [at((event.clientX - box.left) / box.width, width), at((event.clientY - box.top) / box.height, height)];
};
const slideTo = (event) => {
  const box = stage.getBoundingClientRect();
  change({ split: Math.min(Math.max((100 * (event.clientX - box.left)) / box.width, 0), 100) });
};
const pointers = () => {
  let drag = null;
  stage.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    drag = { x: event.clientX, y: event.clientY, sliding: event.target === handle };
    stage.setPointerCapture(event.pointerId);
  });
  stage.addEventListener("pointermove", (event) => {
    cursor = pixelAt(event);
    keyed = false;
    readOut();
    if (!drag) return;
    const [dx, dy] = [Math.abs(event.clientX - drag.x), Math.abs(event.clientY - drag.y)];
    drag.sliding ||= dx > 8 && dx > dy;
    if (drag.sliding && state.look === "swipe") slideTo(event);
  });
  stage.addEventListener("pointerup", (event) => {
    if (drag && !drag.sliding) change({ pixel: pixelAt(event) });
    drag = null;
  });
  stage.addEventListener("pointercancel", () => (drag = null));
  stage.addEventListener("pointerleave", () => {
    cursor = null;
    readOut();
  });
};
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const keys = () => {
  handle.addEventListener("keydown", (event) => {
    const steps = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -10, PageUp: 10, Home: -100, End: 100 };
    const step = steps[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    change({ split: Math.min(Math.max(state.split + step * (event.shiftKey ? 10 : 1), 0), 100) });
  });
  stage.addEventListener("keydown", (event) => {
    const from = cursor ?? state.pixel ?? [width >> 1, height >> 1], step = ARROWS[event.key];
    if (step) {
      const far = event.shiftKey ? 10 : 1;
      cursor = [from[0] + far * step[0], from[1] + far * step[1]];
      cursor = [Math.min(Math.max(cursor[0], 0), width - 1), Math.min(Math.max(cursor[1], 0), height - 1)];
      keyed = true;
      readOut();
    } else if (event.key === "Enter" || event.key === " ") {
      change({ pixel: from });
    } else return;
    event.preventDefault();
  });
  const shortcuts = {
    1: () => change({ look: "swipe" }), 2: () => change({ look: "signed" }), 3: () => change({ look: "error" }),
    x: () => by("swap").click(), h: () => change({ hatch: !state.hatch }),
  };
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || /^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName) && event.target.type !== "checkbox" && event.target.type !== "radio") return;
    shortcuts[event.key.toLowerCase()]?.();
  });
};

// ---- from state to everything
const refresh = (changes) => {
  by("left").value = state.left;
  by("right").value = state.right;
  by("hatch").checked = state.hatch;
  by("exposure").value = state.exposure;
  for (const radio of document.querySelectorAll("[name=look]")) radio.checked = radio.value === state.look;
  document.querySelectorAll("[data-cause]").forEach((card, k) => {
    const now = state.left === "r" + k && state.right === "r" + (k + 1) && state.look !== "swipe";
    card.setAttribute("aria-pressed", String(now));
  });
  if (index.layers) refreshMixer();
  const only = Object.keys(changes);
  if (only.length === 1 && only[0] === "split") return slide();
  if (only.length === 1 && only[0] === "pixel") {
    cursor = null;
    readOut();
    return void tell();
  }
  drawSoon();
  if (("terms" in changes || "lights" in changes) && state.pixel) void tell();
};
let soon = 0;
const drawSoon = () => {
  cancelAnimationFrame(soon);
  soon = requestAnimationFrame(() => draw().catch(fail));
};
const fail = (error) => {
  const box = by("fallback");
  box.hidden = false;
  box.textContent = "The moving part of this page could not start: " + error.message;
};

const start = async () => {
  fillSelects();
  controls();
  setUpMixer();
  pointers();
  keys();
  stage.style.setProperty("--ratio", String(width / height));
  await loadExplained();
  state = readHash();
  listeners.push(refresh);
  document.documentElement.classList.add("is-live");
  by("viewer").hidden = by("pixel").hidden = false;
  refresh({ everything: true });
  await tell();
  addEventListener("hashchange", () => change(readHash()));
  addEventListener("resize", () => state.hatch && drawSoon());
  // For the console, and for tests: values of any picture as the page holds them.
  window.rastray = {
    state: () => state,
    ready: () => document.documentElement.dataset.drawn ?? null,
    value: (id, x, y) => picture(id).then(({ data }) => triple((c) => valueAt(data, y * width + x, c))),
  };
};
if (!index) {
  by("fallback").hidden = true;
} else if (typeof DecompressionStream === "undefined") {
  fail(new Error("this browser cannot unpack its pictures (DecompressionStream). Chrome 103, Firefox 113, Safari 16.4 and later can."));
} else {
  start().catch(fail);
}
