#pragma once

#include <boost/beast/core/string_type.hpp>
#include <string_view>

namespace surfcast::net {

/// Text of Beast, whose views are of a type of their own.
inline std::string_view view_of(boost::beast::string_view text) {
  return {text.data(), text.size()};
}

}  // namespace surfcast::net
