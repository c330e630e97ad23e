#include <memory>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "gl/egl_context.h"
#include "residency/block_memory.h"

namespace surfcast::residency {
namespace {

constexpr size_t kMost = size_t{3} << 20;  // texels: the buffer grows twice

std::vector<uint32_t> random_words(size_t count, uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<uint32_t> words(count);
  for (uint32_t& word : words) word = static_cast<uint32_t>(random());
  return words;
}

std::span<const glm::uvec4> as_texels(const std::vector<uint32_t>& words) {
  return {reinterpret_cast<const glm::uvec4*>(words.data()), words.size() / 4};
}

/// Words from the buffer behind the texture that is bound to a unit.
std::vector<uint32_t> bound_words(GLuint unit, size_t first, size_t count) {
  GLint texture = 0;
  GLint buffer = 0;
  glGetIntegeri_v(GL_TEXTURE_BINDING_BUFFER, unit, &texture);
  glGetTextureLevelParameteriv(static_cast<GLuint>(texture), 0, GL_TEXTURE_BUFFER_DATA_STORE_BINDING, &buffer);
  std::vector<uint32_t> words(count);
  glGetNamedBufferSubData(static_cast<GLuint>(buffer), static_cast<GLintptr>(first * sizeof(uint32_t)),
                          static_cast<GLsizeiptr>(count * sizeof(uint32_t)), words.data());
  return words;
}

/// With the memory of software GL, and with that of hardware, which any device can take.
class BlockMemoryGLTest : public ::testing::TestWithParam<bool> {
 protected:
  static void SetUpTestSuite() {
    Result<std::unique_ptr<gl::EglContext>> context = gl::EglContext::create(-1);
    ASSERT_TRUE(context) << context.error().message;
    context_ = std::move(*context);
  }
  static void TearDownTestSuite() { context_.reset(); }
  void TearDown() override { EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR}); }

  static inline std::unique_ptr<gl::EglContext> context_;
  BlockMemory memory_{kMost, GetParam()};
};

TEST_P(BlockMemoryGLTest, WhatWasWrittenStaysWhenTheBufferGrows) {
  const std::vector<uint32_t> first = random_words(4 * 1000, 1);
  const std::vector<uint32_t> second = random_words(4 * 1000, 2);
  const std::vector<uint32_t> last = random_words(4 * 24, 3);
  memory_.write(0, as_texels(first));
  memory_.write(kMost / 2, as_texels(second));
  memory_.write(kMost - 24, as_texels(last));
  memory_.bind(0);
  EXPECT_TRUE(bound_words(0, 0, first.size()) == first);
  EXPECT_TRUE(bound_words(0, 4 * (kMost / 2), second.size()) == second);
  EXPECT_TRUE(bound_words(0, 4 * (kMost - 24), last.size()) == last);
}

TEST_P(BlockMemoryGLTest, BlocksOfAnySizeAreWrittenWhole) {
  // One of more than the ring of uploads, and then so many that its end is passed at odd places.
  const std::vector<uint32_t> large = random_words(BlockMemory::kRingBytes / sizeof(uint32_t) * 5 / 2, 4);
  memory_.write(7, as_texels(large));
  std::vector<std::vector<uint32_t>> blocks;
  size_t at = 7 + large.size() / 4;
  for (uint32_t i = 0; i < 40; ++i) {
    blocks.push_back(random_words(4 * (9000 + 101 * i), 10 + i));
    memory_.write(at, as_texels(blocks.back()));
    at += blocks.back().size() / 4;
  }
  memory_.bind(0);
  EXPECT_TRUE(bound_words(0, 4 * 7, large.size()) == large);
  at = 7 + large.size() / 4;
  for (const std::vector<uint32_t>& block : blocks) {
    EXPECT_TRUE(bound_words(0, 4 * at, block.size()) == block);
    at += block.size() / 4;
  }
}

TEST_P(BlockMemoryGLTest, AttributesHaveABufferOfTheirOwn) {
  const std::vector<uint32_t> surfels = random_words(4 * 300, 5);
  const std::vector<uint32_t> attributes = random_words(300, 6);
  memory_.write(50, as_texels(surfels));
  memory_.write_attributes(50, attributes);
  memory_.bind(0);
  memory_.bind_attributes(1);
  EXPECT_TRUE(bound_words(0, 4 * 50, surfels.size()) == surfels);
  EXPECT_TRUE(bound_words(1, 50, attributes.size()) == attributes);
}

INSTANTIATE_TEST_SUITE_P(Memory, BlockMemoryGLTest, ::testing::Values(false, true),
                         [](const auto& kind) { return kind.param ? "ofTheHost" : "ofTheDevice"; });

}  // namespace
}  // namespace surfcast::residency
