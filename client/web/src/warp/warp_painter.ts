import type { Projection } from '../camera/projection';
import type { Rgb } from '../state/rgb';
import type { DepthPlane } from './depth_plane';
import * as shaders from './shaders';
import { clipMatrix, eyeMovement, rowMatrix, warpBetween } from './warp_camera';
import { fillFloats, marginOf, sheetFloats, tolerance, type WarpMesh } from './warp_mesh';

/** A frame that can be warped. */
export interface WarpSource {
  readonly bitmap: ImageBitmap;
  readonly depth: DepthPlane;
  readonly mesh: WarpMesh; // of `depth`
  readonly projection: Projection; // of the pixels of `bitmap`
  readonly background: Rgb;
}

/** Its floats, and where it begins. */
type Attribute = readonly [number, number];

/** A part of a buffer. */
interface Range {
  readonly first: number;
  readonly count: number;
}

/** A frame on the GPU. */
interface Upload {
  readonly texture: WebGLTexture;
  readonly fillColors: WebGLTexture; // of the cells
  readonly vertices: WebGLBuffer;
  readonly sheets: WebGLBuffer;
  readonly madeUp: WebGLBuffer; // vertices
  readonly fills: Range; // of them
  readonly surroundings: Range;
  readonly holes: Range;
  readonly indices: WebGLBuffer;
  readonly surface: Range;
  readonly background: Range;
  readonly near: Range;
  readonly far: Range;
  readonly farBackground: Range;
}

/** The layer above another one. */
interface LayerTarget {
  readonly framebuffer: WebGLFramebuffer;
  readonly picture: WebGLTexture; // alpha: 1 where it shows something, 0 elsewhere
  readonly depth: WebGLTexture;
  readonly width: number;
  readonly height: number;
}

/** Programs that draw a frame. */
interface FramePrograms {
  readonly surface: WebGLProgram;
  readonly sheets: WebGLProgram;
  readonly fill: WebGLProgram;
}

interface Programs {
  readonly alone: FramePrograms;
  readonly over: FramePrograms; // the layer above
  readonly background: WebGLProgram;
  readonly cellMeans: WebGLProgram;
  readonly fillColors: WebGLProgram;
}

const reach = 20; // how much nearer than all surfaces of a frame the eye may come before they are cut off
const continued = 0.999; // of its inverse depth: behind what the frame shows of it
const filled = 0.9; // also behind slopes
// How far the colour of the frame at rest may be from that of the newest one, squared. Where things are seen through,
// another depth may shine through; frames in motion are less sharp, so that opaque ones differ everywhere.
const sameLook = 6000 / 255 ** 2;
const anyLook = 3;

/** Draws frames as a camera other than theirs sees them, with WebGL 2. */
export class WarpPainter {
  private programs: Programs | undefined;
  private target: LayerTarget | undefined;
  private readonly uploads = new Map<WarpSource, Upload>();

  /** Undefined where the browser has no WebGL 2 that works. `changed`: the context was lost or has come back. */
  static on(canvas: HTMLCanvasElement, changed: () => void): WarpPainter | undefined {
    const gl = canvas.getContext('webgl2', { alpha: false, antialias: false, depth: true });
    try {
      return gl ? new WarpPainter(canvas, gl, changed) : undefined;
    } catch {
      return undefined;
    }
  }

