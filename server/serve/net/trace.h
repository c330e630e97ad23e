#pragma once

#include <string>
#include <string_view>

namespace surfcast::net {

/// The header `traceparent` of an answer: the trace that the request's names,
/// with a span of our own (W3C Trace Context, 3.2). Empty: the request names
/// none.
std::string answered_trace(std::string_view traceparent);

}  // namespace surfcast::net
