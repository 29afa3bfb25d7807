/** The parts of a mesh in an app that is made with three.js or react-three-fiber. */

export { colorFaces, FaceParts } from "./face_parts.js";
export { PartModel, type GltfFile, type Hit, type Paint, type Part } from "./part_model.js";
