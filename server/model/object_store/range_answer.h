#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "object_store/http_module.h"

namespace surfcast::object_store {

/// A version of an object: what a store stated of it when it was opened.
struct ObjectVersion {
  std::string etag;  ///< a strong one, with its quotation marks
  uint64_t size = 0;
};

/// What is wrong with an answer. If it may be well later, the request may be sent again.
struct AnswerFault {
  Error error;
  bool again = false;
  std::string detail{};  ///< what else is known; may name hosts
};

/// The value of a header "Content-Range: bytes FIRST-LAST/SIZE"; none for any other.
struct ContentRange {
  uint64_t first = 0;
  uint64_t last = 0;
  uint64_t size = 0;  ///< of the whole object
};
std::optional<ContentRange> parse_content_range(std::string_view text);

/// True for a validator by which If-Match compares: "..." but not W/"...".
bool is_strong_etag(std::string_view text);

/// Checks the answer to a request for a range of an object whose version is known: status 206, exactly that range, that
/// version, all bytes. None: the body is what was asked for.
std::optional<AnswerFault> check_range_answer(const HttpAnswer& answer, const ByteRange& asked,
                                              const ObjectVersion& version);

/// Checks the first answer, for the first bytes of an object, which may have fewer, and reads the version.
std::optional<AnswerFault> check_first_answer(const HttpAnswer& answer, uint64_t most, ObjectVersion& version);

/// Checks the answer to a request without a range, of which status 200 is wanted.
std::optional<AnswerFault> check_whole_answer(const HttpAnswer& answer);

/// True if the object of an answer was written after `opened`, a time by the clock of the store. Times are whole
/// seconds, so one that was written within the same second passes, and so does one whose time is not known.
bool is_newer(const HttpAnswer& answer, std::optional<int64_t> opened);

}  // namespace surfcast::object_store
