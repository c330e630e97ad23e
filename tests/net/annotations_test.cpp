#include "net/annotations.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "access/secret.h"
#include "access/token_file.h"
#include "net/net_fixture.h"

namespace surfcast::net {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const std::string kGate = R"({"name": "Gate", "parameters": {"position": "1,2,3", "focal_point": "0,0,0"}})";
const std::string kCrack = R"({"text": "A crack", "position": [1.5, -2, 3e2], "parameters": {"position": "1,2,3"}})";

std::string document_of(const std::string& views, const std::string& annotations) {
  return R"({"format": "surfcast-annotations", "version": 1, "views": [)" + views + R"(], "annotations": [)" +
         annotations + "]}";
}

std::string problem_of(const std::string& document) {
  const Result<std::string> normalized = normalized_annotations(document, "cube");
  return normalized ? "" : normalized.error().message;
}

TEST(AnnotationDocument, IsKeptIndentedAndInAFixedOrder) {
  const Result<std::string> text = normalized_annotations(document_of(kGate, kCrack), "cube");
  ASSERT_TRUE(text);
  EXPECT_EQ(*text, R"({
  "format": "surfcast-annotations",
  "version": 1,
  "model": "cube",
  "views": [
    {
      "name": "Gate",
      "parameters": {
        "position": "1,2,3",
        "focal_point": "0,0,0"
      }
    }
  ],
  "annotations": [
    {
      "text": "A crack",
      "position": [
        1.5,
        -2,
        300.0
      ],
      "parameters": {
        "position": "1,2,3"
      }
    }
  ]
}
)");
  EXPECT_EQ(*normalized_annotations(*text, "cube"), *text);
}

