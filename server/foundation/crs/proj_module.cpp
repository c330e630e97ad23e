#include "crs/proj_module.h"

#include "crs/proj_functions.h"

extern "C" const surfcast::crs::ProjFunctions* surfcast_proj_functions() {
  namespace proj = surfcast::crs::proj;
  static constexpr surfcast::crs::ProjFunctions kFunctions{
      &proj::read_system,       &proj::are_same,       &proj::metric_system, &proj::degrees_of,
      &proj::is_in_area_of_use, &proj::find_operation, &proj::apply};
  return &kFunctions;
}
