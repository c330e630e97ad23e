#pragma once

#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include "service/fake_models.h"
#include "service/render_service.h"

namespace surfcast::service {

/// A service of the fake models.
class RenderServiceTest : public ::testing::Test {
 protected:
  /// Still pictures are not drawn in the middle of others unless the limits say so.
  void start(ServiceLimits limits = {}) {
    if (limits.still_turn == ServiceLimits().still_turn) limits.still_turn = std::chrono::hours(1);
    auto started = RenderService::start(models_, fake_renderers(control_), limits);
    ASSERT_TRUE(started);
    service_ = std::move(*started);
  }
  std::pair<JobId, std::future<Result<EncodedPicture>>> draw(const Client& client, PictureJob job) {
    const auto promise = std::make_shared<std::promise<Result<EncodedPicture>>>();
    const JobId id = service_->draw(client, std::move(job), [promise](auto result) { promise->set_value(result); });
    return {id, promise->get_future()};
  }
  void wait_for_drawing(int pictures) const {
    while (control_->drawn < pictures) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  void wait_for_warm_ups(int steps) const {
    while (control_->warmed_up < steps) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  static PictureJob job_for(const std::string& model) {
    PictureJob job{authorized(model)};
    job.request.width = 8;
    job.request.height = 4;
    return job;
  }
  static PictureJob motion_of(const std::string& model) {
    PictureJob job = job_for(model);
    job.request.viewer = 1;
    job.priority = Priority::kMotion;
    return job;
  }

  FakeModels models_;
  std::shared_ptr<FakeRendererControl> control_ = std::make_shared<FakeRendererControl>();
  std::unique_ptr<RenderService> service_;
};

}  // namespace surfcast::service
