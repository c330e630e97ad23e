#include "net/uploads.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "access/secret.h"
#include "access/token_file.h"
#include "net/net_fixture.h"

namespace surfcast::net {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

/// A server that takes scans of up to 100,000 bytes.
class UploadTest : public NetFixture {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ("uploads_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" +
               std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    config_.uploads.folder = folder_;
    config_.uploads.bytes = 100'000;
    config_.uploads.total_bytes = 250'000;
    config_.uploads.extensions = {".laz", ".ply", ".nii.gz"};
    config_.uploads.data_extensions = {".raw", ".raw.gz"};
    config_.uploads.taken = [](const std::string& name) { return name == "taken"; };
    config_.uploads.serve = [this](const fs::path& scan) -> Status {
      const std::lock_guard lock(mutex_);
      if (scan.stem() == "words") return fail(ErrorKind::kInvalidInput, scan.string() + ": not a LAS file");
      served_.push_back(scan.filename().string());
      return {};
    };
  }
  void TearDown() override {
    stop();
    fs::remove_all(folder_);
  }

  static std::string head(const std::string& name, const std::string& more) {
    return "PUT /api/uploads/" + name + " HTTP/1.1\r\nHost: here\r\n" + more + "\r\n";
  }
  [[nodiscard]] std::string put(const std::string& name, const std::string& body, const std::string& more = {}) const {
    return http(head(name, more + "Content-Length: " + std::to_string(body.size()) + "\r\n") + body);
  }
  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) names.push_back(entry.path().filename().string());
    std::ranges::sort(names);
    return names;
  }
  [[nodiscard]] std::string content(const std::string& name) const {
    std::ifstream stream(folder_ / name, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
  }
  static std::string bytes(size_t count) {
    std::string text(count, '\0');
    for (size_t i = 0; i < count; ++i) text[i] = static_cast<char>(i * 7 + i / 256);
    return text;
  }

  fs::path folder_;
  ServerConfig config_;
  std::mutex mutex_;
  std::vector<std::string> served_;
};

