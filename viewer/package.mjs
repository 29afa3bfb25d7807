/** Bundles the web component alone into dist/, which `npm pack` puts into the package cleave-viewer. */
import { build } from "esbuild";
import { cp, rm } from "node:fs/promises";

await rm("dist", { recursive: true, force: true });
await build({
  entryPoints: { "cleave-viewer": "src/component/element.ts" },
  outdir: "dist",
  bundle: true,
  splitting: true, // the original look is loaded when it is first shown
  chunkNames: "[name]-[hash]",
  minify: true,
  format: "esm",
  target: "es2022",
  legalComments: "none",
  logLevel: "warning",
  banner: { js: "/* Cleave, MIT. Contains three.js, copyright three.js authors, MIT. */" },
});
await cp("src/component/cleave-viewer.d.ts", "dist/cleave-viewer.d.ts");
await cp("../LICENSE", "LICENSE");
