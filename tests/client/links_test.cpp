#include <string>

#include <gtest/gtest.h>

#include "client/run_program.h"
#include "support/path_of.h"

namespace surfcast::client {
namespace {

TEST(ThinClient, LinksNothingOfTheServer) {
  const ProgramOutcome linked = run_program("readelf -d " + path_of("surfcast"));
  ASSERT_EQ(linked.code, 0);
  ASSERT_NE(linked.output.find("libprotobuf-lite"), std::string::npos);
  for (const char* library : {"draco", "OpenImageIO", "EGL", "libGL", "epoxy", "OpenEXR", "tbb", "boost", "vpx"}) {
    EXPECT_EQ(linked.output.find(library), std::string::npos) << library;
  }
}

TEST(ThinClient, CarriesNothingOfTheServer) {
  const ProgramOutcome symbols = run_program("nm -C " + path_of("surfcast"));
  ASSERT_EQ(symbols.code, 0);
  ASSERT_NE(symbols.output.find("surfcast::client::ServerConnection::open"), std::string::npos);
  for (const char* name : {"draco::", "surfcast::model::ModelFile", "surfcast::render::Renderer"}) {
    EXPECT_EQ(symbols.output.find(name), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace surfcast::client
