import type { DepthPlane } from './depth_plane';

/**
 * A plane of depth as triangles. Vertices lie at the centres of the cells, and on the border of the picture. Where an
 * edge joins two surfaces it is cut: both go on to the borders of their cells, each at its own depth, and what opens
 * between them is filled from the farther one.
 *
 * A cell has the depth of its nearest surface. So a cell before a cut may show some of what is behind, too, and is two
 * sheets: the pixels that have the colour of what is behind are on the far one, all others on the near one.
 */
export interface WarpMesh {
  readonly vertices: Float32Array; // x, y (pixels of the picture), inverse depth
  readonly surface: Uint32Array; // indices of three vertices a triangle
  readonly background: Uint32Array; // in the cells behind cuts
  readonly sheets: Float32Array; // `sheetFloats` for each vertex
  readonly near: Uint32Array; // indices of three vertices of `sheets` a triangle
  readonly far: Uint32Array; // before a surface
  readonly farBackground: Uint32Array; // before the background
  readonly fills: Float32Array; // `fillFloats` for each of three vertices a triangle
  readonly surroundings: Float32Array; // beyond the border of the picture; as `fills`
  readonly holes: Float32Array; // as `fills`, where the background would fill: what is not covered is background
}

/** Place of a vertex (x, y, inverse depth), what is behind (x, y; outside of the picture: background), 1 if near. */
export const sheetFloats = 6;

/** Place of a vertex (x, y, inverse depth), its farthest vertex (the same), and whose fill colour it has (x, y). */
export const fillFloats = 8;

const maxCellVertices = 32; // of two sheets of four quarters

export const tolerance = 0.03; // relative step of inverse depth for each pixel, beyond which an edge is cut

/** Width of the surroundings, pixels. */
export const marginOf = ({ picture }: DepthPlane): number => picture.height / 4;

export function meshOf(plane: DepthPlane): WarpMesh {
  return new MeshBuilder(new Lattice(plane)).mesh();
}

/** Vertices in rows: the centres of the cells, with a ring on the border of the picture around them. */
class Lattice {
  readonly x: Float64Array; // of the columns
  readonly y: Float64Array; // of the rows
  readonly d: Float32Array;

  constructor(readonly plane: DepthPlane) {
    const { width, height, cell, picture, values } = plane;
    this.x = centres(width, cell, picture.width);
    this.y = centres(height, cell, picture.height);
    this.d = new Float32Array((width + 2) * (height + 2));
    for (let row = 0; row < height; ++row) {
      this.d.set(values.subarray(row * width, (row + 1) * width), (row + 1) * this.columns + 1);
    }
    this.moveToCentres();
    for (let row = 1; row <= height; ++row) this.extend(this.x, row * this.columns, 1);
    for (let column = 0; column < this.columns; ++column) this.extend(this.y, column, this.columns);
  }

  get columns(): number {
    return this.x.length;
  }

  get rows(): number {
    return this.y.length;
  }

  /** A texel is the nearest point of its cell, which on a slanted surface is a corner of it. The centre is farther. */
  private moveToCentres(): void {
    const { d, columns, plane } = this;
    const nearest = d.slice();
    const halfRow = this.halfSteps(nearest, this.x, 1, plane.picture.width);
    const halfColumn = this.halfSteps(nearest, this.y, columns, plane.picture.height);
    for (let i = 0; i < d.length; ++i) d[i] = Math.max(nearest[i]! - halfRow[i]! - halfColumn[i]!, nearest[i]! / 2);
  }

