// ---- pixel: everything that is known of one pixel, as tables, and its ray tree where it was explained beforehand
const cells = (color, form = show) => triple((c) => make("td", { class: "number" }, form(color[c])));
const swatchCell = (color) => make("td", {}, make("i", { class: "swatch", style: "background:rgb(" + color.map(toByte).join(" ") + ")" }));
const row = (name, color, form, note) =>
  make("tr", {}, make("th", { scope: "row" }, name), form === signed ? make("td") : swatchCell(color), ...cells(color, form), make("td", { class: "text" }, note ?? ""));
const table = (caption, rows) => {
  const head = make("tr", {}, ...["", "", "red", "green", "blue", ""].map((t) => (t ? make("th", { scope: "col", class: "number" }, t) : make("td"))));
  return make("div", { class: "scroll" }, make("table", {}, make("caption", {}, caption), make("thead", {}, head), make("tbody", {}, ...rows)));
};

// The ladder at a pixel: each rung, and what the step to it changed.
const ladderTable = async (i) => {
  const rungs = index.pictures.filter((p) => p.rung !== undefined);
  const colors = await Promise.all(rungs.map(async (p) => {
    const data = await plane(p.blob);
    return triple((c) => valueAt(data, i, c));
  }));
  const rows = rungs.map((p, k) => {
    const step = k && p.rung === rungs[k - 1].rung + 1 ? triple((c) => colors[k][c] - colors[k - 1][c]) : null;
    const note = step?.some((x) => x) ? index.causes[p.rung - 1].name + ": " + step.map(signed).join("  ") : "";
    return row(p.rung + " " + p.name, colors[k], show, note);
  });
  return table("The ladder: each rung changes one thing", rows);
};

// The sum at a pixel: each term of each light, and S_L beside it.
const termNames = { emission: "emission", ambient: "ambient", diffuse: "diffuse", specular: "specular", reflection: "reflection", refraction: "refraction" };
const sumTable = async (i) => {
  const sum = [0, 0, 0], mix = [0, 0, 0], rows = [];
  const settings = { terms: state.terms, lights: state.lights }, shadows = settings.terms.includes("s");
  for (const layer of index.layers) {
    const { lit, free } = await layerAt(layer, i), gain = gainOf(layer, settings);
    triple((c) => {
      sum[c] += lit[c];
      mix[c] += gain[c] * (shadows ? lit : free)[c];
    });
    if (!free.some((x) => x) && !lit.some((x) => x)) continue;
    const light = layer.group === null ? "" : " · " + (index.groups[layer.group].length === 1 ? index.groups[layer.group][0] : index.groups[layer.group].length + " lights");
    const blocked = free.some((x, c) => x !== lit[c]);
    const note = !blocked ? "" : lit.some((x) => x) ? "partly shadowed; unblocked " + free.map(show).join("  ") : "in shadow; unblocked " + free.map(show).join("  ");
    rows.push(row(termNames[layer.term] + light, lit, show, note));
  }
  rows.push(row("sum", sum, show, sum.some((x) => x > 1 || x < 0) ? "clamped to 0…1 when shown" : ""));
  if (JSON.stringify(settings) !== JSON.stringify({ terms: TERMS, lights: index.groups.map(freshLight) })) rows.push(row("as mixed", mix, show, ""));
  return table("The sum: what each term adds to the traced picture", rows);
};

// ---- explanations made beforehand
let explained = [];
const loadExplained = async () => {
  if (!index.explained) return;
  explained = JSON.parse(new TextDecoder().decode(await plane(index.explained)));
  const list = by("telling");
  const telling = explained.filter((e) => e.why);
  list.append(make("option", { value: "" }, "choose…"));
  list.append(...telling.map((e) => make("option", { value: e.pixel.join(",") }, e.why + " (" + e.pixel.join(" ") + ")")));
  list.closest("label").hidden = !telling.length;
};
const nearestExplained = ([x, y]) => {
  const distance = (e) => (e.pixel[0] - x) ** 2 + (e.pixel[1] - y) ** 2;
  return explained.reduce((best, e) => (!best || distance(e) < distance(best) ? e : best), null);
};

