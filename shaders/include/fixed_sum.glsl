// Sums of weights that do not depend on the order of their terms: sums of integers. Tile lists are filled in arbitrary
// order, but the same request must give the same bytes. A weight has a precision of 2^-24 of the largest weight of its
// list. After every SURFCAST_CARRY_INTERVAL terms the 32 bit sums are carried over, so a million splats in one pixel
// neither overflow nor lose small terms.
#include "include/rows.glsl"

// Integer units per unit of weight: the power of two that scales weights up to `peak` to below 2^25.
float fixed_unit(float peak) {
  int exponent = int(floatBitsToUint(max(peak, 1e-30)) >> 23);  // biased by 127; peak < 2^(exponent - 126)
  return uintBitsToFloat(uint(127 + 25 + 126 - exponent) << 23);
}

struct FixedSum {
  IntRows part;   // since the last carry
  UintRows low;   // 16 bits
  UintRows high;  // units of 2^16
};

FixedSum fixed_zero() { return FixedSum(IntRows(0), UintRows(0u), UintRows(0u)); }

// `term` is in integer units.
void fixed_add(inout FixedSum sum, Rows term) { sum.part += IntRows(term); }

void fixed_carry(inout FixedSum sum) {
  UintRows part = UintRows(sum.part);
  sum.low += part & 0xffffu;
  sum.high += (part >> 16) + (sum.low >> 16);
  sum.low &= 0xffffu;
  sum.part = IntRows(0);
}

// The sum in integer units.
Rows fixed_value(FixedSum sum) { return Rows(sum.high) * 65536.0 + Rows(sum.low); }
