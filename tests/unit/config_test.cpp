#include "core/config.hpp"

#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "core/assets.hpp"
#include "core/motion/paper/paper_config.hpp"
#include "core/motion/stillpoint/stillpoint_config.hpp"
#include "core/text_file.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;

std::string value_of(const Parameter& p) {
  if (const auto* flag = std::get_if<bool*>(&p.value)) return **flag ? "1" : "0";
  if (const auto* integer = std::get_if<int*>(&p.value)) return std::to_string(**integer);
  if (const auto* text = std::get_if<std::string*>(&p.value)) return **text;
  char digits[40];
  std::snprintf(digits, sizeof digits, "%.17g", *std::get<double*>(p.value));
  return digits;
}

/// The keys in which two configs differ.
std::vector<std::string> differences(Config a, Config b) {
  const auto first = parameters(a), second = parameters(b);
  std::vector<std::string> keys;
  for (std::size_t i = 0; i < first.size(); ++i)
    if (value_of(first[i]) != value_of(second[i])) keys.push_back(first[i].key);
  return keys;
}

/// The keys a TOML file of ours names, read line by line.
std::set<std::string> keys_named_in(const std::string& path) {
  std::set<std::string> keys;
  std::string section;
  for (const TextLine& line : read_text_lines(path)) {
    if (line.text.front() == '[')
      section = line.text.substr(1, line.text.find(']') - 1);
    else
      keys.insert(section + "." + line.text.substr(0, line.text.find_first_of(" =")));
  }
  return keys;
}

class ConfigFile : public testing::Test {
 protected:
  [[nodiscard]] Config read(const std::string& text) const {
    folder.write("mine.toml", text);
    return read_config(folder.path("mine.toml"));
  }
  [[nodiscard]] std::string error(const std::string& text) const {
    return input_error_of([&] { (void)read(text); });
  }
  TemporaryFolder folder;
};

TEST(Parameters, DefaultsLieInTheirRanges) {
  Config config;
  std::set<std::string> keys;
  int texts = 0;
  for (const Parameter& p : parameters(config)) {
    EXPECT_TRUE(keys.insert(p.key).second) << p.key << " is there twice";
    EXPECT_THAT(p.help, testing::Not(IsEmpty())) << p.key;
    if (const auto* text = std::get_if<std::string*>(&p.value)) {
      if (!p.choices.empty()) {  // else any text does
        EXPECT_THAT(p.choices, testing::Contains(**text)) << p.key;
      }
      ++texts;
    } else {
      const double value = std::stod(value_of(p));
      EXPECT_GE(value, p.min) << p.key;
      EXPECT_LE(value, p.max) << p.key;
    }
  }
  EXPECT_GT(texts, 0);
  EXPECT_GT(keys.size(), static_cast<std::size_t>(texts));
}

TEST_F(ConfigFile, EveryParameterComesBackAsWritten) {
  Config config;
  for (const Parameter& p : parameters(config)) {
    if (auto* flag = std::get_if<bool*>(&p.value)) **flag = !**flag;
    if (auto* integer = std::get_if<int*>(&p.value)) **integer = static_cast<int>(p.min) + 1;
    if (auto* real = std::get_if<double*>(&p.value)) **real = p.min + (p.max - p.min) / 3.0;
    if (auto* text = std::get_if<std::string*>(&p.value))
      **text = p.choices.empty() ? "a \"b\", c\\d 'e'" : p.choices.back();
  }
  const Config back = read(to_toml(config));
  EXPECT_THAT(differences(config, back), IsEmpty());
  EXPECT_GT(differences(config, Config{}).size(), 40U);
}

TEST_F(ConfigFile, KeysNotGivenKeepTheirDefault) {
  EXPECT_THAT(differences(read(""), Config{}), IsEmpty());
  EXPECT_THAT(differences(read("# nothing\n\n[paper]\n"), Config{}), IsEmpty());
  const Config config = read("[features]\ncount = 123\n[bundle]\niterations = 7\n");
  EXPECT_EQ(config.features.count, 123);
  EXPECT_EQ(config.bundle.iterations, 7);
  EXPECT_THAT(differences(config, Config{}), testing::ElementsAre("features.count", "bundle.iterations"));
}

TEST_F(ConfigFile, SectionsAndSwitchesOfEarlierVersionsAreStillRead) {
  EXPECT_EQ(read("[motion]\nmax_corners = 123\n").of<PaperConfig>().max_corners, 123);
  EXPECT_FALSE(read("[tracking]\nsoft_weights = 0\n").tracking.soft_weights);
  EXPECT_TRUE(read("[tracking]\nsoft_weights = 1\n").tracking.soft_weights);
  EXPECT_FALSE(read("[tracking]\nsoft_weights = false\n").tracking.soft_weights);
  EXPECT_THAT(error("[tracking]\nsoft_weights = 2\n"),
              HasSubstr("tracking.soft_weights takes true or false"));
  Config config;
  set_parameter(config, "motion.max_corners=99");
  EXPECT_EQ(config.of<PaperConfig>().max_corners, 99);
}

