#pragma once

#include <memory>
#include <string>

#include <proj.h>
#include <proj_experimental.h>  // to make systems; its functions have been the same since PROJ 7

#include "crs/coordinate_system.h"

namespace surfcast::crs {

template <auto Destroy>
struct Destroyer {
  template <typename T>
  void operator()(T* object) const {
    Destroy(object);
  }
};

using Context = std::unique_ptr<PJ_CONTEXT, Destroyer<&proj_context_destroy>>;
using Object = std::unique_ptr<PJ, Destroyer<&proj_destroy>>;
using ObjectList = std::unique_ptr<PJ_OBJ_LIST, Destroyer<&proj_list_destroy>>;
using FactoryContext =
    std::unique_ptr<PJ_OPERATION_FACTORY_CONTEXT, Destroyer<&proj_operation_factory_context_destroy>>;

/// A context for one thread at a time: silent, and without the network.
Context make_context();

/// The system of `wkt`, without a bound transformation around it. Null if PROJ cannot read it.
Object parse_system(PJ_CONTEXT* context, const std::string& wkt);

/// The horizontal part of a compound system, otherwise the system; of two dimensions unless it is geocentric.
Object horizontal_part(PJ_CONTEXT* context, const PJ* system);

/// The properties of a parsed system.
CoordinateSystem describe(PJ_CONTEXT* context, const PJ* system);

/// Metres of a unit of heights of a vertical system; 1 if that is unknown.
double vertical_unit(PJ_CONTEXT* context, const PJ* vertical);

/// What PROJ says about its last error in this context.
std::string last_problem(PJ_CONTEXT* context);

}  // namespace surfcast::crs
