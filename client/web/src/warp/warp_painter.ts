import type { Projection } from '../camera/projection';
import type { Rgb } from '../state/display_options';
import type { DepthPlane } from './depth_plane';
import * as shaders from './shaders';
import { clipMatrix, rowMatrix, warpBetween } from './warp_camera';
import { fillFloats, meshOf, type WarpMesh } from './warp_mesh';

/** A frame that can be warped. */
export interface WarpSource {
  readonly bitmap: ImageBitmap;
  readonly depth: DepthPlane;
  readonly projection: Projection; // of the pixels of `bitmap`
  readonly background: Rgb;
}

/** A frame on the GPU. */
interface Upload {
  readonly texture: WebGLTexture;
  readonly vertices: WebGLBuffer;
  readonly indices: WebGLBuffer; // those of the surface, of its edges and of the background
  readonly fills: WebGLBuffer;
  readonly surfaceCount: number;
  readonly edgeCount: number;
  readonly backgroundCount: number;
  readonly fillCount: number; // vertices
}

/** The depth of the layer below another one. */
interface DepthTarget {
  readonly framebuffer: WebGLFramebuffer;
  readonly depth: WebGLTexture;
  readonly width: number;
  readonly height: number;
}

interface Programs {
  readonly surface: WebGLProgram;
  readonly fill: WebGLProgram;
  readonly surfaceDepth: WebGLProgram;
  readonly fillDepth: WebGLProgram;
  readonly backgroundDepth: WebGLProgram;
  readonly sharp: WebGLProgram;
}

const reach = 20; // how much nearer than all surfaces of a frame the eye may come before they are cut off

/** Draws frames as a camera other than theirs sees them, with WebGL 2. */
export class WarpPainter {
  private programs: Programs | undefined;
  private target: DepthTarget | undefined;
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
    this.gl.deleteTexture(upload.texture);
    for (const buffer of [upload.vertices, upload.indices, upload.fills]) this.gl.deleteBuffer(buffer);
  }

  /** Draws `below` as the target sees it, and over it what `above` shows sharper. */
  draw(below: WarpSource, above: WarpSource | undefined, target: Projection): void {
    const { gl, canvas } = this;
    const { width, height } = target;
    if (canvas.width !== width) canvas.width = width;
    if (canvas.height !== height) canvas.height = height;
    this.programs ??= programsOf(gl);
    gl.viewport(0, 0, width, height);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    const nearest = 1 / (reach * Math.max(below.depth.last, above?.depth.last ?? 0));
    const depth = above && this.drawDepth(below, target, nearest);
    const { surface, fill } = this.programs;
    const { red, green, blue } = below.background;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.clearColor(red / 255, green / 255, blue / 255, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    this.drawSurfaces(below, fill, surface, target, nearest);
    if (above && depth) this.drawAbove(above, below, depth, target, nearest);
  }

  /** Draws the depth of a frame, by which the one above is judged. */
  private drawDepth(source: WarpSource, target: Projection, nearest: number): WebGLTexture {
    const { gl } = this;
    const { surfaceDepth, fillDepth, backgroundDepth } = this.programs!;
    const { framebuffer, depth } = this.targetOf(target.width, target.height);
    const upload = this.uploaded(source);
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    this.drawSurfaces(source, fillDepth, surfaceDepth, target, nearest);
    this.use(backgroundDepth, source, target, nearest);
    this.bindVertices(upload);
    const first = upload.surfaceCount + upload.edgeCount;
    gl.drawElements(gl.TRIANGLES, upload.backgroundCount, gl.UNSIGNED_INT, 4 * first);
    return depth;
  }

  /** Fills come first, so that surfaces at the same depth hide them. */
  private drawSurfaces(
    source: WarpSource,
    fill: WebGLProgram,
    surface: WebGLProgram,
    target: Projection,
    nearest: number,
  ): void {
    const { gl } = this;
    const upload = this.uploaded(source);
    this.use(fill, source, target, nearest);
    gl.bindBuffer(gl.ARRAY_BUFFER, upload.fills);
    [3, 3, 2].reduce((at, size, location) => {
      gl.enableVertexAttribArray(location);
      gl.vertexAttribPointer(location, size, gl.FLOAT, false, 4 * fillFloats, 4 * at);
      return at + size;
    }, 0);
    gl.drawArrays(gl.TRIANGLES, 0, upload.fillCount);
    this.use(surface, source, target, nearest);
    this.bindVertices(upload);
    gl.drawElements(gl.TRIANGLES, upload.surfaceCount, gl.UNSIGNED_INT, 0);
    this.drawEdges(source, target, nearest);
  }

  /** Without the background in their cells. So the picture is needed even for the depth alone. */
  private drawEdges(source: WarpSource, target: Projection, nearest: number): void {
    const { gl } = this;
    const { surface } = this.programs!;
    const { surfaceCount, edgeCount } = this.uploaded(source);
    const { red, green, blue } = source.background;
    this.use(surface, source, target, nearest);
    gl.uniform3f(gl.getUniformLocation(surface, 'background'), red / 255, green / 255, blue / 255);
    gl.uniform1i(gl.getUniformLocation(surface, 'edges'), 1);
    gl.drawElements(gl.TRIANGLES, edgeCount, gl.UNSIGNED_INT, 4 * surfaceCount);
    gl.uniform1i(gl.getUniformLocation(surface, 'edges'), 0);
  }

  /** Only surfaces without their edges: beside those, the newer frame shows better what is before what. */
  private drawAbove(
    source: WarpSource,
    below: WarpSource,
    depth: WebGLTexture,
    target: Projection,
    nearest: number,
  ): void {
    const { gl } = this;
    const program = this.programs!.sharp;
    const upload = this.uploaded(source);
    const cellsOf = ({ depth }: WarpSource): number => (depth.cell * target.width) / depth.picture.width;
    gl.clear(gl.DEPTH_BUFFER_BIT);
    this.use(program, source, target, nearest);
    const other = rowMatrix(warpBetween(source.projection, below.projection));
    gl.uniformMatrix3x4fv(gl.getUniformLocation(program, 'other'), false, other);
    gl.uniform1f(gl.getUniformLocation(program, 'cells'), cellsOf(source) + cellsOf(below));
    this.bindTexture(program, 'belowDepth', 1, depth);
    this.bindVertices(upload);
    gl.drawElements(gl.TRIANGLES, upload.surfaceCount, gl.UNSIGNED_INT, 0);
  }

  private use(program: WebGLProgram, source: WarpSource, target: Projection, nearest: number): void {
    const { gl } = this;
    const warp = warpBetween(source.projection, target);
    gl.useProgram(program);
    const clip = clipMatrix(warp, target.width, target.height, nearest);
    gl.uniformMatrix4fv(gl.getUniformLocation(program, 'clip'), false, clip);
    gl.uniform2f(gl.getUniformLocation(program, 'size'), source.projection.width, source.projection.height);
    this.bindTexture(program, 'picture', 0, this.uploaded(source).texture);
  }

  private bindTexture(program: WebGLProgram, name: string, unit: number, texture: WebGLTexture): void {
    const { gl } = this;
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.uniform1i(gl.getUniformLocation(program, name), unit);
  }

  private bindVertices(upload: Upload): void {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, upload.vertices);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, upload.indices);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    for (const location of [1, 2]) gl.disableVertexAttribArray(location);
  }

  private uploaded(source: WarpSource): Upload {
    const known = this.uploads.get(source);
    if (known) return known;
    const upload = uploadOf(this.gl, source.bitmap, meshOf(source.depth));
    this.uploads.set(source, upload);
    return upload;
  }

  private targetOf(width: number, height: number): DepthTarget {
    const { gl, target } = this;
    if (target?.width === width && target.height === height) return target;
    if (target) {
      gl.deleteFramebuffer(target.framebuffer);
      gl.deleteTexture(target.depth);
    }
    return (this.target = makeTarget(gl, width, height));
  }
}