TEST_F(ConfigFile, ConstantsThatThereAreNoMoreAreReadPast) {
  const Config config = read("[bundle]\napply_after_frames = 3\niterations = 7\n");
  EXPECT_THAT(differences(config, Config{}), testing::ElementsAre("bundle.iterations"));
  Config set;
  EXPECT_THROW(set_parameter(set, "bundle.apply_after_frames=3"), InputError) << "would change nothing";
}

TEST_F(ConfigFile, ConstantsAreStillReadUnderTheirFormerNames) {
  const Config config = read(
      "[tracking]\nlook_back_frames = 7\n[map]\npurge_moving = false\n[stillpoint]\nsegment_px = 12\n"
      "memory = 0.5\n[depth_motion]\nfirm_log_odds = 2.0\n");
  EXPECT_EQ(config.tracking.smoother_lag_frames, 7);
  EXPECT_FALSE(config.map.cull_dynamic);
  EXPECT_EQ(config.of<StillpointConfig>().superpixel_px, 12);
  EXPECT_EQ(config.of<StillpointConfig>().prior_share, 0.5);
  EXPECT_EQ(config.of<StillpointConfig>().confident_log_odds, 2.0);
  EXPECT_EQ(to_toml(config).find("look_back_frames"), std::string::npos)
      << "written under the new name alone";
}

TEST_F(ConfigFile, WholeNumbersServeAsReals) {
  EXPECT_EQ(read("[map]\nfar_depth_m = 4\n").map.far_depth_m, 4.0);
}

TEST_F(ConfigFile, FaultsAreToldWithFileAndLine) {
  EXPECT_THAT(error("[paper]\n\nmax_corner = 5\n"),
              EndsWith("mine.toml:3: there is no parameter 'paper.max_corner'"));
  EXPECT_THAT(error("[colour]\nred = 5\n"), EndsWith("mine.toml:2: there is no parameter 'colour.red'"));
  EXPECT_THAT(error("max_corners = 5\n"), HasSubstr("mine.toml:1: 'max_corners' stands outside a section"));
  EXPECT_THAT(error("[paper]\nmax_corners = 3.5\n"),
              HasSubstr("mine.toml:2: paper.max_corners takes a whole number from 16"));
  EXPECT_THAT(error("[paper]\nmax_corners = \"many\"\n"),
              HasSubstr("mine.toml:2: paper.max_corners takes a whole number"));
  EXPECT_THAT(error("[map]\nfar_depth_m = true\n"),
              HasSubstr("mine.toml:2: map.far_depth_m takes a number from 0.1 to 50 m"));
  EXPECT_THAT(error("[run]\nmethod = 3\n"),
              HasSubstr("mine.toml:2: run.method takes one of: stillpoint, paper, none"));
  EXPECT_THAT(error("[run]\nmethod = \"magic\"\n"),
              HasSubstr("mine.toml:2: run.method takes one of: stillpoint, paper, none"));
  EXPECT_THAT(error("[paper\nmax_corners = 100\n"), HasSubstr("mine.toml:1: not valid TOML"));
  EXPECT_THAT(error("[paper]\nmax_corners = 100\nmax_corners = 200\n"),
              HasSubstr("mine.toml:3: not valid TOML"));
  EXPECT_THAT(error("[run]\nmethod = \"\xff\"\n"), HasSubstr("mine.toml:2: not valid TOML"));
}

TEST_F(ConfigFile, ValuesOutOfRangeAreRefused) {
  EXPECT_THAT(error("[paper]\nmax_corners = 15\n"),
              HasSubstr("mine.toml:2: paper.max_corners = 15 is out of range: it takes a number from 16 to "
                        "20000 corners"));
  EXPECT_EQ(read("[paper]\nmax_corners = 16\n").of<PaperConfig>().max_corners, 16);
  EXPECT_EQ(read("[paper]\nmax_corners = 20000\n").of<PaperConfig>().max_corners, 20000);
  for (const char* value : {"20001", "-1", "5000000000", "-9223372036854775808"})
    EXPECT_THAT(error(std::string("[paper]\nmax_corners = ") + value + "\n"), HasSubstr("is out of range"))
        << value;
  for (const char* value : {"nan", "inf", "-inf", "0", "1e300"})
    EXPECT_THAT(error(std::string("[map]\nfar_depth_m = ") + value + "\n"), HasSubstr("is out of range"))
        << value;
}

TEST_F(ConfigFile, FilesThatCannotBeReadAreTold) {
  const std::string missing = folder.path("none.toml");
  EXPECT_EQ(input_error_of([&] { (void)load_config(missing); }).rfind(missing + ": ", 0), 0U);
  EXPECT_THAT(input_error_of([&] { (void)read_config(folder.path()); }), HasSubstr("cannot be read"));
}

