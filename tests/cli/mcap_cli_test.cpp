// MCAP files as the program writes them, and as the format's own npm reader finds them where that is
// installed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/support/places.hpp"

namespace stillpoint {
namespace {

using ::testing::HasSubstr;

constexpr int kMcapFrames = 8;

class Mcap : public ::testing::Test {
 protected:
  Mcap() {
    const CliResult run = run_cli({"run", sequence.path(), "--method", "paper", "--out", sequence.path("run"),
                                   "--mcap", sequence.path("beside.mcap")});
    EXPECT_EQ(run.exit_code, 0) << run.err;
  }
  SmallSequence sequence{kMcapFrames};
};

TEST_F(Mcap, BesideTheRunAndAfterwardsAreTheSame) {
  const CliResult after = run_cli({"export", sequence.path("run"), "--to", sequence.path("after.mcap")});
  EXPECT_EQ(after.exit_code, 0) << after.err;
  EXPECT_THAT(after.out, HasSubstr("8 frames"));
  EXPECT_EQ(sequence.folder.read("after.mcap"), sequence.folder.read("beside.mcap"));
  EXPECT_TRUE(nlohmann::json::accept(sequence.folder.read("after.foxglove.json")));
  EXPECT_FALSE(std::filesystem::exists(sequence.path("after.mcap.part")));
}

TEST_F(Mcap, WhatCannotBeMeantIsRefused) {
  expect_one_sentence(run_cli({"export", sequence.path("run"), "--to", sequence.path("beside.mcap")}),
                      "is there already; --force replaces it");
  expect_one_sentence(run_cli({"export", sequence.path("run"), "--to", sequence.path("a.bag")}),
                      "expected a name that ends in .mcap");
  const CliResult layers =
      run_cli({"export", sequence.path("run"), "--to", sequence.path("l.mcap"), "--layers", "nonsense"});
  EXPECT_EQ(layers.exit_code, 1);
  EXPECT_THAT(layers.err, HasSubstr("--layers nonsense: no stage of any frame has a layer of that id"));
  for (const char* left : {"l.mcap", "l.mcap.part"})
    EXPECT_FALSE(std::filesystem::exists(sequence.path(left)));
}

TEST_F(Mcap, TheFormatsOwnReaderFindsEverything) {
  const std::string script = places::source() + "/tests/support/read_mcap.cjs";
  const std::string finds = "node -e 'require(\"@mcap/core\"); require(\"fzstd\")' >/dev/null 2>&1";
  if (std::system(finds.c_str()) != 0) GTEST_SKIP() << "node, @mcap/core and fzstd are not here";
  ASSERT_EQ(run_cli({"export", sequence.path("run"), "--to", sequence.path("layers.mcap"), "--layers",
                     "difference,forward_mask"})
                .exit_code,
            0);
  ASSERT_EQ(
      std::system(
          ("node " + script + " " + sequence.path("layers.mcap") + " > " + sequence.path("found")).c_str()),
      0);
  const auto topics = nlohmann::json::parse(sequence.folder.read("found"));
  for (const char* topic : {"/camera/colour", "/camera/depth", "/camera/features", "/features", "/figures"})
    EXPECT_EQ(topics[topic]["count"], kMcapFrames) << topic;
  EXPECT_EQ(topics["/tf"]["count"], 2 * kMcapFrames);
  EXPECT_EQ(topics["/tf"]["schema"], "foxglove.FrameTransforms");
  EXPECT_EQ(topics["/stages/difference"]["count"], kMcapFrames - 1);
  EXPECT_EQ(topics["/camera/colour"]["first"].get<double>(), 100e9);
}

}  // namespace
}  // namespace stillpoint
