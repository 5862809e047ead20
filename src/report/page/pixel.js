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
    const bounced = "RT".includes(LETTER[layer.term]);
    const light = layer.group === null ? (bounced && index.groups.length ? " · ambient, background" : "") : " · " + (index.groups[layer.group].length === 1 ? index.groups[layer.group][0] : index.groups[layer.group].length + " lights");
    const blocked = free.some((x, c) => Math.abs(x - lit[c]) > 5e-4);
    const how = bounced ? "without shadows " : lit.some((x) => x) ? "partly in shadow; unblocked " : "in shadow; unblocked ";
    const note = blocked ? how + free.map(show).join("  ") : "";
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
const times = (x) => (Array.isArray(x) ? (x.every((v) => v === x[0]) ? show(x[0]) : colorText(x)) : show(x));
// "K_D" with its subscript lowered.
const symbol = (text) => {
  const [letter, sub] = text.split("_");
  return make("var", {}, letter, sub ? make("sub", {}, sub) : null);
};
// A product with its numbers: [["K_D", color], ["N·L", 0.5], ...] = result.
const product = (name, factors, result) => {
  const line = make("li", { class: "product" }, make("span", { class: "word" }, name), " ");
  factors.filter(([, x]) => x !== null && x !== undefined).forEach(([sign, x], k) => {
    if (k) line.append(" × ");
    line.append(symbol(sign), " " + times(x));
  });
  line.append(" = ", make("strong", {}, colorText(result)));
  return line;
};
const dark = (color) => (Array.isArray(color) ? color.every((x) => x === 0) : color === 0);
// What a light adds at a hit: each product with its numbers, and why one is 0.
const lightLines = (light, source, material, shininess) => {
  const { n_dot_l: facing, shadow } = light, lines = [];
  const spread = light.attenuation === 1 ? null : light.attenuation, cone = light.spot === 1 ? null : light.spot;
  const arrives = [["I_L", null], ["attenuation", spread], ["spot", cone]];
  const put = (name, factors, color, result) =>
    lines.push(product(name, [...factors, ["I_L", color], ...arrives.slice(1)], result));
  if (!dark(light.ambient)) put("ambient", [["K_A", material.ambient]], source.ambient, light.ambient);
  const why = facing <= 0 ? "faces away" : light.spot === 0 ? "is outside its cone" : shadow !== null && shadow !== undefined && dark(shadow) ? "is blocked by " + (light.blocker ?? "something") : "";
  const about = make("li", {}, make("strong", {}, light.name), " ", symbol("N·L"), " " + show(facing),
    ...(typeof light.distance === "number" ? [", distance " + show(light.distance)] : [", directional"]),
    ...(shadow === null || shadow === undefined ? [] : [", ", symbol("S_L"), " " + times(shadow)]), why ? "; " + why : "");
  if (!why) {
    put("diffuse", [["K_D", material.diffuse], ["N·L", Math.max(facing, 0)], ["S_L", shadow]], source.diffuse, light.diffuse);
    if (!dark(light.specular)) {
      const [sign, cosine] = light.n_dot_h === undefined ? ["V·R", light.v_dot_r] : ["N·H", light.n_dot_h];
      const power = cosine > 0 ? cosine ** shininess : 0;
      put("specular", [["K_S", material.specular], ["(" + sign + ")", cosine], ["to the n = " + show(shininess) + ":", power], ["S_L", shadow]], source.specular, light.specular);
    }
  }
  if (lines.length) about.append(make("ul", {}, ...lines));
  return about;
};
// The terms at a hit.
const termLines = (terms, lights) => {
  const lines = [];
  if (!dark(terms.emission)) lines.push(product("emission", [["I_E", terms.emission]], terms.emission));
  if (!dark(terms.ambient)) lines.push(make("li", { class: "product" }, make("span", { class: "word" }, "ambient"), " ", symbol("K_A"), " ", symbol("I_AL"), " = ", make("strong", {}, colorText(terms.ambient))));
  terms.lights.forEach((light, k) => {
    if (light.n_dot_l !== undefined && terms.material) lines.push(lightLines(light, lights[k], terms.material, terms.material.shininess));
    else if (!dark(light.ambient) || !dark(light.diffuse) || !dark(light.specular)) {
      lines.push(make("li", {}, make("strong", {}, light.name), " ambient " + colorText(light.ambient) + ", diffuse " + colorText(light.diffuse) + ", specular " + colorText(light.specular)));
    }
  });
  return lines;
};
// A ray and what it found, with the rays that start there.
const rayNode = (name, ray, lights, about, level) => {
  const { hit, terms, reflection, refraction } = ray;
  const material = hit && hit.material !== hit.object ? " (" + hit.material + ")" : "";
  const where = hit ? "hits " + hit.object + material + (hit.inside ? " from inside" : "") : "meets nothing: the background";
  const summary = make("summary", {}, make("strong", {}, name), ...about, " " + where + ", brings ", make("strong", {}, colorText(ray.color)));
  const parts = make("ul", {}, ...(terms ? termLines(terms, lights) : []));
  const branch = (word, sign, part, more) => {
    if (!part) return;
    const told = [" weight ", symbol(sign), " " + times(part.weight) + more + ","];
    if (part.ray) parts.append(make("li", {}, rayNode(word, part.ray, lights, told, level + 1)));
    else if (part.tir) parts.append(make("li", {}, word + ": total internal reflection, nothing passes"));
    else parts.append(make("li", {}, word + ": no ray" + (ray.depth_reached ? ", the depth is reached" : ", it would weigh nothing")));
  };
  branch("reflection", index.mirror, reflection, "");
  const bends = refraction && refraction.eta[0] !== refraction.eta[1];
  branch("refraction", "K_T", refraction, bends ? ", η " + refraction.eta.map((x) => String(+x.toFixed(3))).join(" → ") + (refraction.angle_deg === null ? "" : ", angle " + hit.incidence_deg.toFixed(1) + "° → " + refraction.angle_deg.toFixed(1) + "°") : "");
  return make("details", { open: level < 3 }, summary, parts);
};
const explanation = (found) => {
  const { raster, trace, lights, causes } = found.explanation;
  const shares = causes.filter((cause) => !dark(cause.rgb)).map((cause) => cause.name + " " + cause.rgb.map(signed).join(" "));
  return make("div", { class: "tree" }, make("h3", {}, "The equation with its numbers, and the ray tree"),
    make("p", { class: "hint" }, found.why ? found.why[0].toUpperCase() + found.why.slice(1) + ". " : "", "Weights are those of each surface; K_T counts once an interface."),
    rayNode("raster, " + raster.shading, raster, lights, [], 0), rayNode("trace, ray from the eye", trace, lights, [], 0),
    make("p", { class: "hint" }, "Causes of this pixel's difference: " + (shares.join("; ") || "none") + "."));
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
  if (mine !== telling) return;
  by("story").replaceChildren(...parts);
  by("copied").textContent = "The numbers of pixel " + pixel.join(" ") + " follow.";
};

