#pragma once

#include <cstddef>

namespace surfcast::view {

/// Milliseconds of the link that a frame of a video may take at `fps` frames a second. At low rates it is less than
/// there are: where the link becomes ten times as slow, what is on the way still arrives within 300 ms.
double video_frame_ms(double fps);

/// Bytes of such a frame without its depth, if the link transfers `link_bytes` in this time.
size_t video_bytes(size_t link_bytes, size_t depth_bytes);

/// The factor on width and height with which a frame of so many pixels is worth its bytes: 1, or less where even the
/// coarsest quantizers need more.
double video_scale(size_t bytes, double pixels);

/// The size of JPEG files, in bytes of a file of quality 85 for each pixel.
double jpeg_density(size_t bytes, double pixels, int quality);

/// Whether frames become a video: files of a good quality would not fit. `file_bytes`: of such a file of a frame.
/// `link_bytes`: that the link transfers in video_frame_ms(). `is_video`: of the last frames; a change needs evidence.
bool wants_video(double file_bytes, double link_bytes, bool is_video);

/// The bytes of a file of a good quality.
double good_file_bytes(double density, double pixels);

}  // namespace surfcast::view
