/** The files that a mesh file refers to: buffers and images of glTF, materials of OBJ and their pictures. */

const URI = /"uri"\s{0,64}:\s{0,64}("(?!data:)(?:[^"\\]|\\.){1,2048}")/g;
const LIBRARY = /^[ \t]*mtllib[ \t]+([^\r\n]{1,2048})(?=[\r\n])/gm;
const PICTURE = /^[ \t]*(?:map_\w+|bump|disp|decal|refl|norm)[ \t]+([^\r\n]{1,2048})(?=[\r\n])/gim;
const PIECE = 4 * 1024 * 1024; // characters that are searched at a time
const MOST_WORDS = 16; // of a line that may begin a name
const LONGEST = 4096; // characters of a reference; longer ones are not found

/**
 * Return what a mesh file or a material library refers to: for each reference the possible addresses, the most likely
 * first. Names of OBJ may have blanks, and options may stand before them.
 */
export async function referencesOf(file: Blob, name: string): Promise<string[][]> {
  if (/\.gl(tf|b)$/i.test(name)) return (await matches(file, URI)).map((text) => [decoded(text)]);
  if (/\.obj$/i.test(name)) return (await matches(file, LIBRARY)).flatMap(namesIn);
  if (/\.mtl$/i.test(name)) return (await matches(file, PICTURE)).map(namesAtTheEnd);
  return [];
}

/** Return the path of an address relative to a folder; null if it is outside of what was dropped. */
export function pathOf(folder: string, address: string): string | null {
  const text = address.replaceAll("\\", "/");
  if (text.startsWith("/") || text.split("/")[0]!.includes(":")) return null;
  const parts: string[] = [];
  for (const part of `${folder}/${text}`.split("/")) {
    if (part === "" || part === ".") continue;
    if (part !== "..") parts.push(part);
    else if (parts.pop() === undefined) return null;
  }
  return parts.join("/");
}

/** Return the first group of each match, in pieces that overlap, each text once. */
async function matches(file: Blob, pattern: RegExp): Promise<string[]> {
  const found = new Set<string>();
  const search = (text: string) => {
    for (const match of text.matchAll(pattern)) found.add(match[1]!);
  };
  const reader = file.stream().pipeThrough(new TextDecoderStream()).getReader();
  let text = "";
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    text += value;
    if (text.length < PIECE) continue;
    search(text);
    text = text.slice(-LONGEST);
  }
  search(`${text}\n`);
  return [...found];
}

function namesAtTheEnd(line: string): string[] {
  const words = line.trim().split(/\s+/);
  return [line.trim(), ...words.slice(0, MOST_WORDS).map((_, i) => words.slice(i).join(" "))];
}

/** Return what may be the names in a line: one name, which may have blanks, or several without blanks. */
function namesIn(line: string): string[][] {
  const words = line.trim().split(/\s+/);
  return [namesAtTheEnd(line), ...words.slice(0, MOST_WORDS).map((word) => [word])];
}

/** Return the address in a JSON text, without its percent escapes; empty if the text is damaged. */
function decoded(json: string): string {
  try {
    return decodeURIComponent(JSON.parse(json) as string);
  } catch {
    return "";
  }
}
