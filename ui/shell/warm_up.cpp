#include "ui/shell/warm_up.hpp"

#include "ui/gl/texture.hpp"

namespace stillpoint {

void warm_up(Canvas& canvas, int width, int height) {
  canvas.frame_unseen(width, height, 0.0, [](UiFrame&) {});
  // Drivers tell sides that are powers of two from others, and a frame's are not.
  constexpr int kWidth = 20, kHeight = 12;
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4})
    Texture(canvas.gl(), Sampling::kPixels).upload(cv::Mat(kHeight, kWidth, type, cv::Scalar::all(0)));
}

}  // namespace stillpoint
