#pragma once

#include <cstddef>
#include <string_view>

namespace surfcast::client {

/// Ends a JPEG file whose last scans are left out.
inline constexpr std::string_view kEndOfJpeg = "\xff\xd9";

/// How much of a progressive JPEG file can be shown before the rest has come: its complete scans, once the first
/// component (the brightness) has all frequencies, if roughly. Before that, the picture is less sharp than a frame in
/// motion. Bytes from the beginning; with kEndOfJpeg they are a file. 0: nothing yet, or no progressive JPEG.
size_t showable_bytes(std::string_view begun);

}  // namespace surfcast::client
