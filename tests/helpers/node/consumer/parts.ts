/** The parts of a mesh in three.js: the GLB file of the service, and a geometry of the page's own, agree at every level. */
import { Cleave, PartTree } from "cleave-client";
import { colorFaces, FaceParts, PartModel } from "cleave-client/three";
import { Mesh, MeshBasicMaterial, Raycaster, Vector3, type Object3D } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { PLYLoader } from "three/addons/loaders/PLYLoader.js";

const RAYS = 60;

async function compare(server: string, job: string, mesh: Uint8Array<ArrayBuffer>) {
  const cleave = new Cleave(server);
  const model = new PartModel(await new GLTFLoader().loadAsync(cleave.modelUrl(job, "model.glb", { levels: "all" })));
  const kept = new PartModel(await new GLTFLoader().loadAsync(cleave.modelUrl(job, "model.glb", { levels: "all", keep: "all" })));
  const tree = PartTree.of(await cleave.hierarchy(job));
  const parts = new FaceParts(tree, await cleave.labels(job, { segments: tree.maxSegments }));
  const geometry = new PLYLoader().parse(mesh.buffer);
  const own = new Mesh(geometry, new MeshBasicMaterial({ vertexColors: true }));
  const shown = { automatic: model.segments, names: model.parts.map(({ name }) => name) };
  const levels = [];
  for (let segments = 1; segments <= tree.maxSegments; segments++) {
    model.segments = segments;
    kept.segments = segments;
    const seen = rays().map((ray) => [
      labelOf(model, hitOf(ray, rootOf(model))),
      labelOf(kept, hitOf(ray, rootOf(kept))),
      parts.partOf(hitOf(ray, own), segments),
    ]);
    levels.push({ differing: seen.filter((found) => new Set(found).size > 1), seen: new Set(seen.flat()).size });
  }
  const plain = geometry.toNonIndexed();
  colorFaces(plain, parts.at(2), (label) => (label === 0 ? "white" : "red"));
  const green = plain.getAttribute("color");
  const red = parts.labels.filter((_, face) => green.getY(3 * face) === 0).length;
  const refused = [
    refusal(() => (model.segments = 0)),
    refusal(() => (model.segments = tree.maxSegments + 1)),
    refusal(() => colorFaces(geometry, parts.at(2), () => "red")),
    refusal(() => colorFaces(plain, parts.at(2).slice(1), () => "red")),
    refusal(() => new PartModel({ scene: own, parser: { json: {} } })),
    refusal(() => new PartTree([0, 7])),
  ];
  const still = model.parts.length === model.segments;
  const one = new PartModel(await new GLTFLoader().loadAsync(cleave.modelUrl(job, "model.glb", { segments: 5, name: ["3:arm"] })));
  const named = [one.tree.maxSegments, one.segments, one.parts[3]?.name];
  const materials = [one, kept].map(({ parts }) => new Set(parts.flatMap(({ meshes }) => meshes.map(({ material }) => material))).size);
  return { shown, levels, red, ones: parts.at(2).filter((label) => label === 1).length, painted: painted(model), refused, still, named, materials };
}

/** Return the name of the error that a call throws, and the beginning of its message. */
function refusal(call: () => unknown): string {
  try {
    call();
  } catch (error) {
    return String(error).split(" ", 4).join(" ");
  }
  return "none";
}

const rootOf = (model: PartModel): Object3D => {
  let root: Object3D = model.parts[0]!.meshes[0]!;
  while (root.parent !== null) root = root.parent;
  root.updateMatrixWorld(true);
  return root;
};

/** Rays from all around to the middle, which the burr is around. */
function rays(): Raycaster[] {
  return Array.from({ length: RAYS }, (_, i) => {
    const height = 1 - (2 * i + 1) / RAYS;
    const angle = i * Math.PI * (3 - Math.sqrt(5));
    const from = new Vector3(Math.cos(angle) * Math.sqrt(1 - height ** 2), height, Math.sin(angle) * Math.sqrt(1 - height ** 2));
    return new Raycaster(from.clone().multiplyScalar(100), from.negate());
  });
}

const hitOf = (ray: Raycaster, object: Object3D) => ray.intersectObject(object)[0]!;
const labelOf = (model: PartModel, hit: ReturnType<typeof hitOf>) => model.partOf(hit)?.label;

/** A choice for a part stays with its pieces at finer levels, if the app asks for the nodes above them. */
function painted(model: PartModel): number[] {
  model.segments = 2;
  const [first] = model.parts;
  const chosen = new MeshBasicMaterial();
  model.paint((part) => (model.ancestry(part).includes(first!.node) ? chosen : null));
  const meshes = () => model.parts.flatMap((part) => part.meshes).filter(({ material }) => material === chosen).length;
  const before = meshes();
  model.segments = model.tree.maxSegments;
  return [before, meshes(), first!.meshes.length];
}

Object.assign(window, { compare });
