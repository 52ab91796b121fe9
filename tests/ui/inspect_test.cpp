// Looking inside a frame, as a person does: by mouse and key over the whole workbench, offscreen.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/odometry/map_id.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/saved_map.hpp"
#include "core/run/sweep.hpp"
#include "tests/support/golden.hpp"
#include "tests/ui/session_example.hpp"
#include "tests/unit/ui/inspect_scene.hpp"
#include "ui/shell/offscreen.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr int kWidth = 1200, kHeight = 700;

/// Panels side by side.
LayoutNode columns(const std::vector<std::string>& panels) {
  LayoutNode root;
  for (const std::string& panel : panels) {
    LayoutNode child;
    child.panel = panel;
    child.share = 1.0 / static_cast<double>(panels.size());
    root.children.push_back(child);
  }
  return root;
}

class Inspecting : public ::testing::Test {
 protected:
  ~Inspecting() override {
    EXPECT_THAT(offscreen_.take_gl_errors(), IsEmpty());
    offscreen_.make_current();
  }

  cv::Mat render() {
    // What panels tell each other reaches those drawn before a frame later.
    const FrameFunction draw = [this](UiFrame& frame) { workbench_.draw(frame, &session_); };
    offscreen_.render(draw);
    return offscreen_.render(draw);
  }
  void point(float x, float y) {
    offscreen_.send(MouseMoved{x, y});
    render();
  }
  void click(float x, float y, int button = 0) {
    point(x, y);
    offscreen_.send(MouseButton{button, true, {}});
    render();
    offscreen_.send(MouseButton{button, false, {}});
    render();
  }
  void strike(Key key) {
    offscreen_.send(KeyChanged{key, true, {}});
    offscreen_.send(KeyChanged{key, false, {}});
    render();
  }
  /// The part of an image that the i-th of `count` columns takes, below its heading.
  static cv::Rect column(int i, int count) {
    const int width = kWidth / count;
    return {i * width + 8, 110, width - 16, kHeight - 150};
  }

  std::vector<SessionRequest> requests_;
  std::vector<int> gone_to_;
  std::vector<bool> compares_;
  SessionView session_ = generated_example();
  Offscreen offscreen_{{.width = kWidth, .height = kHeight}};
  Workbench workbench_{make_panels(),
                       {.go_to_frame = [this](int frame) { gone_to_.push_back(frame); },
                        .request = [this](SessionRequest wish) { requests_.push_back(std::move(wish)); },
                        .compare = [this](bool compare) { compares_.push_back(compare); }}};
};

TEST_F(Inspecting, TheCursorIsMarkedInEveryImagePanel) {
  workbench_.set_layout(columns({"input", "difference", "features_after", "inspector"}));
  const cv::Mat before = render();
  point(170, 380);
  const cv::Mat after = render();
  for (int i = 0; i < 4; ++i)
    EXPECT_FALSE(images_agree(after(column(i, 4)), before(column(i, 4)), {2, 20.0, 0.0})) << i;
}

TEST_F(Inspecting, APinIsAskedForAtThePixelAndTakenOutAgain) {
  workbench_.set_layout(columns({"input", "inspector"}));
  strike(Key::kP);  // nothing is pointed at yet
  EXPECT_THAT(requests_, IsEmpty());
  point(300, 380);
  strike(Key::kP);
  ASSERT_EQ(requests_.size(), 1U);
  const auto pins = std::get<request::Pins>(requests_[0]).all;
  ASSERT_EQ(pins.size(), 1U);
  EXPECT_EQ(pins[0].name, "A");
  EXPECT_EQ(pins[0].frame, session_.current->index);
  EXPECT_NEAR(pins[0].x, session_.current->frame.gray.cols / 2.0, 12.0);
  const cv::Mat without = render();
  session_.debug.pins = pins;
  const cv::Mat with = render();
  for (int i = 0; i < 2; ++i)
    EXPECT_FALSE(images_agree(with(column(i, 2)), without(column(i, 2)), {2, 20.0, 0.0})) << i;
  strike(Key::kP);
  ASSERT_EQ(requests_.size(), 2U);
  EXPECT_THAT(std::get<request::Pins>(requests_[1]).all, IsEmpty());
}

