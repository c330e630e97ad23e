#include "object_store/range_answer.h"

#include <algorithm>
#include <charconv>

#include "object_store/object_url.h"

namespace surfcast::object_store {
namespace {

constexpr int kOk = 200;
constexpr int kPartial = 206;

/// The number at the start of `text`, which is taken off.
std::optional<uint64_t> take_number(std::string_view& text) {
  uint64_t number = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (code != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<size_t>(end - text.data()));
  return number;
}

bool take_text(std::string_view& text, std::string_view expected) {
  if (!text.starts_with(expected)) return false;
  text.remove_prefix(expected.size());
  return true;
}

AnswerFault lasting(ErrorKind kind, std::string message) {
  return {{kind, std::move(message)}, false};
}

AnswerFault passing(std::string message) {
  return {{ErrorKind::kUnavailable, std::move(message)}, true};
}

AnswerFault replaced() {
  return lasting(ErrorKind::kReplaced, "was replaced in the store since it was opened");
}

/// What a status other than the wanted one says.
AnswerFault fault_of_status(const HttpAnswer& answer) {
  const std::string said = "the store answers " + std::to_string(answer.status);
  switch (answer.status) {
    case kOk:
      return lasting(ErrorKind::kUnsupported, said + ": it sends whole objects where a range is asked for");
    case 401:
    case 403:
      return lasting(ErrorKind::kIo, said + ": it does not allow reading");
    case 404:
    case 410:
      return lasting(ErrorKind::kNotFound, said + ": there is no such object");
    case 412:
      return replaced();
    case 416:
      return lasting(ErrorKind::kInvalidInput, said + ": the object has no such bytes");
    case 408:
    case 429:
      return passing(said);
    default:
      break;
  }
  if (answer.status >= 500) return passing(said);
  if (answer.status / 100 == 3) {
    AnswerFault fault = lasting(ErrorKind::kUnsupported, said + ", a redirection, which is not followed");
    fault.detail = shown_url(answer.location);
    return fault;
  }
  return lasting(ErrorKind::kIo, said);
}

AnswerFault silence(std::string why) {
  AnswerFault fault = passing("the store does not answer");
  fault.detail = std::move(why);
  return fault;
}

/// Faults that answers of every kind may have.
std::optional<AnswerFault> check_status(const HttpAnswer& answer, int wanted) {
  if (!answer.fault.empty()) return silence(answer.fault);
  if (answer.status != wanted) return fault_of_status(answer);
  return std::nullopt;
}

AnswerFault wrong_range(const HttpAnswer& answer) {
  return lasting(ErrorKind::kInvalidInput,
                 "the store sends other bytes than were asked for (Content-Range: " + answer.content_range + ")");
}

std::optional<AnswerFault> check_length(const HttpAnswer& answer, uint64_t bytes) {
  if (answer.body.size() == bytes) return std::nullopt;
  return passing("the store's answer was cut off");
}

}  // namespace

std::optional<ContentRange> parse_content_range(std::string_view text) {
  if (!take_text(text, "bytes ")) return std::nullopt;
  const std::optional<uint64_t> first = take_number(text);
  if (!first || !take_text(text, "-")) return std::nullopt;
  const std::optional<uint64_t> last = take_number(text);
  if (!last || !take_text(text, "/")) return std::nullopt;
  const std::optional<uint64_t> size = take_number(text);
  if (!size || !text.empty() || *first > *last || *last >= *size) return std::nullopt;
  return ContentRange{*first, *last, *size};
}

bool is_strong_etag(std::string_view text) {
  return text.size() > 2 && text.front() == '"' && text.back() == '"';
}

std::optional<AnswerFault> check_range_answer(const HttpAnswer& answer, const ByteRange& asked,
                                              const ObjectVersion& version) {
  if (std::optional<AnswerFault> fault = check_status(answer, kPartial)) return fault;
  const std::optional<ContentRange> range = parse_content_range(answer.content_range);
  if (!range) return wrong_range(answer);
  if (range->size != version.size || (!answer.etag.empty() && answer.etag != version.etag)) return replaced();
  if (range->first != asked.offset || range->last + 1 != asked.end()) return wrong_range(answer);
  return check_length(answer, asked.size);
}

std::optional<AnswerFault> check_first_answer(const HttpAnswer& answer, uint64_t most, ObjectVersion& version) {
  if (std::optional<AnswerFault> fault = check_status(answer, kPartial)) return fault;
  const std::optional<ContentRange> range = parse_content_range(answer.content_range);
  if (!range || range->first != 0 || range->last + 1 != std::min(most, range->size)) return wrong_range(answer);
  if (!is_strong_etag(answer.etag)) {
    return lasting(ErrorKind::kUnsupported,
                   "the store states no strong ETag, so that a replaced object could not be told from the former one");
  }
  version = {answer.etag, range->size};
  return check_length(answer, range->last + 1);
}

std::optional<AnswerFault> check_whole_answer(const HttpAnswer& answer) {
  return check_status(answer, kOk);
}

bool is_newer(const HttpAnswer& answer, std::optional<int64_t> opened) {
  return opened && answer.written && *answer.written > *opened;
}

}  // namespace surfcast::object_store
