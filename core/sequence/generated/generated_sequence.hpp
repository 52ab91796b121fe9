#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/sequence/source.hpp"

namespace stillpoint {

/// A scene that another camera can look at: what generated sequences are beside FrameSource.
class FilmedScene {
 public:
  virtual ~FilmedScene() = default;
  /// A frame's depth as a depth camera beside the sequence's measures it.
  /// @param depth whose distortion is not rendered
  /// @returns CV_32FC1 of the depth camera's size, m, 0 = no measurement
  [[nodiscard]] virtual cv::Mat depth_seen_by(const DepthCamera& depth, int index) const = 0;
};

/// The kinds of generated sequence: the benchmark's nine by name, `room` (nothing moves), `approach` (motion
/// along the optical axis) and `cup` (a small thing pushed across a table).
[[nodiscard]] const std::vector<std::string>& generated_kinds();
/// Beside them `room_shaken` and `walking_shaken`: the camera is turned by jerks while it exposes long, so
/// that for some frames in a row there is little but blur. Harder than the benchmark, and not among
/// generated:all.
[[nodiscard]] const std::vector<std::string>& hard_generated_kinds();

/// What ends the name of a kind that is filmed by a stereo pair: "walking_xyz:stereo".
inline constexpr std::string_view kStereoEnding = ":stereo";

/// When the sensor of a generated sequence takes what. Written behind a kind as `:name=seconds`, by these
/// names: "room:readout_s=0.02:depth_delay_s=-0.01".
struct SensorTiming {
  double readout_s = 0.0;                   ///< as Camera has it: rows are taken one after the other
  std::optional<double> depth_readout_s{};  ///< … of depth; nothing = as colour's
  double depth_delay_s = 0.0;          ///< from a depth image's stamp, which is colour's, to its middle row
  std::optional<double> exposure_s{};  ///< of colour; nothing = the kind's own
};

/// A sequence filmed in a furnished room by ray casting: 640x480 at 30 Hz through camera `generated` and a
/// Kinect-like sensor (generated/sensor.hpp), with exact poses and masks.
///
/// A frame depends on (kind, seed, index) alone, so a longer sequence begins with the shorter one. Depth is
/// what a 16-bit depth image at 5000 a metre gives back, so that a sequence written to a folder reads the
/// same.
///
/// Poses are those at the middle of the exposure of the middle row, masks those of what the image shows. The
/// moving mask holds people whole, also while they stand or sit (they belong to what is dynamic in the
/// sequence, and never keep quite still), the cart that is pushed, and small things (mug, stick) while they
/// move faster than 5 mm/s here or a frame before or after. Furniture, chairs and shadows are not moving.
/// KIND:stereo is the same scene filmed by a stereo pair: the left image is that of KIND to the byte, the
/// right one is filmed 0.12 m beside it, with noise and exposure of its own, and depth comes of matching the
/// two.
/// @param kind with its endings, `:stereo` or those of SensorTiming; a rolling shutter is filmed in bands of
/// 8 rows
/// @param frames how many; 0 = the kind's own length, 300.
/// @param timing_of whose readouts and delay camera() is to have in place of the true ones
/// @throws InputError for an unknown kind, naming the kinds, for a number of frames below 0 or above 100,000,
/// and for a time that is none.
[[nodiscard]] std::unique_ptr<FrameSource> make_generated_sequence(
    std::string_view kind, int frames, unsigned seed, const StereoOptions& stereo = {},
    const std::optional<Camera>& timing_of = {});

}  // namespace stillpoint