  /**
   * What a surface that is not broken on either side loses from the nearest side of its cell to the middle. Its slope
   * is that of the flatter side, or none if they do not agree in sign: the depths of rough surfaces differ without it.
   */
  private halfSteps(nearest: Float32Array, at: Float64Array, stride: number, size: number): Float32Array {
    const cut = this.cuts(at, stride);
    const half = new Float32Array(nearest.length);
    const last = at.length - 2; // the first and the last vertices of lines are not known
    if (last === 1) return half;
    const ends = Float64Array.from(at, (_, k) => Math.min(size, k * this.plane.cell));
    // From the nearest side of a cell to that of the next one; the last cell may be smaller.
    const slope = (i: number, k: number): number => {
      const step = nearest[i + stride]! - nearest[i]!;
      return step / (step > 0 ? ends[k + 1]! - ends[k]! : ends[k]! - ends[k - 1]!);
    };
    for (let i = 0; i < nearest.length; ++i) {
      const k = stride === 1 ? i % at.length : Math.floor(i / stride);
      if (nearest[i] === 0 || (k > 1 && cut[i - stride] === 1) || (k < last && cut[i] === 1)) continue;
      const after = slope(k < last ? i : i - stride, Math.min(k, last - 1));
      const before = k > 1 ? slope(i - stride, k - 1) : after;
      if (after * before <= 0) continue;
      half[i] = (Math.min(Math.abs(after), Math.abs(before)) * (ends[k]! - ends[k - 1]!)) / 2;
    }
    return half;
  }

  /** Continues a line of vertices, whose outermost ones are not known, as far as the picture. */
  private extend(at: Float64Array, start: number, stride: number): void {
    const end = at.length - 1;
    this.d[start] = this.beyond(at, start, stride, 0, 1);
    this.d[start + end * stride] = this.beyond(at, start, stride, end, -1);
  }

  /** A surface goes on with its slope, if there is one: the two vertices before the outermost one tell. */
  private beyond(at: Float64Array, start: number, stride: number, last: number, inwards: number): number {
    const index = (steps: number): number => start + (last + steps * inwards) * stride;
    const near = this.d[index(1)]!;
    if (at.length < 4) return near;
    const next = this.d[index(2)]!;
    const inner = Math.min(last + inwards, last + 2 * inwards);
    // Of the line's ends, which are not known yet, the rule for cuts takes no notice: they are 0.
    if (near === 0 || next === 0 || this.breaks(at, inner, stride, start + inner * stride)) return near;
    const slope = (near - next) / Math.abs(at[last + 2 * inwards]! - at[last + inwards]!);
    return Math.max(near / 2, near + slope * Math.abs(at[last + inwards]! - at[last]!));
  }

  /**
   * Which edges along lines of vertices are cut. Edge i goes from vertex i to the next one of its line. Only a step
   * that neither slope beside it explains is one between surfaces.
   */
  cuts(at: Float64Array, stride: number): Uint8Array {
    const { d } = this;
    const cut = new Uint8Array(d.length);
    const length = at.length;
    for (let i = 0; i < d.length; ++i) {
      const k = stride === 1 ? i % length : Math.floor(i / stride);
      if (k + 1 >= length) continue;
      const [a, b] = [d[i]!, d[i + stride]!];
      if (a === b) continue;
      cut[i] = a === 0 || b === 0 || this.breaks(at, k, stride, i) ? 1 : 0;
    }
    return cut;
  }

  private breaks(at: Float64Array, k: number, stride: number, i: number): boolean {
    const { d } = this;
    const [a, b] = [d[i]!, d[i + stride]!];
    const length = at[k + 1]! - at[k]!;
    const allowed = tolerance * length * Math.max(a, b);
    if (Math.abs(b - a) <= allowed) return false;
    const before = k > 0 ? d[i - stride]! : 0;
    if (before > 0 && Math.abs(b - a - ((a - before) * length) / (at[k]! - at[k - 1]!)) <= allowed) return false;
    const after = k + 2 < at.length ? d[i + 2 * stride]! : 0;
    return !(after > 0 && Math.abs(b - a - ((after - b) * length) / (at[k + 2]! - at[k + 1]!)) <= allowed);
  }
}

/** Positions of the centres of cells along one side of the picture, with its two ends. */
function centres(count: number, cell: number, size: number): Float64Array {
  const at = new Float64Array(count + 2);
  for (let i = 0; i < count; ++i) at[i + 1] = (i * cell + Math.min(size, (i + 1) * cell)) / 2;
  at[count + 1] = size;
  return at;
}