TEST_F(UploadTest, AScanArrivesWholeAndIsServed) {
  start(config_);
  const std::string body = bytes(99'000);
  const std::string answer = put("church.laz", body);
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 201"));
  EXPECT_THAT(answer, HasSubstr("\"church\""));
  EXPECT_TRUE(content("church.laz") == body);
  EXPECT_THAT(files(), ElementsAre("church.laz"));
  EXPECT_THAT(served_, ElementsAre("church.laz"));
}

TEST_F(UploadTest, AFileThatAScanWillNameIsKeptAndNotServed) {
  start(config_);
  const std::string answer = put("church.RAW.gz", bytes(60'000));
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 201"));
  EXPECT_THAT(answer, HasSubstr("\"file\": \"church.RAW.gz\""));
  EXPECT_THAT(served_, IsEmpty());
  EXPECT_THAT(uploaded_scans(config_.uploads), IsEmpty());
  EXPECT_THAT(put("taken.raw", "x"), StartsWith("HTTP/1.1 201")) << "it takes no name of a model";
  EXPECT_THAT(put("church.laz", bytes(90'000)), HasSubstr("201 "));
  EXPECT_THAT(put("other.laz", bytes(100'000)), HasSubstr("/1.1 503")) << "files of both sorts fill the folder";
}

TEST_F(UploadTest, AModelHasTheNameWithoutBothExtensions) {
  start(config_);
  EXPECT_THAT(put("brain.nii.gz", "x"), HasSubstr("\"model\": \"brain\""));
  EXPECT_THAT(put("taken.nii.gz", "x"), HasSubstr("there is a model or scan of that name already"));
  EXPECT_THAT(put(".nii.gz", "x"), StartsWith("HTTP/1.1 4"));
}

TEST_F(UploadTest, AScanInChunksArrivesWholeAndTheConnectionGoesOn) {
  start(config_);
  RawSocket socket(port_);
  socket.send(head("Two%20halves.PLY", "Transfer-Encoding: chunked\r\n"));
  socket.send(std::string_view("5\r\nfirst\r\n"));
  socket.send(std::string_view("6\r\nsecond\r\n0\r\n\r\n"));
  EXPECT_THAT(socket.read_http(), StartsWith("HTTP/1.1 201"));
  EXPECT_EQ(content("Two halves.PLY"), "firstsecond");
  socket.send(std::string_view("GET /healthz HTTP/1.1\r\nHost: here\r\nConnection: close\r\n\r\n"));
  EXPECT_THAT(socket.read_http(), StartsWith("HTTP/1.1 200"));
}

TEST_F(UploadTest, AClientThatAsksMayGoOn) {
  start(config_);
  RawSocket socket(port_);
  socket.send(head("a.ply", "Expect: 100-continue\r\nConnection: close\r\nContent-Length: 3\r\n"));
  EXPECT_THAT(socket.read_http(), StartsWith("HTTP/1.1 100"));
  socket.send(std::string_view("abc"));
  EXPECT_THAT(socket.read_to_end(), HasSubstr("HTTP/1.1 201"));
}

TEST_F(UploadTest, NamesAreThoseOfScansInTheFolder) {
  start(config_);
  for (const std::string& name : std::vector<std::string>{
           "..%2fescape.laz", "%2fetc%2fa.laz", "../a.laz", "a/b.laz", "a%5cb.laz", ".hidden.laz", "..laz", "",
           "a%00b.laz", "a%0a.laz", "c%3a.laz", "a%ff.laz", "a%zz.laz", std::string(300, 'a') + ".laz"}) {
    EXPECT_THAT(put(name, "x"), StartsWith("HTTP/1.1 4")) << name;
  }
  for (const char* name : {"model.surf", "a.exe", "laz", "a.laz.html", "a.laz.tmp1-1"}) {
    EXPECT_THAT(put(name, "x"), StartsWith("HTTP/1.1 501")) << name;
  }
  EXPECT_THAT(files(), IsEmpty());
  EXPECT_THAT(served_, IsEmpty());
}

TEST_F(UploadTest, NothingIsOverwritten) {
  start(config_);
  EXPECT_THAT(put("a.laz", "first"), StartsWith("HTTP/1.1 201"));
  EXPECT_THAT(put("a.laz", "second"), HasSubstr("there is a model or scan of that name already"));
  EXPECT_EQ(content("a.laz"), "first");
  EXPECT_THAT(put("taken.laz", "x"), HasSubstr("there is a model or scan of that name already"));
  fs::create_symlink(folder_ / "elsewhere", folder_ / "link.laz");
  EXPECT_THAT(put("link.laz", "x"), HasSubstr("there is a model or scan of that name already"));
  EXPECT_THAT(files(), ElementsAre("a.laz", "link.laz"));
}

TEST_F(UploadTest, AFileThatAppearsMeanwhileIsNotOverwritten) {
  start(config_);
  RawSocket socket(port_);
  socket.send(head("a.laz", "Content-Length: 4\r\n") + "ab");
  EXPECT_TRUE(eventually([this] { return !files().empty(); }));
  std::ofstream(folder_ / "a.laz") << "of somebody else";
  socket.send(std::string_view("cd"));
  EXPECT_THAT(socket.read_http(), HasSubstr("there is a model or scan of that name already"));
  EXPECT_EQ(content("a.laz"), "of somebody else");
  EXPECT_TRUE(eventually([this] { return files().size() == 1; }));
}

TEST_F(UploadTest, AFileThatIsNoScanIsRefusedInOneLineThatDoesNotTellWhereItWas) {
  start(config_);
  const std::string answer = put("words.laz", "no scan");
  EXPECT_THAT(answer, StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(answer, HasSubstr("\"words.laz: not a LAS file\""));
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(UploadTest, AFolderThatIsFullTakesNoMore) {
  config_.uploads.at_once = 3;
  start(config_);
  EXPECT_THAT(put("a.laz", bytes(90'000)), StartsWith("HTTP/1.1 201"));
  EXPECT_THAT(put("b.laz", bytes(90'000)), StartsWith("HTTP/1.1 201"));
  EXPECT_THAT(put("c.laz", bytes(90'000)), HasSubstr("503 "));
  RawSocket promised(port_);
  promised.send(head("d.laz", "Content-Length: 40000\r\n"));
  EXPECT_TRUE(eventually([this] { return files().size() == 3; }));
  EXPECT_THAT(put("e.laz", bytes(40'000)), HasSubstr("e.laz: the server has no room for it"));
  RawSocket endless(port_);
  endless.send(head("f.laz", "Transfer-Encoding: chunked\r\n") + "c350\r\n" + bytes(50'000) + "\r\n0\r\n\r\n");
  EXPECT_THAT(endless.read_http(), StartsWith("HTTP/1.1 413"));
  EXPECT_THAT(put("g.laz", bytes(30'000)), StartsWith("HTTP/1.1 201"));
}

TEST_F(UploadTest, AScanBeyondTheLimitIsRefusedAndNothingIsLeft) {
  start(config_);
  const std::string announced = put("a.laz", bytes(100'001));
  EXPECT_THAT(announced, StartsWith("HTTP/1.1 413"));
  EXPECT_THAT(announced, HasSubstr("larger than the 100000 bytes"));
  EXPECT_THAT(http(head("a.laz", "Content-Length: 18446744073709551615\r\n")), StartsWith("HTTP/1.1 413"));
  RawSocket socket(port_);
  socket.send(head("b.laz", "Transfer-Encoding: chunked\r\n"));
  socket.send("1d4c0\r\n" + bytes(120'000) + "\r\n0\r\n\r\n");  // does not say how long it is
  EXPECT_THAT(socket.read_http(), HasSubstr("larger than the 100000 bytes"));
  EXPECT_TRUE(eventually([this] { return files().empty(); }));
}

TEST_F(UploadTest, NothingIsLeftOfAScanThatIsBrokenOff) {
  start(config_);
  {
    RawSocket socket(port_);
    socket.send(head("a.laz", "Content-Length: 50000\r\n") + bytes(20'000));
    EXPECT_TRUE(eventually([this] { return !files().empty(); }));
    EXPECT_NE(files()[0], "a.laz") << "not under its name before it is whole";
  }
  EXPECT_TRUE(eventually([this] { return files().empty(); }));
  EXPECT_THAT(put("a.laz", "again"), StartsWith("HTTP/1.1 201"));
}

TEST_F(UploadTest, AServerThatStopsLeavesNoPartOfAScan) {
  config_.drain = std::chrono::milliseconds(10);
  start(config_);
  RawSocket socket(port_);
  socket.send(head("a.laz", "Content-Length: 50000\r\n") + bytes(20'000));
  EXPECT_TRUE(eventually([this] { return !files().empty(); }));
  stop();
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(UploadTest, NoMoreThanSoManyAreReceivedAtOnce) {
  config_.uploads.at_once = 1;
  start(config_);
  RawSocket socket(port_);
  socket.send(head("a.laz", "Content-Length: 4\r\n") + "ab");
  EXPECT_TRUE(eventually([this] { return !files().empty(); }));
  EXPECT_THAT(put("b.laz", "x"), StartsWith("HTTP/1.1 503"));
  EXPECT_THAT(put("a.ply", "x"), HasSubstr("is being received"));
  socket.send(std::string_view("cd"));
  EXPECT_THAT(socket.read_http(), StartsWith("HTTP/1.1 201"));
  EXPECT_THAT(put("b.laz", "x"), StartsWith("HTTP/1.1 201"));
}

TEST_F(UploadTest, PagesOfOtherOriginsAndOtherMethodsAreRefused) {
  start(config_);
  EXPECT_THAT(put("a.laz", "x", "Origin: https://evil.example\r\n"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(put("a.laz", "x", "Origin: null\r\n"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(http("OPTIONS /api/uploads/a.laz HTTP/1.1\r\nHost: here\r\nOrigin: https://evil.example\r\n"
                   "Access-Control-Request-Method: PUT\r\n\r\n"),
              Not(HasSubstr("Access-Control-Allow")));
  EXPECT_THAT(files(), IsEmpty());
  EXPECT_THAT(put("b.laz", "x", "Origin: http://here\r\n"), StartsWith("HTTP/1.1 201"));
  EXPECT_THAT(get("/api/uploads/b.laz"), StartsWith("HTTP/1.1 405"));
}

TEST_F(UploadTest, AClientThatSendsTooSlowlyGivesItsPlaceUp) {
  config_.uploads.at_once = 1;
  config_.uploads.timeout = std::chrono::milliseconds(1000);  // for the last scan, too, however busy the machine
  start(config_);
  RawSocket socket(port_);
  socket.send(head("a.laz", "Content-Length: 50000\r\n") + "slow");
  EXPECT_TRUE(socket.closed_within(RawSocket::kPatience));
  EXPECT_TRUE(eventually([this] { return files().empty(); }));
  EXPECT_THAT(put("b.laz", "x"), StartsWith("HTTP/1.1 201"));
}

// A header that names samples finds those of its own sender.
TEST_F(UploadTest, EachTokenHasAFolderOfItsOwn) {
  const std::string alice = access::make_secret();
  const std::string bob = access::make_secret();
  config_.tokens = folder_ / "tokens.json";
  const auto principal = [](const std::string& name, const std::string& secret) {
    return access::Principal{.name = name, .sha256 = access::sha256(secret), .models = {"*"}, .uploads = true};
  };
  ASSERT_TRUE(access::write_tokens(config_.tokens, {principal("alice", alice), principal("../bob", bob)}));
  start(config_);
  const auto put_as = [&](const std::string& secret, const std::string& name, const std::string& body) {
    return put(name, body, "Authorization: Bearer " + secret + "\r\n");
  };
  EXPECT_THAT(put_as(alice, "samples.raw", "hers"), StartsWith("HTTP/1.1 201"));
  EXPECT_THAT(put_as(bob, "samples.raw", "his"), StartsWith("HTTP/1.1 201"));
  EXPECT_THAT(put_as(bob, "house.laz", bytes(60'000)), StartsWith("HTTP/1.1 201"));
  EXPECT_EQ(content("sender-alice/samples.raw"), "hers");
  EXPECT_EQ(content("sender-%2E%2E%2Fbob/samples.raw"), "his");
  EXPECT_THAT(uploaded_scans(config_.uploads), ElementsAre(folder_ / "sender-%2E%2E%2Fbob" / "house.laz"));
  EXPECT_THAT(put_as(alice, "a.laz", bytes(95'000)), StartsWith("HTTP/1.1 201"));
  EXPECT_THAT(put_as(alice, "b.laz", bytes(99'000)), StartsWith("HTTP/1.1 503")) << "one total for all senders";
}

TEST_F(UploadTest, FoldersOfSendersAreNeverTheSame) {
  const std::string long_name(300, 'a');
  std::set<fs::path> folders;
  const std::vector<std::string> senders{"",  "a",   "A",    "a/b",     "a%2Fb",        "..",
                                         ".", "a b", "a\nb", long_name, long_name + "b"};
  for (const std::string& sender : senders) {
    const fs::path folder = upload_folder(config_.uploads, sender);
    EXPECT_EQ(sender.empty() ? folder : folder.parent_path(), folder_) << sender;
    EXPECT_LT(folder.filename().string().size(), 220U);
    folders.insert(folder);
  }
  EXPECT_EQ(folders.size(), senders.size());
}

TEST_F(UploadTest, AServerThatTakesNoneSaysSo) {
  config_.uploads.folder.clear();
  start(config_);
  EXPECT_THAT(put("a.laz", "x"), HasSubstr("--uploads"));
  EXPECT_FALSE(nlohmann::json::parse(get("/api/models").substr(get("/api/models").find('{'))).contains("uploads"));
}

TEST_F(UploadTest, AListOfModelsTellsWhatIsTaken) {
  start(config_);
  const std::string answer = get("/api/models");
  const nlohmann::json uploads = nlohmann::json::parse(answer.substr(answer.find('{')))["uploads"];
  EXPECT_EQ(uploads["max_bytes"], 100'000);
  EXPECT_EQ(uploads["extensions"], nlohmann::json({".laz", ".ply", ".nii.gz", ".raw", ".raw.gz"}));
}

}  // namespace
}  // namespace surfcast::net
