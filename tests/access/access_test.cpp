#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "access/authorization.h"
#include "access/joined_name.h"
#include "access/secret.h"
#include "access/token_file.h"
#include "access/token_table.h"

namespace surfcast::access {
namespace {

namespace fs = std::filesystem;
using std::chrono::hours;
using ::testing::HasSubstr;
using ::testing::Not;

class TokenFileTest : public ::testing::Test {
 protected:
  void SetUp() override { fs::remove(file_); }
  void TearDown() override { fs::remove(file_); }
  Result<std::vector<Principal>> read(const std::string& text) const {
    std::ofstream(file_) << text;
    return read_tokens(file_);
  }

  fs::path file_ =
      fs::path(::testing::TempDir()) / (std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) +
                                        "_" + std::to_string(::getpid()) + ".json");
};

const std::string kHash(64, 'a');

TEST(SecretTest, HasAKnownHashAndIsNewEachTime) {
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");  // FIPS 180-4
  EXPECT_NE(make_secret(), make_secret());
  EXPECT_TRUE(is_secret(make_secret()));
  EXPECT_FALSE(is_secret(make_secret() + "A"));
  EXPECT_FALSE(is_secret(std::string(43, '+')));
}

Rights rights_of(const Principal& principal) {
  return Rights::of(std::make_shared<const Principal>(principal));
}

TEST(RightsTest, AllowTheModelsOfTheirPatterns) {
  const Rights some = rights_of({.name = "a", .sha256 = kHash, .models = {"church*", "tower-?", "[xy]"}});
  for (const std::string seen : {"church", "church 2", "tower-1", "x"}) {
    EXPECT_TRUE(some.authorize(seen).allowed()) << seen;
  }
  for (const std::string other : {"Church", "a church", "tower-10", "z", ""}) {
    EXPECT_FALSE(some.authorize(other).allowed()) << other;
  }
  EXPECT_FALSE(rights_of({.name = "b", .sha256 = kHash, .models = {}}).authorize("church").allowed());
  EXPECT_FALSE(Rights::of(nullptr).authorize("church").allowed()) << "nobody may do nothing";
  EXPECT_TRUE(Rights::unlimited().authorize("church").allowed());
}

TEST(RightsTest, AModelThatIsNotAllowedIsLookedUpUnderANameThatNoneHas) {
  const AuthorizedModel allowed = Rights::unlimited().authorize("church");
  EXPECT_EQ(allowed.name(), "church");
  EXPECT_EQ(allowed.served_name(), "church");
  const AuthorizedModel denied = Rights::of(nullptr).authorize("church");
  EXPECT_EQ(denied.name(), "church");
  EXPECT_NE(denied.served_name().find('/'), std::string::npos) << "no name of a file has one";
  EXPECT_EQ(shown_name(denied.served_name()), "church");
  EXPECT_EQ(shown_name(allowed.served_name()), "church");
}

TEST(RightsTest, ModelsThatAreJoinedAreAllowedTogether) {
  EXPECT_EQ(members_of("a+b+c"), (std::vector<std::string>{"a", "b", "c"}));
  for (const std::string alone : {"a", "", "+", "a+", "+a", "a++b"}) EXPECT_TRUE(members_of(alone).empty()) << alone;

  const Rights some = rights_of({.name = "a", .sha256 = kHash, .models = {"nave", "tower-?"}});
  const AuthorizedModel both = some.authorize("nave+tower-1");
  EXPECT_TRUE(both.allowed());
  EXPECT_FALSE(both.allowed_alone()) << "a model of exactly this name";
  EXPECT_FALSE(some.authorize("nave+crypt").allowed());
  EXPECT_FALSE(some.authorize("crypt+nave").allowed());
}

// What may be looked up under a served name is what was allowed, whatever the name that was asked for looks like.
TEST(RightsTest, AServedNameSaysWhatMayBeTheAnswer) {
  struct Case {
    std::vector<std::string> patterns;
    bool alone = false;
    bool joined = false;
  };
  for (const Case& of : {Case{{"*"}, true, true}, Case{{"a+*"}, true, false}, Case{{"a", "b"}, false, true},
                         Case{{"a"}, false, false}, Case{{"[ab]", "a[+]b"}, true, true}}) {
    const Rights rights = rights_of({.name = "x", .sha256 = kHash, .models = of.patterns});
    const ServedName served = parse_served_name(rights.authorize("a+b").served_name());
    EXPECT_EQ(served.name, "a+b");
    EXPECT_EQ(served.alone, of.alone) << of.patterns.front();
    EXPECT_EQ(served.joined, of.joined) << of.patterns.front();
  }
  const Rights everything = rights_of({.name = "x", .sha256 = kHash, .models = {"*"}});
  const Rights nothing = Rights::of(nullptr);
  for (const std::string asked : {"/a+b", "/0a+b", "/1a+b", "/2a+b", "//2a+b", "a/+b", "a+/2b", "/2/2a+b"}) {
    for (const Rights& rights : {everything, nothing}) {
      const AuthorizedModel model = rights.authorize(asked);
      const ServedName served = parse_served_name(model.served_name());
      EXPECT_FALSE(model.allowed() || served.alone || served.joined) << asked;
      EXPECT_EQ(served.name, asked);
    }
  }
}

TEST(RightsTest, WritingNeedsARightOfItsOwn) {
  const Rights reader = rights_of({.name = "a", .sha256 = kHash, .models = {"*"}});
  EXPECT_FALSE(reader.authorize_annotations("church"));
  EXPECT_FALSE(reader.authorize_upload("church.laz", "church"));

  const Rights writer =
      rights_of({.name = "b", .sha256 = kHash, .models = {"church"}, .uploads = true, .annotations = true});
  EXPECT_FALSE(writer.authorize_annotations("tower"));
  EXPECT_FALSE(writer.authorize_upload("tower.laz", "tower"));
  const auto annotations = writer.authorize_annotations("church");
  ASSERT_TRUE(annotations);
  EXPECT_TRUE(annotations->model().allowed());
  const auto upload = writer.authorize_upload("church.laz", "church");
  ASSERT_TRUE(upload);
  EXPECT_EQ(upload->file(), "church.laz");
  EXPECT_EQ(upload->sender(), "b");

  EXPECT_FALSE(Rights::of(nullptr).authorize_annotations("church"));
  EXPECT_FALSE(Rights::of(nullptr).authorize_upload("church.laz", "church"));
  EXPECT_TRUE(Rights::unlimited().authorize_annotations("church"));
  const auto of_anybody = Rights::unlimited().authorize_upload("church.laz", "church");
  ASSERT_TRUE(of_anybody);
  EXPECT_EQ(of_anybody->sender(), "");
}

// Rights alone make what stands for their decision.
static_assert(!std::is_default_constructible_v<AuthorizedModel> && !std::is_default_constructible_v<Rights>);
static_assert(!std::is_constructible_v<AuthorizedModel, std::string>);
static_assert(!std::is_constructible_v<AuthorizedModel, std::string, bool>);
static_assert(!std::is_constructible_v<AuthorizedAnnotations, AuthorizedModel>);
static_assert(!std::is_constructible_v<AuthorizedUpload, std::string, std::string>);
static_assert(!std::is_constructible_v<Rights, std::shared_ptr<const Principal>, bool>);

TEST_F(TokenFileTest, WhatIsWrittenIsReadForItsOwnerAlone) {
  const auto expires = *parse_time("2027-01-31T12:00:00Z");
  const std::vector<Principal> tokens{
      {.name = "alice", .sha256 = kHash, .models = {"*"}, .expires = expires, .connections = 3, .views = 2},
      {.name = "bob", .sha256 = std::string(64, 'b'), .models = {}, .uploads = true, .annotations = true}};
  ASSERT_TRUE(write_tokens(file_, tokens));
  EXPECT_EQ(read_tokens(file_), tokens);
  EXPECT_EQ(fs::status(file_).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  fs::permissions(file_, fs::perms::group_read, fs::perm_options::add);
  ASSERT_TRUE(write_tokens(file_, tokens));
  EXPECT_NE(fs::status(file_).permissions() & fs::perms::group_read, fs::perms::none) << "a mode that was set stays";
}

TEST_F(TokenFileTest, WhatIsNoFileOfTokensIsAnErrorThatNamesIt) {
  const std::string hash = kHash;
  const std::string entry = R"({"name": "a", "sha256": ")" + hash + R"("})";
  const std::vector<std::string> wrong{
      "",
      "[]",
      "{}",
      R"({"tokens": [{"name": "a"}]})",
      R"({"tokens": [{"name": "a", "sha256": "12"}]})",
      R"({"tokens": [)" + entry + "," + entry + "]}",
      R"({"tokens": [{"name": "a", "sha256": ")" + hash + R"(", "models": "x"}]})",
      R"({"tokens": [{"name": "a", "sha256": ")" + hash + R"(", "expires": "tomorrow"}]})"};
  for (const std::string& text : wrong) {
    const auto tokens = read(text);
    ASSERT_FALSE(tokens) << text;
    EXPECT_THAT(tokens.error().message, HasSubstr(file_.string()));
    EXPECT_THAT(tokens.error().message, Not(HasSubstr("\n")));
  }
  EXPECT_TRUE(read(R"({"tokens": []})"));
  EXPECT_EQ(read(R"({"tokens": [)" + entry + "]}")->size(), 1U);
  EXPECT_FALSE(read_tokens(file_.string() + ".absent"));
}

TEST(TokenTableTest, FindsASecretUntilItExpires) {
  const auto now = std::chrono::system_clock::now();
  const std::string secret = make_secret();
  const Principal principal{.name = "a", .sha256 = sha256(secret), .models = {"*"}, .expires = now + hours(1)};
  const TokenTable table({principal});
  ASSERT_TRUE(table.find(secret, now));
  EXPECT_EQ(table.find(secret, now)->name, "a");
  EXPECT_FALSE(table.find(secret, now + hours(1)));
  EXPECT_FALSE(table.find(make_secret(), now));
  EXPECT_FALSE(table.find("", now));
}

TEST(TokenTableTest, TellsWhyAPrincipalIsNotServedAnyMore) {
  const auto now = std::chrono::system_clock::now();
  Principal principal{.name = "a", .sha256 = kHash, .models = {"*"}, .expires = now + hours(1)};
  EXPECT_EQ(TokenTable({principal}).why_ended(principal, now), "");
  EXPECT_EQ(TokenTable({principal}).why_ended(principal, now + hours(2)), "the token has expired");
  EXPECT_EQ(TokenTable({}).why_ended(principal, now), "the token was revoked");
  Principal less = principal;
  less.models = {"church"};
  EXPECT_EQ(TokenTable({less}).why_ended(principal, now), "what the token allows has changed");
}

}  // namespace
}  // namespace surfcast::access
