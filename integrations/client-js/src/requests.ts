/** Bodies and queries of requests. */

/** A mesh file, its bytes, or one mesh and the files that it refers to, such as materials and pictures. */
export type Mesh = Blob | ArrayBuffer | Uint8Array<ArrayBuffer> | readonly File[];

/** Return the body that sends a mesh, and the name of the file if it has one. */
export function bodyOf(mesh: Mesh): { body: BodyInit; fileName?: string } {
  if (mesh instanceof Blob) return mesh instanceof File ? { body: mesh, fileName: mesh.name } : { body: mesh };
  if (mesh instanceof ArrayBuffer || ArrayBuffer.isView(mesh)) return { body: mesh };
  const form = new FormData();
  for (const file of mesh) form.append("mesh", file, file.webkitRelativePath || file.name);
  return { body: form };
}

/** Return the text of a query: entries of lists are repeated, as the service expects. */
export function queryText(query: object): string {
  const entries = Object.entries(query as Record<string, unknown>);
  const texts = entries.flatMap(([name, value]) => (value == null ? [] : [value].flat().map((one) => [name, String(one)])));
  return new URLSearchParams(texts).toString();
}
