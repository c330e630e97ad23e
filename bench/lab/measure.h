#pragma once

#include <filesystem>

#include "lab/subject.h"

namespace surfcast::lab {

/// Draws a subject with every method: the still view `frames` times, and the slow path once. The methods take turns, so
/// that other load on the machine affects them equally. Writes the still pictures to the folder `pictures` unless it is
/// empty.
SceneResult measure(const Subject& subject, int frames, const std::filesystem::path& pictures, Methods& methods);

}  // namespace surfcast::lab
