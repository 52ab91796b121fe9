#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <opencv2/imgproc.hpp>

#include "tests/support/golden.hpp"
#include "tests/ui/gallery.hpp"
#include "ui/gl/texture.hpp"
#include "ui/shell/offscreen.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/rounded.hpp"
#include "ui/theme/text.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::IsEmpty;

/// The gallery offscreen, driven by events as a person would.
class WidgetsTest : public ::testing::Test {
 protected:
  void SetUp() override { render(); }
  void TearDown() override { EXPECT_THAT(offscreen.take_gl_errors(), IsEmpty()); }

  cv::Mat render() { return offscreen.render(std::ref(gallery)); }
  void move_to(ImVec2 place) {
    offscreen.send(MouseMoved{place.x, place.y});
    render();
  }
  void press(int button, bool down) {
    offscreen.send(MouseButton{button, down, {}});
    offscreen.draw(std::ref(gallery));
  }
  void drag(ImVec2 from, ImVec2 to, int button) {
    move_to(from);
    press(button, true);
    for (int step = 1; step <= 4; ++step) {
      const float share = static_cast<float>(step) / 4.0F;
      offscreen.send(MouseMoved{from.x + share * (to.x - from.x), from.y + share * (to.y - from.y)});
      offscreen.draw(std::ref(gallery));
    }
    press(button, false);
    render();
  }
  ImVec2 image_place(double x, double y) const { return gallery.image_response.to_screen(RasterPoint(x, y)); }
  cv::Mat image_panel(const cv::Mat& whole) const {
    const ImageResponse& panel = gallery.image_response;
    return whole(
        cv::Rect(cv::Point(static_cast<int>(panel.panel_min.x), static_cast<int>(panel.panel_min.y)),
                 cv::Point(static_cast<int>(panel.panel_max.x), static_cast<int>(panel.panel_max.y))));
  }
  ImVec2 scene_middle() const {
    return gallery.scene_response.to_screen(
        {0.5 * gallery.scene_response.viewport.width, 0.5 * gallery.scene_response.viewport.height});
  }

  Offscreen offscreen{{.width = 1280, .height = 900}};
  Gallery gallery;
};

TEST_F(WidgetsTest, ImageTellsThePixelUnderTheMouse) {
  move_to(image_place(100.5, 60.5));
  EXPECT_EQ(gallery.image_response.pixel, Eigen::Vector2i(100, 60));
  move_to({2.0F, 2.0F});
  EXPECT_EQ(gallery.image_response.pixel, std::nullopt);
}

TEST_F(WidgetsTest, ImageZoomsAboutTheMouseAndShowsNumbers) {
  const ImVec2 place = image_place(60.5, 118.5);
  move_to(place);
  // ImGui keeps the mouse on whole pixels, so it may point beside the place asked for.
  const auto before = gallery.image_response.pixel;
  for (int i = 0; i < 20; ++i) {
    offscreen.send(MouseWheel{0.0F, 1.0F, {}});
    offscreen.draw(std::ref(gallery));
  }
  const cv::Mat zoomed = render();
  EXPECT_GT(gallery.image_response.map.scale(), 32.0);
  EXPECT_EQ(gallery.image_response.pixel, before);
  EXPECT_TRUE(matches_golden(image_panel(zoomed), "image_numbers"));
}

TEST_F(WidgetsTest, ImagePansAndFitsAgain) {
  gallery.image_view.zoom = 3.0;
  render();
  const ImVec2 from = image_place(150.0, 110.0);
  drag(from, {from.x + 40.0F, from.y + 24.0F}, 0);
  const ImVec2 now = image_place(150.0, 110.0);
  EXPECT_NEAR(now.x - from.x, 40.0F, 0.01F);
  EXPECT_NEAR(now.y - from.y, 24.0F, 0.01F);
  for (int i = 0; i < 2; ++i) {
    press(0, true);
    press(0, false);
  }
  render();
  EXPECT_EQ(gallery.image_view, ImageView{});
}

TEST_F(WidgetsTest, SceneIsDrawn) {
  const auto& viewport = gallery.scene_response.viewport;
  const ImVec2 corner = gallery.scene_response.panel_min;
  const cv::Rect area(static_cast<int>(corner.x), static_cast<int>(corner.y),
                      static_cast<int>(viewport.width), static_cast<int>(viewport.height));
  EXPECT_FALSE(is_blank(render()(area), 200));
}

TEST_F(WidgetsTest, HoveringAPoseFindsIt) {
  const std::size_t wanted = 410;
  const ScenePath& estimate = gallery.scene.paths[2];
  ASSERT_TRUE(estimate.pickable);
  const auto seen =
      project(gallery.scene_view, gallery.scene_response.viewport, estimate.positions[wanted].cast<double>());
  ASSERT_TRUE(seen);
  const ImVec2 place = gallery.scene_response.to_screen(seen->head<2>());
  move_to(place);
  ASSERT_TRUE(gallery.scene_response.pose);
  EXPECT_EQ(gallery.scene_response.pose->path, 2U);
  EXPECT_NEAR(static_cast<double>(gallery.scene_response.pose->index), static_cast<double>(wanted), 2.0);
  move_to({gallery.scene_response.panel_min.x + 5.0F, gallery.scene_response.panel_min.y + 300.0F});
  EXPECT_FALSE(gallery.scene_response.pose);
}

