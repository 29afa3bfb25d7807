/** Whether this browser can draw the model. */

let canDraw: boolean | null = null;

export function hasGraphics(): boolean {
  if (canDraw === null) {
    const context = document.createElement("canvas").getContext("webgl2");
    canDraw = context !== null;
    context?.getExtension("WEBGL_lose_context")?.loseContext();
  }
  return canDraw;
}
