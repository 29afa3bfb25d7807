/** The faces that are seen at a position, in a disc or in an outline. Faces are those of the file. */

import type { Point, Sight } from "./cleave-viewer";
import type { Model } from "./glb";
import type { IdBuffer } from "./id_buffer";
import { faceNormals } from "./normals";

export interface Projection {
  /** (16) from the model to clip space, by columns. */
  readonly toClip: ArrayLike<number>;
  /** The camera, in coordinates of the model. */
  readonly eye: readonly number[];
  /** Of the canvas, in CSS pixels. */
  readonly width: number;
  readonly height: number;
}

/** What draws the model. */
export interface Eye {
  /** Return the drawn faces at the pixels; null if nothing is shown. */
  ids(): IdBuffer | null;
  projection(): Projection | null;
}

const NONE = -1;
/** Cosine below which a face with a pixel may be one of the far side, at the outline of the model; set by hand. */
const LEAST_FACING = 0.1;
/** How much farther than the face at its pixel the middle of a face may be that has no pixel, as a factor; set by hand. */
const HIDDEN_BEHIND = 1.01;

export class Faces implements Sight {
  /** (F) face of the file of every drawn face. */
  readonly faceOf: Uint32Array;
  readonly #drawnOf: Uint32Array;
  readonly #centres: Float32Array;
  readonly #normals: Float32Array;
  readonly #neighbours: Int32Array;
  readonly #eye: Eye;

  /** ``edges`` are pairs of corners, one after the other, as sharedEdges returns them. */
  constructor(model: Model, faceOf: Uint32Array, edges: Int32Array, eye: Eye) {
    this.faceOf = faceOf;
    this.#eye = eye;
    this.#drawnOf = new Uint32Array(faceOf.length);
    for (let drawn = 0; drawn < faceOf.length; drawn++) this.#drawnOf[faceOf[drawn]!] = drawn;
    this.#centres = centres(model);
    this.#normals = faceNormals(model);
    this.#neighbours = new Int32Array(model.index.length).fill(NONE);
    for (let i = 0; i < edges.length; i += 2) {
      const [a, b] = [edges[i]!, edges[i + 1]!];
      this.#neighbours[a] = (b / 3) | 0;
      this.#neighbours[b] = (a / 3) | 0;
    }
  }

  get count(): number {
    return this.faceOf.length;
  }

