// The question what to open, by mouse and key over the workbench.
#include "ui/workbench/open_dialog.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/ui/controller_example.hpp"
#include "tests/unit/temporary_folder.hpp"
#include "ui/shell/offscreen.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class OpenDialogTest : public ::testing::Test {
 protected:
  OpenDialogTest() : dialog_([this](const OpenAs& place) { return look(place); }) {}
  ~OpenDialogTest() override {
    EXPECT_THAT(offscreen_.take_gl_errors(), IsEmpty());
    offscreen_.make_current();
  }

  PlaceLook look(const OpenAs& place) {
    return look_at_place(place, [this](const OpenAs& as) {
      readings_.push_back(as.reading);
      return untimed(open_sequence(as.where), Config());
    });
  }
  void draw(int times = 2) {
    for (int i = 0; i < times; ++i)
      offscreen_.draw([this](UiFrame& frame) {
        if (auto chosen = dialog_.draw(frame, recent_)) chosen_ = std::move(chosen);
      });
  }
  void type(const std::string& text) {
    for (const char c : text) {
      offscreen_.send(TextTyped{static_cast<unsigned char>(c)});
      draw(1);
    }
  }
  void strike(Key key) {
    for (const bool down : {true, false}) {
      offscreen_.send(KeyChanged{key, down, {}});
      draw();
    }
  }

  Offscreen offscreen_{{.width = 1200, .height = 800}};
  SmallSequence sequence_{4};
  std::vector<std::vector<std::string>> readings_;  // read by the dialog's thread while nothing else reads
  std::vector<std::string> recent_;
  std::optional<OpenAs> chosen_;
  OpenDialog dialog_;
};

TEST_F(OpenDialogTest, TellsWhatIsInAPlaceBeforeItIsOpened) {
  dialog_.open("", "");
  draw();
  type(sequence_.path());
  ASSERT_TRUE(draw_until(
      [this] { draw(1); },
      [this] { return dialog_.seen() != nullptr && dialog_.seen()->of.where == sequence_.path(); }));
  EXPECT_EQ(dialog_.seen()->problem, "");
  ASSERT_FALSE(dialog_.seen()->facts.empty());
  EXPECT_THAT(dialog_.seen()->facts[0].value, HasSubstr("4 frames"));
  EXPECT_FALSE(dialog_.seen()->picture.empty());
  EXPECT_TRUE(dialog_.is_open());
  strike(Key::kEnter);
  EXPECT_FALSE(dialog_.is_open());
  ASSERT_TRUE(chosen_);
  EXPECT_EQ(*chosen_, OpenAs{.where = sequence_.path()});
}

TEST_F(OpenDialogTest, GoesIntoAFolderAndSaysWhatCannotBeOpened) {
  const TemporaryFolder folder;
  folder.write("inner/rgb.txt", std::string("no list at all\n"));
  dialog_.open("", "");
  draw();
  type(folder.path());
  strike(Key::kEnter);
  EXPECT_TRUE(dialog_.is_open());
  EXPECT_FALSE(chosen_);
  type("/inner");
  ASSERT_TRUE(
      draw_until([this] { draw(1); },
                 [&] { return dialog_.seen() != nullptr && dialog_.seen()->of.where.ends_with("/inner"); }));
  EXPECT_THAT(dialog_.seen()->problem, HasSubstr("inner"));
  EXPECT_TRUE(dialog_.seen()->facts.empty());
  strike(Key::kEscape);
  EXPECT_FALSE(dialog_.is_open());
  EXPECT_FALSE(chosen_);
}

TEST_F(OpenDialogTest, OpensWhatWasOpenBeforeByAClick) {
  recent_ = {sequence_.path()};
  dialog_.open(sequence_.path(), "");
  // Its row is looked for from below: it is the last of the list.
  for (float y = 790.0F; y > 60.0F && !chosen_; y -= 8.0F) {
    offscreen_.send(MouseMoved{300.0F, y});
    draw();
    for (const bool down : {true, false}) {
      offscreen_.send(MouseButton{0, down, {}});
      draw();
    }
  }
  ASSERT_TRUE(chosen_);
  EXPECT_EQ(*chosen_, OpenAs{.where = sequence_.path()});
}

TEST(OpenedAs, IsReadAndRunAsItSays) {
  const SmallSequence folder(4);
  Offscreen offscreen({.width = 500, .height = 400});
  ControllerOptions options = controller_options();
  std::vector<std::string> read;
  options.open_source = [&read](const std::string& where, const Config& config,
                                const std::vector<std::string>& reading) {
    read = reading;
    return untimed(open_sequence(where), config);
  };
  {
    AppController controller(std::move(options));
    const auto draw = [&] { offscreen.draw([&](UiFrame& frame) { controller.draw(frame); }); };
    controller.open_as({folder.path(), {"camera=freiburg2"}, "paper"});
    ASSERT_TRUE(draw_until(draw, [&] { return controller.idle() && controller.view(); }));
    EXPECT_EQ(controller.view()->config.run.method, "paper");
    EXPECT_THAT(read, ElementsAre("camera=freiburg2"));
    controller.open_as({folder.path(), {}, "magic"});
    EXPECT_THAT(controller.workbench().message(), HasSubstr("run.method takes one of"));
    EXPECT_EQ(controller.config().run.method, "paper");
    offscreen.make_current();
  }
  EXPECT_THAT(offscreen.take_gl_errors(), IsEmpty());
}

}  // namespace
}  // namespace stillpoint::testing