TEST(AnnotationDocument, HasNothingElseInIt) {
  EXPECT_EQ(problem_of("nonsense"), "the annotations are not JSON");
  EXPECT_EQ(problem_of("[]"), "the document of annotations is not an object");
  EXPECT_EQ(problem_of("{}"), "the format is not \"surfcast-annotations\"");
  EXPECT_EQ(problem_of(R"({"format": "surfcast-annotations", "version": 2})"),
            "the annotations are of another version of Surfcast");
  EXPECT_THAT(problem_of(R"({"format": "surfcast-annotations", "version": 1, "wiews": []})"), HasSubstr("'wiews'"));
  EXPECT_EQ(problem_of(document_of(kGate + ", 7", "")), "view 2 is not an object");
  EXPECT_EQ(problem_of(document_of(R"({"name": "", "parameters": {}})", "")), "view 1: name must have 1 to 320 bytes");
  EXPECT_EQ(problem_of(document_of(R"({"name": "a", "parameters": {"opacity": 1}})", "")),
            "view 1: parameters are short texts");
  EXPECT_EQ(problem_of(document_of("", R"({"text": "a", "position": [1, 2], "parameters": {}})")),
            "annotation 1: position must be three finite numbers");
  EXPECT_EQ(problem_of(document_of("", R"({"text": "a", "position": [1, 2, 1e400], "parameters": {}})")),
            "the annotations are not JSON");
  EXPECT_THAT(problem_of(document_of("", R"({"text": ")" + std::string(kMaxAnnotationTextBytes + 1, 'x') + R"("})")),
              HasSubstr("1 to 4000 bytes"));
  EXPECT_EQ(problem_of(document_of("", std::string(100'000, '['))), "the annotations are not JSON");
}

TEST(AnnotationFile, StaysInItsFolderWhateverTheNameOfTheModel) {
  const AnnotationConfig config{.folder = "/notes"};
  EXPECT_EQ(annotation_file(config, "church 2.b"), "/notes/church 2.b.json");
  EXPECT_EQ(annotation_file(config, "../../etc/passwd"), "/notes/%2E.%2F..%2Fetc%2Fpasswd.json");
  EXPECT_EQ(annotation_file(config, "a%2Fb"), "/notes/a%252Fb.json") << "no two names have one file";
  EXPECT_EQ(annotation_file(config, "Düne"), "/notes/Düne.json");
}

/// A server that keeps annotations of up to 4000 bytes.
class AnnotationsTest : public NetFixture {
 protected:
  void SetUp() override {
    const std::string test = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    folder_ = fs::path(::testing::TempDir()) / ("annotations_" + test + "_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "kept");
    config_.annotations = {.folder = folder_ / "kept", .bytes = 4000};
  }
  void TearDown() override {
    stop();
    fs::remove_all(folder_);
  }

  [[nodiscard]] std::string put(const std::string& body, const std::string& headers = {},
                                const std::string& model = "cube") const {
    return http("PUT /api/models/" + model + "/annotations HTTP/1.1\r\nHost: here\r\n" + headers +
                "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body);
  }
  [[nodiscard]] std::string get_as(const std::string& secret) const {
    return http("GET /api/models/cube/annotations HTTP/1.1\r\nHost: here\r\nConnection: close\r\n" + bearer(secret) +
                "\r\n");
  }
  static std::string bearer(const std::string& secret) { return "Authorization: Bearer " + secret + "\r\n"; }
  static std::string edition_in(const std::string& answer) {
    const size_t begin = answer.find("ETag: ") + 6;
    return answer.substr(begin, answer.find('\r', begin) - begin);
  }
  [[nodiscard]] std::string file() const {
    std::ifstream stream(folder_ / "kept" / "cube.json");
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
  }

  fs::path folder_;
  ServerConfig config_;
};

TEST_F(AnnotationsTest, AreWrittenByOneAndReadByOthersAsAFileOfTheModel) {
  start(config_);
  const std::string before = get("/api/models/cube/annotations");
  EXPECT_THAT(before, AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("\"annotations\": []"), HasSubstr("GET, HEAD, PUT")));
  const std::string written = put(document_of(kGate, kCrack), "If-Match: " + edition_in(before) + "\r\n");
  EXPECT_THAT(written, AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("A crack")));
  const std::string after = get("/api/models/cube/annotations");
  EXPECT_THAT(after, AllOf(HasSubstr("Gate"), HasSubstr("A crack")));
  EXPECT_EQ(edition_in(after), edition_in(written));
  EXPECT_EQ(file(), *normalized_annotations(document_of(kGate, kCrack), "cube"));
}

TEST_F(AnnotationsTest, ThatOthersHaveChangedMeanwhileAreNotOverwritten) {
  start(config_);
  const std::string first = edition_in(get("/api/models/cube/annotations"));
  EXPECT_THAT(put(document_of(kGate, ""), "If-Match: " + first + "\r\n"), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(put(document_of("", kCrack), "If-Match: " + first + "\r\n"), StartsWith("HTTP/1.1 412"));
  EXPECT_THAT(file(), HasSubstr("Gate"));
  EXPECT_THAT(put(document_of("", kCrack)), StartsWith("HTTP/1.1 200")) << "without If-Match, whatever is there";
  EXPECT_THAT(file(), Not(HasSubstr("Gate")));
}

TEST_F(AnnotationsTest, ThatArePutIntoTheFolderAreRead) {
  start(config_);
  std::ofstream(folder_ / "kept" / "cube.json") << document_of(kGate, "");
  EXPECT_THAT(get("/api/models/cube/annotations"), HasSubstr("Gate"));
  std::ofstream(folder_ / "kept" / "cube.json") << "nonsense";
  const std::string answer = get("/api/models/cube/annotations");
  EXPECT_THAT(answer, AllOf(StartsWith("HTTP/1.1 500"), HasSubstr("the file of cube: the annotations are not JSON")));
  EXPECT_THAT(answer, Not(HasSubstr(folder_.string())));
}

TEST_F(AnnotationsTest, ThatAreWrongOrTooLongAreRefused) {
  start(config_);
  EXPECT_THAT(put("nonsense"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(put(document_of(kGate, "") + std::string(4000, ' ')), StartsWith("HTTP/1.1 413"));
  std::string many = kCrack;
  for (int i = 0; i < 30; ++i) many += "," + kCrack;
  EXPECT_THAT(put(document_of("", many)), StartsWith("HTTP/1.1 413")) << "short as sent, too long as kept";
  EXPECT_THAT(put(document_of(kGate, ""), "Origin: https://elsewhere.example\r\n"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(put(document_of(kGate, ""), "", "absent"), StartsWith("HTTP/1.1 404"));
  EXPECT_TRUE(fs::is_empty(folder_ / "kept"));
}

TEST_F(AnnotationsTest, NeedAFolder) {
  config_.annotations.folder.clear();
  start(config_);
  EXPECT_THAT(get("/api/models/cube/annotations"), AllOf(StartsWith("HTTP/1.1 501"), HasSubstr("--annotations")));
  EXPECT_THAT(put(document_of(kGate, "")), StartsWith("HTTP/1.1 501"));
}

TEST_F(AnnotationsTest, AreReadByWhoSeesTheModelAndWrittenByWhoMay) {
  const std::string reader = access::make_secret();
  const std::string writer = access::make_secret();
  const std::string other = access::make_secret();
  config_.tokens = folder_ / "tokens.json";
  ASSERT_TRUE(access::write_tokens(
      config_.tokens, {{.name = "reader", .sha256 = access::sha256(reader), .models = {"*"}},
                       {.name = "writer", .sha256 = access::sha256(writer), .models = {"cube"}, .annotations = true},
                       {.name = "other", .sha256 = access::sha256(other), .models = {"x"}, .annotations = true}}));
  start(config_);
  EXPECT_THAT(put(document_of(kGate, "")), StartsWith("HTTP/1.1 401"));
  EXPECT_THAT(put(document_of(kGate, ""), bearer(reader)), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(put(document_of(kGate, ""), bearer(other)), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(put(document_of(kGate, ""), bearer(writer)), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(get_as(reader), AllOf(HasSubstr("Gate"), HasSubstr("Allow: GET, HEAD\r\n")));
  EXPECT_THAT(get_as(writer), HasSubstr("Allow: GET, HEAD, PUT\r\n"));
  EXPECT_THAT(get_as(other), StartsWith("HTTP/1.1 404")) << "a model that a token does not open is absent for it";
  EXPECT_THAT(get("/api/models/cube/annotations"), StartsWith("HTTP/1.1 401"));
}

}  // namespace
}  // namespace surfcast::net