  private constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly gl: WebGL2RenderingContext,
    changed: () => void,
  ) {
    this.programs = programsOf(gl); // now, as it takes longer than an animation frame
    canvas.addEventListener('webglcontextlost', (event) => {
      event.preventDefault(); // so that it comes back
      this.programs = undefined;
      this.target = undefined;
      this.uploads.clear();
      changed();
    });
    canvas.addEventListener('webglcontextrestored', changed);
  }

  get lost(): boolean {
    return this.gl.isContextLost();
  }

  /** Frees what the GPU holds of a frame. */
  forget(source: WarpSource): void {
    const upload = this.uploads.get(source);
    if (!upload) return;
    this.uploads.delete(source);
    const { texture, fillColors, vertices, sheets, madeUp, indices } = upload;
    for (const each of [texture, fillColors]) this.gl.deleteTexture(each);
    for (const buffer of [vertices, sheets, madeUp, indices]) this.gl.deleteBuffer(buffer);
  }

  /** Draws `below` as the target sees it, and over it what `above` shows sharper. */
  draw(below: WarpSource, above: WarpSource | undefined, target: Projection): void {
    const { gl, canvas } = this;
    const { width, height } = target;
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
    this.programs ??= programsOf(gl);
    for (const source of [below, above]) if (source) this.uploaded(source); // before the target's state is set
    gl.viewport(0, 0, width, height);
    gl.enable(gl.DEPTH_TEST);
    const nearest = 1 / (reach * Math.max(below.depth.last, above?.depth.last ?? 0));
    gl.depthFunc(gl.LEQUAL);
    const layer = above && this.drawAside(above, target, nearest);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    this.clear(below.background, 1);
    if (above && layer) this.drawOver(below, above, layer, target, nearest);
    else this.drawBelow(this.programs.alone, below, target, nearest);
  }

  /** Waits until what was drawn is there. */
  finish(): void {
    const { gl } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  private clear({ red, green, blue }: Rgb, alpha: number): void {
    const { gl } = this;
    gl.clearColor(red / 255, green / 255, blue / 255, alpha);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  }

  /** Draws what a frame shows, without the background, for the layer below to be compared to. */
  private drawAside(source: WarpSource, target: Projection, nearest: number): LayerTarget {
    const { gl } = this;
    const { surface, sheets } = this.programs!.alone;
    const { near, far } = this.uploaded(source);
    const layer = this.targetOf(target.width, target.height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, layer.framebuffer);
    this.clear(source.background, 0);
    this.use(surface, source, target, nearest);
    this.drawSurface(source);
    this.use(sheets, source, target, nearest);
    this.drawSheets(source, near, far);
    return layer;
  }

  /** Draws the layer below with what the one above shows better, and that one where the layer below shows nothing. */
  private drawOver(
    below: WarpSource,
    above: WarpSource,
    layer: LayerTarget,
    target: Projection,
    nearest: number,
  ): void {
    const { gl } = this;
    const { over, background } = this.programs!;
    const other = rowMatrix(warpBetween(below.projection, above.projection));
    for (const program of [over.surface, over.sheets, over.fill]) {
      gl.useProgram(program);
      this.bindTexture(program, 'above', 1, layer.picture);
      this.bindTexture(program, 'aboveDepth', 2, layer.depth);
      gl.uniformMatrix3x4fv(gl.getUniformLocation(program, 'other'), false, other);
      gl.uniform1f(gl.getUniformLocation(program, 'mostOff'), above.depth.seenThrough ? sameLook : anyLook);
    }
    this.use(background, below, target, nearest);
    this.drawBackground(below);
    this.drawBelow(over, below, target, nearest);
    this.drawMadeUp(below, this.uploaded(below).holes);
  }

  /** Draws what a frame shows, and then behind that what it does not show. */
  private drawBelow(programs: FramePrograms, source: WarpSource, target: Projection, nearest: number): void {
    const { gl } = this;
    const { surface, sheets, fill } = programs;
    const { near, far, farBackground, fillColors, fills, surroundings } = this.uploaded(source);
    this.use(surface, source, target, nearest);
    this.drawSurface(source);
    this.use(sheets, source, target, nearest);
    this.drawSheets(source, near, far, farBackground);
    gl.depthFunc(gl.LESS);
    this.use(fill, source, target, nearest);
    this.bindTexture(fill, 'colors', 3, fillColors);
    gl.uniform1f(gl.getUniformLocation(fill, 'cell'), source.depth.cell);
    gl.uniform1f(gl.getUniformLocation(fill, 'part'), continued);
    gl.uniform1f(gl.getUniformLocation(fill, 'margin'), 0);
    this.drawContinued(source);
    gl.uniform1f(gl.getUniformLocation(fill, 'part'), filled);
    this.drawMadeUp(source, fills);
    gl.uniform1f(gl.getUniformLocation(fill, 'margin'), marginOf(source.depth));
    this.drawMadeUp(source, surroundings);
    gl.uniform1f(gl.getUniformLocation(fill, 'margin'), 0); // for holes
  }

  private drawBackground(source: WarpSource): void {
    const upload = this.uploaded(source);
    this.bindAttributes(upload.vertices, 3, [[3, 0]]);
    this.drawRange(upload, upload.background);
  }

  private drawSurface(source: WarpSource): void {
    const upload = this.uploaded(source);
    this.bindAttributes(upload.vertices, 3, [[3, 0]]);
    this.drawRange(upload, upload.surface);
  }

  private drawSheets(source: WarpSource, ...ranges: readonly Range[]): void {
    const upload = this.uploaded(source);
    this.bindAttributes(upload.sheets, sheetFloats, [[3, 0], [2, 3], [1, 5]]);
    for (const range of ranges) this.drawRange(upload, range);
  }

  /** What is behind goes on behind what is in front, in its fill colour. */
  private drawContinued(source: WarpSource): void {
    const upload = this.uploaded(source);
    this.bindAttributes(upload.sheets, sheetFloats, [[3, 0], [3, 0], [2, 3]]);
    this.drawRange(upload, upload.far);
  }

  /** By the program of fills. */
  private drawMadeUp(source: WarpSource, { first, count }: Range): void {
    this.bindAttributes(this.uploaded(source).madeUp, fillFloats, [[3, 0], [3, 3], [2, 6]]);
    this.gl.drawArrays(this.gl.TRIANGLES, first, count);
  }

  private drawRange(upload: Upload, { first, count }: Range): void {
    const { gl } = this;
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, upload.indices);
    gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, 4 * first);
  }

  /** Attributes 0, 1, ... of vertices of `floats` floats. */
  private bindAttributes(buffer: WebGLBuffer, floats: number, attributes: readonly Attribute[]): void {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    for (const location of [0, 1, 2]) {
      const attribute = attributes[location];
      if (attribute) {
        gl.enableVertexAttribArray(location);
        const [size, first] = attribute;
        gl.vertexAttribPointer(location, size, gl.FLOAT, false, 4 * floats, 4 * first);
      } else {
        gl.disableVertexAttribArray(location);
      }
    }
  }

  private use(program: WebGLProgram, source: WarpSource, target: Projection, nearest: number): void {
    const { gl } = this;
    const warp = warpBetween(source.projection, target);
    gl.useProgram(program);
    const clip = clipMatrix(warp, target.width, target.height, nearest);
    gl.uniformMatrix4fv(gl.getUniformLocation(program, 'clip'), false, clip);
    const { eta, height, width } = source.projection;
    gl.uniform2f(gl.getUniformLocation(program, 'size'), width, height);
    gl.uniform1f(gl.getUniformLocation(program, 'eta'), eta);
    gl.uniform3f(gl.getUniformLocation(program, 'moved'), ...eyeMovement(source.projection, target));
    const { red, green, blue } = source.background;
    gl.uniform3f(gl.getUniformLocation(program, 'background'), red / 255, green / 255, blue / 255);
    this.bindTexture(program, 'picture', 0, this.uploaded(source).texture);
  }

  private bindTexture(program: WebGLProgram, name: string, unit: number, texture: WebGLTexture): void {
    const { gl } = this;
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.uniform1i(gl.getUniformLocation(program, name), unit);
  }

  private uploaded(source: WarpSource): Upload {
    const known = this.uploads.get(source);
    if (known) return known;
    const texture = pictureTexture(this.gl, source.bitmap);
    const fillColors = this.fillColors(source.depth, texture);
    const upload = { texture, fillColors, ...buffersOf(this.gl, source.mesh) };
    this.uploads.set(source, upload);
    return upload;
  }

  /** A texel for each cell of a picture. */
  private fillColors(depth: DepthPlane, picture: WebGLTexture): WebGLTexture {
    const { gl } = this;
    const { width, height } = depth;
    const depths = textureOf(gl, gl.NEAREST);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.R32F, width, height, 0, gl.RED, gl.FLOAT, depth.values);
    const [means, colors] = [cellTexture(gl, width, height), cellTexture(gl, width, height)];
    const { cellMeans, fillColors } = this.programs!;
    const framebuffer = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    gl.viewport(0, 0, width, height);
    gl.disable(gl.DEPTH_TEST);
    for (const location of [0, 1, 2]) gl.disableVertexAttribArray(location);
    const cover = (program: WebGLProgram, target: WebGLTexture): void => {
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
      gl.uniform2f(gl.getUniformLocation(program, 'size'), depth.picture.width, depth.picture.height);
      gl.uniform1f(gl.getUniformLocation(program, 'cell'), depth.cell);
      gl.drawArrays(gl.TRIANGLES, 0, 3);
    };
    gl.useProgram(cellMeans);
    this.bindTexture(cellMeans, 'picture', 0, picture);
    cover(cellMeans, means);
    gl.useProgram(fillColors);
    this.bindTexture(fillColors, 'means', 0, means);
    this.bindTexture(fillColors, 'depths', 1, depths);
    gl.uniform1f(gl.getUniformLocation(fillColors, 'sameSurface'), tolerance * depth.cell);
    cover(fillColors, colors);
    gl.deleteFramebuffer(framebuffer);
    for (const texture of [depths, means]) gl.deleteTexture(texture);
    return colors;
  }

  private targetOf(width: number, height: number): LayerTarget {
    const { gl, target } = this;
    if (target?.width === width && target.height === height) return target;
    if (target) {
      gl.deleteFramebuffer(target.framebuffer);
      for (const texture of [target.picture, target.depth]) gl.deleteTexture(texture);
    }
    return (this.target = makeTarget(gl, width, height));
  }
}

