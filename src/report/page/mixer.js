// ---- mixer: I = E + A + sum over lights of g (a + D S_L + S S_L) + reflection + refraction, live.
const LETTER = { emission: "E", ambient: "A", diffuse: "D", specular: "S", reflection: "R", refraction: "T" };

// What a layer is multiplied by, channel by channel: strength times colour of its lights, 0 where it is switched off.
const gainOf = (layer, settings) => {
  const letter = LETTER[layer.term];
  if (!settings.terms.includes(letter)) return [0, 0, 0];
  if (layer.group === null) return [1, 1, 1];
  const light = settings.lights[layer.group];
  if ("ADS".includes(letter) && !light.terms.includes(letter)) return [0, 0, 0];
  return bytesOf(light.tint).map((byte) => (light.strength * byte) / 255);
};
// Which plane a layer is taken from, and the mask that cuts shadows out of it.
const sourceOf = (layer, shadows) => ({
  name: shadows && layer.lit ? layer.lit : layer.free,
  mask: shadows && layer.mask ? layer.mask : null,
});

// Adds gain times a plane to the sum, which holds three channels one after the other.
const addPlane = (sum, p, gain, mask) => {
  if (p.kind === "rgb") {
    for (let c = 0; c < 3; c++) {
      const g = gain[c], start = c * count, { codes } = p;
      if (!g) continue;
      if (mask) for (let i = 0; i < count; i++) sum[start + i] += mask[i] * g * valueOf[codes[start + i]];
      else for (let i = 0; i < count; i++) sum[start + i] += g * valueOf[codes[start + i]];
    }
    return;
  }
  const { indices, scalar, palette } = p;
  const colors = palette.map((color) => color.map((x, c) => x * gain[c]));
  while (colors.length < 256) colors.push([0, 0, 0]);
  for (let i = 0; i < count; i++) {
    if (!indices[i] || (mask && !mask[i])) continue;
    const color = colors[indices[i]], s = valueOf[scalar[i]];
    sum[i] += s * color[0];
    sum[count + i] += s * color[1];
    sum[2 * count + i] += s * color[2];
  }
  for (const [i, color] of p.escapes) {
    if (!mask || mask[i]) for (let c = 0; c < 3; c++) sum[c * count + i] += gain[c] * color[c];
  }
};

// The mix as a picture; the last one is kept.
let last = { key: null, result: null };
const mixed = async () => {
  const settings = { terms: state.terms, lights: state.lights };
  const key = JSON.stringify(settings);
  if (last.key === key) return last.result;
  const floats = new Float32Array(3 * count), shadows = settings.terms.includes("s");
  for (const layer of index.layers) {
    const gain = gainOf(layer, settings);
    if (!gain.some((g) => g)) continue;
    const { name, mask } = sourceOf(layer, shadows);
    addPlane(floats, await plane(name), gain, mask && (await plane(mask)));
  }
  const beyond = (x) => x > 1 || x < 0;
  const clamped = (i) => beyond(floats[i]) || beyond(floats[count + i]) || beyond(floats[2 * count + i]);
  const result = { data: { kind: "float", floats }, clamped };
  last = { key: JSON.stringify(settings), result };
  return result;
};

// A layer's colour at a pixel with S_L and without, and whether it is cut out there.
const layerAt = async (layer, i) => {
  const read = async (shadows) => {
    const { name, mask } = sourceOf(layer, shadows);
    const [p, m] = await Promise.all([plane(name), mask ? plane(mask) : null]);
    return triple((c) => (m && !m[i] ? 0 : valueAt(p, i, c)));
  };
  return { lit: await read(true), free: await read(false) };
};

// ---- the equation shows which terms are on in the picture on the right
const lightEquation = () => {
  const mix = state.right === "mix";
  let on = mix ? state.terms : entry(state.right).terms;
  if (mix && state.lights.length) {
    const some = (letter) => state.lights.some((l) => l.strength > 0 && l.terms.includes(letter));
    on = [...on].filter((letter) => !"DS".includes(letter) || some(letter)).join("");
  }
  const direct = on.includes("D") || on.includes("S");
  for (const part of document.querySelectorAll("[data-term]")) {
    const letter = part.dataset.term;
    const lit = letter === "L" ? direct : letter === "s" ? direct && on.includes("s") : on.includes(letter);
    part.classList.toggle("off", !lit);
  }
  by("lit").textContent = "Lit: the terms in " + nameOf(state.right) + ".";
};