/** Of a quarter of a cell, in a square: its own vertex, those of the same row and column, and the opposite one. */
type Corners = readonly [number, number, number, number];

/** A vertex, and an offset from it (x, y). */
type Outside = readonly [number, number, number];

class MeshBuilder {
  private readonly across: Uint8Array; // cuts of edges within rows
  private readonly down: Uint8Array; // cuts of edges within columns
  private readonly behind: Int32Array; // of vertices before cuts: the farthest vertex across one; of others -1
  private readonly divided: Uint8Array; // squares, by their upper left vertices: whether their quarters are apart
  private readonly vertices: number[] = [];
  private readonly surface: number[] = [];
  private readonly background: number[] = [];
  private readonly sheets: Float32Array;
  private sheetVertices = 0;
  private readonly near: number[] = [];
  private readonly far: number[] = [];
  private readonly farBackground: number[] = [];
  private readonly fills: number[] = [];
  private readonly surroundings: number[] = [];
  private readonly holes: number[] = [];

  constructor(private readonly lattice: Lattice) {
    this.across = lattice.cuts(lattice.x, 1);
    this.down = lattice.cuts(lattice.y, lattice.columns);
    this.behind = this.findBehind();
    this.divided = this.findDivided();
    const before = this.behind.reduce((count, behind) => count + (behind < 0 ? 0 : 1), 0);
    this.sheets = new Float32Array(before * maxCellVertices * sheetFloats);
    for (let i = 0; i < lattice.d.length; ++i) this.vertices.push(this.x(i), this.y(i), lattice.d[i]!);
  }

  mesh(): WarpMesh {
    const { columns, rows } = this.lattice;
    for (let row = 0; row + 1 < rows; ++row) {
      for (let column = 0; column + 1 < columns; ++column) this.addSquare(row * columns + column);
    }
    this.addSurroundings();
    return {
      vertices: new Float32Array(this.vertices),
      surface: new Uint32Array(this.surface),
      background: new Uint32Array(this.background),
      sheets: this.sheets.subarray(0, this.sheetVertices * sheetFloats),
      near: new Uint32Array(this.near),
      far: new Uint32Array(this.far),
      farBackground: new Uint32Array(this.farBackground),
      fills: new Float32Array(this.fills),
      surroundings: new Float32Array(this.surroundings),
      holes: new Float32Array(this.holes),
    };
  }

  private findBehind(): Int32Array {
    const { d, columns } = this.lattice;
    const behind = new Int32Array(d.length).fill(-1);
    const note = (near: number, far: number): void => {
      const known = behind[near]!;
      if (known < 0 || d[far]! < d[known]!) behind[near] = far;
    };
    const noteEdge = (a: number, b: number): void => (d[a]! > d[b]! ? note(a, b) : note(b, a));
    for (let i = 0; i < d.length; ++i) {
      if (this.across[i] === 1) noteEdge(i, i + 1);
      if (this.down[i] === 1) noteEdge(i, i + columns);
    }
    return behind;
  }

  /** Squares with a cell before a cut. Every cut has one. */
  private findDivided(): Uint8Array {
    const { columns } = this.lattice;
    const divided = new Uint8Array(this.behind.length);
    this.behind.forEach((behind, i) => {
      if (behind < 0) return;
      for (const square of [i, i - 1, i - columns, i - columns - 1]) divided[square] = 1;
    });
    return divided;
  }

  /** The square between four vertices, of which `a` is the upper left one. */
  private addSquare(a: number): void {
    const b = a + 1;
    const c = a + this.lattice.columns;
    const e = c + 1;
    if (this.divided[a] === 0) {
      if (this.lattice.d[a] !== 0) this.addWhole(a, b, c, e);
      return;
    }
    const [top, bottom, left, right] = [this.across[a]!, this.across[c]!, this.down[a]!, this.down[b]!];
    const whole = (top | bottom | left | right) === 0;
    this.addQuarter([a, b, c, e], top, left, whole);
    this.addQuarter([b, a, e, c], top, right, whole);
    this.addQuarter([c, e, a, b], bottom, left, whole);
    this.addQuarter([e, c, b, a], bottom, right, whole);
    if ((top | right) !== 0) this.addFill([a, b, e]);
    if ((left | bottom) !== 0) this.addFill([a, e, c]);
  }

