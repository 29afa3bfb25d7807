/** Compiles only if the generated types are exact. */
import createClient from "openapi-fetch";
import type { components, paths } from "./cleave";

type Schemas = components["schemas"];
type Equal<A, B> = (<T>() => T extends A ? 1 : 2) extends <T>() => T extends B ? 1 : 2 ? true : false;
function same<A, B>(..._: Equal<A, B> extends true ? [] : [never]): void {}

const client = createClient<paths>({ baseUrl: "http://127.0.0.1:8000" });
const path = { params: { path: { job_id: "5f1c5d1d2c0f4e0fa8f0b4b2f1a9d6c3" } } };

const hierarchy = await client.GET("/v1/jobs/{job_id}/hierarchy", path);
if (hierarchy.error !== undefined) {
  same<typeof hierarchy.error, Schemas["ProblemDocument"]>();
  // @ts-expect-error: the code is none of the enumeration
  hierarchy.error.code === "no_such_code";
  if (hierarchy.error.code === "job_failed") same<typeof hierarchy.error.error, Schemas["JobError"] | undefined>();
} else {
  same<typeof hierarchy.data, Schemas["HierarchyDocument"]>();
}

type JsonTypes = "application/json" | "application/problem+json";
const labels = await createClient<paths, JsonTypes>().GET("/v1/jobs/{job_id}/labels", path);
if (labels.error !== undefined) same<typeof labels.error, Schemas["ProblemDocument"]>();
else same<typeof labels.data, Schemas["LabelsDocument"]>();
same<Schemas["LabelsDocument"]["parts"], Schemas["SaidPart"][] | undefined>();
same<Schemas["MeshReport"]["structure"], Schemas["StructureCounts"] | null>();
same<Schemas["MeshReport"]["notes"], string[]>();

const { data: job } = await client.GET("/v1/jobs/{job_id}", path);
if (job === undefined) throw new Error("no job");
same<typeof job.status, "queued" | "running" | "succeeded" | "failed" | "canceled">();
same<typeof job.stage, "reading" | "clean" | "affinity" | "coarsen" | "cut" | "label" | null>();
same<typeof job.finished_at, string | null>();
if (job.status === "succeeded") {
  same<typeof job.mesh.faces, number>();
  same<typeof job.automatic_segments, number>();
  same<typeof job.finished_at, string>();
}
if (job.status === "failed") {
  same<typeof job.error, Schemas["JobError"]>();
  // @ts-expect-error: the code is none of the enumeration
  job.error.code === "no_such_code";
}
// @ts-expect-error: the status is none of the enumeration
job.status === "done";

type Submission = paths["/v1/jobs"]["post"]["responses"];
same<Submission[202]["content"]["application/json"]["status"], "queued" | "running">();
same<Submission[200]["content"]["application/json"]["status"], "succeeded" | "failed" | "canceled">();
same<Extract<Submission[200]["content"]["application/json"], { status: "succeeded" }>["labels"], number[] | null>();

type Query = NonNullable<paths["/v1/jobs"]["post"]["parameters"]["query"]>;
same<Query["segments"], number | undefined>();
same<Query["unit"], "micron" | "millimeter" | "centimeter" | "inch" | "foot" | "meter" | undefined>();
// Only what differs from the defaults need be sent.
await client.POST("/v1/jobs/{job_id}/rerun", { ...path, body: { max_segments: 32 } });
same<Extract<Schemas["EditError"]["code"], "part_locked" | "worker_lost" | "no_such_code">, "part_locked" | "worker_lost">();

const { data: edit } = await client.GET("/v1/jobs/{job_id}/edits/{edit_id}", { params: { path: { ...path.params.path, edit_id: "1" } } });
if (edit?.status === "failed") same<typeof edit.error, Schemas["EditError"]>();
if (edit?.status === "succeeded") same<typeof edit.revision, Schemas["RevisionDocument"]>();
