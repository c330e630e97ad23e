#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace surfcast::object_store {

/// A page of the objects of a folder.
struct ListingPage {
  std::vector<std::string> models;  ///< names within the folder of the objects that end with ".surf"
  std::string next;                 ///< of S3: what asks for the next page; empty: this is the last one
};

/// Reads a page: the XML of S3 (ListObjectsV2), or the index that nginx and others make of a folder, as JSON or HTML.
/// `prefix`: how the keys of S3 begin; those of folders further down are left out.
Result<ListingPage> parse_listing(std::string_view text, std::string_view prefix);

}  // namespace surfcast::object_store
