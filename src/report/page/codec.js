// ---- codec: unpacks what codec.rs packed. A code is a half float's bits of value / 2048, as an integer that grows with it.
const by = (id) => document.getElementById(id);
const index = JSON.parse(by("index").textContent);
const [width, height] = index ? index.size : [0, 0];
const count = width * height;

// The value of each code, as unsigned 16 bits.
const valueOf = Float32Array.from({ length: 65536 }, (_, code) => {
  const signed = (code << 16) >> 16, bits = Math.abs(signed);
  const exponent = bits >> 10, fraction = bits & 1023;
  const half = exponent ? 2 ** (exponent - 15) * (1 + fraction / 1024) : fraction * 2 ** -24;
  return Math.sign(signed) * half * 2048;
});
const CODE_OF_ONE = 4096;

const inflate = async (name) => {
  const text = by("blob-" + name).textContent;
  const packed = Uint8Array.fromBase64 ? Uint8Array.fromBase64(text) : Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
};

// Low bytes, then high bytes of zigzagged remainders.
const remainders = (bytes, start, length) => {
  const rests = new Int16Array(length);
  for (let i = 0; i < length; i++) {
    const z = bytes[start + i] | (bytes[start + length + i] << 8);
    rests[i] = (z >>> 1) ^ -(z & 1);
  }
  return rests;
};

// Adds to each remainder what the neighbours left, above and above left say: the median edge detector. In place.
const unpredict = (plane) => {
  for (let i = 0, y = 0; y < height; y++) {
    for (let x = 0; x < width; x++, i++) {
      let guess = 0;
      if (x && y) {
        const a = plane[i - 1], b = plane[i - width], c = plane[i - width - 1];
        const low = Math.min(a, b), high = Math.max(a, b);
        guess = c >= high ? low : c <= low ? high : a + b - c;
      } else if (x) guess = plane[i - 1];
      else if (y) guess = plane[i - width];
      plane[i] += guess;
    }
  }
  return plane;
};

const unpackers = {
  raw: (bytes) => bytes,
  mask: (bytes) => Uint8Array.from({ length: count }, (_, i) => (bytes[i >> 3] >> (i & 7)) & 1),
  // Codes of three channels, one after the other.
  rgb: async (bytes, how) => {
    const codes = new Int16Array(3 * count);
    const base = how.base && (await plane(how.base)).codes;
    for (let c = 0; c < 3; c++) {
      const rests = remainders(bytes, 2 * c * count, count);
      codes.set(how.spatial ? unpredict(rests) : rests, c * count);
    }
    if (how.previous) for (let i = count; i < 3 * count; i++) codes[i] += codes[i - count];
    if (base) for (let i = 0; i < 3 * count; i++) codes[i] += base[i];
    return { kind: "rgb", codes: new Uint16Array(codes.buffer) };
  },
  // 8-bit values, by their distance to the rounded ones of a float picture.
  bytes: async (bytes, how) => {
    const { codes } = await plane(how.base);
    for (let i = 0; i < 3 * count; i++) {
      bytes[i] += Math.floor(Math.min(Math.max(valueOf[codes[i]], 0), 1) * 255 + 0.5);
    }
    return { kind: "bytes", bytes };
  },
  // One number a pixel times a colour of a palette; index 255 stands in a list of its own.
  tone: (bytes, how) => {
    const indices = bytes.subarray(0, count);
    const scalar = new Uint16Array(unpredict(remainders(bytes, count, count)).buffer);
    const escapes = new Map();
    const start = 3 * count, length = 3 * how.escapes;
    for (let i = 0, k = 0; k < how.escapes; i++) {
      if (indices[i] !== 255) continue;
      const code = (c) => bytes[start + 3 * k + c] | (bytes[start + length + 3 * k + c] << 8);
      escapes.set(i, [0, 1, 2].map((c) => valueOf[code(c)]));
      k++;
    }
    return { kind: "tone", indices, scalar, palette: how.palette, escapes };
  },
};

const planes = new Map();
// The plane of a name, unpacked once.
const plane = (name) => {
  if (!planes.has(name)) {
    const how = index.how[name];
    planes.set(name, inflate(name).then((bytes) => unpackers[how.kind](bytes, how)));
  }
  return planes.get(name);
};

// The value of channel c of pixel i of a plane of any kind.
const valueAt = (p, i, c) => {
  if (p.kind === "rgb") return valueOf[p.codes[c * count + i]];
  if (p.kind === "bytes") return p.bytes[c * count + i] / 255;
  if (p.kind === "float") return p.floats[c * count + i];
  const entry = p.indices[i];
  return entry === 255 ? p.escapes.get(i)[c] : valueOf[p.scalar[i]] * p.palette[entry][c];
};

