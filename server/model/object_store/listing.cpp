#include "object_store/listing.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "object_store/object_url.h"
#include "scan/xml_tree.h"

namespace surfcast::object_store {
namespace {

constexpr std::string_view kExtension = ".surf";

/// Adds the name of an object unless it is no model, or cannot be one directly in the folder.
void add_model(std::string name, std::vector<std::string>& models) {
  const bool within = std::ranges::none_of(name, [](unsigned char c) { return c == '/' || c < ' ' || c == 0x7f; });
  if (within && name.size() > kExtension.size() && name.ends_with(kExtension)) models.push_back(std::move(name));
}

std::string text_of(const scan::XmlNode& node, std::string_view name) {
  const scan::XmlNode* child = node.child(name);
  return child == nullptr ? std::string() : child->text;
}

Result<ListingPage> parse_s3(std::string_view text, std::string_view prefix) {
  const Result<scan::XmlNode> root = scan::parse_xml(text);
  if (!root) return fail(root);
  if (root->name != "ListBucketResult") {
    return fail(ErrorKind::kUnsupported, "the store's list is XML, but not that of S3: <" + root->name + ">");
  }
  ListingPage page;
  for (const scan::XmlNode& object : root->children) {
    const std::string key = object.name == "Contents" ? text_of(object, "Key") : std::string();
    if (key.starts_with(prefix)) add_model(key.substr(prefix.size()), page.models);
  }
  if (text_of(*root, "IsTruncated") == "true") page.next = text_of(*root, "NextContinuationToken");
  return page;
}

Result<ListingPage> parse_json(std::string_view text) {
  const nlohmann::json list = parse_json_text(text);
  if (!list.is_array()) return fail(ErrorKind::kInvalidInput, "the store's list is no JSON");
  ListingPage page;
  for (const nlohmann::json& entry : list) {
    if (!entry.is_object()) continue;
    const auto name = entry.find("name");
    const auto type = entry.find("type");
    if (name == entry.end() || !name->is_string() || (type != entry.end() && *type != "file")) continue;
    add_model(name->get<std::string>(), page.models);
  }
  return page;
}

/// The targets of links; those that leave the folder are left out. A name may be linked more than once.
ListingPage parse_html(std::string_view text) {
  constexpr std::string_view kLink = "href=\"";
  constexpr std::string_view kAmpersand = "&amp;";
  ListingPage page;
  for (size_t at = text.find(kLink); at != std::string_view::npos; at = text.find(kLink, at)) {
    at += kLink.size();
    std::string target(text.substr(at, text.find('"', at) - at));
    for (size_t found = 0; (found = target.find(kAmpersand, found)) != std::string::npos; ++found) {
      target.replace(found, kAmpersand.size(), "&");
    }
    if (target.starts_with("./")) target.erase(0, 2);
    if (target.find_first_of("?#:") == std::string::npos) add_model(decode_percent(target), page.models);
  }
  std::sort(page.models.begin(), page.models.end());
  page.models.erase(std::unique(page.models.begin(), page.models.end()), page.models.end());
  return page;
}

}  // namespace

Result<ListingPage> parse_listing(std::string_view text, std::string_view prefix) {
  const size_t first = text.find_first_not_of(" \t\r\n");
  const std::string_view content = first == std::string_view::npos ? std::string_view() : text.substr(first);
  if (content.starts_with("<?xml") || content.starts_with("<ListBucketResult")) return parse_s3(content, prefix);
  if (content.starts_with('[')) return parse_json(content);
  if (content.starts_with('<')) return parse_html(content);
  return fail(ErrorKind::kUnsupported, "the store answers with no list of objects");
}

}  // namespace surfcast::object_store