  drawn(faces: Iterable<number>): number[] {
    return Array.from(faces, (face) => this.#drawnOf[face]!);
  }

  /** Return the face at a position; -1 if there is none. */
  at([x, y]: Point): number {
    const drawn = this.#eye.ids()?.at(x, y) ?? NONE;
    return drawn < 0 ? NONE : this.faceOf[drawn]!;
  }

  /** Return the visible faces in the discs around the points of a path. */
  alongPath(path: readonly Point[], radius: number): number[] {
    return this.stroke(radius)(path);
  }

  /** Return a function that returns the visible faces in discs, those that it has not returned before. */
  stroke(radius: number): (path: readonly Point[]) => number[] {
    const seen = new Uint8Array(this.count);
    return (path) => this.#inDiscs(dense(path, Math.max(radius / 2, 1)), radius, seen);
  }

  /** Return the visible faces in a closed outline. */
  inOutline(outline: readonly Point[]): number[] {
    const seen = new Uint8Array(this.count);
    const found: number[] = [];
    const ys = outline.map(([, y]) => y);
    for (let y = Math.floor(Math.min(...ys)); y <= Math.max(...ys); y++) {
      const ends = crossings(outline, y + 0.5);
      for (let i = 0; i + 1 < ends.length; i += 2) this.#collect(y, ends[i]!, ends[i + 1]!, seen, found);
    }
    return this.#grown(found, seen, (x, y) => crossings(outline, y).filter((end) => end < x).length % 2 === 1);
  }

  #inDiscs(points: readonly Point[], radius: number, seen: Uint8Array): number[] {
    const found: number[] = [];
    for (const [px, py] of points)
      for (let y = Math.floor(py - radius); y <= py + radius; y++) {
        const half = Math.sqrt(radius * radius - (y + 0.5 - py) ** 2); // NaN beside the disc
        if (half >= 0) this.#collect(y, px - half, px + half, seen, found);
      }
    return this.#grown(found, seen, (x, y) => {
      for (const point of points) if ((x - point[0]) ** 2 + (y - point[1]) ** 2 <= radius * radius) return true;
      return false;
    });
  }

  /** Return where the middle of a face is on the canvas; null if it is behind the camera. */
  place(face: number): Point | null {
    const projection = this.#eye.projection();
    return projection === null ? null : project(projection, this.#centres, this.#drawnOf[face]!);
  }

  /** Add the drawn faces with a pixel between two positions of a row, unless they were seen. */
  #collect(row: number, left: number, right: number, seen: Uint8Array, found: number[]): void {
    const ids = this.#eye.ids();
    if (ids === null) return;
    for (let x = Math.max(Math.floor(left), 0); x <= Math.min(right, ids.width - 1); x++) {
      const drawn = ids.at(x, row);
      if (drawn < 0 || seen[drawn] === 1) continue;
      seen[drawn] = 1;
      found.push(drawn);
    }
  }

  /**
   * Add to drawn faces their neighbours whose middle is inside, because small faces may have no pixel, and return the
   * faces of the file. A neighbour counts if it faces the camera as the face from which it was reached, and is not
   * behind the face that is drawn at its middle.
   */
  #grown(found: number[], seen: Uint8Array, isInside: (x: number, y: number) => boolean): number[] {
    const projection = this.#eye.projection();
    const ids = this.#eye.ids();
    if (projection === null || ids === null) return [];
    const { toClip: m, width, height, eye } = projection;
    const c = this.#centres;
    const shown = found.length;
    for (let next = 0; next < found.length; next++) {
      const from = found[next]!;
      const side = this.#facing(eye, from);
      if (next < shown && !(Math.abs(side) > LEAST_FACING * this.#distance(eye, from))) continue;
      for (let corner = 3 * from; corner < 3 * from + 3; corner++) {
        const drawn = this.#neighbours[corner]!;
        if (drawn === NONE || seen[drawn] === 1) continue;
        if (!(this.#facing(eye, drawn) * side > 0)) continue; // NaN for a face without area, from which none is reached
        // As project(), without an array for each of many thousand faces.
        const [x, y, z] = [c[3 * drawn]!, c[3 * drawn + 1]!, c[3 * drawn + 2]!];
        const w = m[3]! * x + m[7]! * y + m[11]! * z + m[15]!;
        const right = (m[0]! * x + m[4]! * y + m[8]! * z + m[12]!) / w;
        const up = (m[1]! * x + m[5]! * y + m[9]! * z + m[13]!) / w;
        const [column, row] = [((right + 1) / 2) * width, ((1 - up) / 2) * height];
        if (w <= 0 || !isInside(column, row)) continue;
        const front = ids.at(column, row);
        if (front < 0 || this.#distance(eye, drawn) > HIDDEN_BEHIND * this.#distance(eye, front)) continue;
        seen[drawn] = 1;
        found.push(drawn);
      }
    }
    return found.map((drawn) => this.faceOf[drawn]!);
  }

  #distance(eye: Projection["eye"], drawn: number): number {
    const [c, i] = [this.#centres, 3 * drawn];
    return Math.hypot(eye[0]! - c[i]!, eye[1]! - c[i + 1]!, eye[2]! - c[i + 2]!);
  }

  /** Return the distance to a face times the cosine of the angle between its normal and the direction of the camera. */
  #facing(eye: Projection["eye"], drawn: number): number {
    const [n, c, i] = [this.#normals, this.#centres, 3 * drawn];
    return n[i]! * (eye[0]! - c[i]!) + n[i + 1]! * (eye[1]! - c[i + 1]!) + n[i + 2]! * (eye[2]! - c[i + 2]!);
  }
}

/** Return points on a path that are at most ``step`` apart. */
function dense(path: readonly Point[], step: number): Point[] {
  const points: Point[] = path.slice(0, 1);
  for (let i = 1; i < path.length; i++) {
    const [[ax, ay], [bx, by]] = [path[i - 1]!, path[i]!];
    const count = Math.max(Math.ceil(Math.hypot(bx - ax, by - ay) / step), 1);
    for (let k = 1; k <= count; k++) points.push([ax + ((bx - ax) * k) / count, ay + ((by - ay) * k) / count]);
  }
  return points;
}

/** Return where a row crosses a closed outline, from left to right; an even number of positions. */
function crossings(outline: readonly Point[], y: number): number[] {
  const ends: number[] = [];
  for (let i = 0, j = outline.length - 1; i < outline.length; j = i++) {
    const [[ax, ay], [bx, by]] = [outline[i]!, outline[j]!];
    if (ay > y !== by > y) ends.push(((bx - ax) * (y - ay)) / (by - ay) + ax);
  }
  return ends.sort((a, b) => a - b);
}

/** (3 F) middles of the drawn faces. */
function centres({ positions: p, index }: Model): Float32Array {
  const result = new Float32Array(index.length);
  for (let i = 0; i < index.length; i += 3)
    for (let k = 0; k < 3; k++) result[i + k] = (p[3 * index[i]! + k]! + p[3 * index[i + 1]! + k]! + p[3 * index[i + 2]! + k]!) / 3;
  return result;
}

function project({ toClip: m, width, height }: Projection, points: Float32Array, i: number): Point | null {
  const [x, y, z] = [points[3 * i]!, points[3 * i + 1]!, points[3 * i + 2]!];
  const w = m[3]! * x + m[7]! * y + m[11]! * z + m[15]!;
  if (w <= 0) return null;
  const [right, up] = [m[0]! * x + m[4]! * y + m[8]! * z + m[12]!, m[1]! * x + m[5]! * y + m[9]! * z + m[13]!];
  return [((right / w + 1) / 2) * width, ((1 - up / w) / 2) * height];
}
