/** The element in JSX, for React 19: `import "cleave-viewer/react"`. Events are `oncleave-select` and so on. */

import type { DetailedHTMLProps, HTMLAttributes } from "react";
import type { CleaveViewer, CleaveViewerAttributes, CleaveViewerEventMap } from "./dist/cleave-viewer.js";

type Handlers = { [Name in keyof CleaveViewerEventMap as `on${Name}`]?: (event: CleaveViewerEventMap[Name]) => void };
type Properties = Partial<Pick<CleaveViewer, "requestHeaders" | "hiddenParts" | "cut" | "view">>;

declare module "react" {
  namespace JSX {
    interface IntrinsicElements {
      "cleave-viewer": DetailedHTMLProps<HTMLAttributes<CleaveViewer>, CleaveViewer> & CleaveViewerAttributes & Handlers & Properties;
    }
  }
}
