#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>
#include <string>
#include <type_traits>

#include <gtest/gtest.h>

#include "protocol/endpoint.h"
#include "protocol/errors.h"
#include "protocol/lights_file.h"
#include "protocol/parse.h"
#include "protocol/picture_fields.h"
#include "protocol/picture_query.h"
#include "protocol/sample_fields.h"
#include "protocol/transfer_file.h"
#include "protocol/validate.h"

namespace surfcast::protocol {
namespace {

TEST(Parse, NumbersAreReadWholeOrNotAtAll) {
  EXPECT_EQ(parse_double("-1.5e3"), -1500);
  EXPECT_EQ(parse_double("+2"), 2);
  for (const char* text : {"", " 1", "1 ", "1x", "0x10", "nan", "inf", "-inf", "1e999", "--1", "+-1", "+", "1,5"}) {
    EXPECT_EQ(parse_double(text), std::nullopt) << text;
  }
  EXPECT_EQ(parse_unsigned("4294967295"), 4294967295U);
  for (const char* text : {"", "-1", "+1", "4294967296", "1.0", "1e3", " 1"}) {
    EXPECT_EQ(parse_unsigned(text), std::nullopt) << text;
  }
}

TEST(Parse, DoublesKeepEveryBit) {
  EXPECT_EQ(parse_double("652000.12345678912"), 652000.12345678912);
}

TEST(Parse, ListsHaveExactlyAsManyPartsAsAskedFor) {
  EXPECT_EQ(parse_doubles("1,-2,3.5", 3), (std::vector<double>{1, -2, 3.5}));
  for (const char* text : {"", "1,2", "1,2,3,4", "1,2,3,", ",1,2", "1,,2", "1;2;3", "1, 2, 3"}) {
    EXPECT_EQ(parse_doubles(text, 3), std::nullopt) << text;
  }
}

TEST(PictureFields, GlyphsAreSetFromTheirTexts) {
  wire::DrawPicture picture;
  EXPECT_TRUE(set_picture_field(picture, "glyph", "superquadric,2"));
  EXPECT_TRUE(set_picture_field(picture, "glyph_radius", "unit"));
  EXPECT_TRUE(set_picture_field(picture, "glyph_scale", "1.25"));
  EXPECT_TRUE(set_picture_field(picture, "threshold", "fa,0.2;a,b,-1,2"));
  EXPECT_TRUE(set_picture_field(picture, "color_by", "attribute:confidence"));
  const wire::Glyphs& glyphs = picture.glyphs();
  EXPECT_EQ(glyphs.shape(), wire::GLYPH_SHAPE_SUPERQUADRIC);
  EXPECT_EQ(glyphs.sharpness(), 2);
  EXPECT_EQ(glyphs.radius(), wire::GLYPH_RADIUS_UNIT);
  EXPECT_EQ(glyphs.scale(), 1.25);
  ASSERT_EQ(glyphs.thresholds_size(), 2);
  EXPECT_EQ(glyphs.thresholds(0).attribute(), "fa");
  EXPECT_EQ(glyphs.thresholds(0).smallest(), 0.2);
  EXPECT_FALSE(glyphs.thresholds(0).has_largest());
  EXPECT_EQ(glyphs.thresholds(1).attribute(), "a,b") << "names may contain commas";
  EXPECT_EQ(glyphs.thresholds(1).largest(), 2);
  EXPECT_EQ(picture.coloring().source(), wire::COLOR_SOURCE_ATTRIBUTE);
  EXPECT_EQ(picture.coloring().attribute(), "confidence");
}

TEST(PictureFields, LightsAreReadFromTextAndFromJson) {
  wire::DrawPicture picture;
  EXPECT_TRUE(set_picture_field(picture, "lights", "0.08,0.25,20;0.5,0.7,-0.6,0.75;0,1,0,0.2"));
  wire::Lighting read;
  ASSERT_TRUE(parse_lights_json(R"({"ambient": 0.08, "specular": 0.25, "exponent": 20, "lights":
      [{"direction": [0.5, 0.7, -0.6], "power": 0.75}, {"direction": [0, 1, 0], "power": 0.2}]})",
                                read));
  EXPECT_EQ(read.SerializeAsString(), picture.lighting().SerializeAsString());
  ASSERT_TRUE(parse_lights_json(R"({"lights": [{"direction": [0, 0, -2]}]})", read));
  EXPECT_EQ(read.exponent(), 32);
  EXPECT_EQ(read.lights(0).power(), 1);
}

TEST(PictureFields, WrongLightsChangeNothing) {
  wire::Lighting lighting;
  lighting.set_ambient(0.5);
  for (const char* text : {"", "[]", "{}", R"({"lights": [{}]})", R"({"lights": [{"direction": [0, 0, 0]}]})",
                           R"({"ambient": -1, "lights": []})", R"({"lights": [{"direction": [0, 1]}]})"}) {
    EXPECT_FALSE(parse_lights_json(text, lighting)) << text;
  }
  EXPECT_EQ(lighting.ambient(), 0.5);
}

