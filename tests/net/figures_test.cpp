#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include <gmock/gmock.h>

#include "net/exposition.h"
#include "net/metrics.h"
#include "net/net_fixture.h"
#include "net/trace.h"
#include "support/path_of.h"

namespace surfcast::net {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;

TEST(HistogramTest, CountsEachValueInItsBinAndAllAbove) {
  Histogram histogram;
  for (const double seconds : {0.0005, 0.001, 0.0011, 1.0, 100.0}) histogram.add(seconds);
  EXPECT_EQ(Histogram::bound(0), 0.001);
  EXPECT_DOUBLE_EQ(Histogram::bound(Histogram::kBins - 1), 32.768);
  EXPECT_EQ(histogram.count_to(0), 2U);
  EXPECT_EQ(histogram.count_to(1), 3U);
  EXPECT_EQ(histogram.count_to(Histogram::kBins - 1), 4U);
  EXPECT_EQ(histogram.count(), 5U);
  EXPECT_NEAR(histogram.sum(), 101.0026, 1e-9);
}

TEST(ExpositionTest, WritesBothFormats) {
  for (const auto format : {Exposition::Format::kPrometheus, Exposition::Format::kOpenMetrics}) {
    Exposition out(format);
    out.value("a_total", "counter", "Some.", 3);
    out.begin("t_seconds", "histogram", "Times.");
    Histogram histogram;
    histogram.add(0.5);
    out.add("t_seconds", label_of("kind", "a\"b"), histogram);
    const bool open = format == Exposition::Format::kOpenMetrics;
    EXPECT_THAT(out.text(), HasSubstr(open ? "# TYPE a counter\na_total 3\n" : "# TYPE a_total counter\na_total 3\n"));
    EXPECT_THAT(out.text(), HasSubstr("t_seconds_bucket{kind=\"a\\\"b\",le=\"0.512\"} 1\n"));
    EXPECT_THAT(out.text(), HasSubstr("t_seconds_bucket{kind=\"a\\\"b\",le=\"+Inf\"} 1\n"));
    EXPECT_THAT(out.text(), HasSubstr("t_seconds_sum{kind=\"a\\\"b\"} 0.5\n"));
    EXPECT_EQ(out.text().ends_with("# EOF\n"), open);
  }
}

TEST(TraceTest, TakesOverTheTraceAndHasASpanOfItsOwn) {
  const std::string sent = "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01";
  const std::string answered = answered_trace(sent);
  ASSERT_EQ(answered.size(), sent.size());
  EXPECT_EQ(answered.substr(0, 36), sent.substr(0, 36));
  EXPECT_NE(answered, sent);
  EXPECT_THAT(answered, EndsWith("-01"));
  EXPECT_NE(answered_trace(sent), answered) << "each answer is a span";
}

TEST(TraceTest, WhatIsNoTraceIsLeftOut) {
  const std::string trace = "4bf92f3577b34da6a3ce929d0e0e4736";
  for (const std::string& wrong :
       {std::string(), "00-" + trace, "00-" + trace + "-00f067aa0ba902b7-01x", "ff-" + trace + "-00f067aa0ba902b7-01",
        "00-" + std::string(32, '0') + "-00f067aa0ba902b7-01", "00-" + trace + "-0000000000000000-01",
        "00-" + std::string(32, 'G') + "-00f067aa0ba902b7-01"}) {
    EXPECT_EQ(answered_trace(wrong), "") << wrong;
  }
  EXPECT_NE(answered_trace("01-" + trace + "-00f067aa0ba902b7-01-later"), "");
}

class FiguresTest : public NetFixture {};

TEST_F(FiguresTest, MetricsAreOpenMetricsWhereTheyAreAskedForAsSuch) {
  start();
  EXPECT_EQ(get("/api/models/cube/image?resolution=4,4").substr(9, 3), "200");
  const std::string open = http(
      "GET /metrics HTTP/1.1\r\nHost: here\r\nConnection: close\r\n"
      "Accept: application/openmetrics-text;version=1.0.0\r\n\r\n");
  EXPECT_THAT(open, AllOf(HasSubstr("Content-Type: application/openmetrics-text"), EndsWith("# EOF\n")));
  EXPECT_THAT(get("/metrics"), AllOf(HasSubstr("Content-Type: text/plain; version=0.0.4"), Not(HasSubstr("# EOF"))));
  EXPECT_EQ(metric("surfcast_picture_seconds_count{kind=\"still\"}"), 1);
}

TEST_F(FiguresTest, AnAnswerIsASpanOfTheRequestsTrace) {
  start();
  const std::string trace = "4bf92f3577b34da6a3ce929d0e0e4736";
  EXPECT_THAT(http("GET /healthz HTTP/1.1\r\nHost: here\r\nConnection: close\r\n"
                   "traceparent: 00-" +
                   trace + "-00f067aa0ba902b7-01\r\n\r\n"),
              HasSubstr("traceparent: 00-" + trace + "-"));
  EXPECT_THAT(get("/healthz"), Not(HasSubstr("traceparent")));
}

std::set<std::string> names_in(const std::string& text) {
  const std::regex name("surfcast_[a-z_]+");
  std::set<std::string> names;
  for (std::sregex_iterator found(text.begin(), text.end(), name), end; found != end; ++found) {
    names.insert(found->str());
  }
  return names;
}

TEST(DashboardTest, ShowsFiguresThatThereAre) {
  Metrics metrics;
  metrics.tls_expires = 1;
  metrics.stage_seconds["draw"] = 1;
  const std::set<std::string> there = names_in(metrics_text(metrics, {}, Exposition::Format::kPrometheus));
  std::ifstream stream(path_of("deploy/grafana/surfcast.json"));
  std::ostringstream dashboard;
  dashboard << stream.rdbuf();
  const std::set<std::string> shown = names_in(dashboard.str());
  EXPECT_GT(shown.size(), 10U);
  EXPECT_THAT(there, IsSupersetOf(shown));
}

}  // namespace
}  // namespace surfcast::net