TEST_F(WidgetsTest, PickedPlaceIsWhereTheLineIsDrawn) {
  // Projection for picking and projection by the shader must be the same: the pixel there has the line's
  // colour.
  gallery.scene.show_grid = false;
  gallery.scene.points.clear();
  gallery.scene.keyframes.clear();
  gallery.scene.errors.clear();
  gallery.scene.paths.erase(gallery.scene.paths.begin(), gallery.scene.paths.begin() + 2);
  ++gallery.scene.revision;
  const cv::Mat image = render();
  const Rgb colour = role_colour(Role::kEstimate, ThemeName::kDark);
  int found = 0;
  for (const std::size_t index : {50UL, 150UL, 250UL, 350UL}) {
    const auto seen = project(gallery.scene_view, gallery.scene_response.viewport,
                              gallery.scene.paths[0].positions[index].cast<double>());
    const ImVec2 place = gallery.scene_response.to_screen(seen->head<2>());
    const auto& bgr = image.at<cv::Vec3b>(static_cast<int>(place.y), static_cast<int>(place.x));
    if (std::abs(bgr[0] - colour.b) < 40 && std::abs(bgr[1] - colour.g) < 40 &&
        std::abs(bgr[2] - colour.r) < 60)
      ++found;
  }
  EXPECT_GE(found, 3);
}

TEST_F(WidgetsTest, SceneOrbitsPansAndZooms) {
  const SceneView before = gallery.scene_view;
  const ImVec2 middle = scene_middle();
  drag(middle, {middle.x + 60.0F, middle.y}, 0);
  EXPECT_FALSE(gallery.scene_view.world_from_view.isApprox(before.world_from_view));
  EXPECT_TRUE(gallery.scene_view.target.isApprox(before.target));
  drag(middle, {middle.x + 60.0F, middle.y}, 1);
  EXPECT_FALSE(gallery.scene_view.target.isApprox(before.target));
  offscreen.send(MouseWheel{0.0F, 2.0F, {}});
  render();
  EXPECT_LT(gallery.scene_view.distance, before.distance);
}

TEST_F(WidgetsTest, PlotHoversClicksZoomsAndPans) {
  const ImVec2 place{700.0F, 650.0F};
  move_to(place);
  ASSERT_TRUE(gallery.plot_response.hovered_x);
  const double under = *gallery.plot_response.hovered_x;
  EXPECT_GT(under, 0.0);
  EXPECT_LT(under, 30.0);
  EXPECT_FALSE(gallery.plot_response.clicked_x);
  offscreen.send(MouseWheel{0.0F, 3.0F, {}});
  const cv::Mat hovered = render();
  ASSERT_TRUE(gallery.plot_view.x);
  EXPECT_LT(gallery.plot_view.x->span(), 30.0);
  EXPECT_NEAR(*gallery.plot_response.hovered_x, under, 1e-6);
  EXPECT_TRUE(matches_golden(hovered.rowRange(500, 900), "plot_hover"));

  const AxisRange before = *gallery.plot_view.x;
  drag(place, {place.x + 100.0F, place.y}, 1);
  EXPECT_LT(gallery.plot_view.x->low, before.low);
  EXPECT_NEAR(gallery.plot_view.x->span(), before.span(), 1e-9);

  move_to(place);
  press(0, true);
  ASSERT_TRUE(gallery.plot_response.clicked_x);
  EXPECT_NEAR(*gallery.plot_response.clicked_x, *gallery.plot_response.hovered_x, 1e-9);
  press(0, false);
}

TEST_F(WidgetsTest, EmptyPlotsImagesAndScenesAreDrawnToo) {
  SceneWidget scene_widget(offscreen.gl());
  const SceneData nothing;
  SceneView view;
  ImageView image_view;
  PlotView plot_view{.log_y = true};
  const cv::Mat image = offscreen.render([&](UiFrame& frame) {
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize({600, 800});
    ImGui::Begin("empty");
    draw_plot(frame, "plot", Plot{.x_label = "time", .x_unit = "s"}, plot_view, {0, 200});
    draw_image(frame, "image", ImageContent{.absent = "This sequence has no depth."}, image_view, {0, 200});
    scene_widget.draw(frame, "scene", nothing, view, {0, 200});
    ImGui::End();
  });
  EXPECT_FALSE(is_blank(image, 20));
  EXPECT_TRUE(matches_golden(image(cv::Rect(0, 0, 600, 800)), "empty"));
}

