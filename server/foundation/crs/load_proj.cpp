#include "crs/load_proj.h"

#include "base/contract.h"
#include "base/load_module.h"

namespace surfcast::crs {

const Result<const ProjFunctions*>& load_proj() {
  static const Result<const ProjFunctions*> functions =
      load_function(kProjModule, kProjSymbol)
          .map([](void* symbol) { return reinterpret_cast<ProjSymbolType*>(symbol)(); })
          .map_error([](const Error& error) {
            return Error{error.kind, "coordinate systems: " + error.message};
          });
  return functions;
}

const ProjFunctions& loaded_proj() {
  const Result<const ProjFunctions*>& functions = load_proj();
  SURFCAST_EXPECTS(functions.has_value());
  return **functions;
}

}  // namespace surfcast::crs
