#pragma once

#include <filesystem>

#include "lab/subject.h"

namespace surfcast::lab {

/// Draws a subject with every method: `frames` times the still view, the methods in turn so that load on the machine
/// strikes them alike, and once the slow path. Keeps the still pictures in `pictures` unless that is empty.
SceneResult measure(const Subject& subject, int frames, const std::filesystem::path& pictures, Methods& methods);

}  // namespace surfcast::lab
