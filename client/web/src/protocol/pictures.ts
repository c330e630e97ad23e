import { create, type MessageInitShape } from '@bufbuild/protobuf';
import type { Camera } from '../camera/pose';
import type { Box } from '../camera/standard_views';
import { vector, type Vector } from '../camera/vector';
import {
  ColorSource,
  DrawPictureSchema,
  FileFormat,
  GlyphShape,
  GridAxis,
  TransferPreset,
  type Box as WireBox,
  type Camera as WireCamera,
  type DrawPicture,
  type GlyphsSchema,
  type IsoSurfaceSchema,
  type SliceSchema,
  type TransferFunctionSchema,
  type Vector3,
} from '../generated/surfcast_pb';
import { choices, plainMembers } from '../generated/plain_options';
import { defaultGlyphs, type GlyphOptions } from '../state/glyph_options';
import type { ColorSourceName, DisplayOptions } from '../state/display_options';
import type { GridAxis as GridAxisName, IsoSurface, Slice } from '../volume/surfaces';
import { defaultTransfer, type PresetName, type Transfer } from '../volume/transfer';

export interface Size {
  readonly width: number;
  readonly height: number;
}

const sources: Readonly<Record<ColorSourceName, ColorSource>> = {
  rgb: ColorSource.RGB,
  intensity: ColorSource.INTENSITY,
  elevation: ColorSource.ELEVATION,
  classification: ColorSource.CLASSIFICATION,
  normal: ColorSource.NORMAL,
  direction: ColorSource.DIRECTION,
  dec: ColorSource.DEC,
  attribute: ColorSource.ATTRIBUTE,
};

const presets: Readonly<Record<PresetName, TransferPreset>> = {
  auto: TransferPreset.AUTO,
  gray: TransferPreset.GRAY,
  'ct-bone': TransferPreset.CT_BONE,
  'ct-soft': TransferPreset.CT_SOFT,
  mr: TransferPreset.MR,
};

function wireTransfer({ preset, range, points }: Transfer): MessageInitShape<typeof TransferFunctionSchema> {
  if (points.length > 0) return { points: points.map(({ value, color, opacity }) => ({ value, color, opacity })) };
  return { preset: presets[preset], ...(range ? { first: range[0], last: range[1] } : {}) };
}

const axes: Readonly<Record<GridAxisName, GridAxis>> = { i: GridAxis.I, j: GridAxis.J, k: GridAxis.K };

const wireSurface = ({ value, color, opacity }: IsoSurface): MessageInitShape<typeof IsoSurfaceSchema> => ({
  value,
  opacity,
  ...(color ? { color } : {}),
});

const wireSlice = (slice: Slice): MessageInitShape<typeof SliceSchema> =>
  slice.axis ? { axis: axes[slice.axis], index: slice.index } : { point: slice.point, normal: slice.normal };

function wireGlyphs(glyphs: GlyphOptions): MessageInitShape<typeof GlyphsSchema> {
  const { shape, sharpness, radius, scale, thresholds } = glyphs;
  return {
    shape: shape === 'superquadric' ? GlyphShape.SUPERQUADRIC : GlyphShape.ELLIPSOID,
    sharpness,
    radius: choices.glyphRadius.indexOf(radius),
    ...(scale === undefined ? {} : { scale }),
    thresholds: thresholds.map(({ attribute, smallest, largest }) => ({
      attribute,
      smallest,
      ...(largest === undefined ? {} : { largest }),
    })),
  };
}

/** The request for a picture. Without a camera the server chooses a view of the whole model. */
export function pictureOf(
  model: string,
  camera: Camera | undefined,
  display: DisplayOptions,
  resolution: Size,
  format: FileFormat = FileFormat.PNG,
): DrawPicture {
  const [first, last] = display.range ?? [];
  const coloring = {
    source: sources[display.source],
    map: choices.colorMap.indexOf(display.map),
    ...(display.source === 'attribute' ? { attribute: display.attribute } : {}),
    ...(first !== undefined && last !== undefined ? { first, last } : {}),
  };
  const picture: MessageInitShape<typeof DrawPictureSchema> = {
    ...plainMembers(display),
    model,
    resolution,
    format,
    coloring,
    hiddenClasses: [...display.hiddenClasses],
    hiddenModels: [...display.hiddenModels],
    clipBoxes: display.clips.map(({ box, inverted }) => ({ box, inverted })),
    ...(camera ? { camera: wireCamera(camera) } : {}),
    ...(display.eyeDome.strength > 0 ? { eyeDome: display.eyeDome } : {}),
    ...(display.transfer === defaultTransfer ? {} : { transfer: wireTransfer(display.transfer) }),
    isoSurfaces: display.surfaces.map(wireSurface),
    slices: display.slices.map(wireSlice),
    classOpacities: display.classOpacities.map(({ code, opacity }) => ({ code, opacity })),
    ...(display.glyphs === defaultGlyphs ? {} : { glyphs: wireGlyphs(display.glyphs) }),
    ...(display.lighting ? { lighting: { ...display.lighting, lights: [...display.lighting.lights] } } : {}),
  };
  return create(DrawPictureSchema, picture);
}

const wireCamera = ({ viewUp, ...camera }: Camera): Omit<Camera, 'viewUp'> & { viewUp?: Vector } =>
  viewUp ? { ...camera, viewUp } : camera;

export const vectorFrom = (v: Vector3 | undefined): Vector => vector(v?.x ?? 0, v?.y ?? 0, v?.z ?? 0);

export const boxFrom = (box: WireBox | undefined): Box => ({ min: vectorFrom(box?.min), max: vectorFrom(box?.max) });

/** The camera of a picture; undefined if it is incomplete. */
export function cameraFrom(camera: WireCamera | undefined): Camera | undefined {
  if (!camera?.position || !camera.focalPoint) return undefined;
  return {
    position: vectorFrom(camera.position),
    focalPoint: vectorFrom(camera.focalPoint),
    viewUp: camera.viewUp && vectorFrom(camera.viewUp),
    viewAngle: camera.viewAngle ?? 30,
  };
}
