import type { DepthPlane } from './depth_plane';

/**
 * A plane of depth as triangles. Vertices lie at the centres of the cells, and on the border of the picture. Where an
 * edge joins two surfaces it is cut: both go on to the borders of their cells, each at its own depth, and what opens
 * between them is filled from the farther one. Beside the background nothing is filled: it has one colour, and what is
 * not covered is background.
 */
export interface WarpMesh {
  readonly vertices: Float32Array; // x, y (pixels of the picture), inverse depth
  readonly surface: Uint32Array; // indices of three vertices a triangle
  readonly edges: Uint32Array; // the same, of surfaces beside cuts
  readonly background: Uint32Array;
  readonly fills: Float32Array; // `fillFloats` for each of three vertices a triangle
}

/** Place of a vertex (x, y, inverse depth), its farthest vertex (the same), and where the colour is taken (x, y). */
export const fillFloats = 8;

const tolerance = 0.02; // relative step of inverse depth for each pixel, beyond which an edge is cut

export function meshOf(plane: DepthPlane): WarpMesh {
  return new MeshBuilder(new Lattice(plane)).mesh();
}

/** Vertices in rows: the centres of the cells, with a ring on the border of the picture around them. */
class Lattice {
  readonly x: Float64Array; // of the columns
  readonly y: Float64Array; // of the rows
  readonly d: Float32Array;

  constructor(readonly plane: DepthPlane) {
    const { width, height, cell, picture } = plane;
    this.x = centres(width, cell, picture.width);
    this.y = centres(height, cell, picture.height);
    this.d = new Float32Array((width + 2) * (height + 2));
    for (let row = 0; row < height; ++row) {
      this.d.set(plane.values.subarray(row * width, (row + 1) * width), (row + 1) * this.columns + 1);
      this.extend(this.x, (row + 1) * this.columns, 1);
    }
    for (let column = 0; column < this.columns; ++column) this.extend(this.y, column, this.columns);
  }

  get columns(): number {
    return this.x.length;
  }

  get rows(): number {
    return this.y.length;
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

class MeshBuilder {
  private readonly across: Uint8Array; // cuts of edges within rows
  private readonly down: Uint8Array; // cuts of edges within columns
  private readonly vertices: number[] = [];
  private readonly surface: number[] = [];
  private readonly edges: number[] = [];
  private readonly background: number[] = [];
  private readonly fills: number[] = [];

  constructor(private readonly lattice: Lattice) {
    this.across = lattice.cuts(lattice.x, 1);
    this.down = lattice.cuts(lattice.y, lattice.columns);
    for (let i = 0; i < lattice.d.length; ++i) {
      this.vertices.push(lattice.x[i % lattice.columns]!, lattice.y[Math.floor(i / lattice.columns)]!, lattice.d[i]!);
    }
  }

  mesh(): WarpMesh {
    const { columns, rows } = this.lattice;
    for (let row = 0; row + 1 < rows; ++row) {
      for (let column = 0; column + 1 < columns; ++column) this.addSquare(row * columns + column);
      this.addBackground(row * columns);
    }
    return {
      vertices: new Float32Array(this.vertices),
      surface: new Uint32Array(this.surface),
      edges: new Uint32Array(this.edges),
      background: new Uint32Array(this.background),
      fills: new Float32Array(this.fills),
    };
  }

  /** The square between four vertices, of which `a` is the upper left one. */
  private addSquare(a: number): void {
    const b = a + 1;
    const c = a + this.lattice.columns;
    const e = c + 1;
    const [top, bottom, left, right] = [this.across[a]!, this.across[c]!, this.down[a]!, this.down[b]!];
    if ((top | bottom | left | right) === 0) {
      if (this.lattice.d[a] !== 0) this.surface.push(a, b, e, a, e, c);
      return;
    }
    this.addQuarter([a, b, c, e], top, left);
    this.addQuarter([b, a, e, c], top, right);
    this.addQuarter([c, e, a, b], bottom, left);
    this.addQuarter([e, c, b, a], bottom, right);
    if ((top | right) !== 0) this.addFill([a, b, e]);
    if ((left | bottom) !== 0) this.addFill([a, e, c]);
  }

  /** The background between two rows of vertices. It is infinitely far, so few large triangles are as good as many. */
  private addBackground(row: number): void {
    const { d, columns } = this.lattice;
    const isOpen = (i: number): boolean => d[i] === 0 && d[i + columns] === 0;
    for (let a = row; a + 1 < row + columns; ++a) {
      let b = a;
      while (b + 1 < row + columns && isOpen(b) && isOpen(b + 1)) b += 1;
      if (b > a) this.background.push(a, b, b + columns, a, b + columns, a + columns);
      a = b;
    }
  }

  /**
   * What the cell of the first corner has of a square: at its depth, and on the way to that of a neighbour on its
   * surface. Then come the corners beside it, in its column, and across.
   */
  private addQuarter(corners: readonly [number, number, number, number], cutBeside: number, cutOver: number): void {
    const [own, beside, over, across] = corners;
    const { d } = this.lattice;
    const depth = d[own]!;
    if (depth === 0) return;
    const toBeside = cutBeside === 0 ? (d[beside]! - depth) / 2 : 0;
    const toOver = cutOver === 0 ? (d[over]! - depth) / 2 : 0;
    const a = this.between(own, beside, depth + toBeside);
    const b = this.between(own, over, depth + toOver);
    const middle = this.between(own, across, Math.max(depth / 2, depth + toBeside + toOver));
    this.edges.push(own, a, middle, own, middle, b);
  }

  /** A vertex in the middle between two. */
  private between(one: number, other: number, depth: number): number {
    const { vertices } = this;
    const at = (axis: number): number => (vertices[3 * one + axis]! + vertices[3 * other + axis]!) / 2;
    vertices.push(at(0), at(1), depth);
    return vertices.length / 3 - 1;
  }

  /** The colour is that of the farthest corner, taken one cell away from the nearest one. */
  private addFill(corners: readonly number[]): void {
    const { d, plane } = this.lattice;
    if (corners.some((corner) => d[corner] === 0)) return;
    const far = corners.reduce((best, corner) => (d[corner]! < d[best]! ? corner : best));
    const near = corners.reduce((best, corner) => (d[corner]! > d[best]! ? corner : best));
    const [x, y, depth] = this.at(far);
    const [fromX, fromY] = this.at(near);
    const distance = Math.hypot(x - fromX, y - fromY);
    const away = (to: number, from: number, size: number): number =>
      Math.min(size - 0.5, Math.max(0.5, to + ((to - from) * plane.cell) / distance));
    const colour = [away(x, fromX, plane.picture.width), away(y, fromY, plane.picture.height)];
    for (const corner of corners) this.fills.push(...this.at(corner), x, y, depth, ...colour);
  }

  private at(vertex: number): [number, number, number] {
    const { vertices } = this;
    return [vertices[3 * vertex]!, vertices[3 * vertex + 1]!, vertices[3 * vertex + 2]!];
  }
}
