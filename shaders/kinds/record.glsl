// The sign bit of a.w: set of the records of other kinds than surfels, whose number the other bits are.
#define SURFCAST_KIND_RECORD 0x80000000u
