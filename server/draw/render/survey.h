#pragma once

#include <bitset>
#include <list>
#include <memory>
#include <string>
#include <vector>

#include "picture/picture.h"
#include "selection/visibility.h"

namespace surfcast::render {

/// All that determines which surfaces of a model a picture shows in which pixel.
struct ShownPart {
  geometry::CameraFrame frame;
  double spacing = 0;
  geometry::Clip clip;
  std::bitset<256> hidden_classes;
  std::vector<std::string> hidden_models;

  [[nodiscard]] bool operator==(const ShownPart& other) const;
};

/// The spacing of the survey of a picture, pixels: a small part of its surfels is drawn.
[[nodiscard]] double survey_spacing(double spacing);

/// The number of surfels above which a picture is surveyed. One surface that fills the picture needs a seventh; views
/// of whole scans have about that, views from the ground several times more.
[[nodiscard]] double surfels_worth_a_survey(int width, int height, double spacing);

/// What the surveys of the most recent pictures of a model have found.
class Surveys {
 public:
  using Found = std::shared_ptr<const selection::Visibility>;

  /// Null if there is none.
  [[nodiscard]] Found find(const ShownPart& shown);
  /// That of a picture from the same camera, of any size and spacing. Null if there is none.
  [[nodiscard]] Found find_from_camera(const ShownPart& shown) const;
  void keep(ShownPart shown, Found visible);

 private:
  struct Survey {
    ShownPart shown;
    Found visible;
  };
  std::list<Survey> surveys_;  ///< most recent first
};

}  // namespace surfcast::render
