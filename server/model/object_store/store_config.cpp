#include "object_store/store_config.h"

#include <cstdlib>

namespace surfcast::object_store {
namespace {

void read_variable(const char* name, std::string& target) {
  const char* value = std::getenv(name);
  if (value != nullptr && *value != '\0') target = value;
}

}  // namespace

void read_environment(StoreConfig& config) {
  read_variable("AWS_ACCESS_KEY_ID", config.credentials.key);
  read_variable("AWS_SECRET_ACCESS_KEY", config.credentials.secret);
  read_variable("AWS_SESSION_TOKEN", config.credentials.session);
  read_variable("AWS_DEFAULT_REGION", config.region);
  read_variable("AWS_REGION", config.region);
  read_variable("AWS_ENDPOINT_URL", config.endpoint);
}

}  // namespace surfcast::object_store
