#include "net/http_login.h"

#include <utility>

namespace surfcast::net {
namespace {

constexpr std::string_view kBegin =
    "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>Surfcast</title>"
    "<meta name=\"viewport\" content=\"width=device-width\">"
    "<style>body{font:16px sans-serif;background:#16181c;color:#e8e8e8;display:grid;place-items:center;height:90vh}"
    "form{display:grid;gap:12px;width:22em}input,button{font:inherit;padding:8px;border-radius:6px;border:1px solid "
    "#555;background:#22252b;color:inherit}button{background:#2f6feb;border:0}p{margin:0;color:#ff9a8a}</style></head>"
    "<body><form method=\"post\" action=\"/api/login\"><label for=\"token\">Token</label>"
    "<input id=\"token\" name=\"token\" type=\"password\" autocomplete=\"current-password\" autofocus required>"
    "<button>Log in</button>";
constexpr std::string_view kEnd = "</form></body></html>\n";

/// `reason` needs no escapes.
HttpAnswer denial(unsigned status, std::string_view reason) {
  HttpAnswer answer = text_answer(
      "{\n  \"error\": {\n    \"kind\": \"denied\",\n    \"message\": \"" + std::string(reason) + "\"\n  }\n}\n",
      "application/json");
  answer.status = status;
  return answer;
}

}  // namespace

HttpAnswer forbidden_answer() {
  return denial(403, "this token may not do that");
}

HttpAnswer denied_answer() {
  HttpAnswer answer = denial(401, "a token is missing, or is not good");
  answer.headers = {{"WWW-Authenticate", "Bearer realm=\"surfcast\""}, {"Cache-Control", "no-store"}};
  return answer;
}

HttpAnswer login_page(std::string_view problem) {
  const std::string note = problem.empty() ? "" : "<p role=\"alert\">" + std::string(problem) + "</p>";
  HttpAnswer answer = text_answer(std::string(kBegin) + note + std::string(kEnd), "text/html; charset=utf-8");
  answer.status = 401;
  answer.headers = {{"WWW-Authenticate", "Bearer realm=\"surfcast\""},
                    {"Cache-Control", "no-store"},
                    {"Content-Security-Policy",
                     "default-src 'none'; style-src 'unsafe-inline'; form-action 'self'; base-uri 'none'; "
                     "frame-ancestors 'none'"}};
  return answer;
}

HttpAnswer login_answer(std::string cookie) {
  HttpAnswer answer = text_answer("", "text/plain");
  answer.status = 303;
  answer.headers = {{"Location", "/"}, {"Cache-Control", "no-store"}, {"Set-Cookie", std::move(cookie)}};
  return answer;
}

}  // namespace surfcast::net
