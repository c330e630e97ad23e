#pragma once

#include <string>
#include <string_view>

#include "net/http_answer.h"

namespace surfcast::net {

/// 401 for programs: the request names no token, or one that is not good.
HttpAnswer denied_answer();
/// 403: the token is good, but not for that.
HttpAnswer forbidden_answer();
/// 401 for browsers: a page that asks for the token. `problem`: what was wrong with the last one; empty: nothing.
HttpAnswer login_page(std::string_view problem);
/// Back to the viewer, with that cookie.
HttpAnswer login_answer(std::string cookie);

}  // namespace surfcast::net