/// The request with this field alone.
wire::DrawPicture with_field(const PictureField& field, const std::string& text) {
  wire::DrawPicture picture;
  picture.set_model("cube");
  EXPECT_TRUE(set_picture_field(picture, field.name, text)) << field.name << '=' << text;
  return picture;
}

std::vector<PictureField> plain_fields() {
  std::vector<PictureField> fields;
  for (const PictureField& field : picture_fields()) {
    if (field.value.kind != FieldKind::kStructured) fields.push_back(field);
  }
  return fields;
}

TEST(PlainFields, EachIsSetFromItsTextAndPassesTheCheck) {
  wire::DrawPicture usual;
  usual.set_model("cube");
  for (const PictureField& field : plain_fields()) {
    const wire::DrawPicture picture = with_field(field, sample_text(field));
    EXPECT_NE(picture.SerializeAsString(), usual.SerializeAsString()) << field.name;
    EXPECT_TRUE(check_picture(picture)) << field.name;
  }
}

TEST(PlainFields, WrongTextsAreExplainedAndChangeNothing) {
  for (const PictureField& field : plain_fields()) {
    wire::DrawPicture picture;
    const std::string text = wrong_text(field);
    const Status status = set_picture_field(picture, field.name, text);
    ASSERT_FALSE(status) << field.name;
    EXPECT_EQ(status.error().message,
              std::string(field.name) + ": expected " + std::string(field.form) + ", got '" + text + "'");
    EXPECT_EQ(picture.ByteSizeLong(), 0U) << field.name;
  }
}

/// The bytes of all options.
std::string bytes_of(const picture::PlainOptions& options) {
  std::ostringstream text;
  picture::with_members(options, [&text](const auto&... members) {
    const auto put = [&text](const auto& member) {
      using Member = std::decay_t<decltype(member)>;
      if constexpr (std::is_enum_v<Member>) {
        text << static_cast<int>(member) << ' ';
      } else if constexpr (std::is_arithmetic_v<Member>) {
        text << member << ' ';
      } else {
        text << int{member.x} << ',' << int{member.y} << ',' << int{member.z} << ' ';
      }
    };
    (put(members), ...);
  });
  return text.str();
}

TEST(PlainFields, ThoseOfTheStructureAreReadFromMessages) {
  const std::string usual = bytes_of(picture::PlainOptions{});
  EXPECT_EQ(bytes_of(plain_options(wire::DrawPicture())), usual) << "what is absent has its default";
  std::set<std::string> seen{usual};
  size_t read = 0;
  for (const PictureField& field : plain_fields()) {
    if (field.value.read == nullptr) continue;
    ++read;
    EXPECT_TRUE(seen.insert(bytes_of(plain_options(with_field(field, sample_text(field))))).second) << field.name;
  }
  size_t members = 0;
  picture::PlainOptions options;
  picture::with_members(options, [&members](auto&... all) { members = sizeof...(all); });
  EXPECT_EQ(read, members) << "each member has a row of the table";
}

TEST(PlainFields, TheirValuesAreThoseOfTheMessage) {
  wire::DrawPicture picture;
  for (const PictureField& field : plain_fields()) {
    ASSERT_TRUE(set_picture_field(picture, field.name, sample_text(field)));
  }
  EXPECT_EQ(picture.normalization(), wire::NORMALIZATION_SURFEL);
  EXPECT_EQ(picture.filter(), wire::FILTER_NONE);
  EXPECT_EQ(picture.spacing(), 1.5);
  EXPECT_EQ(picture.error(), 1.5);
  EXPECT_EQ(picture.time_ms(), 1.5);
  EXPECT_EQ(picture.shading(), wire::SHADING_LIT);
  EXPECT_EQ(picture.background().blue(), 255U);
  EXPECT_EQ(picture.coloring().map(), wire::COLOR_MAP_TERRAIN);
  EXPECT_TRUE(picture.shaded());
  EXPECT_TRUE(picture.medium());
  EXPECT_EQ(picture.opacity(), 0.5);
  EXPECT_EQ(picture.ghost(), 0.5);
  EXPECT_EQ(picture.xray(), wire::X_RAY_DENSITY);
  EXPECT_EQ(picture.splat_convention(), wire::SPLAT_CONVENTION_EXACT);
  EXPECT_EQ(picture.glyphs().radius(), wire::GLYPH_RADIUS_UNIT);
  EXPECT_EQ(picture.glyphs().scale(), 1.5);
  const picture::PlainOptions options = plain_options(picture);
  EXPECT_EQ(options.normalization, picture::Normalization::kSurfel);
  EXPECT_EQ(options.filter, picture::Filter::kNone);
  EXPECT_EQ(options.shading, picture::Shading::kLit);
  EXPECT_EQ(options.splat_convention, picture::SplatConvention::kExact);
  EXPECT_EQ(options.xray, picture::XRay::kDensity);
  EXPECT_EQ(options.background, glm::u8vec3(1, 2, 255));
  EXPECT_EQ(options.opacity, 0.5);
}