function uploadOf(gl: WebGL2RenderingContext, bitmap: ImageBitmap, mesh: WarpMesh): Upload {
  const texture = textureOf(gl, gl.LINEAR);
  gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
  const indices = new Uint32Array(mesh.surface.length + mesh.edges.length + mesh.background.length);
  indices.set(mesh.surface);
  indices.set(mesh.edges, mesh.surface.length);
  indices.set(mesh.background, mesh.surface.length + mesh.edges.length);
  return {
    texture,
    vertices: bufferOf(gl, gl.ARRAY_BUFFER, mesh.vertices),
    indices: bufferOf(gl, gl.ELEMENT_ARRAY_BUFFER, indices),
    fills: bufferOf(gl, gl.ARRAY_BUFFER, mesh.fills),
    surfaceCount: mesh.surface.length,
    edgeCount: mesh.edges.length,
    backgroundCount: mesh.background.length,
    fillCount: mesh.fills.length / fillFloats,
  };
}

/** Bound to the active unit. */
function textureOf(gl: WebGL2RenderingContext, filter: GLenum): WebGLTexture {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, filter);
  for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
  return texture;
}

function bufferOf(gl: WebGL2RenderingContext, kind: GLenum, data: Float32Array | Uint32Array): WebGLBuffer {
  const buffer = gl.createBuffer();
  gl.bindBuffer(kind, buffer);
  gl.bufferData(kind, data as Float32Array<ArrayBuffer> | Uint32Array<ArrayBuffer>, gl.STATIC_DRAW);
  return buffer;
}

function makeTarget(gl: WebGL2RenderingContext, width: number, height: number): DepthTarget {
  const depth = textureOf(gl, gl.NEAREST);
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, width, height);
  const framebuffer = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, depth, 0);
  return { framebuffer, depth, width, height };
}

function programsOf(gl: WebGL2RenderingContext): Programs {
  return {
    surface: programOf(gl, shaders.surfaceVertex, shaders.pictureFragment),
    fill: programOf(gl, shaders.fillVertex, shaders.pictureFragment),
    surfaceDepth: programOf(gl, shaders.surfaceVertex, shaders.depthFragment),
    fillDepth: programOf(gl, shaders.fillVertex, shaders.depthFragment),
    backgroundDepth: programOf(gl, shaders.backgroundVertex, shaders.depthFragment),
    sharp: programOf(gl, shaders.sharpVertex, shaders.sharpFragment),
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
