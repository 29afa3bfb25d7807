/** An app of React with the viewer component, and with a model in react-three-fiber. */
import { Canvas, useLoader, type ThreeEvent } from "@react-three/fiber";
import { Cleave } from "cleave-client";
import { PartModel } from "cleave-client/three";
import type { CleaveViewer, ErrorDetail } from "cleave-viewer";
import "cleave-viewer/react";
import { Suspense, useEffect, useMemo, useState } from "react";
import { createRoot } from "react-dom/client";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

function Model({ url, segments, onPick }: { url: string; segments: number; onPick: (name: string) => void }) {
  const gltf = useLoader(GLTFLoader, url);
  const model = useMemo(() => new PartModel(gltf), [gltf]);
  model.segments = segments;
  useEffect(() => document.getElementById("scene")?.setAttribute("data-state", "loaded"));
  const pick = (event: ThreeEvent<MouseEvent>) => {
    event.stopPropagation();
    onPick(model.partOf(event)?.name ?? "nothing");
  };
  return <primitive object={gltf.scene} onClick={pick} />;
}

function App({ server, job }: { server: string; job: string }) {
  const [picked, setPicked] = useState("");
  const [segments, setSegments] = useState(7);
  const [selected, setSelected] = useState<readonly number[]>([]);
  const [error, setError] = useState<ErrorDetail | null>(null);
  const [source, setSource] = useState(job);
  const cleave = new Cleave(server);
  const url = cleave.modelUrl(job, "model.glb", { levels: "all" });
  return (
    <>
      <div id="scene" style={{ width: 300, height: 300 }}>
        <Canvas camera={{ position: [0, 0, 8] }}>
          <ambientLight />
          <Suspense fallback={null}>
            <Model url={url} segments={segments} onPick={setPicked} />
          </Suspense>
        </Canvas>
      </div>
      <cleave-viewer
        src={cleave.modelUrl(source, "model.glb", { levels: "all" })}
        segments={segments}
        label="A burr"
        no-entrance=""
        oncleave-select={({ detail }) => setSelected(detail.parts)}
        oncleave-error={({ detail }) => setError(detail)}
        ref={(viewer: CleaveViewer | null) => void viewer?.state}
      />
      <output id="picked">{picked}</output>
      <output id="selected">{selected.join()}</output>
      <output id="error">{error?.code}</output>
      <button onClick={() => setSegments(1)}>One part</button>
      <button onClick={() => setSource("0".repeat(32))}>Another job</button>
    </>
  );
}

Object.assign(window, {
  start: (server: string, job: string) => createRoot(document.body.appendChild(document.createElement("div"))).render(<App server={server} job={job} />),
});
