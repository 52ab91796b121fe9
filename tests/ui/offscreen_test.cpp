#include "ui/shell/offscreen.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "tests/support/golden.hpp"
#include "tests/support/resident_memory.hpp"
#include "tests/ui/gallery.hpp"
#include "ui/gl/imgui_renderer.hpp"
#include "ui/theme/fonts.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

cv::Mat render_gallery(const OffscreenOptions& options, bool with_scene) {
  Offscreen offscreen(options);
  Gallery gallery(with_scene);
  cv::Mat image = offscreen.render(std::ref(gallery));
  EXPECT_THAT(offscreen.take_gl_errors(), IsEmpty());
  return image;
}

bool same_bytes(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

TEST(OffscreenTest, GalleryInEitherTheme) {
  const cv::Mat dark = render_gallery({.width = 1280, .height = 900}, true);
  EXPECT_FALSE(is_blank(dark, 100));
  EXPECT_TRUE(matches_golden(dark, "gallery_dark", kSceneTolerance));
  const cv::Mat light =
      render_gallery({.width = 1280, .height = 900, .look = {.theme = ThemeName::kLight}}, true);
  EXPECT_TRUE(matches_golden(light, "gallery_light", kSceneTolerance));
}

TEST(OffscreenTest, InterfaceAtTwiceItsSize) {
  const cv::Mat image = render_gallery({.width = 1600, .height = 1200, .look = {.scale = 2.0F}}, false);
  EXPECT_FALSE(is_blank(image, 100));
  EXPECT_TRUE(matches_golden(image, "interface_scale2", kInterfaceTolerance));
}

TEST(OffscreenTest, SameCallsSameBytes) {
  const OffscreenOptions options{.width = 900, .height = 700};
  EXPECT_TRUE(same_bytes(render_gallery(options, true), render_gallery(options, true)));
}

TEST(OffscreenTest, EglDrawsWhatOsMesaDraws) {
  if (!has_osmesa()) GTEST_SKIP() << "built without OSMesa";
  OffscreenOptions options{.width = 900, .height = 700, .backend = OffscreenBackend::kOsMesa};
  const cv::Mat by_osmesa = render_gallery(options, true);
  options.backend = OffscreenBackend::kEgl;
  cv::Mat by_egl;
  try {
    by_egl = render_gallery(options, true);
  } catch (const InputError& error) {
    GTEST_SKIP() << error.what();
  }
  EXPECT_TRUE(images_agree(by_egl, by_osmesa, kSceneTolerance));
}

TEST(OffscreenTest, EnvironmentChoosesTheBackend) {
  ::setenv("STILLPOINT_OFFSCREEN", "egl", 1);
  EXPECT_EQ(make_offscreen_context()->name(), "EGL surfaceless");
  ::setenv("STILLPOINT_OFFSCREEN", "vulkan", 1);
  EXPECT_THROW((void)make_offscreen_context(), InputError);
  ::unsetenv("STILLPOINT_OFFSCREEN");
}

TEST(OffscreenTest, ImpossibleSizesAreRefused) {
  for (const auto& [width, height] : {std::array{0, 600}, {800, -1}, {800, 100000}}) {
    EXPECT_THROW(Offscreen({.width = width, .height = height}), InputError);
  }
}

TEST(OffscreenTest, ResizingKeepsDrawing) {
  Offscreen offscreen({.width = 640, .height = 480});
  Gallery gallery;
  for (int i = 0; i < 30; ++i) {
    const int width = 100 + (i * 211) % 900, height = 80 + (i * 157) % 700;
    offscreen.resize(width, height);
    offscreen.draw(std::ref(gallery));
    EXPECT_EQ(offscreen.image().size(), cv::Size(width, height));
  }
  EXPECT_THAT(offscreen.take_gl_errors(), IsEmpty());
}

TEST(OffscreenTest, TwoHundredContextsLeaveNothingBehind) {
  const FrameFunction hello = [](UiFrame&) { ImGui::Text("hello"); };
  double after_warming = 0.0;
  for (int i = 0; i < 200; ++i) {
    Offscreen offscreen({.width = 64, .height = 64});
    offscreen.draw(hello);
    if (i == 20) after_warming = resident_mb();
  }
  // A context with its fonts takes several MB; 180 of them would show.
  EXPECT_LT(resident_mb() - after_warming, 30.0);
}

/// A full-size window without frame, so that positions are simple.
void begin_bare(const UiFrame& frame) {
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize(frame.size);
  ImGui::Begin("bare", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoBackground);
}

TEST(OffscreenTest, InputReachesTheInterface) {
  Offscreen offscreen({.width = 400, .height = 300});
  int clicks = 0, chords = 0;
  std::array<char, 32> text{};
  std::vector<std::string> dropped;
  const FrameFunction function = [&](UiFrame& frame) {
    begin_bare(frame);
    ImGui::SetCursorPos({20, 20});
    if (ImGui::Button("press", {100, 30})) ++clicks;
    ImGui::SetCursorPos({20, 100});
    ImGui::InputText("field", text.data(), text.size());
    if (is_chord_pressed({Key::kP, {.ctrl = true, .shift = true}})) ++chords;
    dropped.insert(dropped.end(), frame.dropped_files.begin(), frame.dropped_files.end());
    ImGui::End();
  };
  offscreen.render(function);
  const auto click = [&](float x, float y) {
    offscreen.send(MouseMoved{x, y});
    offscreen.send(MouseButton{0, true, {}});
    offscreen.send(MouseButton{0, false, {}});
    offscreen.render(function);
  };
  click(60, 35);
  EXPECT_EQ(clicks, 1);
  click(300, 250);
  EXPECT_EQ(clicks, 1);
  click(60, 110);
  for (const unsigned letter : {'h', 'o', 'i'}) offscreen.send(TextTyped{letter});
  offscreen.send(KeyChanged{Key::kBackspace, true, {}});
  offscreen.send(KeyChanged{Key::kBackspace, false, {}});
  offscreen.send(KeyChanged{Key::kP, true, {.ctrl = true, .shift = true}});
  offscreen.send(KeyChanged{Key::kP, false, {.ctrl = true, .shift = true}});
  offscreen.send(KeyChanged{Key::kP, true, {.ctrl = true}});
  offscreen.send(KeyChanged{Key::kP, false, {}});
  offscreen.send(FilesDropped{{"a/folder", "another"}});
  offscreen.render(function);
  EXPECT_STREQ(text.data(), "ho");
  EXPECT_EQ(chords, 1);
  EXPECT_THAT(dropped, ElementsAre("a/folder", "another"));
}

TEST(OffscreenTest, ListsOfMoreVerticesThanAnIndexCountsAreDrawnWhole) {
  Offscreen offscreen({.width = 200, .height = 200});
  const cv::Mat image = offscreen.render([](UiFrame&) {
    ImDrawList& list = *ImGui::GetForegroundDrawList();
    for (int i = 0; i < 40000; ++i) {
      const float x = static_cast<float>(i % 200), y = static_cast<float>(i / 200);
      list.AddRectFilled({x, y}, {x + 1, y + 1},
                         i < 39999 ? IM_COL32(0, 255, 0, 255) : IM_COL32(255, 0, 0, 255));
    }
  });
  EXPECT_EQ(image.at<cv::Vec3b>(0, 0), cv::Vec3b(0, 255, 0));
  EXPECT_EQ(image.at<cv::Vec3b>(199, 198), cv::Vec3b(0, 255, 0));
  EXPECT_EQ(image.at<cv::Vec3b>(199, 199), cv::Vec3b(0, 0, 255));
}

TEST(OffscreenTest, ClippingCutsAtTheGivenPixels) {
  Offscreen offscreen({.width = 100, .height = 80});
  const cv::Mat image = offscreen.render([](UiFrame&) {
    ImDrawList& list = *ImGui::GetForegroundDrawList();
    list.PushClipRect({10, 20}, {30, 50});
    list.AddRectFilled({0, 0}, {100, 80}, IM_COL32(255, 255, 255, 255));
    list.PopClipRect();
  });
  cv::Mat white;
  cv::inRange(image, cv::Scalar::all(255), cv::Scalar::all(255), white);
  EXPECT_EQ(cv::boundingRect(white), cv::Rect(10, 20, 20, 30));
  EXPECT_EQ(cv::countNonZero(white), 20 * 30);
}

TEST(OffscreenTest, ListsAreDrawnAtTheFramebuffersScale) {
  Offscreen offscreen({.width = 100, .height = 80});
  offscreen.draw([](UiFrame&) {
    ImDrawList& list = *ImGui::GetForegroundDrawList();
    list.PushClipRect({10, 20}, {30, 50});
    list.AddRectFilled({0, 0}, {100, 80}, IM_COL32(255, 255, 255, 255));
    list.PopClipRect();
  });
  ImDrawData data = *ImGui::GetDrawData();
  data.FramebufferScale = {2.0F, 2.0F};
  const Framebuffer target(offscreen.gl(), 200, 160);
  ImGuiRenderer(offscreen.gl()).draw(data, target, {0.0F, 0.0F, 0.0F, 1.0F});
  cv::Mat white;
  cv::inRange(target.read(), cv::Scalar::all(255), cv::Scalar::all(255), white);
  EXPECT_EQ(cv::boundingRect(white), cv::Rect(20, 40, 40, 60));
  EXPECT_THAT(offscreen.take_gl_errors(), IsEmpty());
}

TEST(OffscreenTest, LooksChangeFromTheNextFrameOn) {
  Offscreen offscreen({.width = 64, .height = 64});
  offscreen.draw([](UiFrame& frame) { frame.wanted_look = {ThemeName::kLight, 1.5F}; });
  offscreen.draw([](UiFrame& frame) {
    EXPECT_EQ(frame.theme.name, ThemeName::kLight);
    EXPECT_EQ(frame.scale, 1.5F);
    EXPECT_EQ(frame.fonts.text->FontSize, 23.0F);
  });
}

TEST(OffscreenTest, FontsHaveTheSignsWeWrite) {
  Offscreen offscreen({.width = 64, .height = 64});
  offscreen.draw([](UiFrame& frame) {
    for (const int sign : {0x2013, 0x2026, 0x00B0, 0x00D7, 0x2212, 0x2264, 0x2192, 0x03C3, 0x25A0, 0x2713}) {
      EXPECT_NE(frame.fonts.text->FindGlyphNoFallback(static_cast<ImWchar>(sign)), nullptr)
          << std::hex << sign;
      EXPECT_NE(frame.fonts.small->FindGlyphNoFallback(static_cast<ImWchar>(sign)), nullptr)
          << std::hex << sign;
    }
    for (const int sign : {0x2212, 0x00B1, 0x00B0, 0x2026}) {
      EXPECT_NE(frame.fonts.mono->FindGlyphNoFallback(static_cast<ImWchar>(sign)), nullptr)
          << std::hex << sign;
    }
    EXPECT_NE(frame.fonts.strong->FindGlyphNoFallback(0xF04B), nullptr);
  });
}

}  // namespace
}  // namespace stillpoint::testing