/** Where arrays lie in the buffer that holds them one after the other. `size`: of an element. */
function rangesOf(parts: readonly { readonly length: number }[], size = 1): Range[] {
  let first = 0;
  return parts.map(({ length }) => length / size).map((count) => ({ first: (first += count) - count, count }));
}

/** It is reflected at its border. */
function pictureTexture(gl: WebGL2RenderingContext, bitmap: ImageBitmap): WebGLTexture {
  const texture = textureOf(gl, gl.LINEAR, gl.MIRRORED_REPEAT);
  gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
  return texture;
}

function cellTexture(gl: WebGL2RenderingContext, width: number, height: number): WebGLTexture {
  const texture = textureOf(gl, gl.NEAREST);
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA8, width, height);
  return texture;
}

function buffersOf(gl: WebGL2RenderingContext, mesh: WarpMesh): Omit<Upload, 'texture' | 'fillColors'> {
  const parts = [mesh.surface, mesh.background, mesh.near, mesh.far, mesh.farBackground];
  const [surface, background, near, far, farBackground] = rangesOf(parts) as [Range, Range, Range, Range, Range];
  const made = [mesh.fills, mesh.surroundings, mesh.holes];
  const [fills, surroundings, holes] = rangesOf(made, fillFloats) as [Range, Range, Range];
  return {
    vertices: bufferOf(gl, gl.ARRAY_BUFFER, [mesh.vertices]),
    sheets: bufferOf(gl, gl.ARRAY_BUFFER, [mesh.sheets]),
    madeUp: bufferOf(gl, gl.ARRAY_BUFFER, made),
    indices: bufferOf(gl, gl.ELEMENT_ARRAY_BUFFER, parts),
    ...{ surface, background, near, far, farBackground, fills, surroundings, holes },
  };
}

