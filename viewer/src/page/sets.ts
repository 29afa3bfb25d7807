/** Sorts chosen files into models, each with the files that belong to it, and files that are left out. */

import type { Found } from "./files";
import lists from "./lists.json";
import { pathOf, referencesOf } from "./references";

/** One mesh and the files that it refers to: the input of one job. */
export interface Model {
  /** Of the mesh file, without folders. */
  readonly name: string;
  /** The mesh first; the paths are relative to the folder that has all files of the model. */
  readonly files: readonly Found[];
  readonly bytes: number;
}

export interface Sorted {
  readonly models: readonly Model[];
  /** Paths of files that are no meshes, and to which none refers. */
  readonly leftOut: readonly string[];
}

/** Endings of the files that meshes refer to. */
export const COMPANIONS = [".mtl", ".bin", ".png", ".jpg", ".jpeg", ".webp", ".ktx2", ".tga", ".bmp", ".gif", ".dds"];
export const MESHES: readonly string[] = [...lists.inputFormats.flatMap(({ extensions }) => extensions), ".zip"];

export async function sorted(found: readonly Found[]): Promise<Sorted> {
  const meshes = found.filter(({ path }) => isMesh(path) || (found.length === 1 && !baseOf(path).includes(".")));
  const others = new Map(found.filter((file) => !meshes.includes(file)).map((file) => [file.path.toLowerCase(), file]));
  const used = new Set<Found>();
  const models: Model[] = [];
  for (const mesh of meshes) {
    const companions = others.size === 0 ? [] : await companionsOf(mesh, others);
    for (const companion of companions) used.add(companion);
    models.push(modelOf([mesh, ...companions]));
  }
  return { models, leftOut: [...others.values()].filter((file) => !used.has(file)).map(({ path }) => path).sort() };
}

/** Return a model of one file. */
export function modelOfFile(file: File): Model {
  return modelOf([{ path: file.name, file }]);
}

async function companionsOf(mesh: Found, others: ReadonlyMap<string, Found>): Promise<Found[]> {
  const found = new Set<Found>();
  for (const file of await referred(mesh, others)) {
    found.add(file);
    if (/\.mtl$/i.test(file.path)) for (const picture of await referred(file, others)) found.add(picture);
  }
  return [...found];
}

async function referred({ path, file }: Found, others: ReadonlyMap<string, Found>): Promise<Found[]> {
  const isPacked = path.toLowerCase().endsWith(".gz");
  const content = isPacked ? await unpacked(file) : file;
  const folder = path.split("/").slice(0, -1).join("/");
  return (await referencesOf(content, path.replace(/\.gz$/i, ""))).flatMap((addresses) => {
    const candidates = addresses.map((address) => others.get((pathOf(folder, address) ?? "").toLowerCase()));
    return candidates.find((candidate) => candidate !== undefined) ?? [];
  });
}

/** Return the contents of a gzip file; an empty file if it is damaged, which the server explains. */
async function unpacked(file: File): Promise<Blob> {
  try {
    return await new Response(file.stream().pipeThrough(new DecompressionStream("gzip"))).blob();
  } catch {
    return new Blob();
  }
}

function modelOf(files: readonly Found[]): Model {
  const folders = files.map(({ path }) => path.split("/").slice(0, -1));
  let shared = 0;
  while (folders.every((folder) => folder[shared] !== undefined && folder[shared] === folders[0]![shared])) shared++;
  const inside = files.map(({ path, file }) => ({ path: path.split("/").slice(shared).join("/"), file }));
  return { name: baseOf(files[0]!.path), files: inside, bytes: files.reduce((sum, { file }) => sum + file.size, 0) };
}

function isMesh(path: string): boolean {
  const name = path.toLowerCase().replace(/\.gz$/, "");
  return MESHES.some((ending) => name.endsWith(ending));
}

function baseOf(path: string): string {
  return path.split("/").at(-1)!;
}