TEST(Assignment, SetsOneParameter) {
  Config config;
  set_parameter(config, "features.count=321");
  set_parameter(config, "map.far_depth_m=2.5");
  set_parameter(config, "run.method=none");
  EXPECT_EQ(config.features.count, 321);
  EXPECT_EQ(config.map.far_depth_m, 2.5);
  EXPECT_EQ(config.run.method, "none");
  EXPECT_EQ(differences(config, Config{}).size(), 3U);
}

TEST(Assignment, FaultsAreToldAndChangeNothing) {
  Config config;
  const auto error = [&config](const char* assignment) {
    return input_error_of([&] { set_parameter(config, assignment); });
  };
  EXPECT_THAT(error("features.count"), HasSubstr("write section.name=value"));
  EXPECT_THAT(error(""), HasSubstr("write section.name=value"));
  EXPECT_THAT(error("=5"), HasSubstr("there is no parameter ''"));
  EXPECT_THAT(error("features.colour=5"), HasSubstr("there is no parameter 'features.colour'"));
  EXPECT_THAT(error("features.count="), HasSubstr("features.count"));
  EXPECT_THAT(error("features.count=many"), HasSubstr("'many' is no value for features.count"));
  EXPECT_THAT(error("features.count=1e3"), HasSubstr("takes a whole number"));
  EXPECT_THAT(error("features.count=7"), HasSubstr("is out of range"));
  EXPECT_THAT(error("run.method="), HasSubstr("takes one of"));
  EXPECT_THAT(error("run.method=\"none"), HasSubstr("run.method"));
  EXPECT_THAT(error("features.count=100\nvalue2 = 3"), HasSubstr("is no value"));
  EXPECT_THAT(differences(config, Config{}), IsEmpty());
}

/// Every preset that is shipped.
class Presets : public testing::TestWithParam<const char*> {};

TEST_P(Presets, ReadsAndComesBackAsWritten) {
  const Config preset = load_config(GetParam());
  const TemporaryFolder folder;
  folder.write("copy.toml", to_toml(preset));
  EXPECT_THAT(differences(read_config(folder.path("copy.toml")), preset), IsEmpty());
}

TEST_P(Presets, DiffersOnlyInWhatItNames) {
  const std::string path = (assets_folder() / "presets" / (std::string(GetParam()) + ".toml")).string();
  const std::set<std::string> named = keys_named_in(path);
  const auto differing = differences(load_config(GetParam()), Config{});
  // Two presets are the defaults under their names.
  const bool is_default =
      std::string_view(GetParam()) == "default" || std::string_view(GetParam()) == "stillpoint";
  EXPECT_EQ(differing.empty(), is_default);
  for (const std::string& key : differing)
    EXPECT_TRUE(named.count(key) == 1) << key << " differs, but the preset does not name it";
}

INSTANTIATE_TEST_SUITE_P(All, Presets, testing::Values("default", "none", "paper", "stillpoint", "fast"),
                         [](const auto& tested) { return std::string(tested.param); });

TEST(PresetFolder, HoldsPresetsThatAllCanBeRead) {
  ASSERT_GE(preset_names().size(), 5U);
  for (const std::string& name : preset_names()) EXPECT_NO_THROW((void)load_config(name)) << name;
}

TEST(PresetFolder, MethodsShareTheirOdometry) {
  Config none = load_config("none"), paper = load_config("paper");
  none.run.method = paper.run.method;
  none.methods = paper.methods;
  EXPECT_THAT(differences(none, paper), IsEmpty());
  EXPECT_THAT(differences(load_config("default"), Config{}), IsEmpty());
}

TEST(PresetFolder, PaperHasThePapersConstants) {
  const Config paper = load_config("paper");
  EXPECT_EQ(paper.run.method, "paper");
  EXPECT_EQ(paper.of<PaperConfig>().erode_kernel_px, 4);
  EXPECT_EQ(paper.of<PaperConfig>().erode_iterations, 2);
  EXPECT_EQ(paper.of<PaperConfig>().dilate_kernel_px, 16);
  EXPECT_EQ(paper.of<PaperConfig>().dilate_iterations, 1);
  EXPECT_EQ(paper.of<PaperConfig>().reference_gap, 1);
}

TEST(PresetFolder, UnknownPresetsAreToldWithThoseThereAre) {
  EXPECT_EQ(input_error_of([] { (void)load_config("best"); }),
            fmt::format("there is no preset 'best'; the presets are: {} (or give a .toml file)",
                        fmt::join(preset_names(), ", ")));
  EXPECT_THAT(preset_names(), testing::IsSupersetOf({"default", "fast", "none", "paper", "stillpoint"}));
}

}  // namespace
}  // namespace stillpoint
