/** A texture with the part of every drawn face, of which single faces are rewritten while a stroke is drawn. */

import { DataTexture, NearestFilter, RGBAFormat, UnsignedByteType } from "three";

const COLUMNS = 1024;
const STRIDE = 4; // bytes of a texel; three.js rewrites rows of textures of this size only
const MOST_ROWS = 200; // that are rewritten one by one; set by hand

export class FaceLabels {
  readonly texture: DataTexture;
  readonly columns = COLUMNS;
  /** (F) part of every drawn face. */
  readonly parts: Uint16Array;
  readonly #bytes: Uint8Array;
  /** Whether the whole texture is sent to the graphics card with the next frame. */
  #isAllSent = true;

  constructor(faces: number) {
    const rows = Math.max(Math.ceil(faces / COLUMNS), 1);
    this.#bytes = new Uint8Array(STRIDE * COLUMNS * rows);
    this.parts = new Uint16Array(this.#bytes.length / STRIDE);
    this.texture = new DataTexture(this.#bytes, COLUMNS, rows, RGBAFormat, UnsignedByteType);
    this.texture.minFilter = this.texture.magFilter = NearestFilter;
    this.texture.onUpdate = () => (this.#isAllSent = false);
  }

  /** Show the labels of the faces of the file; ``faceOf`` has that of each drawn face. */
  fill(labels: Int32Array, faceOf: Uint32Array): void {
    for (let drawn = 0; drawn < faceOf.length; drawn++) this.#write(drawn, labels[faceOf[drawn]!]!);
    this.#sendAll();
  }

  /** Show some drawn faces in another part. */
  paint(drawn: Iterable<number>, part: number): void {
    const rows = new Set<number>();
    for (const face of drawn) {
      this.#write(face, part);
      rows.add((face / COLUMNS) | 0);
    }
    if (rows.size + this.texture.updateRanges.length > MOST_ROWS) this.#sendAll();
    if (!this.#isAllSent) for (const row of rows) this.texture.addUpdateRange(STRIDE * COLUMNS * row, STRIDE * COLUMNS);
    this.texture.needsUpdate = true;
  }

  dispose(): void {
    this.texture.dispose();
  }

  #sendAll(): void {
    this.#isAllSent = true;
    this.texture.clearUpdateRanges();
    this.texture.needsUpdate = true;
  }

  #write(drawn: number, part: number): void {
    this.parts[drawn] = part;
    this.#bytes[STRIDE * drawn] = part & 255;
    this.#bytes[STRIDE * drawn + 1] = part >> 8;
  }
}
