#pragma once

#include <array>
#include <cstddef>
#include <memory>

#include "laz/symbol_model.h"

namespace surfcast::laz {

/// Models indexed by a previous value. Few of the values occur in a chunk, so models are created on first use.
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
