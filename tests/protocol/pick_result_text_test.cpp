#include "protocol/pick_result_text.h"

#include <limits>
#include <nlohmann/json.hpp>

#include <gtest/gtest.h>

namespace surfcast::protocol {
namespace {

wire::PickResult hit() {
  wire::PickResult result;
  result.set_hit(true);
  result.mutable_position()->set_x(448262.31);
  result.mutable_position()->set_y(5411932.67);
  result.mutable_position()->set_z(-0.1);
  result.mutable_normal()->set_z(1);
  result.mutable_color()->set_red(7);
  result.set_radius(0.25);
  result.set_distance(12);
  result.set_depth(11.5);
  result.set_surfel(7);
  wire::AttributeValue* value = result.add_attributes();
  value->set_attribute("gps_time");
  value->set_value(384933630.3884339);
  return result;
}

TEST(PickResultText, LinesHoldEveryBitOfTheCoordinates) {
  EXPECT_EQ(pick_result_text(hit()),
            "hit: yes\nposition: 448262.31 5411932.67 -0.1\nnormal: 0.0 0.0 1.0\ncolor: 7 0 0\nradius: 0.25\n"
            "distance: 12.0\ndepth: 11.5\nsurfel: 7\ngps_time: 384933630.3884339\n");
  EXPECT_EQ(pick_result_text({}), "hit: no\n");
}

TEST(PickResultText, JsonHoldsTheSame) {
  const nlohmann::json document = nlohmann::json::parse(pick_result_json(hit()));
  EXPECT_EQ(document["position"], (nlohmann::json{448262.31, 5411932.67, -0.1}));
  EXPECT_EQ(document["attributes"]["gps_time"], 384933630.3884339);
  EXPECT_EQ(nlohmann::json::parse(pick_result_json({})), nlohmann::json({{"hit", false}}));
}

TEST(PickResultText, WhatIsNoNumberIsNull) {
  wire::PickResult result = hit();
  result.mutable_attributes(0)->set_value(std::numeric_limits<double>::quiet_NaN());
  result.mutable_attributes(0)->set_attribute("odd\xff");
  EXPECT_TRUE(nlohmann::json::accept(pick_result_json(result)));
}

}  // namespace
}  // namespace surfcast::protocol
