/** From a mesh to its parts with cleave-client, in Node and in a browser. */
import { Cleave, PartTree, RequestRefused, ServerUnreachable, type Job } from "cleave-client";

const UNKNOWN = "0".repeat(32);

export async function story(server: string, mesh: Uint8Array<ArrayBuffer>) {
  const cleave = new Cleave(`${server}/`);
  const submitted = await cleave.submit(mesh, { format: "ply", parameters: { max_segments: 9 }, recompute: true });
  const states: Job["status"][] = [];
  for await (const { status } of cleave.events(submitted.id)) states.push(status);
  const job = await cleave.wait(submitted.id);
  const tree = PartTree.of(await cleave.hierarchy(job.id));
  const last = await cleave.labels(job.id, { segments: tree.maxSegments });
  const wrong: number[] = [];
  for (let segments = 1; segments <= tree.maxSegments; segments++) {
    const labels = await cleave.labels(job.id, { segments });
    if (String(labels) !== String(tree.labelsAt(last, segments))) wrong.push(segments);
  }
  const model = await fetch(cleave.modelUrl(job.id, "model.glb", { levels: "all", name: ["0:body", "1:an arm"] }));
  const { data: formats } = await cleave.api.GET("/v1/formats");
  return {
    job: job.id,
    last: states.at(-1),
    faces: [job.mesh.faces, last.length],
    levels: tree.maxSegments,
    wrong,
    model: [model.status, model.headers.get("Content-Type")],
    formats: formats?.meshes.length,
    parts: (await cleave.parts(job.id, { segments: 7 })).parts.map(({ number }) => number),
    files: await severalFiles(cleave),
    refused: await refusal(cleave.labels(job.id, { segments: 1000 })),
    unknown: await refusal(cleave.wait(UNKNOWN)),
    unreachable: await new Cleave("http://127.0.0.1:9").job(UNKNOWN).catch((error: unknown) => error instanceof ServerUnreachable),
    key: await sentKey(),
    streams: await twoStreams(),
  };
}

async function sentKey(): Promise<string | null> {
  let key: string | null = null;
  const fetch = async ({ headers }: Request) => ((key = headers.get("Authorization")), Response.json({}));
  await new Cleave("http://127.0.0.1:9", { apiKey: "secret", fetch }).job(UNKNOWN);
  return key;
}

/** A stream that ends early is continued after its last event. Returns the states, and the ids that were sent. */
async function twoStreams(): Promise<[string[], (string | null)[]]> {
  const [states, sent]: [string[], (string | null)[]] = [[], []];
  const texts = ['id: 5\nevent: status\ndata: {"status": "running"}\n\n', 'id: 6\nevent: status\ndata: {"status": "succeeded"}\n\n'];
  const fetch = async ({ headers }: Request) => (sent.push(headers.get("Last-Event-ID")), new Response(texts[sent.length - 1]));
  for await (const { status } of new Cleave("http://127.0.0.1:9", { fetch }).events(UNKNOWN)) states.push(status);
  return [states, sent];
}

/** Submit a mesh and its materials; return the names that the service shows. */
async function severalFiles(cleave: Cleave): Promise<string | null> {
  const corners = ["0 0 0", "1 0 0", "0 1 0", "0 0 1"].map((place) => `v ${place}\n`).join("");
  const faces = ["1 3 2", "1 2 4", "1 4 3", "2 3 4"].map((face) => `f ${face}\n`).join("");
  const mesh = new File([`mtllib paint.mtl\n${corners}usemtl red\n${faces}`], "tetrahedron.obj");
  const materials = new File(["newmtl red\nKd 1 0 0\n"], "paint.mtl");
  const { input } = await cleave.wait((await cleave.submit([mesh, materials])).id);
  return input.file_name;
}

async function refusal(call: Promise<unknown>): Promise<[number, string]> {
  const error = await call.then(() => null, (error: unknown) => error);
  if (!(error instanceof RequestRefused)) throw error;
  // @ts-expect-error: the code is none of the enumeration
  if (error.code === "no_such_code") throw error;
  return [error.status, error.code];
}

/** Compiles only if the types are exact. */
export function types(cleave: Cleave, job: Job): void {
  if (job.status === "failed") job.error.code satisfies string;
  if (job.status === "succeeded") job.mesh.report?.lower satisfies [number, number, number] | undefined;
  // @ts-expect-error: there is no such format
  cleave.modelUrl(job.id, "model.blend");
  // @ts-expect-error: PLY files have one level
  cleave.modelUrl(job.id, "model.ply", { levels: "all" });
  // @ts-expect-error: there is no such parameter
  void cleave.submit(new ArrayBuffer(1), { parameters: { max_segment: 3 } });
}
