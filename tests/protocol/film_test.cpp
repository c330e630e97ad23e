// Films, by a program in the place of ffmpeg that keeps what it is given.

#include "protocol/film.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <unistd.h>

#include "support/file_content.h"

namespace surfcast::protocol {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class FilmTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ("film_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" +
               std::to_string(::getpid()));
    fs::create_directories(folder_ / "bin");
    path_ = std::getenv("PATH");
    ::setenv("PATH", ((folder_ / "bin").string() + ":" + path_).c_str(), 1);
  }
  void TearDown() override {
    ::setenv("PATH", path_.c_str(), 1);
    fs::remove_all(folder_);
  }

  /// The program of that name is this script.
  void have_encoder(const std::string& script) const {
    const fs::path program = folder_ / "bin" / "ffmpeg";
    std::ofstream(program) << "#!/bin/sh\n" << script << "\n";
    fs::permissions(program, fs::perms::owner_all);
  }
  /// Writes its pictures into the film, and its arguments beside it.
  void have_copying_encoder() const {
    have_encoder("for last; do :; done; echo \"$@\" > '" + (folder_ / "arguments").string() + "'; cat > \"$last\"");
  }
  [[nodiscard]] size_t files() const {
    return static_cast<size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  fs::path folder_;
  std::string path_;
};

TEST_F(FilmTest, IsKnownByItsName) {
  EXPECT_TRUE(is_film("a.mp4") && is_film("folder/a.b.WebM"));
  EXPECT_FALSE(is_film("a.png") || is_film("mp4") || is_film("-") || is_film("a.mp4.png"));
}

TEST_F(FilmTest, TheEncoderGetsEveryPicture) {
  have_copying_encoder();
  const fs::path target = folder_ / "film.mp4";
  auto film = FilmWriter::create(target, 24);
  ASSERT_TRUE(film) << film.error().message;
  const std::string large(3'000'000, 'x');  // more than a socket holds
  EXPECT_TRUE(film->append("first"));
  EXPECT_TRUE(film->append(large));
  EXPECT_FALSE(fs::exists(target)) << "it is not whole";
  ASSERT_TRUE(film->finish());
  EXPECT_EQ(testing::file_content(target), "first" + large);
  EXPECT_THAT(testing::file_content(folder_ / "arguments"), HasSubstr("-framerate 24 "));
  EXPECT_THAT(testing::file_content(folder_ / "arguments"), HasSubstr("libx264"));
}

TEST_F(FilmTest, TheNameChoosesTheCodec) {
  have_copying_encoder();
  auto film = FilmWriter::create(folder_ / "film.webm", 0.5);
  ASSERT_TRUE(film);
  ASSERT_TRUE(film->finish());
  EXPECT_THAT(testing::file_content(folder_ / "arguments"), HasSubstr("libvpx-vp9"));
  EXPECT_THAT(testing::file_content(folder_ / "arguments"), HasSubstr("-framerate 0.5 "));
}

TEST_F(FilmTest, AnEncoderThatFailsIsQuotedAndLeavesNothing) {
  have_encoder("echo 'Unknown encoder' >&2; exit 3");
  {
    auto film = FilmWriter::create(folder_ / "film.mp4", 30);
    ASSERT_TRUE(film);
    const Status finished = film->finish();
    ASSERT_FALSE(finished);
    EXPECT_THAT(finished.error().message, StartsWith((folder_ / "film.mp4").string() + ": ffmpeg has ended"));
    EXPECT_THAT(finished.error().message, HasSubstr("Unknown encoder"));
  }
  EXPECT_EQ(files(), 1U) << "the folder of programs";
}

TEST_F(FilmTest, AnEncoderThatEndsBetweenPicturesIsAnError) {
  have_encoder("exec head -c 10 > /dev/null");
  auto film = FilmWriter::create(folder_ / "film.mp4", 30);
  ASSERT_TRUE(film);
  const std::string picture(100'000, 'x');
  Status appended;
  while (appended) appended = film->append(picture);
  EXPECT_THAT(appended.error().message, HasSubstr("ffmpeg has ended"));
}

TEST_F(FilmTest, AFilmThatIsGivenUpLeavesNothing) {
  have_copying_encoder();
  const fs::path target = folder_ / "film.mp4";
  {
    auto film = FilmWriter::create(target, 30);
    ASSERT_TRUE(film);
    EXPECT_TRUE(film->append(std::string(3'000'000, 'x')));
  }
  EXPECT_EQ(files(), 2U) << "programs and arguments";
}

TEST_F(FilmTest, WithoutTheProgramThereIsOneClearLine) {
  ::setenv("PATH", (folder_ / "bin").c_str(), 1);
  const auto film = FilmWriter::create(folder_ / "film.mp4", 30);
  ASSERT_FALSE(film);
  EXPECT_EQ(film.error().message, "a film needs the program ffmpeg, which is not installed");
}

}  // namespace
}  // namespace surfcast::protocol
