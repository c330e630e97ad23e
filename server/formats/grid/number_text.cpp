#include "grid/number_text.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "scan/text_tokens.h"

namespace surfcast::grid {

uint64_t NumberText::at_most() const {
  // A number is at least a digit and a space.
  const uint64_t numbers = (source_->at_most() + (filled_ - used_) + 1) / 2;
  return std::min(left_, numbers) * scan::size_of(type_) + (value_size_ - value_used_);
}

/// The next word, of at most the buffer's size; empty at the end.
Result<std::string_view> NumberText::next_word() {
  for (;;) {
    while (used_ < filled_ && scan::is_space(text_[used_])) ++used_;
    const char* const end = std::find_if(text_.data() + used_, text_.data() + filled_, scan::is_space);
    const auto size = static_cast<size_t>(end - (text_.data() + used_));
    const std::string_view word(text_.data() + used_, size);
    if (used_ + size < filled_ || size == text_.size()) {
      used_ += size;
      return word;
    }
    std::memmove(text_.data(), text_.data() + used_, size);
    const auto read = source_->read(std::as_writable_bytes(std::span(text_).subspan(size)));
    if (!read) return fail(read);
    used_ = *read == 0 ? size : 0;
    filled_ = size + *read;
    if (*read == 0) return std::string_view(text_.data(), size);
  }
}

Status NumberText::parse_next() {
  const Result<std::string_view> word = next_word();
  if (!word) return fail(word);
  if (word->empty()) return fail(ErrorKind::kInvalidInput, "truncated: the numbers end too early");
  return scan::with_type(type_, [&](auto zero) -> Status {
    const auto number = scan::parse_number<decltype(zero)>(*word);
    if (!number) {
      return fail(ErrorKind::kInvalidInput, "not a number of the samples' type: " + scan::printable(*word));
    }
    std::memcpy(value_.data(), &*number, sizeof(*number));
    value_size_ = sizeof(*number);
    value_used_ = 0;
    return {};
  });
}

Result<size_t> NumberText::read(std::span<std::byte> out) {
  size_t done = 0;
  while (done < out.size()) {
    if (value_used_ == value_size_) {
      if (left_ == 0) break;
      if (Status status = parse_next(); !status) return fail(status);
      --left_;
    }
    const size_t part = std::min(value_size_ - value_used_, out.size() - done);
    std::memcpy(out.data() + done, value_.data() + value_used_, part);
    value_used_ += part;
    done += part;
  }
  return done;
}

}  // namespace surfcast::grid