TEST(PlainFields, ChoicesHaveTheNumbersOfTheMessage) {
  for (const PictureField& field : plain_fields()) {
    if (field.value.kind != FieldKind::kChoice) continue;
    const std::string sample = sample_text(field);
    EXPECT_EQ(parse_choice(field.form, sample), std::count(field.form.begin(), field.form.end(), '|')) << field.name;
    EXPECT_EQ(parse_choice(field.form, field.form), std::nullopt);
  }
  EXPECT_EQ(parse_choice("off|sorted", ""), std::nullopt);
}

TEST(PictureFields, EachStructuredFieldIsSetFromItsText) {
  wire::DrawPicture picture;
  const std::vector<std::pair<std::string, std::string>> texts = {{"position", "1,2,3"},
                                                                  {"focal_point", "4,5,6"},
                                                                  {"view_up", "0,0,1"},
                                                                  {"view_angle", "45"},
                                                                  {"resolution", "8,9"},
                                                                  {"format", "exr"},
                                                                  {"quality", "33"},
                                                                  {"channels", "surfel,depth"},
                                                                  {"color_by", "normal"},
                                                                  {"color_range", "-2,7.5"},
                                                                  {"hide_classes", "2,255"},
                                                                  {"hide_models", "nave,tower 2"},
                                                                  {"clip_box", "0,0,0,1,1,1;2,2,2,3,3,3"},
                                                                  {"clip_out", "4,4,4,5,5,5"},
                                                                  {"eye_dome", "1.5,2"},
                                                                  {"transfer", "mr,-1,2.5"},
                                                                  {"iso", "-0.5;300,1,2,255,0.25"},
                                                                  {"slice", "1,2,3,0,0,-2;k,7.5"},
                                                                  {"opacity_by_class", "5=0.3,6=1"},
                                                                  {"glyph", "superquadric,2"},
                                                                  {"threshold", "fa,0.2;a,b,-1,2"},
                                                                  {"lights", "0.1,0.25,32;0,0.5,-1,0.75"}};
  EXPECT_EQ(texts.size(), picture_fields().size() - plain_fields().size());
  for (const auto& [name, text] : texts) EXPECT_TRUE(set_picture_field(picture, name, text)) << name;
  EXPECT_EQ(picture.camera().focal_point().y(), 5);
  EXPECT_EQ(picture.camera().view_angle(), 45);
  EXPECT_EQ(picture.resolution().height(), 9u);
  EXPECT_EQ(picture.format(), wire::FILE_FORMAT_EXR);
  EXPECT_EQ(picture.quality(), 33u);
  ASSERT_EQ(picture.channels_size(), 2);
  EXPECT_EQ(picture.channels(0), wire::CHANNEL_SURFEL);
  EXPECT_EQ(picture.channels(1), wire::CHANNEL_DEPTH);
  EXPECT_EQ(picture.coloring().source(), wire::COLOR_SOURCE_NORMAL);
  EXPECT_EQ(picture.coloring().first(), -2);
  EXPECT_EQ(picture.coloring().last(), 7.5);
  ASSERT_EQ(picture.hidden_classes_size(), 2);
  EXPECT_EQ(picture.hidden_classes(1), 255u);
  ASSERT_EQ(picture.hidden_models_size(), 2);
  EXPECT_EQ(picture.hidden_models(1), "tower 2");
  ASSERT_EQ(picture.clip_boxes_size(), 3);
  EXPECT_EQ(picture.clip_boxes(1).box().max().z(), 3);
  EXPECT_FALSE(picture.clip_boxes(1).inverted());
  EXPECT_TRUE(picture.clip_boxes(2).inverted());
  EXPECT_EQ(picture.eye_dome().strength(), 1.5);
  EXPECT_EQ(picture.eye_dome().radius(), 2);
  EXPECT_TRUE(check_picture(parse_picture_query("m", "eye_dome=1").value()));
  EXPECT_EQ(picture.transfer().preset(), wire::TRANSFER_PRESET_MR);
  EXPECT_EQ(picture.transfer().first(), -1);
  EXPECT_EQ(picture.transfer().last(), 2.5);
  ASSERT_EQ(picture.iso_surfaces_size(), 2);
  EXPECT_EQ(picture.iso_surfaces(0).value(), -0.5);
  EXPECT_FALSE(picture.iso_surfaces(0).has_color());
  EXPECT_FALSE(picture.iso_surfaces(0).has_opacity());
  EXPECT_EQ(picture.iso_surfaces(1).color().blue(), 255u);
  EXPECT_EQ(picture.iso_surfaces(1).opacity(), 0.25);
  ASSERT_EQ(picture.slices_size(), 2);
  EXPECT_EQ(picture.slices(0).point().y(), 2);
  EXPECT_EQ(picture.slices(0).normal().z(), -2);
  EXPECT_EQ(picture.slices(1).axis(), wire::GRID_AXIS_K);
  EXPECT_EQ(picture.slices(1).index(), 7.5);
  ASSERT_EQ(picture.class_opacities_size(), 2);
  EXPECT_EQ(picture.class_opacities(0).code(), 5U);
  EXPECT_EQ(picture.class_opacities(0).opacity(), 0.3);
  EXPECT_EQ(picture.class_opacities(1).code(), 6U);
}

