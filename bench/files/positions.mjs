// node positions.mjs NODE_MODULES: for each line "PATH<tab>TARGET" on standard input, read a glTF or GLB file with the
// GLTFLoader of three.js, write the corners of all triangles of its scene to TARGET as float64 and print a line of JSON,
// {"faces": number} or {"error": string}. Skins and morph targets are in the pose of the file. Materials, textures
// and animations are removed before, and buffers that are other files are put into the file. Draco is decoded by the package draco3d.

import fs from "node:fs";
import path from "node:path";
import readline from "node:readline";
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";

const modules = path.resolve(process.argv[2]);
const load = (name) => import(pathToFileURL(path.join(modules, name)));
const three = await load("three/build/three.module.js");
const { GLTFLoader } = await load("three/examples/jsm/loaders/GLTFLoader.js");
const { MeshoptDecoder } = await load("three/examples/jsm/libs/meshopt_decoder.module.js");
globalThis.self = globalThis;
globalThis.ProgressEvent ??= class extends Event {};

const JSON_CHUNK = 0x4e4f534a;
const BIN_CHUNK = 0x004e4942;

/** The JSON of a file and its chunk of binary data, if it has one. */
function split(data) {
  if (data.toString("latin1", 0, 4) !== "glTF" || data.readUInt32LE(4) === 1) return { json: JSON.parse(data.toString("utf8")) };
  const found = {};
  for (let at = 12; at + 8 <= data.length; ) {
    const [length, kind] = [data.readUInt32LE(at), data.readUInt32LE(at + 4)];
    const chunk = data.subarray(at + 8, at + 8 + length);
    if (kind === JSON_CHUNK) found.json ??= JSON.parse(chunk.toString("utf8"));
    if (kind === BIN_CHUNK) found.binary ??= chunk;
    at += 8 + length;
  }
  return found;
}

/** A GLB file with the same geometry, and with all buffers inside. */
function reduced(file) {
  const { json, binary } = split(fs.readFileSync(file));
  for (const name of ["materials", "textures", "images", "samplers", "animations"]) delete json[name];
  for (const mesh of json.meshes ?? []) for (const primitive of mesh.primitives ?? []) delete primitive.material;
  for (const buffer of json.buffers ?? []) {
    if (!buffer.uri || buffer.uri.startsWith("data:")) continue;
    const data = fs.readFileSync(path.join(path.dirname(file), decodeURIComponent(buffer.uri)));
    buffer.uri = `data:application/octet-stream;base64,${data.toString("base64")}`;
  }
  const text = Buffer.from(JSON.stringify(json));
  const chunks = [[JSON_CHUNK, Buffer.concat([text, Buffer.alloc((4 - (text.length % 4)) % 4, 0x20)])]];
  if (binary) chunks.push([BIN_CHUNK, Buffer.concat([binary, Buffer.alloc((4 - (binary.length % 4)) % 4)])]);
  const parts = chunks.flatMap(([kind, chunk]) => [words(chunk.length, kind), chunk]);
  const length = 12 + parts.reduce((sum, part) => sum + part.length, 0);
  const all = Buffer.concat([words(0x46546c67, 2, length), ...parts]);
  return all.buffer.slice(all.byteOffset, all.byteOffset + all.length);
}

function words(...values) {
  const data = Buffer.alloc(4 * values.length);
  values.forEach((value, i) => data.writeUInt32LE(value, 4 * i));
  return data;
}

/** Decodes Draco in this thread; the DRACOLoader of three.js needs workers. */
class Draco {
  preload() {
    this.module ??= createRequire(path.join(modules, "index.js"))("draco3d").createDecoderModule({});
    return this;
  }

  async decodeDracoFile(data, done, ids) {
    const module = await this.module;
    const [buffer, decoder, mesh] = [new module.DecoderBuffer(), new module.Decoder(), new module.Mesh()];
    buffer.Init(new Int8Array(data), data.byteLength);
    const status = decoder.DecodeBufferToMesh(buffer, mesh);
    if (!status.ok()) throw new Error(status.error_msg());
    const geometry = new three.BufferGeometry();
    for (const [name, id] of Object.entries(ids)) {
      const attribute = decoder.GetAttributeByUniqueId(mesh, id);
      const values = new module.DracoFloat32Array();
      decoder.GetAttributeFloatForAllPoints(mesh, attribute, values);
      const array = Float32Array.from({ length: values.size() }, (_, i) => values.GetValue(i));
      geometry.setAttribute(name, new three.BufferAttribute(array, attribute.num_components()));
    }
    const face = new module.DracoInt32Array();
    const corners = new Uint32Array(3 * mesh.num_faces());
    for (let i = 0; i < mesh.num_faces(); i++) {
      decoder.GetFaceFromMesh(mesh, i, face);
      for (let k = 0; k < 3; k++) corners[3 * i + k] = face.GetValue(k);
    }
    geometry.setIndex(new three.BufferAttribute(corners, 1));
    done(geometry);
  }
}

function matrices(object) {
  if (!object.isInstancedMesh) return [object.matrixWorld];
  return Array.from({ length: object.count }, (_, i) => {
    const own = new three.Matrix4();
    object.getMatrixAt(i, own);
    return own.premultiply(object.matrixWorld);
  });
}

/** The corners of all triangles of a scene, one after the other. */
function corners(scene) {
  const found = [];
  const place = new three.Vector3();
  scene.updateMatrixWorld(true);
  scene.traverse((object) => {
    if (!object.isMesh) return;
    const { index, attributes } = object.geometry;
    const count = (index ?? attributes.position).count;
    for (const matrix of matrices(object)) {
      for (let i = 0; i < count - (count % 3); i++) {
        object.getVertexPosition(index ? index.getX(i) : i, place).applyMatrix4(matrix);
        found.push(place.x, place.y, place.z);
      }
    }
  });
  return Float64Array.from(found);
}

const loader = new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).setDRACOLoader(new Draco());
for await (const line of readline.createInterface({ input: process.stdin })) {
  const [file, target] = line.split("\t");
  try {
    const { scene } = await loader.parseAsync(reduced(file), "");
    const places = corners(scene);
    fs.writeFileSync(target, places);
    process.stdout.write(`${JSON.stringify({ faces: places.length / 9 })}\n`);
  } catch (error) {
    process.stdout.write(`${JSON.stringify({ error: String(error).slice(0, 300) })}\n`);
  }
}
