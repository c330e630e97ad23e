#include "protocol/request_flags.h"

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include <gtest/gtest.h>
#include <unistd.h>

#include "base/atomic_file.h"
#include "protocol/picture_fields.h"
#include "protocol/save_picture.h"

namespace surfcast::protocol {
namespace {

namespace fs = std::filesystem;

class RequestFlagsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    flags_.add_to(app_);
    folder_ = fs::path(::testing::TempDir()) /
              ("flags_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" +
               std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// False when the command line is wrong.
  bool parse(std::vector<std::string> arguments) {
    std::reverse(arguments.begin(), arguments.end());
    try {
      app_.parse(arguments);
    } catch (const CLI::ParseError&) {
      return false;
    }
    return true;
  }
  std::string write(const std::string& name, const std::string& text) {
    EXPECT_TRUE(write_file_atomically(folder_ / name, text));
    return folder_ / name;
  }

  CLI::App app_;
  RequestFlags flags_;
  fs::path folder_;
};

TEST_F(RequestFlagsTest, ATransferFunctionMayBeAFile) {
  const std::string file = write("lung.json", R"({"preset": "ct-soft", "last": 40})");
  ASSERT_TRUE(parse({"--output", "a.png", "--transfer", file}));
  const auto picture = flags_.request("ct");
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->transfer().preset(), wire::TRANSFER_PRESET_CT_SOFT);
  EXPECT_EQ(picture->transfer().last(), 40);
}

TEST_F(RequestFlagsTest, ABadFileOfATransferFunctionIsNamed) {
  const std::string file = write("lung.json", "{}");
  ASSERT_TRUE(parse({"--output", "a.png", "--transfer", file}));
  const auto picture = flags_.request("ct");
  ASSERT_FALSE(picture);
  EXPECT_NE(picture.error().message.find(file), std::string::npos);
}

TEST_F(RequestFlagsTest, AFilmNeedsAPathAndIsOfOneFormat) {
  ASSERT_TRUE(parse({"--output", "film.mp4"}));
  EXPECT_EQ(flags_.check().error().message, "film.mp4: a film needs the camera path --path");
  ASSERT_TRUE(parse({"--output", "film.mp4", "--path", "path.json", "--format", "png"}));
  EXPECT_EQ(flags_.check().error().message, "--format is of pictures, and film.mp4 is a film");
}

TEST_F(RequestFlagsTest, FramesOfAFilmArePng) {
  ASSERT_TRUE(parse({"--output", "film.webm", "--path", "path.json"}));
  ASSERT_TRUE(flags_.check());
  EXPECT_EQ(flags_.request("cube")->format(), wire::FILE_FORMAT_PNG);
}

TEST_F(RequestFlagsTest, FlagsBecomeARequest) {
  ASSERT_TRUE(parse({"--output", "a.jpg", "--camera-position", "-1,2,3", "--camera-focal-point=0,0,-5", "--resolution",
                     "640,480", "--background", "9,8,7"}));
  ASSERT_TRUE(flags_.check());
  const auto picture = flags_.request("cube");
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->model(), "cube");
  EXPECT_EQ(picture->format(), wire::FILE_FORMAT_JPEG);
  EXPECT_EQ(picture->camera().position().x(), -1);
  EXPECT_EQ(picture->camera().focal_point().z(), -5);
  EXPECT_FALSE(picture->camera().has_view_up());
  EXPECT_EQ(picture->resolution().width(), 640u);
  EXPECT_EQ(picture->background().red(), 9u);
}

TEST_F(RequestFlagsTest, WrongValuesAreAWrongCommandLine) {
  EXPECT_FALSE(parse({"--output", "a.png", "--resolution", "640"}));
  EXPECT_FALSE(parse({"--output", "a.png", "--resolution", "640,480x"}));
  EXPECT_FALSE(parse({"--output", "a.png", "--camera-view-angle", "nan"}));
  EXPECT_FALSE(parse({"--output", "a.png", "--unknown", "1"}));
  EXPECT_FALSE(parse({"--resolution", "640,480"}));  // no output
}