// ---- the controls
const setMix = (changes) => change({ ...changes, right: "mix" });
const toggled = (text, letter, on, all) => letters(on ? text + letter : text.replace(letter, ""), all);

const lightCard = (names, i) => {
  const name = names.length === 1 ? names[0] : names.length + " lights together";
  const id = "light" + i, edit = (changes) => setMix({ lights: state.lights.map((l, k) => (k === i ? { ...l, ...changes } : l)) });
  const term = (letter, word) => {
    const box = make("input", { type: "checkbox", "data-light": i, "data-letter": letter });
    box.oninput = () => edit({ terms: toggled(state.lights[i].terms, letter, box.checked, "ADS") });
    const any = index.layers.some((l) => l.group === i && LETTER[l.term] === letter);
    return make("label", { class: any ? "switch" : "switch empty", title: any ? null : "Zero in this scene" }, box, make("span", {}, word));
  };
  const strength = make("input", { type: "range", min: 0, max: 2, step: 0.01, id: id + "-strength", "data-light": i, "aria-label": "Strength of " + name });
  strength.oninput = () => edit({ strength: Number(strength.value) });
  const tint = make("input", { type: "color", id: id + "-tint", "data-light": i, "aria-label": "Colour filter of " + name });
  tint.oninput = () => edit({ tint: tint.value });
  const alone = make("button", { type: "button", class: "quiet", title: "Only this light" }, "solo");
  alone.onclick = () => setMix({ lights: state.lights.map((l, k) => ({ ...l, strength: k === i ? l.strength || 1 : 0 })) });
  return make("fieldset", { class: "light", title: names.join(", ") }, make("legend", {}, name),
    make("div", { class: "row" }, term("A", "ambient"), term("D", "diffuse"), term("S", "specular")),
    make("div", { class: "row" }, strength, make("output", { for: id + "-strength" }), tint, alone));
};

const presets = { all: TERMS, local: "EADS", shadow: "EADSs", none: "" };
const growSteps = { emission: "E", ambient: "EA", diffuse: "EAD", specular: "EADS", shadow: "EADSs", reflection: "EADSsR", refraction: TERMS };
const setUpMixer = () => {
  by("mixer").hidden = !index.layers;
  if (!index.layers) return;
  by("lights").append(...index.groups.map(lightCard));
  for (const box of document.querySelectorAll("[data-switch]")) {
    const letter = box.dataset.switch;
    box.oninput = () => setMix({ terms: toggled(state.terms, letter, box.checked, TERMS) });
    // A switch without a layer would do nothing.
    const shadows = index.layers.some((l) => l.lit || l.mask);
    const any = letter === "s" ? shadows : index.layers.some((l) => LETTER[l.term] === letter);
    box.closest("label").classList.toggle("empty", !any);
    box.closest("label").title = any ? "" : "Zero in this scene";
  }
  for (const button of document.querySelectorAll("[data-preset]")) {
    button.onclick = () => setMix({ terms: presets[button.dataset.preset], lights: index.groups.map(freshLight) });
  }
  for (const part of document.querySelectorAll("[data-term]")) {
    const letter = part.dataset.term;
    if (letter !== "L") part.onclick = () => setMix({ terms: toggled(state.terms, letter, !state.terms.includes(letter), TERMS) });
  }
};
const refreshMixer = () => {
  for (const box of document.querySelectorAll("[data-switch]")) box.checked = state.terms.includes(box.dataset.switch);
  document.querySelectorAll("#lights .light").forEach((card, i) => {
    const light = state.lights[i];
    for (const box of card.querySelectorAll("[data-letter]")) box.checked = light.terms.includes(box.dataset.letter);
    card.querySelector("input[type=range]").value = light.strength;
    card.querySelector("output").textContent = "× " + light.strength.toFixed(2);
    card.querySelector("input[type=color]").value = light.tint;
  });
};