TEST_F(Inspecting, ARightClickOffersAPin) {
  workbench_.set_layout(columns({"input", "inspector"}));
  click(300, 380, 1);
  click(330, 393);  // the menu's first entry
  ASSERT_EQ(requests_.size(), 1U);
  EXPECT_EQ(std::get<request::Pins>(requests_[0]).all.size(), 1U);
}

TEST_F(Inspecting, KeysStepThroughStagesAndOverTheFramesEnd) {
  workbench_.set_layout(columns({"input"}));
  render();
  EXPECT_FALSE(compares_.back());
  strike(Key::kDown);  // brings the panel up
  EXPECT_THAT(panels_of(workbench_.layout()), Contains("stages"));
  EXPECT_TRUE(compares_.back());
  const cv::Mat before = render();
  strike(Key::kDown);
  EXPECT_FALSE(images_agree(render(), before, {2, 200.0, 0.0}));
  strike(Key::kUp);
  EXPECT_TRUE(images_agree(render(), before, {0, 0.0, 0.0}));
  for (int i = 0; i < 40 && gone_to_.empty(); ++i) strike(Key::kDown);
  EXPECT_THAT(gone_to_, ElementsAre(session_.current->index + 1));
}

TEST_F(Inspecting, EveryStageIsDrawn) {
  session_ = [] {
    InspectScene scene;
    scene.add_feature({52, 40}, FeatureFate::removed);
    return scene.session();
  }();
  workbench_.set_layout(columns({"stages"}));
  cv::Mat last;
  int compared = 0;
  for (int i = 0; i < 22; ++i) {
    strike(Key::kUp);
    const cv::Mat image = render();
    EXPECT_FALSE(is_blank(image(column(0, 1)), 30)) << i;
    if (!last.empty() && gone_to_.empty()) {
      EXPECT_FALSE(images_agree(image, last, {2, 50.0, 0.0})) << i;
      ++compared;
    }
    last = image;
  }
  EXPECT_GE(compared, 5);
}

TEST_F(Inspecting, AClickedFeatureIsExplainedAndStaysChosen) {
  const auto scene = std::make_unique<InspectScene>();
  scene->add_feature({79.5F, 59.5F}, FeatureFate::inlier, 3, 0.4F);
  scene->add_feature({20, 20}, FeatureFate::removed);
  session_ = scene->session();
  workbench_.set_layout(columns({"features_before", "feature"}));
  const cv::Mat before = render();
  // The picture's middle.
  click(296, 388);
  point(1100, 690);
  const cv::Mat chosen = render();
  EXPECT_FALSE(images_agree(chosen(column(0, 2)), before(column(0, 2)), {2, 20.0, 0.0}));
  EXPECT_FALSE(images_agree(chosen(column(1, 2)), before(column(1, 2)), {2, 200.0, 0.0}));
  // In a frame that does not have it, the panel says so.
  auto other = std::make_shared<FrameView>(*session_.current);
  auto record = std::make_shared<FrameRecord>(*other->record);
  record->features.erase(record->features.begin());
  other->record = record.get();
  other->index = 60;
  session_.current = other;
  EXPECT_FALSE(images_agree(render()(column(1, 2)), chosen(column(1, 2)), {2, 200.0, 0.0}));
  session_ = scene->session();
  render();
}

TEST_F(Inspecting, LargePixelsCarryTheirNumbers) {
  workbench_.set_layout(columns({"motion"}));
  render();
  point(300, 300);
  for (int i = 0; i < 16; ++i) offscreen_.send(MouseWheel{0.0F, 1.0F, {}});
  const cv::Mat near = render();
  // Numbers are thin and bright on any ground.
  cv::Mat bright;
  cv::inRange(near(column(0, 1)), cv::Scalar(200, 200, 200), cv::Scalar(255, 255, 255), bright);
  EXPECT_GT(cv::countNonZero(bright), 1500);
}

}  // namespace
}  // namespace stillpoint::testing