TEST(Text, LinesEndAtSpacesAndFiguresKeepTheirUnits) {
  Offscreen offscreen({.width = 64, .height = 64});
  offscreen.draw([](UiFrame& frame) {
    const ImFont& font = *frame.fonts.text;
    const auto width = [&](const std::string& text) {
      return font.CalcTextSizeA(font.FontSize, 1e6F, 0.0F, text.c_str()).x;
    };
    const std::string text = "frame 417 was lost for 0.81 s after 12 px of blur";
    for (const float room : {90.0F, 120.0F, 150.0F}) {
      const std::string lines = in_lines(font, text, room);
      std::string whole = lines;
      std::replace(whole.begin(), whole.end(), '\n', ' ');
      EXPECT_EQ(whole, text);
      EXPECT_NE(lines, text);
      EXPECT_EQ(lines.find("0.81\n"), std::string::npos) << lines;
      EXPECT_EQ(lines.find("12\n"), std::string::npos) << lines;
      for (std::size_t at = 0; at < lines.size();) {
        const std::size_t end = std::min(lines.find('\n', at), lines.size());
        EXPECT_LE(width(lines.substr(at, end - at)), room) << lines;
        at = end + 1;
      }
    }
    EXPECT_FLOAT_EQ(widest_word(font, "a longest b"), width("longest"));
    EXPECT_LE(width(cut_to(font, text, 100.0F)), 100.0F);
    EXPECT_EQ(cut_to(font, text, 1e4F), text);
  });
}

/// What a function draws into a window without decoration.
cv::Mat drawn_by(const std::function<void(ImDrawList&)>& draw) {
  Offscreen offscreen({.width = 200, .height = 160});
  return offscreen.render([&](UiFrame&) { draw(*ImGui::GetBackgroundDrawList()); });
}

TEST(RoundedTest, IsFilledToTheSamePixelsAsInOneGo) {
  struct Case {
    ImVec2 low, high;
    float rounding;
  };
  for (const Case& one : {Case{{20, 10}, {180, 150}, 6.0F}, Case{{20, 10}, {180, 150}, 9.5F},
                          Case{{20, 10}, {180, 150}, 2.0F}, Case{{20.4F, 10.3F}, {180.1F, 150.6F}, 6.0F},
                          Case{{20, 10}, {30, 150}, 6.0F}, Case{{20, 10}, {180, 24}, 6.0F}}) {
    const ImU32 colour = IM_COL32(40, 120, 200, 255);
    const cv::Mat in_one =
        drawn_by([&](ImDrawList& list) { list.AddRectFilled(one.low, one.high, colour, one.rounding); });
    const cv::Mat in_parts =
        drawn_by([&](ImDrawList& list) { fill_rounded(list, one.low, one.high, colour, one.rounding); });
    EXPECT_GT(cv::norm(in_one, cv::NORM_INF), 0.0);
    EXPECT_LE(cv::norm(in_one, in_parts, cv::NORM_INF), one.rounding < 3.0F ? 1.0 : 0.0)
        << one.low.x << ' ' << one.high.x << ' ' << one.high.y << ' ' << one.rounding;
  }
}

TEST(CoverTest, LiesOverAPictureAsItsColourWithAlphaDoes) {
  const Rgb colour{230, 120, 30};
  cv::Mat mask(96, 128, CV_8UC1, cv::Scalar(0));
  cv::circle(mask, {70, 40}, 19, cv::Scalar(255), cv::FILLED);
  cv::Mat tinted(mask.size(), CV_8UC4, cv::Scalar(colour.b, colour.g, colour.r, 0));
  tinted.setTo(cv::Scalar(colour.b, colour.g, colour.r, 255), mask);
  const auto over_picture = [&](const cv::Mat& over, Rgb times, std::optional<cv::Rect> part) {
    Offscreen offscreen({.width = 200, .height = 160});
    Texture picture(offscreen.gl()), cover(offscreen.gl(), Sampling::kPixels, OneChannel::kCover);
    picture.upload(example_image(128, 96));
    cover.upload(over);
    EXPECT_FALSE(is_opaque(cover.imgui_id()));
    ImageView view;
    cv::Mat image = offscreen.render([&](UiFrame& frame) {
      ImageContent content{.texture = &picture};
      content.overlays.push_back({&cover, 0.55F, times, part});
      ImGui::SetNextWindowPos({0, 0});
      ImGui::Begin("picture", nullptr, ImGuiWindowFlags_NoDecoration);
      draw_image(frame, "image", content, view, {100, 80});
      ImGui::End();
    });
    offscreen.make_current();
    return image;
  };
  const cv::Mat with_alpha = over_picture(tinted, {255, 255, 255}, std::nullopt);
  const cv::Rect round_it = cv::boundingRect(mask);
  const cv::Rect part =
      cv::Rect(round_it.tl() - cv::Point(8, 8), round_it.br() + cv::Point(8, 8)) & cv::Rect({}, mask.size());
  EXPECT_LE(cv::norm(with_alpha, over_picture(mask, colour, std::nullopt), cv::NORM_INF), 1.0);
  EXPECT_LE(cv::norm(with_alpha, over_picture(mask, colour, part), cv::NORM_INF), 1.0);
  EXPECT_GT(cv::norm(with_alpha, over_picture(mask, colour, cv::Rect()), cv::NORM_INF), 30.0)
      << "without it the picture is another";
}

}  // namespace
}  // namespace stillpoint::testing
