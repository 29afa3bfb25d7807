// Prints, for each of the files named in the JSON list on standard input, what the readers of three.js find in it:
// {"path": [{"name": string, "corners": [x, y, z, ...], "colors": [hex, ...] | null, "material": hex | null}, ...]}, a
// part for every mesh and every copy of one, with morph targets and skins as they are before anything moves,
// and for GLB files what glTF Transform finds in the property table: {"path": {"names": [...], "ids": {mesh: [...]}}}.

import fs from "node:fs";
import { NodeIO } from "@gltf-transform/core";
import { EXTMeshFeatures, EXTStructuralMetadata, KHRMaterialsVariants } from "@gltf-transform/extensions";
import { DOMParser } from "linkedom";
import { Color, Matrix4, SRGBColorSpace, Vector3 } from "three";
import { ThreeMFLoader } from "three/addons/loaders/3MFLoader.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { MTLLoader } from "three/addons/loaders/MTLLoader.js";
import { OBJLoader } from "three/addons/loaders/OBJLoader.js";
import { PLYLoader } from "three/addons/loaders/PLYLoader.js";
import { STLLoader } from "three/addons/loaders/STLLoader.js";

globalThis.DOMParser = DOMParser;
globalThis.self = globalThis;

const io = new NodeIO().registerExtensions([EXTMeshFeatures, EXTStructuralMetadata, KHRMaterialsVariants]);
const geometryOnly = (geometry) => [{ name: "", ...soup(geometry, (i) => new Vector3().fromBufferAttribute(geometry.attributes.position, i)) }];
const readers = {
  glb: async (data) => parts((await new GLTFLoader().parseAsync(data, "")).scene),
  obj: (data, path) => parts(withMaterials(path).parse(new TextDecoder().decode(data))),
  "3mf": (data) => parts(new ThreeMFLoader().parse(data)),
  ply: (data) => geometryOnly(new PLYLoader().parse(data)),
  stl: (data) => geometryOnly(new STLLoader().parse(data)),
};

/** A loader with the materials of the .mtl file beside, if there is one. */
function withMaterials(path) {
  const beside = path.replace(/\.obj$/, ".mtl");
  const loader = new OBJLoader();
  return fs.existsSync(beside) ? loader.setMaterials(new MTLLoader().parse(fs.readFileSync(beside, "utf8"), "")) : loader;
}

function parts(root) {
  const found = [];
  root.updateMatrixWorld(true);
  root.traverse((object) => {
    if (!object.isMesh) return;
    const name = object.geometry.userData.name ?? object.userData.name ?? object.name;
    for (const matrix of places(object)) {
      const place = (i) => object.getVertexPosition(i, new Vector3()).applyMatrix4(matrix);
      const material = object.material.color?.getHex(SRGBColorSpace) ?? null;
      found.push({ name, material, ...soup(object.geometry, place) });
    }
  });
  return found;
}

function places(object) {
  if (!object.isInstancedMesh) return [object.matrixWorld];
  return Array.from({ length: object.count }, (_, i) => {
    const own = new Matrix4();
    object.getMatrixAt(i, own);
    return own.premultiply(object.matrixWorld);
  });
}

/** The corners of all triangles one after the other, and the colour of each triangle where there are any. */
function soup(geometry, place) {
  const { position, color } = geometry.attributes;
  const order = geometry.index ? Array.from(geometry.index.array) : Array.from({ length: position.count }, (_, i) => i);
  const corners = order.flatMap((i) => place(i).toArray());
  const hex = (i) => new Color().fromBufferAttribute(color, i).getHex(SRGBColorSpace);
  return { corners, colors: color ? order.filter((_, i) => i % 3 === 0).map(hex) : null };
}

/** The name of every node, and of every mesh the rows of the table that its corners lead to. */
async function features(data) {
  const root = (await io.readBinary(new Uint8Array(data))).getRoot();
  const metadata = root.getExtension("EXT_structural_metadata");
  if (!metadata) return null;
  const [table] = metadata.listPropertyTables();
  const text = table.getProperty("name");
  const offsets = new Uint32Array(text.getStringOffsets().slice().buffer);
  const names = Array.from({ length: table.getCount() }, (_, i) =>
    new TextDecoder().decode(text.getValues().slice(offsets[i], offsets[i + 1])),
  );
  const ids = root.listMeshes().map((mesh) => {
    const [primitive] = mesh.listPrimitives();
    const [feature] = primitive.getExtension("EXT_mesh_features").listFeatureIDs();
    if (feature.getPropertyTable() !== table) throw new Error("the feature ids lead to no table");
    const attribute = primitive.getAttribute(`_FEATURE_ID_${feature.getAttribute()}`);
    const rows = Array.from(primitive.getIndices().getArray(), (i) => attribute.getScalar(i));
    return [mesh.getName(), [...new Set(rows)]];
  });
  return { names, ids: Object.fromEntries(ids) };
}

const answer = { parts: {}, features: {} };
for (const path of JSON.parse(fs.readFileSync(0, "utf8"))) {
  const file = fs.readFileSync(path);
  const data = file.buffer.slice(file.byteOffset, file.byteOffset + file.byteLength);
  const kind = path.slice(path.lastIndexOf(".") + 1);
  answer.parts[path] = await readers[kind](data, path);
  if (kind === "glb") answer.features[path] = await features(data);
}
process.stdout.write(JSON.stringify(answer));
