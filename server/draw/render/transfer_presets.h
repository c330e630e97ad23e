#pragma once

#include <vector>

#include "model/volume.h"
#include "picture/transfer.h"

namespace surfcast::render {

/// The points of a preset for a volume. Those for CT are stated in Hounsfield units, for a scale from -1000 to 1000: at
/// `first` and `last` if these are stated; else the values themselves if some lie below -500, the whole range of
/// volumes of 8 bits, and 2000 from the lowest value on of others. Those for MR and gray go from the lowest value to
/// the one that a hundredth of the samples exceeds. kAuto is that of CT with skin where the values are Hounsfield
/// units; elsewhere it goes from the end of the background, which the histogram tells, to the value that 1 in 200
/// samples exceeds.
std::vector<picture::TransferPoint> preset_points(const picture::Transfer& transfer, const model::Volume& volume);

}  // namespace surfcast::render
