// How much of the project a panel's file reads: what it includes, and what that includes.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "tests/support/places.hpp"

namespace stillpoint {
namespace {

/// Adds our own headers that a file includes, directly or through others.
void add_headers_of(const std::string& file, std::set<std::string>& reached) {
  const std::string begin = "#include \"";
  std::ifstream text(std::filesystem::path(places::source()) / file);
  for (std::string line; std::getline(text, line);) {
    if (!line.starts_with(begin)) continue;
    const std::string header = line.substr(begin.size(), line.rfind('"') - begin.size());
    if (!std::filesystem::exists(std::filesystem::path(places::source()) / header)) continue;
    if (reached.insert(header).second) add_headers_of(header, reached);
  }
}

std::size_t headers_of(const std::string& file) {
  std::set<std::string> reached;
  add_headers_of(file, reached);
  return reached.size();
}

TEST(PanelHeaders, APanelReadsWhatItDrawsAndNotTheWholeHouse) {
  // What a snapshot of the session holds by value binds most: config, camera, marks and poses, 19 headers
  // with the panel's own and the convention of pixels; how runs share their records, 3 more. The inspector
  // adds images of the frame, curves of the run and tables.
  constexpr std::size_t kMost = 46, kUsually = 36;  // headers of ours; the second is the mean's bound
  std::size_t panels = 0, sum = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(places::source()) / "ui/panels")) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with("_panel.cpp")) continue;
    const std::size_t count = headers_of("ui/panels/" + name);
    EXPECT_GT(count, 5U) << name << ": its includes were not found";
    EXPECT_LE(count, kMost) << name << " includes too much: name what it only refers to (struct X;)";
    ++panels;
    sum += count;
  }
  ASSERT_GT(panels, 20U);
  EXPECT_LE(sum, kUsually * panels);
}

TEST(PanelHeaders, WhatIsOnlyHandedOnIsNotRead) {
  std::set<std::string> reached, of_trajectory, of_parameters;
  add_headers_of("ui/session/session_view.hpp", reached);
  EXPECT_TRUE(reached.contains("core/config.hpp"));
  for (const char* header :
       {"core/odometry/odometry.hpp", "core/motion/methods.hpp", "core/run/run_sequence.hpp"})
    EXPECT_FALSE(reached.contains(header)) << header;
  add_headers_of("ui/panels/trajectory_panel.cpp", of_trajectory);
  EXPECT_TRUE(of_trajectory.contains("ui/scene/scene_widget.hpp"));
  EXPECT_FALSE(of_trajectory.contains("ui/gl/framebuffer.hpp"));
  add_headers_of("ui/panels/parameters_panel.cpp", of_parameters);
  EXPECT_TRUE(of_parameters.contains("core/odometry/engines.hpp"));
  EXPECT_FALSE(of_parameters.contains("core/odometry/odometry_engine.hpp"));
}

}  // namespace
}  // namespace stillpoint