TEST(PictureFields, ATransferFunctionIsAPresetOrPoints) {
  wire::DrawPicture picture;
  ASSERT_TRUE(set_picture_field(picture, "transfer", "ct-bone"));
  EXPECT_EQ(picture.transfer().preset(), wire::TRANSFER_PRESET_CT_BONE);
  EXPECT_FALSE(picture.transfer().has_first());
  ASSERT_TRUE(set_picture_field(picture, "transfer", "-5.5,1,2,3,0;-5.5,4,5,6,0.25;7,255,0,0,1"));
  EXPECT_EQ(picture.transfer().preset(), wire::TRANSFER_PRESET_GRAY);
  ASSERT_EQ(picture.transfer().points_size(), 3);
  EXPECT_EQ(picture.transfer().points(1).value(), -5.5);
  EXPECT_EQ(picture.transfer().points(1).color().blue(), 6u);
  EXPECT_EQ(picture.transfer().points(1).opacity(), 0.25);
  ASSERT_TRUE(set_picture_field(picture, "transfer", "gray"));
  EXPECT_EQ(picture.transfer().points_size(), 0);
}

TEST(PictureFields, TransferFunctionsAreChecked) {
  const auto checked = [](const std::string& text) {
    return check_picture(*parse_picture_query("m", "transfer=" + text));
  };
  EXPECT_TRUE(parse_picture_query("m", "transfer=0,0,0,0,0;0,9,9,9,1;2,9,9,9,1"));
  for (const char* text : {"2,0,0,0,0;1,0,0,0,0", "0,0,0,0,1.5", "0,0,0,0,-1"}) {
    EXPECT_FALSE(parse_picture_query("m", std::string("transfer=") + text)) << text;
  }
  std::string many = "0,0,0,0,0";
  for (int i = 1; i < kMaxTransferPoints; ++i) many += ";0,0,0,0,0";
  EXPECT_TRUE(checked(many));
  EXPECT_FALSE(parse_picture_query("m", "transfer=" + many + ";0,0,0,0,0"));
  wire::DrawPicture picture;
  picture.set_model("m");
  picture.mutable_transfer()->set_first(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(check_picture(picture));
  picture.mutable_transfer()->set_first(2);
  picture.mutable_transfer()->set_last(2);
  EXPECT_FALSE(check_picture(picture));
}

TEST(TransferFile, HoldsPointsOrAPreset) {
  wire::TransferFunction transfer;
  ASSERT_TRUE(parse_transfer_json(
      R"({"points": [{"value": 0, "color": [1, 2, 3], "opacity": 0}, {"value": 9.5, "color": [9, 0, 255], "opacity": 1}]})",
      transfer));
  ASSERT_EQ(transfer.points_size(), 2);
  EXPECT_EQ(transfer.points(1).value(), 9.5);
  EXPECT_EQ(transfer.points(1).color().blue(), 255u);
  ASSERT_TRUE(parse_transfer_json(R"({"preset": "mr", "first": 3, "last": 40})", transfer));
  EXPECT_EQ(transfer.points_size(), 0);
  EXPECT_EQ(transfer.preset(), wire::TRANSFER_PRESET_MR);
  EXPECT_EQ(transfer.last(), 40);
}

TEST(TransferFile, StatesExtinctionsAndLinearColours) {
  wire::TransferFunction transfer;
  ASSERT_TRUE(parse_transfer_json(R"({"points": [
      {"value": 0, "color": [1, 2, 3], "extinction": 0.25, "opacity": 0.5},
      {"value": 1, "color": [1, 2, 3], "color_linear": [0, 0.5, 1], "opacity": 0.5}]})",
                                  transfer));
  ASSERT_EQ(transfer.points_size(), 2);
  EXPECT_EQ(transfer.points(0).extinction(), 0.25);
  EXPECT_FALSE(transfer.points(0).has_color_linear());
  EXPECT_FALSE(transfer.points(1).has_extinction());
  EXPECT_EQ(transfer.points(1).opacity(), 0.5);
  EXPECT_EQ(transfer.points(1).color_linear().y(), 0.5) << "wins over the colour";
}

