/** Prints what the story finds: `node node.js URL < MESH`. */
import { story } from "./story.js";

declare const process: { argv: string[]; stdin: AsyncIterable<Uint8Array> };

const pieces: Uint8Array<ArrayBuffer>[] = [];
for await (const piece of process.stdin) pieces.push(new Uint8Array(piece));
const mesh = new Uint8Array(await new Blob(pieces).arrayBuffer());
console.log(JSON.stringify(await story(process.argv[2] ?? "", mesh)));
