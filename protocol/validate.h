#pragma once

#include <string>

#include "base/result.h"
#include "surfcast.pb.h"

namespace surfcast::protocol {

inline constexpr uint32_t kDefaultWidth = 1280;    ///< pixels
inline constexpr uint32_t kDefaultHeight = 720;    ///< pixels
inline constexpr uint32_t kDefaultQuality = 90;    ///< of JPEG and WebP
inline constexpr double kDefaultViewAngle = 30;    ///< vertical, degrees
inline constexpr size_t kMaxModelNameBytes = 512;  ///< of one model
inline constexpr size_t kMaxJoinedModels = 64;
inline constexpr int kMaxClipBoxes = 32;
inline constexpr uint32_t kMaxClassCode = 255;
inline constexpr double kMaxEyeDomeStrength = 100;
inline constexpr double kMaxEyeDomeRadius = 8;        ///< pixels
inline constexpr double kDefaultEyeDomeRadius = 1.5;  ///< pixels
inline constexpr int kMaxTransferPoints = 256;
inline constexpr int kMaxIsoSurfaces = 8;
inline constexpr int kMaxSlices = 8;
inline constexpr size_t kMaxAttributeBytes = 255;
inline constexpr int kMaxThresholds = 8;
inline constexpr int kMaxLights = 64;
inline constexpr double kMaxSharpness = 10;

/// Checks the name of a model, or the names of models that are joined by plus signs.
Status check_model_name(const std::string& name);

/// Checks a picture request as far as this is possible without the model and the device: numbers are finite and in
/// range, enum values are known, the camera is complete. The server's limits (resolution) are not checked.
Status check_picture(const wire::DrawPicture& picture);

inline constexpr double kMaxFramesPerSecond = 1000;  ///< upper limit of OpenView.target_fps

/// The same for the picture of a view, which has no channels.
Status check_view_picture(const wire::DrawPicture& picture);
/// The same for a request to open a view.
Status check_view(const wire::OpenView& view);

}  // namespace surfcast::protocol