/** Bound to the first unit, so that those of the layer above stay bound to theirs. */
function textureOf(gl: WebGL2RenderingContext, filter: GLenum, wrap: GLenum = gl.CLAMP_TO_EDGE): WebGLTexture {
  const texture = gl.createTexture();
  gl.activeTexture(gl.TEXTURE0);
  gl.bindTexture(gl.TEXTURE_2D, texture);
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, filter);
  for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, wrap);
  return texture;
}

/** A buffer of arrays one after the other. */
function bufferOf(
  gl: WebGL2RenderingContext,
  kind: GLenum,
  parts: readonly (Float32Array | Uint32Array)[],
): WebGLBuffer {
  const buffer = gl.createBuffer();
  gl.bindBuffer(kind, buffer);
  gl.bufferData(kind, parts.reduce((sum, part) => sum + part.byteLength, 0), gl.STATIC_DRAW);
  parts.reduce((at, part) => {
    gl.bufferSubData(kind, at, part as Float32Array<ArrayBuffer> | Uint32Array<ArrayBuffer>);
    return at + part.byteLength;
  }, 0);
  return buffer;
}

function makeTarget(gl: WebGL2RenderingContext, width: number, height: number): LayerTarget {
  const framebuffer = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
  const attached = (format: GLenum, attachment: GLenum): WebGLTexture => {
    const texture = textureOf(gl, gl.NEAREST);
    gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, attachment, gl.TEXTURE_2D, texture, 0);
    return texture;
  };
  const picture = attached(gl.RGBA8, gl.COLOR_ATTACHMENT0);
  const depth = attached(gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT);
  return { framebuffer, picture, depth, width, height };
}

function programsOf(gl: WebGL2RenderingContext): Programs {
  const surface = (over: boolean, sheets: boolean): WebGLProgram =>
    programOf(gl, shaders.surfaceVertex(over, sheets), shaders.surfaceFragment(over, sheets));
  const ofFrames = (over: boolean): FramePrograms => ({
    surface: surface(over, false),
    sheets: surface(over, true),
    fill: programOf(gl, shaders.fillVertex, shaders.fillFragment(over)),
  });
  return {
    alone: ofFrames(false),
    over: ofFrames(true),
    background: programOf(gl, shaders.backgroundVertex, shaders.backgroundFragment),
    cellMeans: programOf(gl, shaders.coverVertex, shaders.meanFragment),
    fillColors: programOf(gl, shaders.coverVertex, shaders.fillColorFragment),
  };
}

function programOf(gl: WebGL2RenderingContext, vertex: string, fragment: string): WebGLProgram {
  const program = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]] as const) {
    const shader = gl.createShader(kind);
    if (!shader) continue; // the context is lost, and with it the program
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
    throw new Error(`A program of the warp does not compile: ${gl.getProgramInfoLog(program) ?? ''}`);
  }
  return program;
}
