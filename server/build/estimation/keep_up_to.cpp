#include "estimation/keep_up_to.h"

#include <array>
#include <bit>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace surfcast::estimation {
namespace {

/// Goes on at key `from`, before which `kept` keys have been kept.
size_t keep_one_by_one(int32_t last, size_t from, size_t count, size_t kept, int32_t* keys) {
  for (size_t i = from; i < count; ++i) {
    const int32_t key = keys[i];
    keys[kept] = key;
    kept += key <= last ? 1 : 0;
  }
  return kept;
}

#if defined(__x86_64__)

constexpr size_t kKeysAtOnce = 8;

/// For each set of lanes: these lanes, in order.
using KeyOrders = std::array<std::array<uint8_t, kKeysAtOnce>, size_t{1} << kKeysAtOnce>;

constexpr KeyOrders key_orders() {
  KeyOrders orders{};
  for (size_t set = 0; set < orders.size(); ++set) {
    size_t count = 0;
    for (uint8_t lane = 0; lane < kKeysAtOnce; ++lane) {
      if ((set >> lane & 1U) != 0) orders.at(set).at(count++) = lane;
    }
  }
  return orders;
}

constexpr KeyOrders kKeyOrders = key_orders();

__attribute__((target("avx2"))) size_t keep_by_vectors(int32_t last, size_t count, int32_t* keys) {
  const __m256i limit = _mm256_set1_epi32(last);
  size_t kept = 0;
  size_t i = 0;
  for (; i + kKeysAtOnce <= count; i += kKeysAtOnce) {
    const __m256i group = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(keys + i));
    const int beyond = _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpgt_epi32(group, limit)));
    const uint32_t within = ~static_cast<uint32_t>(beyond) & 0xffU;
    const auto* order = reinterpret_cast<const __m128i*>(kKeyOrders[within].data());
    const __m256i lanes = _mm256_cvtepu8_epi32(_mm_loadl_epi64(order));
    // (Overwrites no key that has not been read.)
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(keys + kept), _mm256_permutevar8x32_epi32(group, lanes));
    kept += static_cast<size_t>(std::popcount(within));
  }
  return keep_one_by_one(last, i, count, kept, keys);
}

#endif

}  // namespace

size_t keep_up_to(int32_t last, size_t count, int32_t* keys) {
#if defined(__x86_64__)
  static const bool vectors = __builtin_cpu_supports("avx2") != 0;
  if (vectors) return keep_by_vectors(last, count, keys);
#endif
  return keep_one_by_one(last, 0, count, 0, keys);
}

}  // namespace surfcast::estimation