TEST(TransferFile, ExtinctionsAndLinearColoursAreChecked) {
  const auto accepts = [](const std::string& point) {
    wire::DrawPicture picture = *parse_picture_query("m", "");
    const std::string text = R"({"points": [{"value": 0, )" + point + "}]}";
    return parse_transfer_json(text, *picture.mutable_transfer()) && check_picture(picture);
  };
  EXPECT_TRUE(accepts(R"("color_linear": [0, 0.5, 1], "extinction": 0)"));
  EXPECT_TRUE(accepts(R"("color_linear": [0, 0.5, 1], "extinction": 1e6)"));
  EXPECT_FALSE(accepts(R"("color_linear": [0, 0.5, 1], "extinction": -1)"));
  EXPECT_FALSE(accepts(R"("color_linear": [0, 0.5, 1.5], "extinction": 1)"));
  EXPECT_FALSE(accepts(R"("color_linear": [0, 0.5], "extinction": 1)"));
  EXPECT_FALSE(accepts(R"("color_linear": [0, 0.5, "1"], "extinction": 1)"));
}

TEST(TransferFile, WrongTextsAreExplainedAndChangeNothing) {
  wire::TransferFunction transfer;
  transfer.set_first(1);
  for (const char* text :
       {"", "[]", "{}", R"({"points": 3})", R"({"points": [1]})", R"({"points": [{"value": 0, "opacity": 0}]})",
        R"({"points": [{"value": 0, "color": [1, 2], "opacity": 0}]})",
        R"({"points": [{"value": 0, "color": [1, 2, 256], "opacity": 0}]})",
        R"({"points": [{"value": "0", "color": [1, 2, 5], "opacity": 0}]})", R"({"preset": "bone"})",
        R"({"preset": 1})"}) {
    EXPECT_FALSE(parse_transfer_json(text, transfer)) << text;
  }
  EXPECT_EQ(transfer.first(), 1);
}

TEST(PictureFields, BoxesOfOneKindReplaceEachOtherAndLeaveTheOtherKind) {
  wire::DrawPicture picture;
  ASSERT_TRUE(set_picture_field(picture, "clip_box", "0,0,0,1,1,1"));
  ASSERT_TRUE(set_picture_field(picture, "clip_out", "2,2,2,3,3,3"));
  ASSERT_TRUE(set_picture_field(picture, "clip_box", "7,7,7,8,8,8"));
  ASSERT_EQ(picture.clip_boxes_size(), 2);
  EXPECT_TRUE(picture.clip_boxes(0).inverted());
  EXPECT_EQ(picture.clip_boxes(1).box().min().x(), 7);
}

