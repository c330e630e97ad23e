// What the lanes of a work group share when they draw a tile with a long list together (see draw_together.glsl): each
// walks over its part of the list. Lanes that draw alone walk over all of it, and share nothing.
#ifdef SURFCAST_TOGETHER
shared uint shared_first[SHARED_PIXELS];   // bits of inverse depths
shared uint shared_second[SHARED_PIXELS];
shared uint shared_word;

const uint kStride = kShares;

uint own_start() { return own_share(); }
bool may_leave() { return false; }

void set_shared(uint first, uint second, uint word) {
  barrier();
  for (uint i = gl_LocalInvocationIndex; i < uint(SHARED_SUMS); i += kLanes) {
    shared_low[i] = 0u;
    shared_high[i] = 0u;
    if (i >= uint(SHARED_PIXELS)) continue;
    shared_first[i] = first;
    shared_second[i] = second;
  }
  if (gl_LocalInvocationIndex == 0u) shared_word = word;
  barrier();
}

float share_peak(float peak) {
  set_shared(0u, 0u, 0u);
  atomicMax(shared_word, floatBitsToUint(peak));
  barrier();
  return uintBitsToFloat(shared_word);
}

bool share_any(bool own) {
  set_shared(0u, 0u, 0u);
  if (own) atomicOr(shared_word, 1u);
  barrier();
  return shared_word != 0u;
}

void share_largest(inout Columns a, inout Columns b) {
  set_shared(0u, 0u, 0u);
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    for (int i = 0; i < SURFCAST_ROWS; ++i) {
      atomicMax(shared_first[shared_pixel(c, i)], floatBitsToUint(ROW(a[c], i)));
      atomicMax(shared_second[shared_pixel(c, i)], floatBitsToUint(ROW(b[c], i)));
    }
  }
  barrier();
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    for (int i = 0; i < SURFCAST_ROWS; ++i) {
      ROW(a[c], i) = uintBitsToFloat(shared_first[shared_pixel(c, i)]);
      ROW(b[c], i) = uintBitsToFloat(shared_second[shared_pixel(c, i)]);
    }
  }
}

void share_least(inout Columns a) {
  set_shared(0xffffffffu, 0u, 0u);
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    for (int i = 0; i < SURFCAST_ROWS; ++i) {
      atomicMin(shared_first[shared_pixel(c, i)], floatBitsToUint(ROW(a[c], i)));
    }
  }
  barrier();
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    for (int i = 0; i < SURFCAST_ROWS; ++i) ROW(a[c], i) = uintBitsToFloat(shared_first[shared_pixel(c, i)]);
  }
}

void share_sums(inout SurfaceColumns sums) {
  set_shared(0u, 0u, 0u);
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
#define GIVE_SUM(name, number) give_sum(sums[c].seen.name, number, c);
    EACH_SUM(GIVE_SUM)
    give_sum(sums[c].count, 8, c);
    give_sum(sums[c].opacity, 9, c);
  }
  barrier();
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
#define TAKE_SUM(name, number) take_sum(sums[c].seen.name, number, c);
    EACH_SUM(TAKE_SUM)
    take_sum(sums[c].count, 8, c);
    take_sum(sums[c].opacity, 9, c);
  }
}
#else
const uint kStride = 1u;

uint own_start() { return 0u; }
bool may_leave() { return true; }
float share_peak(float peak) { return peak; }
bool share_any(bool own) { return own; }
void share_largest(inout Columns a, inout Columns b) {}
void share_least(inout Columns a) {}
void share_sums(inout SurfaceColumns sums) {}
#endif

#ifdef SURFCAST_BLENDS_BEHIND
const uint kMaxFinds = 2u;  // in motion; what is behind them is a medium
#else
const uint kMaxFinds = uint(SURFCAST_SURFACE_FINDS);
#endif

// The most finds for which the loops over a list stay within what software GL allows. A find walks three times over the
// small splats, four of them at a time, and over the large ones, one at a time.
int finds_for(uint smalls, uint larges) {
  const uint kIterations = 48000u;
  return int(clamp(kIterations * kStride / max(smalls + 4u * larges, 1u), 1u, kMaxFinds));
}
