#pragma once

#include "crs/proj_module.h"

namespace surfcast::crs {

/// Loads the module that uses PROJ, at the first call. PROJ links curl and some 30 other libraries, so commands that
/// meet no coordinate system do not load it. Thread-safe.
const Result<const ProjFunctions*>& load_proj();

/// The functions of the module that is loaded: whoever has a CoordinateSystem has read it by the module.
const ProjFunctions& loaded_proj();

}  // namespace surfcast::crs