  /** A square has the vertices in the middle of its sides that squares beside it have, or there would be chinks. */
  private addWhole(a: number, b: number, c: number, e: number): void {
    const { divided, surface, lattice } = this;
    const { columns, d } = lattice;
    const [above, right, below, left] = [divided[a - columns] ?? 0, divided[b]!, divided[c]!, divided[a - 1] ?? 0];
    if ((above | right | below | left) === 0) {
      surface.push(a, b, e, a, e, c);
      return;
    }
    const ring: number[] = [];
    const addSide = (from: number, to: number, parted: number): void => {
      ring.push(from);
      if (parted === 1) ring.push(this.addMiddle(from, to, (d[from]! + d[to]!) / 2));
    };
    addSide(a, b, above);
    addSide(b, e, right);
    addSide(e, c, below);
    addSide(c, a, left);
    const centre = this.addMiddle(a, e, (d[a]! + d[b]! + d[c]! + d[e]!) / 4);
    ring.forEach((vertex, i) => surface.push(centre, vertex, ring[(i + 1) % ring.length]!));
  }

  /** What the cell of the first corner has of a square: up to half way to the others, at the depths of its surface. */
  private addQuarter(corners: Corners, cutBeside: number, cutOver: number, whole: boolean): void {
    const [own, beside, over, across] = corners;
    const { d } = this.lattice;
    const depth = d[own]!;
    const toBeside = cutBeside === 0 ? (d[beside]! - depth) / 2 : 0;
    const toOver = cutOver === 0 ? (d[over]! - depth) / 2 : 0;
    const opposite = whole
      ? (depth + d[beside]! + d[over]! + d[across]!) / 4
      : Math.max(depth / 2, depth + toBeside + toOver);
    const depths = [depth, depth + toBeside, depth + toOver, opposite] as const;
    if (this.behind[own]! >= 0) {
      this.addSheet(corners, depths, this.near, 1);
      const behind = d[this.behind[own]!] === 0 ? this.farBackground : this.far;
      this.addSheet(corners, this.farDepths(corners, cutBeside, cutOver), behind, 0);
      return;
    }
    const a = this.addMiddle(own, beside, depths[1]);
    const b = this.addMiddle(own, over, depths[2]);
    const middle = this.addMiddle(own, across, depths[3]);
    (depth === 0 ? this.background : this.surface).push(own, a, middle, own, middle, b);
  }

  /** Depths of what is behind a quarter: on the way to that behind its neighbours, where these are before cuts, too. */
  private farDepths([own, beside, over]: Corners, cutBeside: number, cutOver: number): Corners {
    const { d } = this.lattice;
    const depth = d[this.behind[own]!]!;
    // A triangle from a surface to background would become a needle as the eye moves.
    const halfTo = (far: number): number => (depth === 0 || far === 0 ? 0 : (far - depth) / 2);
    const half = (other: number, cut: number): number => {
      if (cut !== 0) return d[other]! < d[own]! ? halfTo(d[other]!) : 0;
      return this.behind[other]! < 0 ? 0 : halfTo(d[this.behind[other]!]!);
    };
    const [toBeside, toOver] = [half(beside, cutBeside), half(over, cutOver)];
    return [depth, depth + toBeside, depth + toOver, depth + toBeside + toOver];
  }