TEST_F(RequestFlagsTest, TheFormatFollowsFromTheExtensionUnlessItIsGiven) {
  ASSERT_TRUE(parse({"--output", "dir.png/a.EXR"}));
  EXPECT_EQ(flags_.request("cube")->format(), wire::FILE_FORMAT_EXR);
  ASSERT_TRUE(parse({"--output", "a.png", "--format", "webp"}));
  EXPECT_EQ(flags_.request("cube")->format(), wire::FILE_FORMAT_WEBP);
  ASSERT_TRUE(parse({"--output", "-", "--format", "jpg"}));
  EXPECT_EQ(flags_.request("cube")->format(), wire::FILE_FORMAT_JPEG);
}

TEST_F(RequestFlagsTest, AnOutputWithoutAFormatIsRefused) {
  for (const std::string output : {"-", "picture", "picture.gif", "png"}) {
    ASSERT_TRUE(parse({"--output", output}));
    EXPECT_FALSE(flags_.check()) << output;
  }
}

TEST_F(RequestFlagsTest, ChannelsNeedAnEXRFile) {
  ASSERT_TRUE(parse({"--output", "a.exr", "--channels", "depth,surfel"}));
  ASSERT_TRUE(flags_.check());
  const auto picture = flags_.request("cube");
  ASSERT_TRUE(picture) << picture.error().message;
  EXPECT_EQ(picture->channels_size(), 2);
  ASSERT_TRUE(parse({"--output", "a.png", "--channels", "depth"}));
  const Status refused = flags_.check();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "--channels needs a picture in EXR format");
  EXPECT_FALSE(parse({"--output", "a.exr", "--channels", "colour"}));
}

TEST_F(RequestFlagsTest, HalfACameraIsRefused) {
  ASSERT_TRUE(parse({"--output", "a.png", "--camera-position", "1,2,3"}));
  EXPECT_FALSE(flags_.check());
  ASSERT_TRUE(parse({"--output", "a.png", "--camera-view-angle", "45"}));
  EXPECT_FALSE(flags_.check());
}

TEST_F(RequestFlagsTest, ACameraFileIsReadAndFlagsWinOverIt) {
  const std::string file = write(
      "camera.json", R"({"position": [1, 2, 3.5], "focal_point": [0, 0, 0], "view_up": [0, 1, 0], "view_angle": 60})");
  ASSERT_TRUE(parse({"--output", "a.png", "--camera", file, "--camera-view-angle", "20"}));
  ASSERT_TRUE(flags_.check());
  const auto picture = flags_.request("cube");
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->camera().position().z(), 3.5);
  EXPECT_EQ(picture->camera().view_up().y(), 1);
  EXPECT_EQ(picture->camera().view_angle(), 20);
}

TEST_F(RequestFlagsTest, WrongCameraFilesAreNamedWithWhatIsWrong) {
  for (const std::string text :
       {"", "[]", "{", "{\"position\": [1,2]}", "{\"position\": [1,2,\"3\"]}", "{\"focal_point\": 5}",
        "{\"view_angle\": \"wide\"}", "{\"position\": [1,2,3], \"target\": [0,0,0]}", "{\"position\": [1,2,1e999]}"}) {
    const std::string file = write("camera.json", text);
    ASSERT_TRUE(parse({"--output", "a.png", "--camera", file}));
    const auto picture = flags_.request("cube");
    ASSERT_FALSE(picture) << text;
    EXPECT_EQ(picture.error().message.find(file + ": "), 0u) << picture.error().message;
  }
  ASSERT_TRUE(parse({"--output", "a.png", "--camera", folder_ / "absent.json"}));
  EXPECT_EQ(flags_.request("cube").error().kind, ErrorKind::kNotFound);
}

TEST_F(RequestFlagsTest, AnotherDefaultHoldsUntilAFlagSaysOtherwiseZeroIncluded) {
  for (const auto& [arguments, expected] : {std::pair{"", 1.5}, std::pair{"--spacing 0", 0.0}}) {
    CLI::App app;
    RequestFlags flags;
    flags.set_default("spacing", "1.5");
    flags.add_view_flags_to(app);
    EXPECT_NE(app.help().find("refinement stops; 0: the finest level (default 1.5)"), std::string::npos);
    app.parse(arguments);
    EXPECT_EQ(flags.view_request("cube").value().spacing(), expected) << arguments;
  }
}

