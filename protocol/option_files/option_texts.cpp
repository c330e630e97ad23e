#include "protocol/option_files/option_texts.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace surfcast::protocol {

std::vector<std::string_view> names_of_choice(std::string_view form) {
  std::vector<std::string_view> names;
  for (size_t end = form.find('|'); end != std::string_view::npos; end = form.find('|')) {
    names.push_back(form.substr(0, end));
    form.remove_prefix(end + 1);
  }
  names.push_back(form);
  return names;
}

std::string number_text(double number) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr};
}

std::string wrapped(std::string_view text, std::string_view prefix, size_t width) {
  std::string lines;
  while (!text.empty()) {
    size_t end = text.size();
    if (prefix.size() + end > width) {
      end = text.rfind(' ', width - prefix.size());
      if (end == std::string_view::npos) end = std::min(text.find(' '), text.size());
    }
    lines.append(prefix).append(text.substr(0, end)).append("\n");
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

}  // namespace surfcast::protocol
