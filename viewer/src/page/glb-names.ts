/** Writes the names of parts into a GLB file of the service, whose nodes are called ``segment 0``, ``segment 1``, ... */

const WORD = 4;
const HEAD = 20; // of the file and of its first chunk

export function renameNodes(data: ArrayBuffer, names: readonly string[]): Blob {
  const length = new DataView(data).getUint32(12, true);
  const document = JSON.parse(new TextDecoder().decode(new Uint8Array(data, HEAD, length))) as {
    nodes: { name?: string; extras?: { segment?: number } }[];
  };
  for (const node of document.nodes) {
    const name = names[node.extras?.segment ?? -1];
    if (name !== undefined) node.name = name;
  }
  const text = new TextEncoder().encode(JSON.stringify(document));
  const padded = new Uint8Array(Math.ceil(text.length / WORD) * WORD).fill(0x20);
  padded.set(text);
  const head = data.slice(0, HEAD);
  new DataView(head).setUint32(8, data.byteLength - length + padded.length, true);
  new DataView(head).setUint32(12, padded.length, true);
  return new Blob([head, padded, data.slice(HEAD + length)], { type: "model/gltf-binary" });
}
