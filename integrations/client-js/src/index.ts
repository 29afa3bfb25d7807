/** A typed client of a Cleave server, and the parts of a mesh at every level. */

export {
  Cleave,
  type Call,
  type CleaveOptions,
  type Job,
  type Level,
  type Mesh,
  type ModelFile,
  type ModelOptions,
  type PartsOptions,
  type SubmitOptions,
  type SucceededJob,
} from "./client.js";
export { JobEnded, RequestRefused, ServerUnreachable } from "./errors.js";
export type { components, operations, paths } from "./schema.js";
export { PartTree } from "./tree.js";
