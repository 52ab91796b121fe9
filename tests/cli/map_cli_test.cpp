// Maps of finished runs as PLY files, as a user asks for them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>
#include <sstream>

#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"

namespace stillpoint {
namespace {

using ::testing::HasSubstr;

class ExportedMap : public ::testing::Test {
 protected:
  ExportedMap() {
    const CliResult ran =
        run_cli({"run", sequence_.path(), "--method", "none", "--out", sequence_.path("run")});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
  }
  [[nodiscard]] CliResult exported(const std::string& to, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"export", sequence_.path("run"), "--to", sequence_.path(to)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_cli(arguments);
  }
  SmallSequence sequence_{10};
};

TEST_F(ExportedMap, HasColoursNormalsAndKeyframesBesideIt) {
  const CliResult made = exported("map.ply");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("with a normal"));
  std::istringstream map(sequence_.folder.read("map.ply"));
  std::string line;
  std::size_t told = 0;
  while (std::getline(map, line) && line != "end_header")
    if (line.starts_with("element vertex ")) told = std::stoul(line.substr(15));
  std::set<int> greys;
  std::size_t points = 0, on_wall = 0, with_normal = 0;
  double x = 0, y = 0, z = 0, nx = 0, ny = 0, nz = 0;
  int red = 0, green = 0, blue = 0;
  while (map >> x >> y >> z >> nx >> ny >> nz >> red >> green >> blue) {
    ++points;
    on_wall += std::abs(z - SmallSequence::kDepth) < 0.05 ? 1 : 0;
    EXPECT_EQ(red, green);  // the wall is grey
    EXPECT_EQ(red, blue);
    greys.insert(red);
    if (nx == 0 && ny == 0 && nz == 0) continue;
    ++with_normal;
    EXPECT_LT(nz, -0.99) << "the wall faces the camera";
  }
  EXPECT_EQ(points, told);
  EXPECT_GT(points, 100U);
  EXPECT_GT(on_wall, points * 9 / 10);
  EXPECT_GT(greys.size(), 20U);
  EXPECT_GT(with_normal, points / 2);
  // The run's folder has the same keyframes.
  EXPECT_THAT(sequence_.folder.read("map_keyframes.ply"), HasSubstr("element face "));
  EXPECT_EQ(sequence_.folder.read("map_keyframes.ply"), sequence_.folder.read("run/keyframes.ply"));
}

TEST_F(ExportedMap, IsRefusedInOneSentence) {
  ASSERT_EQ(exported("map.ply").exit_code, 0);
  expect_one_sentence(exported("map.ply"), "map.ply: is there already; --force replaces it");
  std::filesystem::remove(sequence_.path("map.ply"));
  expect_one_sentence(exported("map.ply"), "map_keyframes.ply: is there already; --force replaces it");
  EXPECT_FALSE(std::filesystem::exists(sequence_.path("map.ply")));
  EXPECT_EQ(exported("map.ply", {"--force"}).exit_code, 0);
  expect_usage_error(exported("other.ply", {"--layers", "difference"}), "--layers: go into an .mcap file");
  expect_one_sentence(exported("no/map.ply"), "no/map.ply: there is no folder ");
  const auto dense = [this](std::vector<std::string> more) {
    more.insert(more.begin(), {"export", sequence_.path("run"), "--dense"});
    return run_cli(more);
  };
  expect_one_sentence(dense({sequence_.path("no/room.ply")}), "no/room.ply: there is no folder ");
  expect_one_sentence(dense({sequence_.path("room.txt")}), "room.txt: expected a name that ends in .ply");
  std::filesystem::create_directory(sequence_.path("folder.ply"));
  expect_one_sentence(dense({sequence_.path("folder.ply"), "--force"}), "folder.ply: is a folder");
  // What would be passed over in silence.
  const std::string room = sequence_.path("room.ply");
  expect_usage_error(dense({room, "--out", sequence_.path("x")}), "--out: goes with a sequence");
  expect_usage_error(dense({room, "--frames", "1:3"}), "--frames: goes with --out");
  expect_usage_error(dense({room, "--layers", "difference"}), "--layers: goes with --to");
  expect_usage_error(dense({room, "--length", "3"}), "a finished run has its own frames");
  expect_usage_error(run_cli({"export", sequence_.path(), "--out", sequence_.path("x"), "--voxel", "0.1"}),
                     "--voxel: goes with --dense");
  EXPECT_FALSE(std::filesystem::exists(sequence_.path("x")) || std::filesystem::exists(room));
  // What would take a recording away.
  expect_one_sentence(
      run_cli({"export", sequence_.path(), "--frames", "1:3", "--out", sequence_.path("rgb/.."), "--force"}),
      "is the sequence itself");
  EXPECT_TRUE(std::filesystem::exists(sequence_.path(SmallSequence::colour(0))));
  sequence_.folder.write("images/000000.png", std::string("mine"));
  expect_one_sentence(
      run_cli({"export", sequence_.path("run"), "--without-movers", sequence_.path("images")}),
      "holds earlier results (000000.png); --force overwrites them");
  EXPECT_EQ(sequence_.folder.read("images/000000.png"), "mine");
  expect_one_sentence(run_cli({"export", sequence_.path(), "--to", sequence_.path("other.ply")}),
                      "records.bin");
}

TEST_F(ExportedMap, WithoutItsSequenceHasNoNormals) {
  std::filesystem::remove_all(sequence_.path("depth"));
  std::filesystem::remove(sequence_.path("depth.txt"));
  const CliResult made = exported("map.ply");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("no normals: "));
  EXPECT_EQ(sequence_.folder.read("map.ply").find("nx"), std::string::npos);
}

}  // namespace
}  // namespace stillpoint
