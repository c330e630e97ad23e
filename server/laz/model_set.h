#pragma once

#include <array>
#include <cstddef>
#include <memory>

#include "laz/symbol_model.h"

namespace surfcast::laz {

/// Models selected by an earlier value. Few of those values occur in a chunk, so a model is made when it is first used.
template <uint32_t kSymbols, size_t kCount>
class ModelSet {
 public:
  SymbolModel<kSymbols>& operator[](size_t context) {
    auto& model = models_[context];
    if (!model) [[unlikely]]
      model = std::make_unique<SymbolModel<kSymbols>>();
    return *model;
  }

 private:
  std::array<std::unique_ptr<SymbolModel<kSymbols>>, kCount> models_;
};

}  // namespace surfcast::laz