TEST_F(RequestFlagsTest, AnErrorOrATimeReplacesTheDefaultSpacing) {
  for (const auto& [arguments, good] :
       {std::pair{"--error 40", true}, std::pair{"--time 200", true}, std::pair{"--spacing 2 --time 200", false}}) {
    CLI::App app;
    RequestFlags flags;
    flags.set_default("spacing", "1");
    flags.add_view_flags_to(app);
    app.parse(arguments);
    const Result<wire::DrawPicture> picture = flags.view_request("cube");
    ASSERT_EQ(picture.has_value(), good) << arguments;
    EXPECT_EQ(picture ? picture->spacing() : 0, 0) << arguments;
  }
}

TEST_F(RequestFlagsTest, TheEnvironmentMirrorsFlagsAndTheCommandLineWins) {
  ::setenv("SURFCAST_RESOLUTION", "11,12", 1);
  ::setenv("SURFCAST_CAMERA_POSITION", "7,8,9", 1);
  ASSERT_TRUE(parse({"--output", "a.png", "--camera-position", "1,1,1", "--camera-focal-point", "0,0,0"}));
  const auto picture = flags_.request("cube");
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->resolution().height(), 12u);
  EXPECT_EQ(picture->camera().position().x(), 1);
  ::setenv("SURFCAST_RESOLUTION", "wrong", 1);
  EXPECT_FALSE(parse({"--output", "a.png"}));
  ::unsetenv("SURFCAST_RESOLUTION");
  ::unsetenv("SURFCAST_CAMERA_POSITION");
}

TEST_F(RequestFlagsTest, EveryFieldOfAPictureHasAFlag) {
  for (const PictureField& field : picture_fields()) {
    EXPECT_NE(app_.get_option_no_throw("--" + std::string(field.flag)), nullptr) << field.flag;
  }
}

TEST_F(RequestFlagsTest, TheCameraOfAPicturesFiguresIsACameraFile) {
  wire::Picture picture;
  picture.mutable_camera()->mutable_position()->set_x(652000.12345678912);
  picture.mutable_camera()->mutable_focal_point()->set_y(0.1);
  picture.mutable_camera()->mutable_view_up()->set_z(1);
  picture.mutable_camera()->set_view_angle(33);
  const auto stats = nlohmann::json::parse(picture_stats_json(picture));
  wire::Camera camera;
  ASSERT_TRUE(parse_camera_json(stats["camera"].dump(), camera));
  EXPECT_EQ(camera.SerializeAsString(), picture.camera().SerializeAsString());
}

TEST_F(RequestFlagsTest, TheFiguresOfAPictureWhoseSpacingWasChosenStateWhatIsExpected) {
  wire::Picture picture;
  EXPECT_FALSE(nlohmann::json::parse(picture_stats_json(picture)).contains("expected_error"));
  picture.set_expected_ms(150);
  picture.set_expected_error(41.5);
  const auto stats = nlohmann::json::parse(picture_stats_json(picture));
  EXPECT_EQ(stats["expected_ms"], 150);
  EXPECT_EQ(stats["expected_error"], 41.5);
  picture.set_expected_error(std::numeric_limits<double>::infinity());
  EXPECT_TRUE(nlohmann::json::parse(picture_stats_json(picture))["expected_error"].is_null());
}

TEST_F(RequestFlagsTest, APictureThatCannotBeWrittenLeavesNothingBehind) {
  wire::Picture picture;
  picture.set_data("bytes");
  EXPECT_FALSE(save_picture(picture, folder_ / "absent" / "a.png", ""));
  ASSERT_TRUE(save_picture(picture, folder_ / "a.png", folder_ / "a.json"));
  EXPECT_EQ(fs::file_size(folder_ / "a.png"), 5u);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 2);
}

}  // namespace
}  // namespace surfcast::protocol
