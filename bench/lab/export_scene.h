#pragma once

#include <filesystem>

#include "lab/subject.h"

namespace surfcast::lab {

/// Writes a subject for other programs (bench/peers/scene_files.py): NAME.ply with the surfels of the finest level
/// (position, normal, radius, colour), NAME.json with camera and resolution, and NAME.ideal.ppm.
void export_scene(const Subject& subject, const std::filesystem::path& folder);

}  // namespace surfcast::lab
