// What core/motion/README.md promises: a method is one class and one registration, and nothing outside
// core/motion knows a method by name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>

#include "core/error.hpp"
#include "core/inspect/frame_stages.hpp"
#include "core/inspect/shown_run.hpp"
#include "core/motion/methods.hpp"
#include "core/run/run_sequence.hpp"
#include "tests/support/places.hpp"
#include "tests/support/rendered.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

// The minimal method, as the README has it: what differs from the frame before by more than 40 grey levels.
struct LastFrame final : MotionPreparation {
  cv::Mat gray;
};

class DifferenceMethod final : public MotionMethod {
 public:
  [[nodiscard]] std::unique_ptr<MotionMethod> clone() const override {
    return std::make_unique<DifferenceMethod>(*this);
  }
  [[nodiscard]] std::shared_ptr<const MotionPreparation> prepare(
      const Frame& frame, std::span<const std::shared_ptr<const MotionPreparation>>, int) const override {
    auto made = std::make_shared<LastFrame>();
    made->gray = frame.gray;
    return made;
  }
  [[nodiscard]] MotionResult detect(const MotionInput& input) const override {
    MotionResult result;
    const cv::Mat& gray = input.frame.gray;
    if (last_.size() != gray.size()) return result;
    cv::Mat difference;
    cv::absdiff(gray, last_, difference);
    result.mask = difference > 40;
    result.mask_share = percent_set(result.mask) / 100.0;
    return result;
  }
  void commit(const MotionInput& input, const MotionResult&, const MotionOutcome&) override {
    last_ = static_cast<const LastFrame&>(*input.prepared).gray;
  }
  [[nodiscard]] StageLog describe(const Frame& frame, const MotionResult& result) const override {
    StageLog log;
    const Layer seen = photo_layer("Frame", frame.gray);
    log.add("mask", "Motion", "Mask", "What differs from the frame before by more than 40 grey levels.")
        .figure("Mask", 100.0 * result.mask_share, "%", 2)
        .add_side({seen}, mask_layer("Mask", result.mask, seen, "mask"));
    return log;
  }

 private:
  cv::Mat last_;
};

const MethodInfo& minimal_method() {
  static const bool registered = [] {
    MethodInfo info;
    info.name = "test_difference";
    info.title = "Difference";
    info.needs.keeps_state = true;
    info.make = [](const Camera&, const Config&) -> std::unique_ptr<MotionMethod> {
      return std::make_unique<DifferenceMethod>();
    };
    register_method(std::move(info));
    return true;
  }();
  EXPECT_TRUE(registered);
  return method_named("test_difference");
}

TEST(MotionMethods, AMinimalOneRunsAndIsInspectedAsAnyOther) {
  const auto source = rendered("walking_static", 8);
  Config config;
  config.run.method = minimal_method().name;
  const RunResult run = run_sequence(*source, config);
  ASSERT_EQ(run.records.size(), 8U);
  EXPECT_EQ(run.tracked(), 8);
  EXPECT_EQ(run.records[0].mask_share, 0.0);
  EXPECT_GT(run.records[5].mask_share, 0.0);
  EXPECT_GT(run.scores[5].mask.found_rightly, 0);

  FrameCache cache(*source);
  ShownRun shown(*source, cache, ReplayableRun(*source, config));
  for (int i = 0; i < 8; ++i) shown.process(source->read(i));
  EXPECT_TRUE(computed_alike(shown.track().records()[7], run.records[7]));
  ShownRun later(*source, cache, ReplayableRun(*source, config));
  for (int i = 0; i < 8; ++i) later.process(source->read(i));
  const auto view = later.frame_view(5);
  ASSERT_NE(view->motion->layer("mask"), nullptr);
  EXPECT_GT(cv::countNonZero(view->mask), 0);
  EXPECT_EQ(cv::norm(view->motion->layer("mask")->image, view->mask, cv::NORM_INF), 0.0);
  EXPECT_EQ(stages_of(*view).front().id, "mask");
  // Its state is had again from a checkpoint: the same mask to the bit.
  MotionReplay replay = later.track().motion_before(5, [&](int i) { return source->read(i); });
  const FrameRecord record = run.records[5];
  const MotionAgain again = replay.repeat(source->read(5), &record);
  EXPECT_EQ(cv::norm(again.mask, view->mask, cv::NORM_INF), 0.0);
}

TEST(MotionMethods, ANameIsTakenOnce) {
  MethodInfo info;
  info.name = minimal_method().name;
  EXPECT_THROW(register_method(info), InputError);
  EXPECT_THROW((void)method_named("magic"), InputError);
}

TEST(MotionMethods, SayWhatTheyAre) {
  std::set<std::string> names, sections, figures;
  ASSERT_GE(methods().size(), 6U);
  for (const MethodInfo& method : methods()) {
    EXPECT_TRUE(names.insert(method.name).second) << method.name;
    EXPECT_FALSE(method.title.empty()) << method.name;
    ASSERT_NE(method.make, nullptr) << method.name;
    if (!method.parameters.empty()) {
      EXPECT_TRUE(sections.insert(method.parameters.name()).second) << method.name;
    }
    for (const FigureInfo& figure : method.figures)
      EXPECT_TRUE(figures.insert(figure.name).second) << method.name << ": " << figure.name;
    if (!method.without_depth.empty()) {
      EXPECT_FALSE(method_named(method.without_depth).needs.depth);
    }
  }
  EXPECT_EQ(std::count_if(methods().begin(), methods().end(), [](const auto& m) { return m.baseline; }), 1);
}

/// The places in a file where a method's name stands as a string, or the run's method is compared with one.
std::vector<std::string> places_in(const fs::path& file, const std::regex& wanted) {
  std::ifstream stream(file);
  std::vector<std::string> places;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const std::size_t comment = line.find("//");
    if (std::regex_search(line.substr(0, comment), wanted))
      places.push_back(file.string() + ":" + std::to_string(number) + ": " + line);
  }
  return places;
}

TEST(MotionMethods, AreKnownByNameInCoreMotionAlone) {
  // "none" and "stillpoint" are words of their own: the program's name, and that there is nothing. They count
  // where a method is compared with them.
  const std::regex name(
      R"re("(paper|oracle|epipolar|yi2013|alcantarilla2012|gao2019|lin2017|dai2020|peng2017|wang2014)"|method\s*[!=]=\s*")re");
  const fs::path root = places::source();
  int files = 0;
  std::vector<std::string> found;
  for (const char* room : {"core", "ui", "app"})
    for (const auto& entry : fs::recursive_directory_iterator(root / room)) {
      const std::string path = entry.path().string();
      const bool source = path.ends_with(".cpp") || path.ends_with(".hpp");
      if (!source || path.find("core/motion/") != std::string::npos) continue;
      ++files;
      for (std::string& place : places_in(entry.path(), name)) found.push_back(std::move(place));
    }
  EXPECT_GT(files, 200);
  EXPECT_THAT(found, testing::IsEmpty());
  // The test finds names where they are.
  EXPECT_FALSE(places_in(root / "core/motion/oracle.cpp", name).empty());
}

}  // namespace
}  // namespace stillpoint
