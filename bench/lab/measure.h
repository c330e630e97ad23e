#pragma once

#include <filesystem>

#include "lab/subject.h"

namespace surfcast::lab {

/// Draws a subject with every method: the still view `frames` times, and the slow path once. The methods take turns, so
/// that other load on the machine affects them equally. Writes the still pictures to the folder `pictures` unless it is
/// empty.
SceneResult measure(const Subject& subject, int frames, const std::filesystem::path& pictures, Methods& methods);

/// Leaves out points of a scene's scan and measures in which colours the methods draw their places. The scene has a
/// place. The methods then have the model of the points that were kept.
LeaveOutFigures measure_left_out(const LabScene& scene, const std::filesystem::path& folder, Methods& methods);

}  // namespace surfcast::lab
