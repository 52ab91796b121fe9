#include "tests/ui/gallery.hpp"

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <random>

#include "ui/gl/texture.hpp"
#include "ui/shell/ui_frame.hpp"
#include "ui/theme/fonts.hpp"
#include "ui/theme/icons.hpp"
#include "ui/theme/theme.hpp"

namespace stillpoint::testing {
namespace {

constexpr int kSamples = 900;

ImGuiWindowFlags tile_flags() {
  return ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse;
}

void begin_tile(const char* name, ImVec2 low, ImVec2 high) {
  ImGui::SetNextWindowPos(low);
  ImGui::SetNextWindowSize({high.x - low.x, high.y - low.y});
  ImGui::Begin(name, nullptr, tile_flags());
}

}  // namespace

SceneData example_scene(int poses, int points) {
  SceneData scene;
  ScenePath truth{.name = "ground truth", .role = Role::kGroundTruth, .width_px = 2.0F};
  ScenePath estimate{.name = "estimate", .role = Role::kEstimate, .width_px = 3.0F, .pickable = true};
  ScenePath baseline{.name = "baseline", .role = Role::kBaseline, .width_px = 2.0F};
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 1.0);
  Eigen::Vector3d drift = Eigen::Vector3d::Zero(), worse = Eigen::Vector3d::Zero();
  const double step = std::sqrt(600.0 / poses);
  for (int i = 0; i < poses; ++i) {
    const double angle = 1.7 * std::numbers::pi * i / poses;
    const Eigen::Vector3d place{1.6 * std::cos(angle), 1.2 * std::sin(angle),
                                1.4 + 0.15 * std::sin(3.0 * angle)};
    const auto wander = [&](double size) -> Eigen::Vector3d {
      return size * step * Eigen::Vector3d(noise(random), noise(random), noise(random));
    };
    drift = 0.995 * drift + wander(0.0025);
    worse = 0.999 * worse + wander(0.011);
    truth.positions.push_back(place.cast<float>());
    estimate.positions.push_back((place + drift).cast<float>());
    baseline.positions.push_back((place + worse).cast<float>());
    if (i % std::max(1, poses / 120) == 0) {
      scene.errors.push_back(
          {truth.positions.back(), estimate.positions.back(), static_cast<float>(drift.norm())});
    }
    Eigen::Matrix3d world_from_camera;
    const Eigen::Vector3d forward = (Eigen::Vector3d(0.0, 0.0, 0.9) - place).normalized();
    const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
    world_from_camera << right, forward.cross(right), forward;
    Pose pose = Pose::Identity();
    pose.linear() = world_from_camera;
    pose.translation() = place + drift;
    if (i % std::max(1, poses / 40) == 0) scene.keyframes.push_back(pose);
    scene.current = pose;
  }
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int i = 0; i < points; ++i) {
    Eigen::Vector3d place;
    if (i % 3 == 0)
      place = {3.0 * share(random) - 1.5, 2.0 * share(random) - 1.0, 0.75 + 0.01 * noise(random)};
    else if (i % 3 == 1)
      place = {-3.0 + 0.01 * noise(random), 6.0 * share(random) - 3.0, 2.5 * share(random)};
    else
      place = {6.0 * share(random) - 3.0, 3.0 + 0.01 * noise(random), 2.5 * share(random)};
    scene.points.push_back({place.cast<float>(), false});
  }
  for (int i = 0; i < points / 25; ++i) {
    const Eigen::Vector3d place{0.6 + 0.14 * noise(random), 1.6 + 0.12 * noise(random), 1.75 * share(random)};
    scene.points.push_back({place.cast<float>(), true});
  }
  scene.error_scale_m = 0.05F;
  scene.current_image = example_image();
  scene.paths = {std::move(truth), std::move(baseline), std::move(estimate)};
  return scene;
}

cv::Mat example_image(int width, int height) {
  cv::Mat image(height, width, CV_8UC3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int texture = ((x * 7919) ^ (y * 104729)) % 23;
      image.at<cv::Vec3b>(y, x) = {cv::saturate_cast<std::uint8_t>(90 + 60 * y / height + texture),
                                   cv::saturate_cast<std::uint8_t>(100 + 70 * x / width + texture),
                                   cv::saturate_cast<std::uint8_t>(120 + texture)};
    }
  }
  cv::rectangle(image, {width / 12, height / 2, width / 3, height / 3}, {60, 90, 140}, cv::FILLED);
  cv::circle(image, {2 * width / 3, height / 3}, height / 6, {200, 210, 220}, cv::FILLED);
  cv::rectangle(image, {5 * width / 9, height / 2, width / 5, height / 2}, {150, 70, 60}, cv::FILLED);
  return image;
}