TEST(PictureFields, WrongTextsAreExplained) {
  wire::DrawPicture picture;
  for (const auto& [name, text] : std::vector<std::pair<std::string, std::string>>{{"position", "1,2"},
                                                                                   {"view_angle", "0"},
                                                                                   {"view_angle", "180"},
                                                                                   {"resolution", "0,5"},
                                                                                   {"resolution", "1e3,1"},
                                                                                   {"format", "gif"},
                                                                                   {"format", "PNG"},
                                                                                   {"quality", "0"},
                                                                                   {"quality", "101"},
                                                                                   {"channels", ""},
                                                                                   {"channels", "depth,"},
                                                                                   {"channels", "Z"},
                                                                                   {"channels", "depth, normal"},
                                                                                   {"spacing", "-1"},
                                                                                   {"error", "0"},
                                                                                   {"error", "-40"},
                                                                                   {"error", "40 dB"},
                                                                                   {"error", "nan"},
                                                                                   {"time", "0"},
                                                                                   {"time", "-1"},
                                                                                   {"time", "inf"},
                                                                                   {"render_scale", "0"},
                                                                                   {"render_scale", "1.1"},
                                                                                   {"shading", ""},
                                                                                   {"background", "256,0,0"},
                                                                                   {"background", "-1,0,0"},
                                                                                   {"color_by", "red"},
                                                                                   {"color_by", "attribute:"},
                                                                                   {"glyph", "cube"},
                                                                                   {"glyph", "superquadric,-1"},
                                                                                   {"glyph_radius", ""},
                                                                                   {"glyph_scale", "0"},
                                                                                   {"threshold", "fa"},
                                                                                   {"threshold", ",1"},
                                                                                   {"threshold", "fa,2,1"},
                                                                                   {"threshold", "fa,0.2;"},
                                                                                   {"lights", "0.1,0.2,32"},
                                                                                   {"lights", "0.1,0.2,32;0,0,0,1"},
                                                                                   {"lights", "lights.json"},
                                                                                   {"color_map", ""},
                                                                                   {"color_range", "1"},
                                                                                   {"color_range", "nan,1"},
                                                                                   {"color_range", "2,2"},
                                                                                   {"color_range", "2,1"},
                                                                                   {"hide_classes", "256"},
                                                                                   {"hide_classes", "1,,2"},
                                                                                   {"hide_classes", "-1"},
                                                                                   {"hide_models", ""},
                                                                                   {"hide_models", "a,,b"},
                                                                                   {"clip_box", "1,0,0,0,1,1"},
                                                                                   {"clip_box", "0,0,0,1,1,1;"},
                                                                                   {"clip_out", "0,0,0,1,1"},
                                                                                   {"eye_dome", "-1"},
                                                                                   {"eye_dome", "101"},
                                                                                   {"eye_dome", "1,9"},
                                                                                   {"eye_dome", "1,"},
                                                                                   {"transfer", ""},
                                                                                   {"transfer", "bone"},
                                                                                   {"transfer", "gray,1"},
                                                                                   {"transfer", "gray,2,1"},
                                                                                   {"transfer", "lung.json"},
                                                                                   {"transfer", "0,0,0,256,0"},
                                                                                   {"transfer", "0,0,0,0.5,0"},
                                                                                   {"transfer", "0,0,0,0"},
                                                                                   {"transfer", "0,0,0,0,0;"},
                                                                                   {"shaded", "yes"},
                                                                                   {"iso", ""},
                                                                                   {"iso", "nan"},
                                                                                   {"iso", "1,2"},
                                                                                   {"iso", "1,0,0,256"},
                                                                                   {"iso", "1,0,0,0,1.5"},
                                                                                   {"iso", "1;"},
                                                                                   {"slice", "k"},
                                                                                   {"slice", "k,"},
                                                                                   {"slice", "x,3"},
                                                                                   {"slice", "1,2,3,0,0,0"},
                                                                                   {"slice", "1,2,3,0,0"},
                                                                                   {"medium", "no"},
                                                                                   {"opacity", "1.5"},
                                                                                   {"opacity", "-0.1"},
                                                                                   {"opacity_by_class", "5"},
                                                                                   {"opacity_by_class", "5=2"},
                                                                                   {"opacity_by_class", "256=0.5"},
                                                                                   {"opacity_by_class", "5=0.5,"},
                                                                                   {"ghost", "1.5"},
                                                                                   {"xray", "yes"},
                                                                                   {"splat_convention", "inria"},
                                                                                   {"filter", "EWA"}}) {
    const Status status = set_picture_field(picture, name, text);
    ASSERT_FALSE(status) << name << '=' << text;
    EXPECT_EQ(status.error().kind, ErrorKind::kInvalidInput);
    EXPECT_EQ(status.error().message.find(name + ": "), 0u);
  }
  EXPECT_EQ(set_picture_field(picture, "colour", "red").error().kind, ErrorKind::kNotFound);
}

TEST(PictureQuery, AnEmptyQueryIsThePictureByDefault) {
  const auto picture = parse_picture_query("cube", "");
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->model(), "cube");
  EXPECT_FALSE(picture->has_camera());
  EXPECT_FALSE(picture->has_resolution());
}

TEST(PictureQuery, EscapesBelongToNamesAndValues) {
  const auto picture = parse_picture_query("cube", "view%5Fup=0%2C1%2c0&position=1,2,3&&focal_point=0,0,0&");
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->camera().view_up().y(), 1);
}

TEST(PictureQuery, MalformedQueriesAreErrors) {
  for (const char* query :
       {"=", "resolution", "resolution=", "=1,1", "a=b", "resolution=1,1&resolution=1,1", "position=1,2,3",
        "view_angle=45", "resolution=%", "resolution=%4", "resolution=%00", "spacing=+1 "}) {
    const auto picture = parse_picture_query("cube", query);
    ASSERT_FALSE(picture) << query;
    EXPECT_EQ(picture.error().kind, ErrorKind::kInvalidInput) << query;
  }
}

wire::DrawPicture sound_picture() {
  wire::DrawPicture picture;
  picture.set_model("cube");
  picture.mutable_camera()->mutable_position()->set_x(1);
  picture.mutable_camera()->mutable_focal_point();
  return picture;
}

TEST(CheckPicture, ASoundRequestPasses) {
  EXPECT_TRUE(check_picture(sound_picture()));
}

TEST(CheckPicture, ChannelsAreOfEXRFilesAndNotOfViews) {
  wire::DrawPicture picture = sound_picture();
  picture.set_format(wire::FILE_FORMAT_EXR);
  picture.add_channels(wire::CHANNEL_POSITION);
  EXPECT_TRUE(check_picture(picture));
  EXPECT_FALSE(check_view_picture(picture));
  picture.clear_channels();
  EXPECT_TRUE(check_view_picture(picture));
}

