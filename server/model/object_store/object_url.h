#pragma once

#include <string>
#include <string_view>

#include "base/result.h"
#include "object_store/store_config.h"

namespace surfcast::object_store {

/// True for http://, https:// and s3:// URLs: what they name is no file of this machine.
bool is_object_url(std::string_view text);

/// Text as it stands in a path of a URL: all but letters, digits, "-", ".", "_", "~" and "/" as %XX, as signatures want
/// it.
std::string encode_path(std::string_view text);
/// The same for a value of a query, where "/" is %2F.
std::string encode_query(std::string_view text);
/// Text without %XX; a percent sign that begins none stays.
std::string decode_percent(std::string_view text);

/// A URL as people may see it: without the query, which may hold a signature.
std::string shown_url(std::string_view url);
/// True if the object of a URL is a model by its name, which ends with ".surf".
bool is_model_url(std::string_view url);
/// The name under which the object of a URL is served: of "https://host/a/church%201.surf?key=7" it is "church 1".
std::string object_name(std::string_view url);

/// Where an object, or a folder of objects, is.
struct StorePlace {
  std::string url;     ///< http or https. Of a folder in S3 that of its bucket, without a query
  std::string prefix;  ///< of a folder in S3: how the keys of its objects begin
  bool s3 = false;     ///< speaks S3, and requests are signed if there are credentials
};

/// The place of a URL. Fails if it is none, or contains credentials, which would be logged.
Result<StorePlace> place_of(std::string_view url, const StoreConfig& config);
/// The place of a folder, whose URL ends with a slash.
Result<StorePlace> folder_of(std::string_view url, const StoreConfig& config);

}  // namespace surfcast::object_store
