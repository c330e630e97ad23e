// Lanes of a work group that draw a tile with a long list together (see draw_together.glsl): SURFCAST_PIXEL_LANES lanes
// hold the pixels, and SURFCAST_SHARES times as many of them each take a share of the list. Their sums of a pixel are
// added up here.
#define SHARED_PIXELS (SURFCAST_PIXEL_LANES * SURFCAST_COLUMNS * SURFCAST_ROWS)
#ifdef SURFCAST_TRANSPARENT
#define SHARED_SUMS (10 * SHARED_PIXELS)
#else
#define SHARED_SUMS (8 * SHARED_PIXELS)
#endif

shared uint shared_low[SHARED_SUMS];
shared uint shared_high[SHARED_SUMS];

const uint kLanes = uint(SURFCAST_PIXEL_LANES * SURFCAST_SHARES);
const uint kShares = uint(SURFCAST_SHARES);

uint pixel_lane() { return gl_LocalInvocationIndex % uint(SURFCAST_PIXEL_LANES); }
uint own_share() { return gl_LocalInvocationIndex / uint(SURFCAST_PIXEL_LANES); }
uint shared_pixel(int column, int row) {
  return (pixel_lane() * uint(SURFCAST_COLUMNS) + uint(column)) * uint(SURFCAST_ROWS) + uint(row);
}

void give_sum(FixedSum sum, int number, int c) {
  for (int i = 0; i < SURFCAST_ROWS; ++i) {
    uint place = uint(number * SHARED_PIXELS) + shared_pixel(c, i);
    atomicAdd(shared_low[place], ROW(sum.low, i));
    atomicAdd(shared_high[place], ROW(sum.high, i));
  }
}

void take_sum(inout FixedSum sum, int number, int c) {
  for (int i = 0; i < SURFCAST_ROWS; ++i) {
    uint place = uint(number * SHARED_PIXELS) + shared_pixel(c, i);
    ROW(sum.low, i) = shared_low[place] & 0xffffu;
    ROW(sum.high, i) = shared_high[place] + (shared_low[place] >> 16);
  }
}
