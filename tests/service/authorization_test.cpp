#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include <gmock/gmock.h>

#include "service/render_service_fixture.h"

namespace surfcast::service {
namespace {

using ::testing::ElementsAre;

// A job, a look-up and a list cannot be had without the decision who may know of a model.
template <typename Job, typename Model>
concept MadeOf = requires(const Model& model) {
  Job{model};
};
template <typename Job>
constexpr bool kNeedsDecision =
    MadeOf<Job, access::AuthorizedModel> && !MadeOf<Job, std::string> && !std::is_default_constructible_v<Job>;
static_assert(kNeedsDecision<PictureJob> && kNeedsDecision<PickJob> && kNeedsDecision<ProfileJob> &&
              kNeedsDecision<PointsJob>);

template <typename Model>
concept Describable = requires(RenderService& service, const Model& model, RenderService::DescriptionDone done) {
  service.describe_model(model, done);
  service.edition(model);
};
static_assert(Describable<access::AuthorizedModel> && !Describable<std::string>);

template <typename... Rights>
concept Lists = requires(RenderService& service, RenderService::ListDone done, const Rights&... rights) {
  service.list_models(rights..., done);
};
static_assert(Lists<access::Rights> && !Lists<>);

class AuthorizationTest : public RenderServiceTest {
 protected:
  static access::Rights rights_to(const std::string& model) {
    return access::Rights::of(std::make_shared<const access::Principal>(
        access::Principal{.name = "some", .sha256 = std::string(64, 'a'), .models = {model}}));
  }
  /// Asks and waits.
  ModelList list(const access::Rights& rights) {
    std::promise<ModelList> promise;
    service_->list_models(rights, [&](ModelList list) { promise.set_value(std::move(list)); });
    return promise.get_future().get();
  }
  Result<ModelDescription> describe(const access::AuthorizedModel& model) {
    std::promise<Result<ModelDescription>> promise;
    service_->describe_model(model, [&](auto description) { promise.set_value(std::move(description)); });
    return promise.get_future().get();
  }
};

TEST_F(AuthorizationTest, AListHasWhatTheRightsAllowToKnow) {
  models_.scan_list = {{.model = "cube"}, {.model = "teapot"}};
  start();
  const ModelList some = list(rights_to("cube"));
  EXPECT_THAT(some.names, ElementsAre("cube"));
  ASSERT_EQ(some.scans.size(), 1U);
  EXPECT_EQ(some.scans[0].model, "cube");
  EXPECT_THAT(list(access::Rights::unlimited()).names, ElementsAre("cube", "teapot"));
  const ModelList none = list(access::Rights::of(nullptr));
  EXPECT_TRUE(none.names.empty() && none.scans.empty());
}

TEST_F(AuthorizationTest, AModelThatIsNotAllowedIsAbsent) {
  start();
  const access::Rights rights = rights_to("cube");
  EXPECT_TRUE(describe(rights.authorize("cube")));
  const auto hidden = describe(rights.authorize("teapot"));
  ASSERT_FALSE(hidden);
  EXPECT_EQ(hidden.error().kind, ErrorKind::kNotFound);
  EXPECT_EQ(hidden.error().message, "teapot: there is no such model");

  PictureJob job = job_for("teapot");
  job.model = rights.authorize("teapot");
  const auto picture = draw(1, job).second.get();
  ASSERT_FALSE(picture);
  EXPECT_EQ(picture.error().message, hidden.error().message);
  EXPECT_TRUE(draw(1, job_for("teapot")).second.get());

  models_.cube_edition = 3;
  EXPECT_EQ(service_->edition(rights.authorize("cube")), 3U);
  EXPECT_EQ(service_->edition(rights_to("teapot").authorize("cube")), 0U);
}

}  // namespace
}  // namespace surfcast::service
