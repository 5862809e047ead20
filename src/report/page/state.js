// ---- state: what is shown, kept in the address behind "#", so that a reload or a link gives the same view.
const TERMS = "EADSsRT";
const freshLight = () => ({ terms: "ADS", strength: 1, tint: "#ffffff" });
const fresh = () => ({
  left: "r0", right: "r9", look: "swipe", split: 50, exposure: 0, hatch: false, pixel: null,
  terms: TERMS, lights: (index?.groups ?? []).map(freshLight),
});
let state = fresh();
const listeners = [];

const number = (text, low, high, other) => {
  const x = Number(text);
  return text !== null && text !== "" && x >= low && x <= high ? x : other;
};
const letters = (text, all) => [...all].filter((letter) => text.includes(letter)).join("");

// One light: "ADS,1.5,ff8800".
const readLight = (text) => {
  const [terms = "ADS", strength = "1", tint = "ffffff"] = text.split(",");
  const color = /^[0-9a-f]{6}$/.test(tint) ? tint : "ffffff";
  return { terms: letters(terms, "ADS"), strength: number(strength, 0, 2, 1), tint: "#" + color };
};
const writeLight = (light) => [light.terms, light.strength, light.tint.slice(1)].join(",");

const readHash = () => {
  const given = new URLSearchParams(location.hash.slice(1));
  const next = fresh();
  const known = (id, other) => (id === "mix" ? index.layers : index.pictures.some((p) => p.id === id)) ? id : other;
  next.left = known(given.get("l"), next.left);
  next.right = known(given.get("r"), next.right);
  if (["swipe", "signed", "error"].includes(given.get("v"))) next.look = given.get("v");
  next.split = number(given.get("s"), 0, 100, next.split);
  next.exposure = number(given.get("e"), -3, 6, next.exposure);
  next.hatch = given.get("h") === "1";
  const [x, y] = (given.get("p") ?? "").split(",").map((t) => number(t, 0, 1e9, -1));
  if (x >= 0 && y >= 0 && x < width && y < height) next.pixel = [Math.floor(x), Math.floor(y)];
  if (given.has("m")) next.terms = letters(given.get("m"), TERMS);
  (given.get("g") ?? "").split(";").forEach((text, i) => {
    if (text && i < next.lights.length) next.lights[i] = readLight(text);
  });
  return next;
};

const writeHash = () => {
  const usual = fresh(), hash = [];
  const put = (key, value, other) => String(value) !== String(other) && hash.push(key + "=" + value);
  put("l", state.left, usual.left);
  put("r", state.right, usual.right);
  put("v", state.look, usual.look);
  put("s", Math.round(state.split * 10) / 10, usual.split);
  put("e", state.exposure, usual.exposure);
  put("h", state.hatch ? 1 : 0, 0);
  put("p", state.pixel ? state.pixel.join(",") : "", "");
  put("m", state.terms, usual.terms);
  put("g", state.lights.map(writeLight).join(";"), usual.lights.map(writeLight).join(";"));
  const target = "#" + hash.join("&");
  if (target !== location.hash && !(target === "#" && !location.hash)) history.replaceState(null, "", target);
};

// Changes the state and tells everybody; the address follows a little later.
let writing = 0;
const change = (changes) => {
  Object.assign(state, changes);
  listeners.forEach((listener) => listener(changes));
  clearTimeout(writing);
  writing = setTimeout(writeHash, 200);
};

// Numbers as people read them, with a true minus sign.
const show = (x) => {
  const small = x !== 0 && Math.abs(x) < 5e-4, text = small ? x.toExponential(1) : x.toFixed(3);
  return text.replace(/-/g, "−");
};
const signed = (x) => (x > 0 ? "+" : "") + show(x);
const percent = (part, whole) => {
  const share = (100 * part) / Math.max(whole, 1);
  if (!part) return "0 %";
  if (part >= whole) return "100 %";
  return share < 0.1 ? "< 0.1 %" : share > 99.9 ? "> 99.9 %" : share.toFixed(1) + " %";
};
// An element with attributes and children; text is always text.
const make = (tag, attributes = {}, ...children) => {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== null && value !== false) node.setAttribute(name, value === true ? "" : value);
  }
  node.append(...children.filter((child) => child !== null));
  return node;
};

