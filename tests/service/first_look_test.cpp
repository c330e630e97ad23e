#include "service/first_look.h"

#include <gtest/gtest.h>

namespace surfcast::service {
namespace {

using picture::Shading;
using picture::SurfelColor;

model::ModelInfo scan_without_colors() {
  model::ModelInfo info;
  info.surfels = 100;
  return info;
}

void expect_unchanged(const picture::PictureRequest& request, const model::ModelInfo& info) {
  const picture::PictureRequest looked = with_first_look(request, info);
  EXPECT_EQ(looked.shading, request.shading);
  EXPECT_EQ(looked.coloring.source, request.coloring.source);
  EXPECT_EQ(looked.eye_dome.strength, request.eye_dome.strength);
}

TEST(FirstLookTest, AScanWithoutColorsIsColoredByElevationAndLit) {
  const picture::PictureRequest looked = with_first_look({}, scan_without_colors());
  EXPECT_EQ(looked.coloring.source, SurfelColor::kElevation);
  EXPECT_EQ(looked.shading, Shading::kLit);
  EXPECT_GT(looked.eye_dome.strength, 0);
}

TEST(FirstLookTest, AnIntensityThatVariesIsShownInGreyAndNowhereBlack) {
  model::ModelInfo info = scan_without_colors();
  info.ranges = {{"intensity", 0, 900, 100, 500}};
  const picture::PictureRequest looked = with_first_look({}, info);
  EXPECT_EQ(looked.coloring.source, SurfelColor::kIntensity);
  EXPECT_EQ(looked.coloring.map, picture::ColorMap::kGray);
  EXPECT_LT(*looked.coloring.first, 0) << "the lowest of the range is not black";
  EXPECT_EQ(looked.coloring.last, 500);
  info.ranges = {{"intensity", 7, 7, 7, 7}};
  EXPECT_EQ(with_first_look({}, info).coloring.source, SurfelColor::kElevation) << "an intensity that tells nothing";
}

TEST(FirstLookTest, WhatIsAskedForStays) {
  const model::ModelInfo info = scan_without_colors();
  picture::PictureRequest request;
  request.shading = Shading::kLit;
  expect_unchanged(request, info);
  request.shading = Shading::kUnlit;
  expect_unchanged(request, info);
  request.shading = Shading::kAuto;
  request.coloring.source = SurfelColor::kNormal;
  expect_unchanged(request, info);
  request.coloring.source = SurfelColor::kStored;
  request.eye_dome.strength = 2;
  EXPECT_EQ(with_first_look(request, info).eye_dome.strength, 2);
}

TEST(FirstLookTest, ModelsWithColorsMeshesAndOtherKindsStayAsTheyAre) {
  model::ModelInfo info = scan_without_colors();
  info.color_bits = 8;
  expect_unchanged({}, info);
  info = scan_without_colors();
  info.even = true;
  expect_unchanged({}, info);
  info = scan_without_colors();
  info.surfels = 0;
  expect_unchanged({}, info);
}

}  // namespace
}  // namespace surfcast::service