const colorText = (color) => (color ? "(" + color.map(show).join(", ") + ")" : "–");
const vectorText = (v) => (v ? "(" + v.map(show).join(", ") + ")" : "–");
// The lights at a hit: geometry and terms.
const lightLines = (terms) =>
  (terms?.lights ?? []).map((light) => {
    const facts = [];
    const fact = (name, value) => value !== null && value !== undefined && facts.push(name + " = " + (typeof value === "number" ? show(value) : value));
    fact("N·L", light.n_dot_l);
    fact("N·H", light.n_dot_h);
    fact("V·R", light.v_dot_r);
    fact("distance", light.distance);
    if (light.attenuation !== 1) fact("attenuation", light.attenuation);
    if (light.spot !== 1) fact("spot", light.spot);
    const shadow = Array.isArray(light.shadow) ? colorText(light.shadow) : light.shadow;
    fact("S_L", shadow);
    if (light.blocker) facts.push("blocked by " + (light.blocker.object ?? light.blocker.name ?? light.blocker));
    return make("li", {}, make("strong", {}, light.name), " " + facts.join(", "), make("br"),
      "ambient " + colorText(light.ambient) + " + diffuse " + colorText(light.diffuse) + " + specular " + colorText(light.specular));
  });
// A ray and what it found, with the rays that start there.
const rayNode = (name, ray, weight, about) => {
  const hit = ray?.hit;
  const where = hit ? "hits " + hit.object + (hit.material && hit.material !== hit.object ? " (" + hit.material + ")" : "") + (hit.inside ? " from inside" : "") + (typeof hit.t === "number" ? " at t = " + show(hit.t) : "")
    : "meets nothing";
  const summary = make("summary", {}, make("strong", {}, name), " " + where, weight ? ", weight " + colorText(weight) : "", about ?? "",
    ", brings " + colorText(ray?.color));
  const parts = make("ul", {});
  const terms = ray?.terms;
  if (terms) {
    parts.append(make("li", {}, "emission " + colorText(terms.emission) + " + ambient " + colorText(terms.ambient)), ...lightLines(terms));
  }
  if (hit?.point) parts.append(make("li", { class: "geometry" }, "point " + vectorText(hit.point) + ", normal " + vectorText(hit.normal)));
  const { reflection, refraction } = ray ?? {};
  if (reflection?.ray) parts.append(make("li", {}, rayNode("reflection", reflection.ray, reflection.weight)));
  if (refraction?.ray) {
    const eta = refraction.eta ? ", η " + refraction.eta.map(show).join(" → ") : "";
    parts.append(make("li", {}, rayNode("refraction", refraction.ray, refraction.weight, eta)));
  } else if (refraction?.tir) parts.append(make("li", {}, "refraction: total internal reflection, nothing passes"));
  return make("details", { open: true }, summary, parts);
};
const explanation = (found) => {
  const { raster, trace } = found.explanation;
  return make("div", { class: "tree" }, make("h3", {}, "The equation with its numbers, and the ray tree"),
    make("p", { class: "hint" }, found.why ? found.why + ". " : "", "Weights are products along the path; K_T counts once an interface."),
    rayNode("raster", raster), rayNode("ray from the eye", trace));
};

// Fills the section; only the newest pixel counts.
let telling = 0;
const tell = async () => {
  const mine = ++telling, { pixel } = state;
  by("pixel").hidden = false;
  const [before, after] = index.explain;
  by("command").textContent = before + (pixel ? pixel.join(" ") : "X Y") + after;
  by("copy").hidden = !pixel;
  if (!pixel) return by("story").replaceChildren();
  [by("x").value, by("y").value] = pixel;
  const i = pixel[1] * width + pixel[0];
  const parts = [await ladderTable(i)];
  if (index.layers) parts.unshift(await sumTable(i));
  const found = explained.find((e) => e.pixel[0] === pixel[0] && e.pixel[1] === pixel[1]);
  if (found) {
    parts.push(explanation(found));
  } else if (explained.length) {
    const near = nearestExplained(pixel);
    const go = make("button", { type: "button", class: "quiet" }, near.pixel.join(" "));
    go.onclick = () => change({ pixel: near.pixel });
    parts.push(make("p", { class: "hint" }, "The ray tree of this pixel is a command away: copy the line above. The nearest one on this page: ", go));
  } else {
    parts.push(make("p", { class: "hint" }, "Directions, factors and the ray tree are a command away: copy the line above."));
  }
  if (mine === telling) by("story").replaceChildren(...parts);
};

