// ---- view: two pictures over each other, or their difference.
const canvases = { left: by("canvas-left"), right: by("canvas-right"), difference: by("canvas-difference") };
const stage = by("stage"), handle = by("handle"), cross = by("cross");
const shownNow = { left: null, right: null };

// A value as the byte that a screen shows.
const srgb = (x) => (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);
const toByte = (x) => {
  const clamped = x > 0 ? (x < 1 ? x : 1) : 0;
  return Math.floor((index.srgb ? srgb(clamped) : clamped) * 255 + 0.5);
};
let byteOfCode = null, byteOfByte = null;
const tables = () => {
  byteOfCode ??= Uint8Array.from(valueOf, toByte);
  byteOfByte ??= Uint8Array.from({ length: 256 }, (_, k) => toByte(k / 255));
};

const entry = (id) => index.pictures.find((p) => p.id === id);
const nameOf = (id) => {
  if (id === "mix") return "mix";
  const { rung, name } = entry(id);
  return rung === undefined ? name : "rung " + rung + ": " + name;
};
// The picture of an id, unpacked: a plane, and which pixels a clamp changes.
const picture = async (id) => {
  if (id === "mix") return mixed();
  const { blob, clamped } = entry(id);
  const [data, mask] = await Promise.all([plane(blob), clamped ? plane(clamped) : null]);
  const codes = mask?.codes ?? data.codes;
  const over = (code) => code > CODE_OF_ONE;
  const beyond = (i) => over(codes[i]) || over(codes[count + i]) || over(codes[2 * count + i]);
  return { data, clamped: mask && !mask.codes ? (i) => mask[i] === 1 : beyond };
};

const paint = (canvas, { data, clamped }, hatch) => {
  tables();
  canvas.width = width;
  canvas.height = height;
  const context = canvas.getContext("2d"), image = context.createImageData(width, height), out = image.data;
  for (let c = 0; c < 3; c++) {
    const start = c * count;
    if (data.kind === "rgb") for (let i = 0; i < count; i++) out[4 * i + c] = byteOfCode[data.codes[start + i]];
    else if (data.kind === "bytes") for (let i = 0; i < count; i++) out[4 * i + c] = byteOfByte[data.bytes[start + i]];
    else for (let i = 0; i < count; i++) out[4 * i + c] = toByte(data.floats[start + i]);
  }
  // Stripes of two screen pixels, dark on light and light on dark.
  const period = Math.max(6, Math.round((7 * width) / Math.max(stage.clientWidth, 1)));
  for (let i = 0; i < count; i++) {
    out[4 * i + 3] = 255;
    if (hatch && clamped(i) && ((i % width) + Math.floor(i / width)) % period < period / 3) {
      const light = out[4 * i] + out[4 * i + 1] + out[4 * i + 2] > 382;
      out.fill(light ? 0 : 255, 4 * i, 4 * i + 3);
    }
  }
  context.putImageData(image, 0, 0);
};

// Colours of differences: at value 0 the middle, else at least one step beside it.
const bytesOf = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16));
let palettes = null;
const scaleEnd = () => 2 ** -state.exposure;
const paintDifference = (canvas, a, b, kind) => {
  palettes ??= { signed: index.colors.signed.map(bytesOf), error: index.colors.magnitude.map(bytesOf) };
  canvas.width = width;
  canvas.height = height;
  const context = canvas.getContext("2d"), image = context.createImageData(width, height), out = image.data;
  const palette = palettes[kind], middle = kind === "signed" ? 128 : 0, end = scaleEnd();
  for (let i = 0; i < count; i++) {
    let d = 0;
    for (let c = 0; c < 3; c++) {
      const x = valueAt(b, i, c) - valueAt(a, i, c);
      if (Math.abs(x) > Math.abs(d)) d = x;
    }
    const step = d === 0 ? 0 : Math.min(Math.max(Math.round((Math.abs(d) / end) * 128), 1), 128);
    const color = palette[kind === "signed" && d < 0 ? middle - step : middle + step];
    out[4 * i] = color[0];
    out[4 * i + 1] = color[1];
    out[4 * i + 2] = color[2];
    out[4 * i + 3] = 255;
  }
  context.putImageData(image, 0, 0);
};

const legend = () => {
  const box = by("legend"), on = state.look !== "swipe", end = scaleEnd();
  box.hidden = !on;
  by("exposing").hidden = !on;
  if (!on) return;
  const sided = state.look === "signed", colors = sided ? index.colors.signed : index.colors.magnitude;
  const short = (x) => String(Number(x.toPrecision(3))).replace("-", "−");
  const ticks = sided ? [-end, -end / 2, 0, end / 2, end] : [0, end / 4, end / 2, (3 * end) / 4, end];
  box.querySelector("i").style.background = "linear-gradient(90deg," + colors.filter((_, i) => i % 8 === 0).join(",") + ")";
  box.querySelector("div").replaceChildren(...ticks.map((t) => make("span", {}, (sided && t > 0 ? "+" : "") + short(t))));
  const ends = sided ? "blue: right is darker, white: equal, orange: right is brighter" : "black: equal, light: different";
  box.setAttribute("aria-label", "Scale from " + short(ticks[0]) + " to " + short(end) + "; " + ends);
  by("exposure-says").textContent = (sided ? "±" : "") + short(end);
};

