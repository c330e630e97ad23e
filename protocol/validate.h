#pragma once

#include "base/result.h"
#include "surfcast.pb.h"

namespace surfcast::protocol {

inline constexpr uint32_t kDefaultWidth = 1280;  ///< pixels
inline constexpr uint32_t kDefaultHeight = 720;  ///< pixels
inline constexpr uint32_t kDefaultQuality = 90;  ///< of JPEG and WebP
inline constexpr double kDefaultViewAngle = 30;  ///< vertical, degrees
inline constexpr size_t kMaxModelNameBytes = 512;
inline constexpr int kMaxClipBoxes = 32;
inline constexpr uint32_t kMaxClassCode = 255;
inline constexpr double kMaxEyeDomeStrength = 100;
inline constexpr double kMaxEyeDomeRadius = 8;        ///< pixels
inline constexpr double kDefaultEyeDomeRadius = 1.5;  ///< pixels

/// Whether a request for a picture means something, whatever the model and the device: numbers finite and in range,
/// choices known, the camera whole. Limits of the server (resolution) are not looked at here.
Status check_picture(const wire::DrawPicture& picture);

inline constexpr double kMaxFramesPerSecond = 1000;  ///< that a view may ask for

/// The same for a view to be opened.
Status check_view(const wire::OpenView& view);

}  // namespace surfcast::protocol
