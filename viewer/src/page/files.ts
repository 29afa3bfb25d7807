/** The files that a person drops or chooses, with their paths in the folders that were dropped. */

export interface Found {
  /** Path below what was dropped, with slashes. */
  readonly path: string;
  readonly file: File;
}

export const MOST_FILES = 5000; // that are looked at; set by hand: a home folder dropped by accident has many more

const OF_SYSTEMS = new Set(["__macosx", "thumbs.db", "desktop.ini"]);

/** There are more files than the page looks at. */
export class TooManyFiles extends Error {}

/** Return the files of an input element. */
export function filesOf(input: HTMLInputElement): Found[] {
  const files = [...(input.files ?? [])].map((file) => ({ path: file.webkitRelativePath || file.name, file }));
  return visible(files);
}

/** Return the files of a drop and of its folders. Throws TooManyFiles. */
export async function filesOfDrop(transfer: DataTransfer): Promise<Found[]> {
  // The items are empty as soon as the event is over: take all entries before anything is awaited.
  const items = [...transfer.items].filter(({ kind }) => kind === "file");
  const taken = items.map((item) => ({ entry: item.webkitGetAsEntry(), file: item.getAsFile() }));
  const found: Found[] = [];
  for (const { entry, file } of taken) {
    if (entry?.isDirectory) await collect(entry, found);
    else if (file !== null) found.push({ path: file.name, file });
  }
  return visible(found);
}

async function collect(entry: FileSystemEntry, found: Found[]): Promise<void> {
  if (isHidden(entry.name)) return;
  if (found.length >= MOST_FILES) throw new TooManyFiles();
  if (entry.isFile) {
    const file = await new Promise<File>((resolve, reject) => (entry as FileSystemFileEntry).file(resolve, reject));
    found.push({ path: entry.fullPath.replace(/^\//, ""), file });
    return;
  }
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  for (;;) {
    // A reader returns the entries of a folder in pieces, and an empty one at the end.
    const entries = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
    if (entries.length === 0) return;
    for (const inner of entries) await collect(inner, found);
  }
}

function visible(files: readonly Found[]): Found[] {
  const shown = files.filter(({ path }) => !path.split("/").some(isHidden));
  if (shown.length > MOST_FILES) throw new TooManyFiles();
  return shown;
}

/** Whether a name is that of a hidden file, or of one that an operating system adds. */
function isHidden(name: string): boolean {
  return name.startsWith(".") || OF_SYSTEMS.has(name.toLowerCase());
}