// rmse, share and place of the difference, in words, once things are quiet.
const describe = (a, b) => {
  let squares = 0, pixels = 0, largest = 0;
  const columns = new Uint32Array(width), rows = new Uint32Array(height);
  for (let i = 0; i < count; i++) {
    let changed = false;
    for (let c = 0; c < 3; c++) {
      const d = valueAt(b, i, c) - valueAt(a, i, c);
      squares += d * d;
      largest = Math.max(largest, Math.abs(d));
      changed ||= d !== 0;
    }
    if (changed) {
      pixels++;
      columns[i % width]++;
      rows[Math.floor(i / width)]++;
    }
  }
  if (!pixels) return "No difference" + (stepTooSmall() ? " that this page could store: the step is finer than half floats. The map of the cause is exact." : ".");
  const range = (histogram) => {
    let sum = 0, low = -1, high = 0;
    histogram.forEach((n, k) => {
      sum += n;
      if (low < 0 && sum > pixels * 0.05) low = k;
      if (sum - n < pixels * 0.95) high = n ? k : high;
    });
    return [low, high];
  };
  const x = range(columns), y = range(rows);
  const third = ([low, high], size) => Math.min(Math.floor(((low + high) * 3) / (2 * size)), 2);
  const where = ["upper", "middle", "lower"][third(y, height)] + " " + ["left", "centre", "right"][third(x, width)];
  return "rmse " + show(Math.sqrt(squares / (3 * count))) + ", at most " + show(largest) + "; " + percent(pixels, count) +
    " of the pixels differ, mostly at the " + where + " (x " + x.join(" to ") + ", y " + y.join(" to ") + ").";
};
// The two pictures are neighbouring rungs, and their step is not zero.
const stepTooSmall = () => {
  const [a, b] = [state.left, state.right].map((id) => entry(id)?.rung);
  return b === a + 1 && index.causes[a]?.pixels > 0;
};

let describing = 0;
const speak = () => {
  clearTimeout(describing);
  describing = setTimeout(() => {
    const { left, right } = shownNow;
    if (!left || !right) return;
    const text = describe(left.data, right.data), names = nameOf(state.left) + " against " + nameOf(state.right);
    by("alt").textContent = names + ": " + text;
    canvases.left.setAttribute("aria-label", nameOf(state.left) + ". Against the right picture: " + text);
    canvases.right.setAttribute("aria-label", nameOf(state.right) + ". Against the left picture: " + text);
    canvases.difference.setAttribute("aria-label", "Difference, right minus left. " + text);
  }, 350);
};

const slide = () => {
  const swipe = state.look === "swipe", at = swipe ? state.split : 0;
  stage.style.setProperty("--at", at + "%");
  handle.hidden = !swipe;
  handle.setAttribute("aria-valuenow", String(Math.round(state.split)));
  handle.setAttribute("aria-valuetext", Math.round(state.split) + " % " + nameOf(state.left) + ", the rest " + nameOf(state.right));
};

// Draws what is asked for; only the newest request counts.
let request = 0;
const draw = async () => {
  const mine = ++request;
  const [left, right] = await Promise.all([picture(state.left), picture(state.right)]);
  if (mine !== request) return;
  Object.assign(shownNow, { left, right });
  const swipe = state.look === "swipe";
  canvases.left.hidden = canvases.right.hidden = !swipe;
  canvases.difference.hidden = swipe;
  if (swipe) {
    paint(canvases.left, left, state.hatch);
    paint(canvases.right, right, state.hatch);
  } else {
    paintDifference(canvases.difference, left.data, right.data, state.look);
  }
  by("tag-left").textContent = swipe ? nameOf(state.left) : nameOf(state.right) + " − " + nameOf(state.left);
  by("tag-right").textContent = swipe ? nameOf(state.right) : "";
  stage.classList.toggle("coarse", stage.clientWidth > 1.5 * width);
  slide();
  legend();
  lightEquation();
  readOut();
  speak();
  document.documentElement.dataset.drawn = String(mine);
};

// ---- the numbers under the cursor
let cursor = null;
const triple = (f) => [0, 1, 2].map(f);
const readOut = () => {
  const at = cursor ?? state.pixel, { left, right } = shownNow;
  if (!at || !left || !right) return;
  const i = at[1] * width + at[0];
  by("at").textContent = at.join(" ");
  const a = triple((c) => valueAt(left.data, i, c)), b = triple((c) => valueAt(right.data, i, c));
  const swatch = (color) => make("i", { class: "swatch", style: "background:rgb(" + color.map(toByte).join(" ") + ")" });
  by("value-left").replaceChildren(swatch(a), a.map(show).join("  "));
  by("value-right").replaceChildren(swatch(b), b.map(show).join("  "));
  by("value-difference").textContent = triple((c) => signed(b[c] - a[c])).join("  ");
  by("more").hidden = !state.pixel;
  const place = state.pixel ?? at;
  cross.hidden = false;
  cross.style.left = (100 * ((cursor && keyed ? cursor : place)[0] + 0.5)) / width + "%";
  cross.style.top = (100 * ((cursor && keyed ? cursor : place)[1] + 0.5)) / height + "%";
};