TEST(CheckPicture, TheErrorsOfPlainFieldsNameThemAndTheirRange) {
  const auto message = [](auto spoil) {
    wire::DrawPicture picture = sound_picture();
    spoil(picture);
    const Status status = check_picture(picture);
    return status ? "" : status.error().message;
  };
  EXPECT_EQ(message([](auto& p) { p.set_xray(static_cast<wire::XRay>(3)); }), "xray: unknown");
  EXPECT_EQ(message([](auto& p) { p.set_shading(static_cast<wire::Shading>(-1)); }), "shading: unknown");
  EXPECT_EQ(message([](auto& p) { p.mutable_glyphs()->set_radius(static_cast<wire::GlyphRadius>(3)); }),
            "glyph_radius: unknown");
  EXPECT_EQ(message([](auto& p) { p.set_spacing(-1); }), "spacing: must be a finite number of pixels, at least 0");
  EXPECT_EQ(message([](auto& p) { p.set_error(-1); }), "error: must be a finite number of dB, at least 0");
  EXPECT_EQ(message([](auto& p) { p.set_time_ms(INFINITY); }),
            "time: must be a finite number of milliseconds, at least 0");
  EXPECT_EQ(message([](auto& p) { p.set_opacity(1.5); }), "opacity: must lie between 0 and 1");
  EXPECT_EQ(message([](auto& p) { p.set_ghost(NAN); }), "ghost: must lie between 0 and 1");
  EXPECT_EQ(message([](auto& p) { p.mutable_glyphs()->set_scale(0); }), "glyph_scale: must be a finite number above 0");
  EXPECT_EQ(message([](auto& p) { p.mutable_background()->set_red(256); }),
            "background: each part must be at most 255");
}

TEST(CheckPicture, WhatNoFlagCouldSayIsCaughtInMessagesToo) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](auto spoil) {
    wire::DrawPicture picture = sound_picture();
    spoil(picture);
    const Status status = check_picture(picture);
    return !status && status.error().kind == ErrorKind::kInvalidInput;
  };
  EXPECT_TRUE(refused([](auto& p) { p.clear_model(); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_model(std::string(600, 'x')); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_model("a+" + std::string(600, 'x')); }));
  const auto joined = [](int count) {
    std::string name(300, 'a');
    for (int i = 1; i < count; ++i) name += "+" + std::string(300, 'b');
    return name;
  };
  EXPECT_FALSE(refused([&](auto& p) { p.set_model(joined(64)); }));
  EXPECT_TRUE(refused([&](auto& p) { p.set_model(joined(65)); }));
  EXPECT_TRUE(refused([](auto& p) { p.mutable_camera()->clear_position(); }));
  EXPECT_TRUE(refused([](auto& p) { p.mutable_camera()->clear_focal_point(); }));
  EXPECT_TRUE(refused([&](auto& p) { p.mutable_camera()->mutable_position()->set_y(nan); }));
  EXPECT_TRUE(refused([&](auto& p) { p.mutable_camera()->mutable_view_up()->set_y(INFINITY); }));
  EXPECT_TRUE(refused([&](auto& p) { p.mutable_camera()->set_view_angle(nan); }));
  EXPECT_TRUE(refused([](auto& p) { p.mutable_camera()->set_view_angle(180); }));
  EXPECT_TRUE(refused([](auto& p) { p.mutable_resolution()->set_width(5); }));
  EXPECT_TRUE(refused([&](auto& p) { p.set_spacing(nan); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_spacing(-0.5); }));
  EXPECT_FALSE(refused([](auto& p) { p.set_error(40); }));
  EXPECT_FALSE(refused([](auto& p) { p.set_time_ms(40); }));
  EXPECT_TRUE(refused([](auto& p) {
    p.set_error(40);
    p.set_time_ms(200);
  })) << "at most one of the two";
  EXPECT_TRUE(refused([](auto& p) {
    p.set_error(40);
    p.set_spacing(1);
  })) << "nor with a spacing";
  EXPECT_FALSE(refused([](auto& p) { p.set_render_scale(0.5); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_render_scale(0); }));
  EXPECT_TRUE(refused([](auto& p) {
    p.set_render_scale(0.5);
    p.set_time_ms(200);
  })) << "it is chosen with the time";
  EXPECT_TRUE(refused([&](auto& p) { p.set_error(nan); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_error(INFINITY); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_error(-1); }));
  EXPECT_TRUE(refused([&](auto& p) { p.set_time_ms(nan); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_time_ms(INFINITY); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_time_ms(-1); }));
  EXPECT_TRUE(refused([](auto& p) { p.mutable_background()->set_green(256); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_quality(101); }));
  EXPECT_TRUE(refused([](auto& p) { p.add_channels(wire::CHANNEL_DEPTH); })) << "a PNG has none";
  EXPECT_TRUE(refused([](auto& p) {
    p.set_format(wire::FILE_FORMAT_EXR);
    p.add_channels(static_cast<wire::Channel>(6));
  }));
  EXPECT_TRUE(refused([](auto& p) { p.set_format(static_cast<wire::FileFormat>(9)); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_normalization(static_cast<wire::Normalization>(9)); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_filter(static_cast<wire::Filter>(-1)); }));
  EXPECT_TRUE(refused([](auto& p) { p.set_shading(static_cast<wire::Shading>(9)); }));
  EXPECT_TRUE(refused([](auto& p) { p.mutable_coloring()->set_source(static_cast<wire::ColorSource>(9)); }));
  EXPECT_TRUE(refused([](auto& p) { p.mutable_coloring()->set_map(static_cast<wire::ColorMap>(9)); }));
  EXPECT_TRUE(refused([&](auto& p) { p.mutable_coloring()->set_first(nan); }));
  EXPECT_TRUE(refused([](auto& p) { p.mutable_coloring()->set_last(-INFINITY); }));
  EXPECT_TRUE(refused([](auto& p) {
    p.mutable_coloring()->set_first(3);
    p.mutable_coloring()->set_last(3);
  }));
  EXPECT_TRUE(refused([](auto& p) { p.add_hidden_classes(256); }));
  EXPECT_TRUE(refused([](auto& p) { p.add_hidden_models(""); }));
  EXPECT_TRUE(refused([](auto& p) { p.add_hidden_models(std::string(513, 'a')); }));
  EXPECT_TRUE(refused([](auto& p) {
    for (int i = 0; i < 65; ++i) p.add_hidden_models("a");
  }));
  EXPECT_TRUE(refused([&](auto& p) { p.add_clip_boxes()->mutable_box()->mutable_max()->set_x(nan); }));
  EXPECT_TRUE(refused([](auto& p) { p.add_clip_boxes()->mutable_box()->mutable_max()->set_x(-1); }));
  EXPECT_TRUE(refused([](auto& p) {
    for (int i = 0; i < 33; ++i) p.add_clip_boxes();
  }));
  EXPECT_TRUE(refused([&](auto& p) { p.mutable_eye_dome()->set_strength(nan); }));
  EXPECT_TRUE(refused([](auto& p) { p.mutable_eye_dome()->set_strength(-1); }));
  EXPECT_TRUE(refused([](auto& p) { p.mutable_eye_dome()->set_radius(8.5); }));
}

