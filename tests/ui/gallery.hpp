#pragma once

#include <memory>
#include <vector>

#include "ui/gl/texture.hpp"
#include "ui/plot/plot.hpp"
#include "ui/scene/scene_widget.hpp"
#include "ui/shell/ui_frame.hpp"
#include "ui/view/image_widget.hpp"

namespace stillpoint::testing {

/// A made-up run: a walk around a table, its drifting estimate, a worse baseline, points on walls and table.
[[nodiscard]] SceneData example_scene(int poses, int points);

/// A grey picture with shapes and fine texture, 8UC3.
[[nodiscard]] cv::Mat example_image(int width = 320, int height = 240);

/// One frame with all that the foundations offer: widgets, plots, an image panel and the trajectory view. The
/// same object must be drawn by one shell only, whose GL context its textures belong to.
class Gallery {
 public:
  explicit Gallery(bool with_scene = true);
  ~Gallery();
  void operator()(UiFrame& frame);

  SceneData scene;
  SceneView scene_view;
  ImageView image_view;
  PlotView plot_view;
  SceneResponse scene_response;
  ImageResponse image_response;
  PlotResponse plot_response;

 private:
  void plots(const UiFrame& frame, ImVec2 size);
  void widgets(const UiFrame& frame);

  bool with_scene_;
  std::unique_ptr<SceneWidget> scene_widget_;
  std::unique_ptr<Texture> texture_, mask_;
  cv::Mat image_;
  std::vector<double> time_, rpe_, baseline_, bins_, counts_;
  float opacity_ = 0.6F;
  bool linked_ = true;
};

}  // namespace stillpoint::testing
