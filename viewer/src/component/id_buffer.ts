/** The numbers of what is drawn at each pixel: drawn and read back once after each move of the camera. */

import { WebGLRenderTarget, type Camera, type Scene, type WebGLRenderer } from "three";

export class IdBuffer {
  readonly #target = new WebGLRenderTarget(1, 1);
  #pixels = new Uint8Array(0);
  isStale = true;

  get width(): number {
    return this.#target.width;
  }

  get height(): number {
    return this.#target.height;
  }

  /** Set the size in CSS pixels. */
  resize(width: number, height: number): void {
    if (width === this.width && height === this.height) return;
    this.#target.setSize(width, height);
    this.isStale = true;
  }

  /** Draw the scene, whose materials write numbers from 1. */
  draw(renderer: WebGLRenderer, scene: Scene, camera: Camera): void {
    renderer.setRenderTarget(this.#target);
    renderer.clear();
    renderer.render(scene, camera);
    renderer.setRenderTarget(null);
    // Read the whole target once: later positions of the pointer then need no read-back.
    const { width, height } = this.#target;
    if (this.#pixels.length !== 4 * width * height) this.#pixels = new Uint8Array(4 * width * height);
    renderer.readRenderTargetPixels(this.#target, 0, 0, width, height, this.#pixels);
    this.isStale = false;
  }

  /** Return the number at a position in CSS pixels; -1 if there is none. */
  at(x: number, y: number): number {
    const { width, height } = this.#target;
    const [column, row] = [Math.floor(x), height - 1 - Math.floor(y)];
    if (column < 0 || row < 0 || column >= width || row >= height) return -1;
    const pixel = 4 * (row * width + column);
    return this.#pixels[pixel]! + 256 * this.#pixels[pixel + 1]! + 65536 * this.#pixels[pixel + 2]! - 1;
  }

  dispose(): void {
    this.#target.dispose();
  }
}