TEST(Endpoint, HostsAndPortsAreToldApart) {
  EXPECT_EQ(parse_endpoint("tcp://render.example:7600")->host, "render.example");
  EXPECT_EQ(parse_endpoint("[::1]:80")->host, "::1");
  EXPECT_FALSE(parse_endpoint("ws://a:1")->encrypted);
  EXPECT_TRUE(parse_endpoint("wss://a:1")->encrypted && parse_endpoint("wss://a:1")->websocket);
  EXPECT_TRUE(parse_endpoint("tcps://a:1")->encrypted && !parse_endpoint("tcps://a:1")->websocket);
  EXPECT_EQ(to_string(*parse_endpoint("[::1]:80")), "[::1]:80");
  EXPECT_EQ(parse_endpoint("127.0.0.1:0")->port, 0);
  for (const char* text : {"", "host", ":7600", "host:", "host:65536", "host:-1", "host:x", "::1:80", "[]:80",
                           "http://host:80", "host:80/", "[::1:80"}) {
    EXPECT_FALSE(parse_endpoint(text)) << text;
  }
}

TEST(Endpoint, AModelFollowsTheServer) {
  const auto url = parse_model_url("tcp://host:7600/my model");
  ASSERT_TRUE(url);
  EXPECT_EQ(url->server.port, 7600);
  EXPECT_EQ(url->model, "my model");
  for (const char* text : {"host:7600", "host:7600/", "/model", "host/model", "tcp://"}) {
    EXPECT_FALSE(parse_model_url(text)) << text;
  }
}

TEST(Errors, EveryKindTravelsAndComesBack) {
  for (const ErrorKind kind :
       {ErrorKind::kInvalidInput, ErrorKind::kUnsupported, ErrorKind::kNotFound, ErrorKind::kIo, ErrorKind::kLimit,
        ErrorKind::kCancelled, ErrorKind::kUnavailable, ErrorKind::kInternal}) {
    wire::Error message;
    to_wire(Error{kind, "why"}, message);
    EXPECT_EQ(from_wire(message).kind, kind);
    EXPECT_EQ(from_wire(message).message, "why");
  }
}

TEST(Errors, ACodeOfALaterVersionIsAnInternalError) {
  wire::Error message;
  message.set_code(static_cast<wire::ErrorCode>(99));
  EXPECT_EQ(from_wire(message).kind, ErrorKind::kInternal);
}

}  // namespace
}  // namespace surfcast::protocol
