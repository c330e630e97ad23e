#include "object_store/object_url.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <filesystem>

namespace surfcast::object_store {
namespace {

constexpr std::string_view kS3 = "s3://";

std::string encode(std::string_view text, std::string_view kept) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string encoded;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (byte < 128 && std::isalnum(byte) != 0) || kept.find(c) != std::string_view::npos;
    if (plain) {
      encoded += c;
    } else {
      encoded += {'%', kDigits[byte >> 4], kDigits[byte & 15]};
    }
  }
  return encoded;
}

/// A bucket and the key, or prefix of keys, in it.
struct S3Name {
  std::string bucket;
  std::string key;
};

Result<S3Name> split_s3(std::string_view url) {
  const std::string_view rest = url.substr(kS3.size());
  const size_t slash = rest.find('/');
  const std::string_view bucket = rest.substr(0, slash);
  const bool plain = std::ranges::all_of(
      bucket, [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '.' || c == '_'; });
  if (bucket.empty() || !plain || slash == std::string_view::npos) {
    return fail(ErrorKind::kInvalidInput, std::string(url) + ": not like s3://BUCKET/KEY");
  }
  return S3Name{std::string(bucket), std::string(rest.substr(slash + 1))};
}

/// The URL of a bucket, without a slash at its end. A name with dots is no single label of a host's certificate.
std::string bucket_url(const std::string& bucket, const StoreConfig& config) {
  if (!config.endpoint.empty()) {
    std::string_view endpoint = config.endpoint;
    while (endpoint.ends_with('/')) endpoint.remove_suffix(1);
    return std::string(endpoint) + "/" + bucket;
  }
  if (bucket.find('.') != std::string::npos) return "https://s3." + config.region + ".amazonaws.com/" + bucket;
  return "https://" + bucket + ".s3." + config.region + ".amazonaws.com";
}

/// Fails for what is not like http://HOST/PATH.
Status check_http(std::string_view url) {
  const size_t host = url.find("://") + 3;
  const size_t path = url.find('/', host);
  const std::string_view authority = url.substr(host, path == std::string_view::npos ? path : path - host);
  if (authority.empty() || path == std::string_view::npos) {
    return fail(ErrorKind::kInvalidInput, std::string(url) + ": not like https://HOST/PATH");
  }
  if (authority.find('@') != std::string_view::npos) {
    return fail(ErrorKind::kInvalidInput, "the URL of a model contains a password, which would be logged");
  }
  return {};
}

/// The last part of the path of a URL, as a name of a file.
std::filesystem::path file_name(std::string_view url) {
  const std::string path = shown_url(url);
  const std::string last = path.substr(path.rfind('/') + 1);
  return url.starts_with(kS3) ? last : decode_percent(last);
}

}  // namespace

bool is_object_url(std::string_view text) {
  return text.starts_with("https://") || text.starts_with("http://") || text.starts_with(kS3);
}

std::string encode_path(std::string_view text) {
  return encode(text, "-._~/");
}

std::string encode_query(std::string_view text) {
  return encode(text, "-._~");
}

std::string decode_percent(std::string_view text) {
  std::string decoded;
  for (size_t i = 0; i < text.size(); ++i) {
    unsigned value = 0;
    const char* digits = text.data() + i + 1;
    if (text[i] == '%' && i + 2 < text.size() && std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2) {
      decoded += static_cast<char>(value);
      i += 2;
    } else {
      decoded += text[i];
    }
  }
  return decoded;
}

std::string shown_url(std::string_view url) {
  if (url.starts_with(kS3)) return std::string(url);  // a key may contain any character
  return std::string(url.substr(0, url.find_first_of("?#")));
}

bool is_model_url(std::string_view url) {
  return file_name(url).extension() == ".surf";
}

std::string object_name(std::string_view url) {
  return file_name(url).stem().string();
}

Result<StorePlace> place_of(std::string_view url, const StoreConfig& config) {
  if (!url.starts_with(kS3)) {
    if (Status status = check_http(url); !status) return fail(status);
    return StorePlace{std::string(url), {}, false};
  }
  return split_s3(url).map([&](const S3Name& name) {
    return StorePlace{bucket_url(name.bucket, config) + "/" + encode_path(name.key), {}, true};
  });
}

Result<StorePlace> folder_of(std::string_view url, const StoreConfig& config) {
  if (!url.starts_with(kS3)) return place_of(url, config);
  return split_s3(url).map([&](const S3Name& name) {
    return StorePlace{bucket_url(name.bucket, config) + "/", name.key, true};
  });
}

}  // namespace surfcast::object_store
