// Writes arrays, what the reference encoder of meshoptimizer makes of them, and what its decoder makes of that.

import fs from "node:fs";
import { MeshoptDecoder, MeshoptEncoder } from "meshoptimizer";

await MeshoptEncoder.ready;
await MeshoptDecoder.ready;

const side = 20;
let seed = 12345;
const random = () => (seed = (seed * 1103515245 + 12345) & 0x7fffffff) / 0x7fffffff;
const base64 = (array) => Buffer.from(array).toString("base64");
const bytes = (array) => new Uint8Array(array.buffer, array.byteOffset, array.byteLength);

const count = side * side;
const positions = new Float32Array(3 * count).map((_, i) =>
  i % 3 === 0 ? Math.floor(i / 3 / side) : i % 3 === 1 ? Math.floor(i / 3) % side : Math.round(64 * random()) / 16,
);
const shorts = new Uint16Array(4 * count).map((_, i) => (i % 4 === 3 ? 0 : i % 4 === 2 ? 65535 * random() : i % side));
const corners = [];
for (let i = 0; i + 1 < side; i++) {
  for (let j = 0; j + 1 < side; j++) {
    const a = i * side + j;
    corners.push(a, a + 1, a + side + 1, a, a + side + 1, a + side);
  }
}
for (let i = 0; i < 90; i++) corners.push(Math.floor(count * random()));
const indices = new Uint32Array(corners);
const normals = new Float32Array(4 * count).map(() => 2 * random() - 1);
for (let i = 0; i < 4 * count; i += 4) {
  const length = Math.hypot(normals[i], normals[i + 1], normals[i + 2]);
  for (let k = 0; k < 3; k++) normals[i + k] /= length;
  normals[i + 3] = 0;
}

const encode = (...all) => base64(MeshoptEncoder.encodeGltfBuffer(...all));
const octahedral = (size) =>
  MeshoptEncoder.encodeGltfBuffer(MeshoptEncoder.encodeFilterOct(normals, count, size, 2 * size), count, size, "ATTRIBUTES", 0);
const exponential = MeshoptEncoder.encodeGltfBuffer(
  MeshoptEncoder.encodeFilterExp(positions, count, 12, 15), count, 12, "ATTRIBUTES", 0,
);
function decode(source, size, filter) {
  const target = new Uint8Array(count * size);
  MeshoptDecoder.decodeGltfBuffer(target, count, size, source, "ATTRIBUTES", filter);
  return base64(target);
}
const samples = {
  positions: Array.from(positions),
  shorts: Array.from(shorts),
  indices: Array.from(indices),
  normals: Array.from(normals, (value) => Math.round(1e6 * value) / 1e6),
  encoded: {
    positions_0: encode(bytes(positions), count, 12, "ATTRIBUTES", 0),
    positions_1: base64(MeshoptEncoder.encodeVertexBufferLevel(bytes(positions), count, 12, 3, 1)),
    shorts_0: encode(bytes(shorts), count, 8, "ATTRIBUTES", 0),
    shorts_1: base64(MeshoptEncoder.encodeVertexBufferLevel(bytes(shorts), count, 8, 3, 1)),
    triangles: encode(bytes(indices), indices.length, 4, "TRIANGLES"),
    indices: encode(bytes(indices), indices.length, 4, "INDICES"),
    exponential: base64(exponential),
    octahedral_4: base64(octahedral(4)),
    octahedral_8: base64(octahedral(8)),
  },
  decoded: {
    exponential: decode(exponential, 12, "EXPONENTIAL"),
    octahedral_4: decode(octahedral(4), 4, "OCTAHEDRAL"),
    octahedral_8: decode(octahedral(8), 8, "OCTAHEDRAL"),
  },
};
fs.writeFileSync(process.argv[2], JSON.stringify(samples) + "\n");
