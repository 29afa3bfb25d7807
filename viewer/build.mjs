/** Bundles the page and the web component into the folder that the Python package ships; with --check, compares them. */
import { build } from "esbuild";
import { mkdir, readdir, readFile, rm, writeFile } from "node:fs/promises";
import { join } from "node:path";

const target = "../service/viewer";
const TYPES = "cleave-viewer.d.ts"; // of the component, for pages that embed it
const common = { bundle: true, minify: true, write: false, logLevel: "warning", outdir: target };

/** Return the contents of the built files, by name. */
async function built() {
  const scripts = await build({
    ...common,
    // The page imports the component's own file, so that a browser loads three.js once.
    entryPoints: { "cleave-viewer": "src/component/element.ts", page: "src/page/main.ts" },
    splitting: true,
    chunkNames: "[name]-[hash]",
    format: "esm",
    target: "es2022",
    legalComments: "none",
    banner: { js: "/* Cleave, MIT. Contains three.js, copyright three.js authors, MIT. */" },
  });
  const styles = await build({ ...common, entryPoints: { page: "src/page/styles.css" } });
  const files = withPlainNames([...scripts.outputFiles, ...styles.outputFiles]);
  files.set(TYPES, await readFile(join("src/component", TYPES)));
  for (const name of await readdir("static")) files.set(name, await readFile(join("static", name)));
  return files;
}

/** Return contents by name; the scripts that several share are called viewer.js, viewer-2.js, ..., the largest first. */
function withPlainNames(outputs) {
  const nameOf = ({ path }) => path.split("/").at(-1);
  const shared = outputs.filter((output) => nameOf(output).startsWith("chunk-")).sort((a, b) => b.contents.length - a.contents.length);
  const renamed = new Map(shared.map((output, i) => [nameOf(output), i === 0 ? "viewer.js" : `viewer-${i + 1}.js`]));
  for (const name of outputs.map(nameOf)) if (/^original-\w+\.js$/.test(name)) renamed.set(name, "original.js");
  return new Map(
    outputs.map((output) => {
      const text = [...renamed].reduce((text, [from, to]) => text.replaceAll(from, to), Buffer.from(output.contents).toString());
      return [renamed.get(nameOf(output)) ?? nameOf(output), Buffer.from(text)];
    }),
  );
}

const files = await built();
if (process.argv.includes("--check")) {
  const present = await readdir(target);
  const stale = [...new Set([...present, ...files.keys()])].filter((name) => !present.includes(name) || !files.has(name));
  for (const [name, contents] of files)
    if (!stale.includes(name) && !contents.equals(await readFile(join(target, name)))) stale.push(name);
  if (stale.length > 0) {
    console.error(`service/viewer does not match its sources (${stale.join(", ")}): run npm run build in viewer/.`);
    process.exit(1);
  }
} else {
  await rm(target, { recursive: true, force: true });
  await mkdir(target);
  for (const [name, contents] of files) await writeFile(join(target, name), contents);
}