  private addSheet(corners: Corners, depths: Corners, indices: number[], near: number): void {
    const first = this.sheetVertices;
    const [own] = corners;
    const behind = this.behind[own]!;
    const [x, y] = this.lattice.d[behind] === 0 ? [-1, -1] : [this.x(behind), this.y(behind)];
    for (let i = 0; i < 4; ++i) {
      const at = sheetFloats * this.sheetVertices++;
      this.sheets[at] = this.middleX(own, corners[i]!);
      this.sheets[at + 1] = this.middleY(own, corners[i]!);
      this.sheets[at + 2] = depths[i]!;
      this.sheets[at + 3] = x;
      this.sheets[at + 4] = y;
      this.sheets[at + 5] = near;
    }
    indices.push(first, first + 1, first + 3, first, first + 3, first + 2);
  }

  /** Corners of the surface in front take the fill colour of the farthest corner, the others their own. */
  private addFill(corners: readonly number[]): void {
    const { d } = this.lattice;
    const far = corners.reduce((best, corner) => (d[corner]! < d[best]! ? corner : best));
    const nearest = Math.max(...corners.map((corner) => d[corner]!));
    for (const corner of corners) {
      const inFront = nearest - d[corner]! <= d[corner]! - d[far]!;
      this.addMadeUp(this.fills, corner, 0, 0, far, inFront ? far : corner);
    }
  }

  /** What a turning eye sees beyond the border. */
  private addSurroundings(): void {
    const { columns, rows, plane } = this.lattice;
    const width = marginOf(plane);
    const bottom = (rows - 1) * columns;
    for (let i = 0; i + 1 < columns; ++i) {
      this.addStrip(i, i + 1, 0, -width);
      this.addStrip(bottom + i, bottom + i + 1, 0, width);
    }
    for (let i = 0; i < bottom; i += columns) {
      this.addStrip(i, i + columns, -width, 0);
      this.addStrip(i + columns - 1, i + 2 * columns - 1, width, 0);
    }
    this.addCorner(0, -width, -width);
    this.addCorner(columns - 1, width, -width);
    this.addCorner(bottom, -width, width);
    this.addCorner(bottom + columns - 1, width, width);
  }

  /** A strip outwards from the border between two vertices. */
  private addStrip(a: number, b: number, dx: number, dy: number): void {
    const { d } = this.lattice;
    const far = d[a]! < d[b]! ? a : b;
    this.addOutside(far, [a, 0, 0], [b, 0, 0], [b, dx, dy], [a, dx, dy]);
  }

  private addCorner(a: number, dx: number, dy: number): void {
    this.addOutside(a, [a, 0, 0], [a, dx, 0], [a, dx, dy], [a, 0, dy]);
  }

  /** Four vertices, each at an offset from one of the border. */
  private addOutside(far: number, ...[p, q, r, s]: readonly [Outside, Outside, Outside, Outside]): void {
    for (const [vertex, dx, dy] of [p, q, r, p, r, s]) this.addMadeUp(this.surroundings, vertex, dx, dy, far, vertex);
  }

  /** A vertex at an offset from another one, behind `far` in the colour of `from`; a hole where that is background. */
  private addMadeUp(list: number[], vertex: number, dx: number, dy: number, far: number, from: number): void {
    const { d } = this.lattice;
    const [depth, open] = [d[vertex]!, d[far] === 0];
    const [x, y] = [this.x(vertex) + dx, this.y(vertex) + dy];
    const to = open ? this.holes : list;
    to.push(x, y, depth, this.x(far), this.y(far), d[far]!, open ? -1 : this.x(from), open ? -1 : this.y(from));
  }

  /** A vertex in the middle between two. */
  private addMiddle(a: number, b: number, depth: number): number {
    this.vertices.push(this.middleX(a, b), this.middleY(a, b), depth);
    return this.vertices.length / 3 - 1;
  }

  private middleX(a: number, b: number): number {
    return (this.x(a) + this.x(b)) / 2;
  }

  private middleY(a: number, b: number): number {
    return (this.y(a) + this.y(b)) / 2;
  }

  private x(vertex: number): number {
    return this.lattice.x[vertex % this.lattice.columns]!;
  }

  private y(vertex: number): number {
    return this.lattice.y[Math.floor(vertex / this.lattice.columns)]!;
  }
}
