#include "client/bench_report.h"

#include <nlohmann/json.hpp>
#include <numeric>

#include <gtest/gtest.h>

namespace surfcast::client {
namespace {

BenchFrame moving_frame(double latency, std::vector<std::pair<std::string, double>> stages = {}) {
  return {.moving = true,
          .converged = false,
          .latency_ms = latency,
          .turned = latency / 10,
          .depth_bytes = 800,
          .bytes = 1000,
          .width = 640,
          .spacing = 2,
          .stages = std::move(stages)};
}

BenchFrame final_frame(double latency) {
  return {.moving = false,
          .converged = true,
          .latency_ms = latency,
          .turned = 0,
          .depth_bytes = 0,
          .bytes = 9000,
          .width = 1280,
          .spacing = 1,
          .stages = {}};
}

TEST(Percentiles, AreValuesThatOccurred) {
  std::vector<double> values(200);
  std::iota(values.rbegin(), values.rend(), 1);
  const Percentiles figures = percentiles(values);
  EXPECT_EQ(figures.count, 200u);
  EXPECT_EQ(figures.mean, 100.5);
  EXPECT_EQ(figures.p50, 100);
  EXPECT_EQ(figures.p95, 190);
  EXPECT_EQ(figures.p99, 198);
  EXPECT_EQ(figures.most, 200);
}

TEST(Percentiles, OfFewValuesAreTheLargest) {
  EXPECT_EQ(percentiles({7}).p99, 7);
  EXPECT_EQ(percentiles({7}).p50, 7);
  EXPECT_EQ(percentiles({1, 2}).p50, 1);
  EXPECT_EQ(percentiles({}).count, 0u);
}

TEST(BenchReport, RatesAreOverClientsAndLatenciesOverFrames) {
  BenchRecord quick;
  quick.moving_seconds = 2;
  quick.frames = {moving_frame(10), moving_frame(20), moving_frame(30), moving_frame(40), final_frame(500)};
  BenchRecord slow;
  slow.moving_seconds = 2;
  slow.frames = {moving_frame(100), final_frame(900)};
  const BenchReport report = make_report({quick, slow});
  EXPECT_EQ(report.clients, 2u);
  EXPECT_EQ(report.frames_per_second.p50, 0.5);
  EXPECT_EQ(report.frames_per_second.most, 2);
  EXPECT_EQ(report.latency.p50, 30);
  EXPECT_EQ(report.latency.most, 100);
  EXPECT_EQ(report.converged.p50, 500);
  EXPECT_EQ(report.converged.most, 900);
  EXPECT_EQ(report.moving_frames, 5u);
  EXPECT_EQ(report.turned.p50, 3);
  EXPECT_EQ(report.depth_bytes.most, 800);
}

TEST(BenchReport, GrowthOfLatencyShowsInItsThirds) {
  BenchRecord record;
  for (int i = 1; i <= 30; ++i) record.frames.push_back(moving_frame(i));
  const BenchReport report = make_report({record});
  EXPECT_EQ(report.latency_begin.most, 10);
  EXPECT_EQ(report.latency_end.p50, 25);
}

TEST(BenchReport, WhatNoStageAccountsForIsOutsideAndPartsAreNotCountedTwice) {
  BenchRecord record;
  record.frames = {
      moving_frame(100, {{"queue", 5}, {"load", 20}, {"decode", 18}, {"upload", 2}, {"splat", 30}, {"transfer", 9}})};
  const BenchReport report = make_report({record});
  EXPECT_EQ(report.outside.p50, 45);
  EXPECT_EQ(report.moving_stages.at("splat").p50, 30);
}

TEST(BenchReport, ARunWithoutFramesIsNoDivisionByZero) {
  const BenchReport report = make_report({BenchRecord{}});
  EXPECT_EQ(report.frames_per_second.count, 0u);
  EXPECT_FALSE(to_text(report).empty());
}

TEST(BenchReport, JsonHoldsTheFigures) {
  BenchRecord record;
  record.moving_seconds = 1;
  record.frames = {moving_frame(10, {{"splat", 3}}), final_frame(20)};
  record.frames[1].stages = {{"splat", 7}};
  const auto document = nlohmann::json::parse(to_json(make_report({record}), "here:1/cube"));
  EXPECT_EQ(document["url"], "here:1/cube");
  EXPECT_EQ(document["moving"]["latency_ms"]["p95"], 10);
  EXPECT_EQ(document["moving"]["stages_ms"]["splat"]["p50"], 3);
  EXPECT_EQ(document["rest"]["converged_ms"]["p50"], 20);
  EXPECT_EQ(document["rest"]["stages_ms"]["splat"]["p50"], 7);
}

}  // namespace
}  // namespace surfcast::client
