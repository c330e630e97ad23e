#include "worker/offered_models.h"

#include <utility>
#include <vector>

#include "service/guarded.h"

namespace surfcast::worker {

OfferedModel joined_model(const OfferJoin& offer, const OfferedModels& models) {
  std::vector<model::Member> members;
  for (const OfferJoin::Part& part : offer.parts) {
    const auto found = models.find(part.model);
    if (found == models.end()) return fail(ErrorKind::kInternal, "a model of several that was not offered");
    if (!found->second) return fail(found->second);
    members.push_back({part.name, *found->second, part.places});
  }
  return service::guarded([&] { return model::ModelFile::join(std::move(members)); }).map([](model::ModelFile joined) {
    return std::make_shared<const model::ModelFile>(std::move(joined));
  });
}

}  // namespace surfcast::worker