Gallery::Gallery(bool with_scene)
    : scene(example_scene(600, with_scene ? 6000 : 0)), with_scene_(with_scene), image_(example_image()) {
  look_from(scene_view, ViewPreset::kOblique, scene.up);
  fit(scene_view, {760, 480}, bounds(scene));
  scene_view.distance *= 1.1;
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 1.0);
  for (int i = 0; i < kSamples; ++i) {
    const double t = i / 30.0;
    time_.push_back(t);
    rpe_.push_back(0.008 + 0.002 * std::abs(noise(random)) + 0.01 * std::exp(-std::pow(t - 12.0, 2)));
    baseline_.push_back(0.01 + 0.006 * std::abs(noise(random)) +
                        0.09 * std::exp(-0.3 * std::pow(t - 12.0, 2)));
    if (i > 600 && i < 660) rpe_.back() = std::nan("");
  }
  for (int i = 0; i < 64; ++i) {
    bins_.push_back(4.0 * i);
    counts_.push_back(
        std::round(120000.0 * std::exp(-i / 3.0) + 900.0 * std::exp(-0.01 * (i - 38) * (i - 38)) + 1.0));
  }
}

Gallery::~Gallery() = default;

void Gallery::plots(const UiFrame& frame, ImVec2 size) {
  const ThemeName name = frame.theme.name;
  Plot plot{.x_label = "time", .x_unit = "s", .y_label = "RPE per second", .y_unit = "m"};
  plot.series.push_back(
      {"baseline", time_, baseline_, role_colour(Role::kBaseline, name), SeriesStyle::kDashed});
  plot.series.push_back({"paper", time_, rpe_, role_colour(Role::kEstimate, name), SeriesStyle::kLine});
  plot.levels.push_back({0.05, "break at 0.05 m", role_colour(Role::kWarning, name)});
  plot.bands.push_back({{20.0, 22.0}, role_colour(Role::kRemoved, name)});
  plot.cursor_x = 12.4;
  plot_response = draw_plot(frame, "rpe", plot, plot_view, {size.x, 0.58F * size.y});
  Plot histogram{.x_label = "difference", .x_unit = "grey levels", .y_label = "pixels", .y_unit = ""};
  histogram.series.push_back({"", bins_, counts_, frame.theme.accent, SeriesStyle::kBars});
  histogram.marks.push_back({61.0, "Otsu 61", role_colour(Role::kWarning, name)});
  PlotView log_view{.log_y = true};
  draw_plot(frame, "histogram", histogram, log_view);
}

void Gallery::widgets(const UiFrame& frame) {
  ImGui::Button(icons::kFastBack);
  ImGui::SameLine();
  ImGui::Button(icons::kStepBack);
  ImGui::SameLine();
  ImGui::Button(icons::kPlay);
  ImGui::SameLine();
  ImGui::Button(icons::kStepForward);
  ImGui::SameLine();
  ImGui::Checkbox("Link views", &linked_);
  ImGui::SetNextItemWidth(160.0F * frame.scale);
  ImGui::SliderFloat("Opacity", &opacity_, 0.0F, 1.0F, "%.2f");
  ImGui::SameLine();
  ImGui::TextDisabled("x 412  y 207");
  ImGui::PushFont(frame.fonts.mono);
  ImGui::Text("0123456789  −0.0512 m  ± 3σ");
  ImGui::PopFont();
}

void Gallery::operator()(UiFrame& frame) {
  if (!texture_) {
    texture_ = std::make_unique<Texture>(frame.gl);
    texture_->upload(image_);
    cv::Mat mask(image_.size(), CV_8UC4, cv::Scalar::all(0));
    cv::circle(mask, {210, 80}, 44, {0, 94, 213, 255}, cv::FILLED);
    mask_ = std::make_unique<Texture>(frame.gl, Sampling::kNearest);
    mask_->upload(mask);
    if (with_scene_) scene_widget_ = std::make_unique<SceneWidget>(frame.gl);
  }
  const float split_x = std::round(0.58F * frame.size.x), split_y = std::round(0.55F * frame.size.y),
              gap = 4.0F;
  begin_tile("Trajectory", {gap, gap}, {split_x, split_y});
  if (with_scene_)
    scene_response = scene_widget_->draw(frame, "scene", scene, scene_view);
  else
    ImGui::TextWrapped("No trajectory yet. Open a sequence, or drop a folder here. Größe: 3 µm, α ≤ β → γ ✓");
  ImGui::End();

  begin_tile("Union mask", {split_x + gap, gap}, {frame.size.x - gap, split_y});
  widgets(frame);
  ImageContent content;
  content.texture = texture_.get();
  content.values = &image_;
  content.overlays.push_back({mask_.get(), opacity_});
  image_response = draw_image(frame, "image", content, image_view);
  ImGui::End();

  begin_tile("Error over time", {gap, split_y + gap}, {frame.size.x - gap, frame.size.y - gap});
  plots(frame, ImGui::GetContentRegionAvail());
  ImGui::End();
}

}  // namespace stillpoint::testing
