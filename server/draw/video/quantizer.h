#pragma once

#include <cstddef>

namespace surfcast::video {

/// How many bytes pictures take: 2^(complexity - steepness * quantizer) for each pixel. Key frames depend less on the
/// quantizer than frames that refer to others.
struct SizeModel {
  double complexity = 0;
  double steepness = 0;
};

/// Of the first key frame of a stream.
inline constexpr SizeModel kFirstKeySizes{-2.5, 0.07};

/// Of the frames that refer to others, after the first key frame: they take no more than that.
SizeModel sizes_after_key(int quantizer, double bytes, double pixels);

/// Of a picture that is larger than the one it refers to, which lacks its finer detail. With a fifth or a quarter more
/// width, it was measured to take 2^0.5 to 2^0.9 times the bytes for each pixel.
SizeModel sizes_of_larger(const SizeModel& model);

/// The finest quantizer with which a picture of so many pixels is expected to take at most `bytes`.
int quantizer_for(const SizeModel& model, double bytes, double pixels);

/// The model after a picture that took `bytes`. One that took more than expected counts at once, so that the next one
/// does not; one that took less by half.
SizeModel learned(const SizeModel& model, int quantizer, double bytes, double pixels);

}  // namespace surfcast::video
